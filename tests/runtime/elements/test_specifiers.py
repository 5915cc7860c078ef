"""Every specifier on fixed operands, against the formulas of the language computed with SciPy."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from tests.runtime.programs import (
    altitude,
    assert_angles_equal,
    assert_same_rotation,
    azimuth,
    euler,
    failure,
    scenario,
    thing,
)

EGO = (
    "ego = new Object at (1, 2, 3), facing (0.4, 0.3, -0.2), with allowCollisions True,\n"
    "    with width 2, with length 4, with height 6\n"
    "p = new OrientedPoint at (-20, 5, 1), facing (1.1, -0.3, 0.2)\n"
    "v = new Point at (30, -10, 4)\n"
)
NEW = "new Object with width 1, with length 2, with height 3, "
EGO_AT, EGO_TURNED = np.array([1.0, 2, 3]), euler(0.4, 0.3, -0.2)
P_AT, P_TURNED = np.array([-20.0, 5, 1]), euler(1.1, -0.3, 0.2)
V_AT = np.array([30.0, -10, 4])
TOLERANCE = 1e-4


def made(specifiers: str) -> Any:
    return thing(EGO + NEW + specifiers)


def assert_at(found: Any, expected: Any) -> None:
    np.testing.assert_allclose(tuple(found.position), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("specifiers", "position", "turned"),
    [
        ("at (7, 8)", (7, 8, 0), euler(0)),
        ("at (7, 8, 9)", (7, 8, 9), euler(0)),
        ("at [7, 8, 9]", (7, 8, 9), euler(0)),
        ("at 7 @ 8", (7, 8, 0), euler(0)),
        ("at p", P_AT, euler(0)),
        ("at v", V_AT, euler(0)),
        ("offset by (5, 6, 7)", EGO_AT + EGO_TURNED.apply([5, 6, 7]), EGO_TURNED),
        ("offset by 5 @ 6", EGO_AT + EGO_TURNED.apply([5, 6, 0]), EGO_TURNED),
        ("offset along 0.7 by (5, 6, 7)", EGO_AT + euler(0.7).apply([5, 6, 7]), EGO_TURNED),
        ("offset along (0.7, 0.2, 0.1) by (5, 6)", EGO_AT + euler(0.7, 0.2, 0.1).apply([5, 6, 0]), EGO_TURNED),
        ("offset along p by (5, 6, 7)", EGO_AT + P_TURNED.apply([5, 6, 7]), EGO_TURNED),
        ("on (7, 8, 9)", (7, 8, 9 + 1.5 + TOLERANCE / 2), euler(0)),
        ("on (7, 8, 9), with baseOffset (1, 2, 3)", (6, 6, 6 + TOLERANCE / 2), euler(0)),
        ("on (7, 8, 9), with contactTolerance 2", (7, 8, 9 + 1.5 + 1), euler(0)),
    ],
)  # fmt: skip
def test_places(specifiers: str, position: Any, turned: Rotation) -> None:
    found = made(specifiers)
    assert_at(found, position)
    assert_same_rotation(found.orientation, turned)


@pytest.mark.parametrize(
    ("operands", "target", "step", "start", "turned"),
    [
        ("v by 5", V_AT, (0, 5, 0), EGO_AT, EGO_TURNED),
        ("v by (1, 2, 3)", V_AT, (1, 2, 3), EGO_AT, EGO_TURNED),
        ("v by (1, 2, 3) from p", V_AT, (1, 2, 3), P_AT, P_TURNED),
        ("p by 4 from (9, 9, 9)", P_AT, (0, 4, 0), np.array([9, 9, 9]), euler(0)),
        ("(9, 9) by -4 from v", np.array([9, 9, 0]), (0, -4, 0), V_AT, euler(0)),
    ],
)
def test_beyond_takes_the_orientation_of_the_observer(
    operands: str, target: Any, step: Any, start: Any, turned: Rotation
) -> None:
    line = target - start
    found = made(f"beyond {operands}")
    assert_at(found, target + euler(azimuth(line), altitude(line)).apply(step))
    assert_same_rotation(found.orientation, turned)


SIDES = {
    "left of": (0, -1),
    "right of": (0, 1),
    "ahead of": (1, 1),
    "behind": (1, -1),
    "above": (2, 1),
    "below": (2, -1),
}
DISTANCES = {"": None, " by 3": 3, " by (3, 4, 5)": (3, 4, 5), " by -1": -1}


@pytest.mark.parametrize(("side", "distance"), list(itertools.product(SIDES, DISTANCES)))
def test_next_to_things(side: str, distance: str) -> None:
    axis, sign = SIDES[side]
    by = DISTANCES[distance]

    def offset(other_size: float, gap: float) -> list[float]:
        parts = [0.0, 0, 0] if by is None or isinstance(by, int) else [float(part) for part in by]
        along = 0.0 if by is None else by if isinstance(by, int) else by[axis]
        size = (1, 2, 3)[axis]
        parts[axis] = sign * (size / 2 + other_size / 2 + along + (gap if by is None else 0))
        return parts

    next_to_ego = made(f"{side} ego{distance}")
    assert_at(next_to_ego, EGO_AT + EGO_TURNED.apply(offset((2, 4, 6)[axis], TOLERANCE / 2)))
    assert_same_rotation(next_to_ego.orientation, EGO_TURNED)
    next_to_p = made(f"{side} p{distance}")
    assert_at(next_to_p, P_AT + P_TURNED.apply(offset(0, 0)))
    assert_same_rotation(next_to_p.orientation, P_TURNED)
    # Next to a mere position, the new object's own orientation is the frame.
    for target in ("v", "(30, -10, 4)"):
        next_to_v = made(f"{side} {target}{distance}, facing (0.9, 0.1, 0.3)")
        assert_at(next_to_v, V_AT + euler(0.9, 0.1, 0.3).apply(offset(0, 0)))


PARENT = "with parentOrientation (0.3, 0.2, 0.1), "


@pytest.mark.parametrize(
    ("operand", "turned"),
    [
        ("0.5", euler(0.5)),
        ("30 deg", euler(math.radians(30))),
        ("(0.5, 0.4, 0.3)", euler(0.5, 0.4, 0.3)),
        ("p", P_TURNED),
        ("p.orientation", P_TURNED),
        ("0.5 relative to p.orientation", P_TURNED * euler(0.5)),
        ("Orientation.fromEuler(1, 2, 3)", euler(1, 2, 3)),
    ],
)
def test_facing_is_global(operand: str, turned: Rotation) -> None:
    assert_same_rotation(made(f"{PARENT}facing {operand}").orientation, turned)


@pytest.mark.parametrize(("word", "sign"), [("toward", 1), ("away from", -1)])
def test_facing_a_place(word: str, sign: int) -> None:
    parent = euler(0.3, 0.2, 0.1)
    line = parent.inv().apply(sign * (V_AT - np.array([7, 8, 9])))
    level = made(f"{PARENT}at (7, 8, 9), facing {word} v, with pitch 0.25, with roll 0.5")
    assert_angles_equal(level.yaw, azimuth(line))
    assert (level.pitch, level.roll) == (0.25, 0.5)
    aimed = made(f"{PARENT}at (7, 8, 9), facing directly {word} v")
    assert_same_rotation(aimed.orientation, parent * euler(azimuth(line), altitude(line)))


@pytest.mark.parametrize(("operands", "start"), [("0.3", EGO_AT), ("0.3 from v", V_AT), ("-3 from p", P_AT)])
def test_apparently_facing_is_not_compensated(operands: str, start: Any) -> None:
    found = made(f"{PARENT}at (7, 8, 9), apparently facing {operands}")
    assert_angles_equal(found.yaw, azimuth(np.array([7, 8, 9]) - start) + float(operands.split()[0]))
    assert (found.pitch, found.roll) == (0, 0)


REGION = (
    "r = RectangularRegion((50, 60, 2), 0.3, 8, 4)\nb = BoxRegion((2, 4, 6), (50, 60, 70), (0.3, 0.2, 0.1))\n"
)


def test_in_a_region() -> None:
    local = euler(0.3, 0.2, 0.1).inv()
    for seed in range(20):
        flat = thing(REGION + "new Object in r", seed=seed)
        across = euler(0.3).inv().apply(np.array(flat.position) - [50, 60, 2])
        assert np.all(np.abs(across) <= [4, 2, 0])
        solid = thing(REGION + "new Object contained in b, with width 0.01, with length 0.01, with height 0.01", seed=seed)  # fmt: skip
        assert np.all(np.abs(local.apply(np.array(solid.position) - [50, 60, 70])) <= [1, 2, 3])
        assert str(solid.regionContainedIn) == "<BoxRegion>"


def test_on_a_region_draws_and_rests() -> None:
    found = thing(REGION + NEW + "on r")
    assert found.z == pytest.approx(2 + 1.5 + TOLERANCE / 2, abs=1e-12)


def test_on_modifies_a_position() -> None:
    found = thing(REGION + NEW + "at (51, 60, 99), on r")
    assert_at(found, (51, 60, 2 + 1.5 + TOLERANCE / 2))


def test_on_a_place_beside_the_region() -> None:
    found = failure(REGION + NEW + "at (58, 60, 99), on r")
    assert type(found) is InvalidScenarioError
    # With a random place, the candidates beside the region are rejected: 4 of 8 metres are left.
    program = scenario("r = RectangularRegion((0, 0), 0, 4, 1)\nnew Object at (Range(-4, 4), 0, 9), on r")
    scenes = program.sample(200, seed=0)
    assert all(abs(item.objects[0].x) <= 2 for item in scenes)
    assert 300 < sum(item.attempts for item in scenes) < 500


def test_on_an_object_stands_on_its_top_and_turns_with_it() -> None:
    for seed in range(10):
        box = "box = new Object facing 1, with width 4, with length 4, with height 2\n"
        found = thing(box + NEW + "on box", seed=seed)
        assert found.z == pytest.approx(1 + 1.5 + TOLERANCE / 2, abs=1e-9)
        assert np.all(np.abs(euler(1).inv().apply(np.array(found.position))[:2]) <= 2)


def test_on_wins_the_parent_orientation_from_directions_and_loses_it_to_with() -> None:
    ground = "ground = new Object at (0, 0, -2), with width 40, with length 40, with height 2\n"
    tilted = "ego = new Object at (0, 0, 3), facing (0.5, 0.4, 0.3), with allowCollisions True\n"
    beside = thing(ground + tilted + NEW + "left of ego by 3")
    assert_same_rotation(beside.orientation, euler(0.5, 0.4, 0.3))
    on_ground = thing(ground + tilted + NEW + "left of ego by 3, on ground")
    assert_same_rotation(on_ground.orientation, euler(0))
    assert on_ground.z == pytest.approx(-1 + 1.5 + TOLERANCE / 2, abs=1e-9)
    told = thing(ground + tilted + NEW + "left of ego by 3, on ground, with parentOrientation 0.25")
    assert_same_rotation(told.orientation, euler(0.25))


@pytest.mark.parametrize(
    ("specifier", "error"),
    [
        ("at 3", ScenicTypeError),
        ("at (1, 2, 3, 4)", ScenicTypeError),
        ("at 'here'", ScenicTypeError),
        ("in p", ScenicTypeError),
        ("on 3", ScenicTypeError),
        ("left of 3", ScenicTypeError),
        ("left of ego by 'far'", ScenicTypeError),
        ("facing (1, 2)", ScenicTypeError),
        ("facing v", ScenicTypeError),
        ("facing toward 3", ScenicTypeError),
        ("apparently facing (1, 2, 3)", ScenicTypeError),
        ("beyond 3 by 4", ScenicTypeError),
        ("offset by 4", ScenicTypeError),
        ("offset along 'north' by (1, 2)", ScenicTypeError),
        ("in everywhere", InvalidScenarioError),
        ("in nowhere", InvalidScenarioError),
        ("at (1, 2, 3), on (4, 5, 6)", ScenicTypeError),
    ],
)
def test_wrong_operands(specifier: str, error: type[Exception]) -> None:
    found = failure(EGO + "new Object " + specifier)
    assert type(found) is error, found
    assert found.span is not None
    assert found.span.line == 5
    assert found.help is None or not found.help.endswith(".")


@pytest.mark.parametrize("specifier", ["offset by (1, 2)", "beyond (1, 2) by 3", "apparently facing 3"])
def test_specifiers_that_need_an_ego(specifier: str) -> None:
    found = failure("new Object " + specifier)
    assert type(found) is InvalidScenarioError
    assert "ego" in str(found)


@pytest.mark.parametrize("options", ["ego, (7, 8, 9)", "(7, 8, 9), ego"])
def test_beside_an_object_or_a_place_is_beside_a_place(options: str) -> None:
    """What may be either is read as what both are: the object's size and orientation count for nothing (section 8.1)."""
    text = f"{EGO}{NEW}left of Uniform({options}) by 1, facing 90 deg, with allowCollisions True\n"
    offset = euler(math.pi / 2).apply([-1.5, 0, 0])
    found = {tuple(np.round(item.objects[-1].position, 9)) for item in scenario(text).sample(12, seed=1)}
    assert found == {tuple(np.round(at + offset, 9)) for at in (EGO_AT, np.array([7.0, 8, 9]))}


