"""Checks the links within the built site: every file and every anchor that a page leads to must exist."""

from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urldefrag, urlsplit

from sphinx.application import Sphinx
from sphinx.util import logging

__all__ = ["dead_links"]

_LEADING = {"a": "href", "link": "href", "img": "src", "script": "src", "iframe": "src", "source": "src"}


class _Reader(HTMLParser):
    """Collects the anchors and the links of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take what the attributes of an element name."""
        given = dict(attrs)
        self.anchors.update(value for key in ("id", "name") if (value := given.get(key)))
        target = given.get(_LEADING.get(tag, ""))
        if target:
            self.links.append(target)


def dead_links(site: Path) -> list[str]:
    """Links of the pages of a folder that lead nowhere, as ``PAGE: TARGET``; those to other sites are not looked at."""
    read: dict[Path, _Reader] = {}
    for path in sorted(site.rglob("*.html")):
        if path.is_relative_to(site / "scenes"):
            continue  # pages that show scenes link to nothing
        read[path] = _Reader()
        read[path].feed(path.read_text(encoding="utf-8"))
    dead = []
    for path, page in read.items():
        for link in page.links:
            address, anchor = urldefrag(link)
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            linked_page = read.get(target)
            if not target.exists() or (
                anchor
                and anchor != "top"
                and linked_page is not None
                and unquote(anchor) not in linked_page.anchors
            ):
                dead.append(f"{path.relative_to(site)}: {link}")
    return dead


def _check(app: Sphinx, exception: Exception | None) -> None:
    if exception is None and app.builder.name == "html":
        for line in dead_links(Path(app.outdir)):
            logging.getLogger(__name__).warning("dead link in %s", line)


def setup(app: Sphinx) -> dict[str, Any]:
    """Check links when the site is complete."""
    app.connect("build-finished", _check, priority=900)
    return {"version": "1", "parallel_read_safe": True}
