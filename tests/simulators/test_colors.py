"""Colours of cars over lanes are those of the formula of one."""

import math
import random

import numpy as np
import pytest

import scenic
from scenic.runtime.instances.properties import _colour, _colours
from scenic.runtime.python import opaque
from scenic.simulators.utils.colors import _SHIFTED, Color


def test_colours_together_are_those_one_by_one() -> None:
    chance = random.Random(1)
    bases = [Color(*(chance.randint(0, 255) / 255 for _ in range(3))) for _ in range(40)]
    bases += [Color(0.0, 0.0, 0.0), Color(1.0, 1.0, 1.0), Color(0.5, 0.5, 0.5), Color(1.0, 0.0, 0.0)]
    rows = [(chance.choice(bases), *(chance.gauss(0, 0.4) for _ in range(3))) for _ in range(2000)]
    assert _SHIFTED.python is not None
    assert _SHIFTED.together is not None
    together = _SHIFTED.together(*map(list, zip(*rows, strict=True)))
    assert together == [_SHIFTED.python(*row) for row in rows]


def test_what_is_no_colour_is_left_to_the_formula_of_one() -> None:
    assert _SHIFTED.together is not None
    assert _SHIFTED.together([(1, 2)], [0.0], [0.0], [0.0]) is None
    assert _SHIFTED.together([[1.0, 0.0, 0.0]], [0.0], [0.0], [0.0]) is None


def test_random_parts_need_no_call_of_python(monkeypatch: pytest.MonkeyPatch) -> None:
    def called(*_arguments: object) -> None:
        raise AssertionError("Python was called for a sample")

    monkeypatch.setattr(opaque.Calls, "results", called)
    text = (
        "from scenic.simulators.utils.colors import Color\nego = new Object with color Color.uniformColor()\n"
    )
    scenes = scenic.scenarioFromString(text).sample(20, seed=1)
    assert len({scene.egoObject.color for scene in scenes}) == 20
    assert all(0 < part < 1 for scene in scenes for part in scene.egoObject.color)


def test_colours_of_objects_are_checked_together_as_one_by_one() -> None:
    fine = [Color(0.0, 0.5, 1.0), (1, 0, 1), (np.float64(0.25), 0.5, True)]
    assert _colours(fine) == [_colour("color", value) for value in fine]
    assert [type(value) for value in _colours(fine) or ()] == [Color, tuple, tuple]
    faulty = [
        (0.1, 0.2, 1.5),
        (0.1, 0.2),
        ("0", 0.5, 0.5),
        [0.1, 0.2, 0.3],
        (math.nan, 0, 0),
        (10**400, 0, 0),
        None,
    ]
    for value in faulty:
        assert _colours([fine[0], value]) is None
    assert _colours([(0.1, 0.2, 0.3), (0.1, 0.2, 0.3, 0.4)]) is None


@pytest.mark.parametrize("made", ["Color.defaultCarColor()", "Color.uniformColor()", "Color(0.5, 0, 1)"])
def test_a_colour_of_the_class_stays_one(made: str) -> None:
    text = f"from scenic.simulators.utils.colors import Color\nego = new Object with color {made}\n"
    (scene,) = scenic.scenarioFromString(text).sample(1, seed=1)
    assert type(scene.egoObject.color) is Color
    assert scene.egoObject.color.b == scene.egoObject.color[2]