def test_the_box_round_an_object_is_where_the_object_is() -> None:
    found = thing("new Object at (5, 6, 7), facing 45 deg, with width 2, with length 4, with height 1\n")
    box, half = found.boundingBox, 3 / math.sqrt(2)
    for inside, part in ((True, 0.999), (False, 1.001)):
        for offset in ((half, 0, 0), (-half, 0, 0), (0, half, 0), (0, -half, 0), (0, 0, 0.5), (0, 0, -0.5)):
            assert box.containsPoint(tuple(np.array([5, 6, 7]) + part * np.array(offset))) is inside
    assert found.planarInradius == 1
    assert found.inradius == 0.5


def test_visible_needs_the_size_before_it_places() -> None:
    text = (
        "class Tower:\n    height: self.base * 2\n    length: self.base + 1\n    base: self.kind + 0\n    kind: 3\n"
        "ego = new Object with visibleDistance 20\nnew Tower visible\n"
    )
    found = thing(text)
    assert (found.height, found.length) == (6, 4)


LAIN = {
    # what an object of one metre lies on: its expression, the place of its middle, how far from there
    "point": ("p", (9, 9, 0.50005), 0),
    "pair": ("(1, 2)", (1, 2, 0.50005), 0),
    "region": ("r", (50, 50, 2.50005), 1),
    "object": ("a", (30, 30, 4.50005), 1),
}


