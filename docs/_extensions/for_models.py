"""Texts for language models: ``llms.txt``, ``llms-full.txt``, and ``snippets.jsonl`` with one checked example a line.

The build of the site writes them. A copy of the snippets is in the package (``scenic/language/snippets.jsonl``), where ``scenic mcp``
searches them: ``python -m docs._extensions.for_models`` writes it again.
"""

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from docs._extensions.blocks import blocks_of
from docs._extensions.declared import (
    class_text,
    operator_text,
    provided_text,
    specifier_text,
    statement_text,
    temporal_text,
)

__all__ = ["COPY", "full_text", "index_text", "snippets", "write_copy"]

DOCS = Path(__file__).parents[1]
COPY = DOCS.parent / "scenic" / "language" / "snippets.jsonl"
_FOLDERS = ("tutorial", "howto", "reference", "explanation")
_DIRECTIVE = re.compile(r"^```\{(\w[\w-]*)\}[ \t]*([^\n]*)\n(?:.*?\n)??```\n", re.MULTILINE | re.DOTALL)
_TEXTS = {
    "class": class_text,
    "operator": operator_text,
    "provided": provided_text,
    "specifier": specifier_text,
    "statement": statement_text,
    "temporal": temporal_text,
}
_HEADING = re.compile(r"^(#+) (.+)$")
_LONGEST = 1500
"""Characters of the text of a snippet."""


def pages() -> Iterator[tuple[str, str]]:
    """The pages of the site by their names, in the order of the site, with declarations in words."""
    for folder in _FOLDERS:
        files = sorted((DOCS / folder).glob("*.md"), key=lambda file: (file.name != "index.md", file.name))
        for file in files:
            yield f"{folder}/{file.stem}", _expanded(file.read_text(encoding="utf-8"))


def _expanded(text: str) -> str:
    """A page in which directives are replaced by the text of the declarations; pictures are left out."""

    def replacement(found: re.Match[str]) -> str:
        make = _TEXTS.get(found[1])
        return "" if make is None else make(found[2].strip())

    return _DIRECTIVE.sub(replacement, text)


def index_text() -> str:
    """``llms.txt``: all pages with their first sentences."""
    lines = [
        "# Scenic",
        "",
        "> A language for scenarios: programs describe distributions of scenes of objects, and their behavior over time.",
        "",
        "- [All pages as one text](llms-full.txt)",
        "- [Examples, one JSON object a line](snippets.jsonl)",
    ]
    folder = ""
    for name, text in pages():
        if name.partition("/")[0] != folder:
            folder = name.partition("/")[0]
            lines += ["", f"## {folder.capitalize()}", ""]
        title = text.partition("\n")[0].removeprefix("# ").strip()
        lines.append(f"- [{title}]({name}.html): {_first_sentence(text)}")
    return "\n".join(lines) + "\n"


def _first_sentence(text: str) -> str:
    for paragraph in text.split("\n\n")[1:]:
        plain = " ".join(paragraph.split())
        if plain and plain[0] not in "#`|-{<![*:(" and not plain[0].isdigit():
            return re.split(r"(?<=[.:])\s", plain, maxsplit=1)[0]
    return ""


def full_text() -> str:
    """``llms-full.txt``: all pages, one after the other."""
    return "\n\n".join(text.strip() for _, text in pages()) + "\n"


def snippets() -> Iterator[Mapping[str, Any]]:
    """The examples of all pages: where each is, the headings above it, the text before it, and the program."""
    for name, text in pages():
        lines = text.splitlines()
        for block in blocks_of(text):
            if block.language != "scenic" or not block.text.strip() or "wrong" in block.options:
                continue
            headings, start = _headings(lines, block.first)
            yield {
                "topic": headings[-1],
                "section": " / ".join(headings),
                "page": f"{name}.html",
                "text": _text_before(lines[start : block.first]),
                "program": block.text,
            }


def _headings(lines: list[str], end: int) -> tuple[list[str], int]:
    """The headings above a line, and the line after the last of them."""
    above: list[tuple[int, str]] = []
    start, is_code = 0, False
    for number, line in enumerate(lines[:end]):
        is_code ^= line.startswith("```")
        heading = None if is_code else _HEADING.match(line)
        if heading is not None:
            above = [item for item in above if item[0] < len(heading[1])]
            above.append((len(heading[1]), heading[2].strip()))
            start = number + 1
    return [title for _, title in above] or [""], start


def _text_before(lines: list[str]) -> str:
    text = re.sub(r"```.*?```", "", "\n".join(lines), flags=re.DOTALL)
    return re.sub(r"\n{3,}", "\n\n", text).strip()[-_LONGEST:]


def snippets_text() -> str:
    """Return the text of ``snippets.jsonl``."""
    return "".join(json.dumps(each, ensure_ascii=False) + "\n" for each in snippets())


def write_copy() -> None:
    """Write the copy of the snippets in the package."""
    COPY.write_text(snippets_text(), encoding="utf-8")


def _finish(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html":
        folder = Path(app.outdir)
        for file, text in (
            ("llms.txt", index_text()),
            ("llms-full.txt", full_text()),
            ("snippets.jsonl", snippets_text()),
        ):
            (folder / file).write_text(text, encoding="utf-8")


def setup(app: Any) -> Mapping[str, bool]:
    """Write the texts when the site is built."""
    app.connect("build-finished", _finish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


if __name__ == "__main__":
    write_copy()
