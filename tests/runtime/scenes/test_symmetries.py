"""What must not matter: where a scenario stands and which way it is turned, the order of specifiers, how a scene is kept."""

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import scenic
from tests.amounts import amount
from tests.runtime.programs import euler, plain, rotation, scenario

# A scenario whose whole world hangs on one frame: the parameters say where it is.

WORLD = """
param x = 0, y = 0, z = 0, yaw = 0, pitch = 0, roll = 0
G = globalParameters
frame = new OrientedPoint at (G.x, G.y, G.z), facing (G.yaw, G.pitch, G.roll)
def at_(*place): return frame.relativePosition(place)
def turned(*angles): return frame.orientation * Orientation.fromEuler(*angles)
hall = BoxRegion((24, 22, 20), position=at_(0, 0, 0), rotation=frame.orientation)
workspace = Workspace(hall)
ego = new Object at at_(Range(-3, 3), Range(-3, 3), 1), facing turned(Range(-3, 3), 0.2, 0.1), with length 2
box = new Object in BoxRegion((4, 3, 2), position=at_(0, 6, 0), rotation=turned(0.3, 0.1, 0)), facing turned(0, Range(-1, 1), 0)
side = new Object left of ego by Range(1, 2), with pitch 0.2, with width 0.5
over = new Object above box by (0.5, 0.1, 0.5), with shape CylinderShape(), with height 2
far = new Object beyond box by (1, 2, 0) from ego, with parentOrientation frame.orientation
seen = new Object offset by (0, Range(-6, -4), 2), with shape SpheroidShape()
c = Uniform(ego, box)
near = new Object behind c by 2, with width 0.3, with length 0.3, with height 0.3
require (distance from box to ego) > 4
require ego.position.distanceTo(frame) > 1
require (ego can see box) or (distance to side) > 2
"""
UPRIGHT = """
toward = new Object at at_(9, Range(-5, 5), Range(-5, 5)), facing toward box
plate = new Object in RectangularRegion(at_(-8, 0, 5), frame.heading + 0.2, 3, 2), apparently facing Range(-1, 1) from ego
beside = new Object ahead of toward by 1, facing away from ego
directly = new Object at at_(-9, 8, Range(-4, 0)), facing directly toward ego
ground = new Object on RectangularRegion(at_(6, -8, -9), frame.heading, 4, 2), with height 2, facing turned(1, 0, 0)
require abs(relative heading of toward from ego) > 0.3
"""
ANGLE = st.floats(-3.1, 3.1).map(lambda angle: round(angle, 2))
PLACE = st.tuples(*[st.floats(-50, 50).map(lambda number: round(number, 1))] * 3)
SCENES = 3


def observed(text: str, place: tuple[float, ...], angles: tuple[float, ...]) -> list[Any]:
    names = ("x", "y", "z", "yaw", "pitch", "roll")
    program = scenario(text, params=dict(zip(names, (*place, *angles), strict=True)))
    return program.sample(SCENES, seed=4)


def assert_moved(text: str, place: tuple[float, ...], angles: tuple[float, ...]) -> None:
    turn = euler(*angles)
    for one, other in zip(observed(text, (0, 0, 0), (0, 0, 0)), observed(text, place, angles), strict=True):
        assert one.attempts == other.attempts
        for before, after in zip(one.objects, other.objects, strict=True):
            assert (before.width, before.length, before.height) == (after.width, after.length, after.height)
            np.testing.assert_allclose(
                tuple(after.position), turn.apply(tuple(before.position)) + place, atol=1e-7
            )
            difference: Rotation = (turn * rotation(before.orientation)).inv() * rotation(after.orientation)
            assert difference.magnitude() < 1e-6


@settings(max_examples=amount(2, 6), deadline=None)
@given(PLACE, ANGLE)
@example((0, 0, 0), np.pi / 2)
@example((1e3, -1e3, 10), np.pi)
def test_an_upright_scenario_may_stand_anywhere(place: tuple[float, ...], yaw: float) -> None:
    assert_moved(WORLD + UPRIGHT, place, (yaw, 0, 0))


@settings(max_examples=amount(2, 6), deadline=None)
@given(PLACE, st.tuples(ANGLE, ANGLE.map(lambda angle: angle / 2.5), ANGLE))
@example((3, 2, 1), (0.5, np.pi / 2, 0.3))
@example((0, 0, 0), (0, np.pi, 0))
def test_a_scenario_in_space_may_be_turned_anyhow(
    place: tuple[float, ...], angles: tuple[float, float, float]
) -> None:
    """Without what knows the horizon: headings, `on`, regions of the plane, `facing toward`."""
    text = WORLD.replace(
        "far = new Object beyond box by (1, 2, 0) from ego", "far = new Object at at_(9, 9, 9)"
    )
    assert_moved(text, place, angles)


# The order of specifiers

