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


DRIVING = "param map = localPath('town.xodr')\nmodel scenic.domains.driving.model\n"
CARLA = "param map = localPath('town.xodr')\n{}model scenic.simulators.carla.model\n"
PICK = """\
def pick(least):
    return Uniform(*filter(lambda l: len(l.maneuvers) > least and l.uid, network.lanes))
"""
FAILURES = [
    # An empty choice, by condition and map.
    (
        f"{DRIVING}lane = Uniform(*filter(lambda l: len(l.maneuvers) > 9 and l.road is not None, network.lanes))\n",
        "load",
        "SC401",
        (
            "line 3 left 0 of 20",
            "`len(l.maneuvers) > 9` alone leaves 0",
            "`l.road is not None` alone leaves 20",
            "town.xodr",
        ),
    ),
    # The same of what closes over a name.
    (
        f"{DRIVING}{PICK}lane = pick(9)\n",
        "load",
        "SC401",
        ("`len(l.maneuvers) > least` alone leaves 0", "`l.uid` alone leaves 20"),
    ),
    # A category without blueprints, and a list of none.
    (
        CARLA.format("") + "x = blueprints.ids('cars')\n",
        "load",
        "SC401",
        ("no blueprints of the category 'cars'", "`car`"),
    ),
    (CARLA.format("") + "x = blueprints.carModel\n", "load", "SC400", ("did you mean `carModels`",)),
    # An unknown blueprint.
    (
        CARLA.format("") + "ego = new Car on road, with blueprint 'vehicle.tesla.modell3'\n",
        "simulate",
        "SC405",
        ("'vehicle.tesla.modell3'", "`vehicle.tesla.model3`", ":3"),
    ),
    # Maps that differ.
    (
        CARLA.format("param carla_map = 'Town05'\n") + "ego = new Car on road\n",
        "simulate",
        "SC620",
        ("town.xodr", "Town05", "carla_map = 'town'", ":2"),
    ),
    # Control flow on random values.
    ("x = Range(0, 9)\nego = new Object\nif x > 3:\n    new Object\n", "check", "SC403", ("Uniform", ":3")),
    (
        "ego = new Object\nfor x in Range(0, 3):\n    new Object at (x, 9)\n",
        "check",
        "SC403",
        ("range(3)", "present i < count"),
    ),
    (
        "x = Uniform(1, 2)\nego = new Object\nmatch x:\n    case 1:\n        pass\n",
        "check",
        "SC403",
        ("Uniform", ":3"),
    ),
    # Lanes asked for what their sections have.
    (
        f"{DRIVING}ego = new Car on road\nnew Car on ego.lane.fasterLane\n",
        "sample",
        "SC214",
        ("a `Lane` has no attribute `fasterLane`", "ego.laneSection", ":4"),
    ),
    # A parameter after the model that reads it.
    (
        "model scenic.domains.driving.model\nparam map = localPath('town.xodr')\nego = new Car on road\n",
        "load",
        "SC620",
        ("before this line sets it", "move this line before", ":2"),
    ),
    # A pedestrian that drives.
    (
        f"{DRIVING}ego = new Car on road\nnew Pedestrian on sidewalk, with behavior FollowLaneBehavior()\n",
        "check",
        "SC314",
        ("cannot drive", "Walk", ":4"),
    ),
    # A run in which nothing happened.
    ("ego = new Object\n", "simulate", "SC407", ("nothing happens", "with behavior")),
]
"""Programs that fail in ways that were seen elsewhere, the phase, the code, and what the answer has to say."""


@pytest.mark.parametrize(("text", "phase", "code", "words"), FAILURES)
def test_failures_seen_elsewhere(
    text: str, phase: str, code: str, words: tuple[str, ...], tmp_path: Path
) -> None:
    town = Path(__file__).parents[2] / "examples" / "driving" / "crossing.xodr"
    (tmp_path / "town.xodr").write_bytes(town.read_bytes())
    found = answer(Trial(text, str(tmp_path / "program.scenic"), steps=2))
    assert found["phase"] == phase
    said = [each for each in found["diagnostics"] if each["code"] == code]
    assert said, found["diagnostics"]
    line = said[0]["span"]["line"] if said[0].get("span") else 0
    whole = f"{said[0]['message']} {said[0]['help']} :{line}"
    assert [word for word in words if word not in whole] == []