@pytest.mark.parametrize(
    "names", [*itertools.permutations(LAIN, 2), ("pair", "object", "region"), ("point", "pair", "region")]
)
def test_on_a_choice_of_different_things_is_on_what_is_drawn(names: tuple[str, ...]) -> None:
    first, *others = (LAIN[name][0] for name in names)
    text = (
        "p = new Point at (9, 9)\nr = RectangularRegion((50, 50, 2), 0, 2, 2)\n"
        "a = new Object at (30, 30, 3), with width 2, with length 2, with height 2\n"
        f"ego = new Object on Uniform({first}, Uniform({', '.join([*others, others[0]])}))\n"
    )
    met = set()
    for item in scenario(text).sample(14, seed=1):
        places = {
            name: np.array(item.egoObject.position) - place
            for name, (_, place, _) in LAIN.items()
            if math.dist(place, item.egoObject.position) < 3
        }
        ((name, off),) = places.items()
        assert abs(off[2]) < 1e-9
        assert max(abs(off[:2])) <= LAIN[name][2] + 1e-9
        met.add(name)
    assert met == set(names)


@pytest.mark.parametrize("target", ["a", "Uniform(a, b)", "told(a, Range(0, 1))"])
@pytest.mark.parametrize("before", ["", "at (Range(29.9, 30.1), 30, 40), "])
def test_things_lie_on_the_surface_that_their_class_names(target: str, before: str) -> None:
    """Not on the top; where a position is given before, they fall down to it."""
    text = (
        "class Shelf:\n    height: 2\n    @property\n    def onSurface(self):\n"
        "        return RectangularRegion(self.position + (0, 0, -0.25), 0, 1, 1)\n"
        "a = new Shelf at (30, 30, 10)\nb = new Shelf at (30, 30, 20), with allowCollisions True\n"
        "told = distributionFunction(lambda value, _: value)\n"
        f"new Object {before}on {target}, with allowCollisions True\n"
    )
    found = {round(item.objects[-1].z - 0.50005, 9) for item in scenario(text).sample(12, seed=1)}
    expected = {"a": {9.75}, "Uniform(a, b)": {9.75, 19.75}, "told(a, Range(0, 1))": {9.75}}
    assert found == expected[target]