SETTING = """
ego = new Object at (1, 2, 3), facing (0.3, 0.2, 0.1)
slab = new Object at (0, 0, -9), facing (0, 0.25, 0), with width 90, with length 90, with allowCollisions True
field = VectorField("field", lambda p: 0.7)
"""
GROUPS = [
    ["left of ego by 3", "on slab", "facing toward (9, 9, 9)", "with pitch 0.2"],
    ["at (Range(3, 4), 0, 0)", "with width Range(1, 2)", "facing field", "with parentOrientation (1, 0.5, 0)"],
    ["on slab", "with height Range(1, 2)", "with baseOffset (0.1, 0, -1)", "with yaw Range(0, 1)"],
    ["ahead of (1, 9, 9) by 2", "with length Range(1, 2)", "facing (0.4, 0.2, 0)", "with contactTolerance 0.5"],
    ["contained in BoxRegion((40, 40, 40), position=(20, 0, 0))", "with pitch 0.2", "with yaw Range(0, 1)"],
    ["beyond (9, 9, 9) by Range(1, 2)", "apparently facing 0.3", "with roll 0.4", "with shape CylinderShape((1, 2, 3))"],
    ["visible from ego", "at (5, Range(5, 6), 3)", "facing directly away from slab", "with width 0.5"],
    ["following field from (5, 5, 5) for 3", "on slab", "with onDirection (0, 0, 1)", "facing 0.3"],
]  # fmt: skip


@pytest.mark.parametrize("group", GROUPS, ids=", ".join)
def test_the_order_of_specifiers_says_nothing(group: list[str]) -> None:
    """Each on a line of its own, so that draws are the same."""
    found = set()
    for order in itertools.permutations(group):
        lines = ",\n    ".join(order)
        program = scenario(f"{SETTING}new Object with allowCollisions True,\n    {lines},\n")
        found.add(repr([plain(item.objects[-1]) for item in program.sample(2, seed=3)]))
    assert len(found) == 1


# Relative to, and back


@settings(max_examples=30, deadline=None)
@given(*[st.tuples(ANGLE, ANGLE, ANGLE)] * 2)
@example((0.5, np.pi / 2, 0.25), (0, -np.pi / 2, 0))
@example((np.pi, 0, 0), (-np.pi, 0, 0))
def test_relative_to_is_undone_by_the_inverse(
    one: tuple[float, float, float], other: tuple[float, float, float]
) -> None:
    text = (
        f"p, q = Orientation.fromEuler(*{one!r}), Orientation.fromEuler(*{other!r})\n"
        "r = Uniform(p, p)\nparam p = p, q = q, forth = (r relative to q) relative to q.inverse,"
        " back = r.inverse * (r * q), both = (q relative to r) relative to r.inverse\n"
    )
    found = scenario(text).sample(1)[0].params
    for value, expected in (("forth", "p"), ("back", "q"), ("both", "q")):
        assert (rotation(found[value]).inv() * rotation(found[expected])).magnitude() < 1e-7


# Scenes that are kept

KEPT = [
    WORLD + UPRIGHT,
    "x = Range(0, 1)\nrequire[0.5] x > 0.5\nego = new Object at (x, Normal(0, 1), 0)\nmutate ego by 2\nparam x = x, k = DiscreteRange(0, 9)\n",
    "import random\ndef f(v): return v + random.random()\ng = distributionFunction(f)\nx = g(Range(0, 1))\nego = new Object at (x, 0, 0)\nparam x = x\n",
    "r = Uniform(CircularRegion((0, 0), 2), SpheroidRegion(dimensions=(2, 3, 4)), BoxRegion((1, 2, 3)))\nego = new Object in r.difference(BoxRegion((0.5, 0.5, 0.5)))\n",
    "xs = Uniform([1, 2, 3], [4])\nego = new Object at (Uniform(*xs), len(xs), 0), with tag [xs, {'k': xs}], with color (Range(0, 1), 0, 1)\n",
    "s = Uniform(BoxShape((1, 2, 3)), CylinderShape(), ConeShape(), SpheroidShape())\nego = new Object with shape s, facing (Range(0, 3), Range(0, 3), 0), with velocity (1, Range(0, 1), 0)\n",
    "ego = new Object with width Range(1, 2)\nspot = new Object on ego, with height Range(0.1, 1), facing Range(0, 6)\nbeside = new Object left of spot by Range(1, 2), with requireVisible Uniform(True, False)\n",
]  # fmt: skip


@pytest.mark.parametrize("text", KEPT)
def test_every_scene_is_taken_up_again(text: str) -> None:
    """From its bytes bit for bit; from its program up to the rounding of the numbers written down."""
    program = scenario(text)
    for item in program.sample(4, seed=5):
        again = program.sceneFromBytes(program.sceneToBytes(item))
        assert plain(again.params) == plain(item.params)
        assert [plain(each) for each in again.objects] == [plain(each) for each in item.objects]
        (dumped,) = scenic.scenarioFromString(item.dump()).sample(1)
        assert len(dumped.objects) == len(item.objects)
        for one, other in zip(dumped.objects, item.objects, strict=True):
            np.testing.assert_allclose(tuple(one.position), tuple(other.position), rtol=1e-12, atol=1e-12)
            assert (rotation(one.orientation).inv() * rotation(other.orientation)).magnitude() < 1e-7
            assert (one.width, one.length, one.height) == (other.width, other.length, other.height)
            assert type(one.shape) is type(other.shape)
