"""Scenes and simulations within another page, such as that of a notebook: a page in a frame, above an image.

The image is what remains where a host removes frames or runs no scripts.
"""

import base64
import html as markup
from collections.abc import Mapping, Sequence
from itertools import chain, repeat
from typing import Any

from scenic.formats.course_page import PoseTape, course_data, course_page
from scenic.formats.html import page
from scenic.formats.imaging import MissingLibraryError
from scenic.formats.lamps import NO_COLORS
from scenic.formats.png import png
from scenic.formats.scene_protocols import Scene

__all__ = ["embedded_courses", "embedded_scenes", "embedded_simulation", "scene_bundle", "table"]

HEIGHT = 420
"""Pixels of a frame."""
_IMAGE = (720, HEIGHT)


def embedded_scenes(scenes: Sequence[Scene], title: str) -> str:
    """Return HTML that shows scenes, at least one, in a frame; without scripts it shows an image of the first one."""
    return _framed(page(scenes, title), _image(scenes[0]))


def embedded_courses(courses: Sequence[Mapping[str, Any]], title: str) -> str:
    """Return HTML that plays simulations, each as `course_data` gives it; at least one."""
    return _framed(course_page(title, courses), "")


def embedded_simulation(simulation: Any) -> str:
    """Return HTML that plays a simulation whose states were kept."""
    tape = PoseTape()
    colors = chain(getattr(simulation, "light_course", ()), repeat(NO_COLORS))
    for state, lights in zip(simulation.trajectory, colors, strict=False):
        tape.add(list(zip(state.positions, state.orientations, strict=True)), lights)
    return embedded_courses([course_data(simulation, tape)], "simulation")


def scene_bundle(scene: Scene) -> dict[str, str]:
    """Return a scene by type of media, in the form that notebooks use."""
    return {"text/html": embedded_scenes([scene], "scene"), "text/plain": repr(scene)}


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return an HTML table."""
    lines = [_row("th", head), *(_row("td", row) for row in rows)]
    return f"<table>{''.join(lines)}</table>"


def _row(kind: str, cells: Sequence[object]) -> str:
    return "<tr>" + "".join(f"<{kind}>{markup.escape(str(cell))}</{kind}>" for cell in cells) + "</tr>"


def _image(scene: Scene) -> str:
    """Return an image of the scene as an element; nothing without the library that writes images."""
    try:
        content = png(scene, _IMAGE)
    except MissingLibraryError:
        return ""
    data = base64.b64encode(content).decode("ascii")
    return (
        f'<img alt="{markup.escape(repr(scene))}" src="data:image/png;base64,{data}" style="max-width:100%"/>'
    )


def _framed(text: str, below: str) -> str:
    frame = (
        f'<iframe srcdoc="{markup.escape(text)}" sandbox="allow-scripts" loading="lazy" title="scene in three dimensions" '
        f'style="width:100%;height:{HEIGHT}px;border:0;{"position:absolute;inset:0" if below else ""}"></iframe>'
    )
    return f'<div style="position:relative;min-height:{HEIGHT}px;overflow:hidden">{below}{frame}</div>'
