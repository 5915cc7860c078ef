"""Scenes as tables on a terminal."""

import io

from rich.console import Console

import scenic
from scenic.cli.render.scene_listing import render_scene


def test_a_scene_is_a_table_of_its_objects() -> None:
    (scene,) = scenic.scenarioFromString(
        "param weather = 'rain'\nego = new Object at (1, 2, 3), facing 90 deg\nothers = [new Object at (9 + 2 * i, 0) for i in range(25)]\n"
    ).sample(1, seed=0)
    out = io.StringIO()
    render_scene(scene, Console(file=out, width=100, highlight=False))
    text = out.getvalue()
    assert text.startswith("weather = rain\n")
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in text.splitlines() if "│" in line]
    assert rows[0] == ["ego", "Object", "1", "2", "3", "90"]
    assert rows[1][:3] == ["others[0]", "Object", "9"]
    assert len(rows) == 20
    assert "and 6 more objects" in text
