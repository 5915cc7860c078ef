"""The gallery: the programs of ``examples`` by theme, each with a picture, its header and its text."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs._extensions.pictures import Shot, kept_picture
from docs._extensions.programs import PICTURES
from examples import FOLDER

__all__ = ["header", "themes"]

_SIZE = (360, 250)
_THEMES = {
    "basics": "First steps",
    "indoor": "Indoor robots",
    "tabletop": "Table tops",
    "warehouse": "Warehouses",
    "roads": "Roads without a map",
    "driving": "Driving on maps",
    "scenarios": "Ten scenarios of road traffic",
    "drones": "Drones",
    "underwater": "Under water",
    "terrain": "Terrain",
    "sensors": "Sensors",
    "games": "Games",
}
_OPTIONS = {
    "driving": {"plan": "", "2d": ""},
    "scenarios": {"plan": "", "2d": ""},
    "roads": {"frame": "objects"},
    "occlusion": {"frame": "objects", "from": "-20,35"},
    "corridor": {"from": "60,35"},
    "gates": {"from": "-60,30", "frame": "objects"},
    "bowling": {"from": "-20,30"},
}
"""Options of pictures by theme or program, as a code block would have them."""


def themes() -> Iterator[tuple[str, str, list[Path]]]:
    """Return the folder, title and programs of each theme."""
    for folder, title in _THEMES.items():
        yield folder, title, sorted((FOLDER / folder).glob("*.scenic"))


def header(path: Path) -> str:
    """Return the description at the beginning of a program."""
    quoted, _, _ = path.read_text(encoding="utf-8").removeprefix('"""').partition('"""')
    return " ".join(ast.literal_eval(f'"""{quoted}"""').split())


class _Gallery(SphinxDirective):
    """All themes, one section each."""

    def run(self) -> list[nodes.Node]:
        """Sections with a figure and the text of each program."""
        return [self._theme(*theme) for theme in themes()]

    def _theme(self, folder: str, title: str, programs: list[Path]) -> nodes.Node:
        section = nodes.section("", nodes.title("", title), ids=[folder])
        for path in programs:
            self.env.note_dependency(str(path))
            options = {**_OPTIONS.get(folder, {}), **_OPTIONS.get(path.stem, {})}
            picture = kept_picture(Shot.of(path, options, size=_SIZE), PICTURES)
            text = path.read_text(encoding="utf-8").rstrip()
            name = f"{folder}/{path.name}"
            section += nodes.container(
                "",
                nodes.image(uri=f"/_build/{PICTURES.name}/{picture.name}", alt=header(path)),
                *self.parse_text_to_nodes(f"**{path.stem.replace('_', ' ')}** {header(path)}"),
                nodes.raw("", f"<details><summary>examples/{name}</summary>", format="html"),
                nodes.literal_block(text, text, language="scenic"),
                nodes.raw("", "</details>", format="html"),
                classes=["example"],
            )
        return section


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directive."""
    app.add_directive("gallery", _Gallery)
    return {"version": "1", "parallel_read_safe": True}
