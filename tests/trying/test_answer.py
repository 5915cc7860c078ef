"""Answers about programs: the phase, the diagnostics, the scene, and their schema."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from scenic.trying.answer import Limits, Trial, answer
from scenic.trying.schema import SCHEMA

RANDOM = "behavior Rest():\n    while True: wait\nego = new Object at (Range(0, 9), 0), with behavior Rest\n"


def tried(text: str, **options: Any) -> dict[str, Any]:
    found = answer(Trial(text, "program.scenic", **options))
    jsonschema.validate(json.loads(json.dumps(found)), dict(SCHEMA))
    return found


@pytest.mark.parametrize(
    ("text", "phase", "codes"),
    [
        ("ego = nw Object\nrequire ego.x > \n", "parse", ["SC118", "SC110"]),
        ("ego = new Objekt\nx = undefined_name\n", "check", ["SC203", "SC202"]),
        ("ego = new Object\nx = [1][3]\n", "load", ["SC400"]),
        ("ego = new Object at (Range(0, 9), 0)\nrequire ego.x > 12\n", "sample", ["SC500"]),
    ],
)
def test_the_first_phase_that_fails(text: str, phase: str, codes: list[str]) -> None:
    found = tried(text, steps=3)
    assert (found["phase"], found["ok"]) == (phase, False)
    assert [each["code"] for each in found["diagnostics"] if each["severity"] == "error"] == codes
    assert (found["rejections"] is not None) == (phase == "sample")


def test_a_program_that_runs() -> None:
    found = tried(RANDOM, steps=5, seed=3)
    assert (found["phase"], found["ok"], found["diagnostics"]) == ("simulate", True, [])
    assert [each["name"] for each in found["draws"]] == ["ego.position.x"]
    assert found["scene"]["seed"] == 3
    assert found["simulation"]["steps"] == 5
    assert found["scene"] == tried(RANDOM, steps=0, seed=3)["scene"]


def test_a_simulation_in_which_nothing_happens() -> None:
    found = tried("ego = new Object\n", steps=2)
    assert found["ok"]
    assert "nothing happens" in found["diagnostics"][0]["message"]


def test_rejections_by_requirement() -> None:
    text = "ego = new Object at (Range(0, 9), Range(0, 9))\nrequire ego.x > 8.9999\nrequire ego.y > 3\n"
    found = tried(text, limits=Limits(candidates=3))
    if not found["ok"]:
        first = found["rejections"]["requirements"][0]
        assert first["span"]["line"] == 2
        assert first["rejects"] > 0.9


def test_the_map_and_a_picture(tmp_path: Path) -> None:
    town = Path(__file__).parents[2] / "examples" / "driving" / "crossing.xodr"
    text = f"param map = {str(town)!r}\nmodel scenic.simulators.newtonian.driving_model\nego = new Car\n"
    found = tried(text, mode_2d=True, png=str(tmp_path / "scene.png"))
    assert found["ok"], found["diagnostics"]
    assert found["map"]["intersections"] == 1
    assert (tmp_path / "scene.png").read_bytes().startswith(b"\x89PNG")
