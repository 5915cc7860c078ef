"""The specification's tables of specifiers (6.2) and of properties (5.1) as data, against what programs do.

The tables are written from the specification, not from the declarations: both the declarations and the behaviour are
compared with them.
"""

import math
from itertools import combinations
from typing import Any

import pytest

from scenic.language.errors import InvalidScenarioError, SpecifierError
from scenic.language.properties import properties_of
from scenic.language.specifiers import SPECIFIERS
from tests.runtime.programs import assert_same_rotation, euler, failure, place, scenario, scene, thing

# 6.2: what each specifier specifies, with priorities; 1 is the strongest.

POSITION, PARENT = "position", "parentOrientation"
BESIDE = {POSITION: 1, PARENT: 3}
PRIORITIES: dict[str, dict[str, int]] = {
    "with": {},
    "at": {POSITION: 1},
    "in": {POSITION: 1, PARENT: 3},
    "contained in": {POSITION: 1, PARENT: 3, "regionContainedIn": 1},
    "on": {POSITION: 1, PARENT: 2},
    "resting on": {POSITION: 1, "yaw": 3, "pitch": 1, "roll": 1, PARENT: 2},
    "offset by": BESIDE,
    "offset along": BESIDE,
    "beyond": BESIDE,
    "visible": {POSITION: 3},
    "not visible": {POSITION: 3},
    "left of": BESIDE,
    "right of": BESIDE,
    "ahead of": BESIDE,
    "behind": BESIDE,
    "above": BESIDE,
    "below": BESIDE,
    "following": BESIDE,
    "facing": {"yaw": 1, "pitch": 1, "roll": 1},
    "facing toward": {"yaw": 1},
    "facing away from": {"yaw": 1},
    "facing directly toward": {"yaw": 1, "pitch": 1},
    "facing directly away from": {"yaw": 1, "pitch": 1},
    "apparently facing": {"yaw": 1},
}
NEEDS: dict[str, frozenset[str]] = {
    "on": frozenset({"baseOffset", "contactTolerance", "onDirection"}),
    "resting on": frozenset({"shape", "width", "length", "height", "contactTolerance", "onDirection"}),
    "visible": frozenset({"regionContainedIn"}),
    "not visible": frozenset({"regionContainedIn"}),
    **dict.fromkeys(("left of", "right of"), frozenset({"width"})),
    **dict.fromkeys(("ahead of", "behind"), frozenset({"length"})),
    **dict.fromkeys(("above", "below"), frozenset({"height"})),
    "facing": frozenset({PARENT}),
    **dict.fromkeys(
        (
            *("facing toward", "facing away from", "facing directly toward"),
            *("facing directly away from", "apparently facing"),
        ),
        frozenset({POSITION, PARENT}),
    ),
}


@pytest.mark.parametrize("name", PRIORITIES)
def test_declared_priorities(name: str) -> None:
    declared = SPECIFIERS[name]
    assert {item.property: item.priority for item in declared.specifies} == PRIORITIES[name]
    assert set(declared.needs) == NEEDS.get(name, frozenset())
    assert declared.modifies == (("position",) if name in ("on", "resting on") else ())


def test_every_specifier_is_in_the_table() -> None:
    assert set(SPECIFIERS) == set(PRIORITIES)


# What programs do. Everything below has a frame of its own: turned otherwise than everything else.

EGO_ANGLES, SLAB_ANGLES, LEDGE_ANGLES, OWN_ANGLES = (0.3, 0.2, 0.1), (0, 0.25, 0), (0, 0, 0.4), (1.1, 0.5, 0)
WORLD = f"""
ego = new Object at (1, 2, 60), facing {EGO_ANGLES}, with allowCollisions True
slab = new Object at (0, 0, -9), facing {SLAB_ANGLES}, with width 90, with length 90, with allowCollisions True
ledge = new Object at (0, 0, -30), facing {LEDGE_ANGLES}, with width 5, with length 5, with allowCollisions True
field = VectorField("field", lambda p: 0.7)
"""
EGO, SLAB, LEDGE, OWN = (euler(*angles) for angles in (EGO_ANGLES, SLAB_ANGLES, LEDGE_ANGLES, OWN_ANGLES))

POSITIONS: dict[str, tuple[str, Any]] = {
    "at": ("at (3, 4, 1)", None),
    "in": ("in ledge.topSurface", LEDGE),
    "contained in": ("contained in CircularRegion((0, 0), 50)", None),
    "offset by": ("offset by (3, 4, 5)", EGO),
    "offset along": ("offset along 0.4 by (3, 4, 5)", EGO),
    "beyond": ("beyond (9, 9, 9) by 2", EGO),
    "left of": ("left of ego by 3", EGO),
    "right of": ("right of ego by 3", EGO),
    "ahead of": ("ahead of ego by 3", EGO),
    "behind": ("behind ego by 3", EGO),
    "above": ("above ego by 3", EGO),
    "below": ("below ego by 3", EGO),
    "following": ("following field from (1, 1, 1) for 3", euler(0.7)),
}
"""Specifiers of the position, and the orientation of the parent that each gives (``None``: none)."""

TOLERANT = ", with allowCollisions True"


def made(specifiers: str) -> Any:
    return thing(f"{WORLD}x = new Object {specifiers}{TOLERANT}\n")


@pytest.mark.parametrize("name", POSITIONS)
def test_who_decides_the_orientation_of_the_parent(name: str) -> None:
    """Alone each gives its own (priority 3); `on` is stronger (2), `with` the strongest (1); their order says nothing."""
    text, own = POSITIONS[name]
    assert_same_rotation(made(text).parentOrientation, euler(0) if own is None else own)
    for pair in (f"{text}, on slab", f"on slab, {text}"):
        assert_same_rotation(made(pair).parentOrientation, SLAB)
    told = f"with parentOrientation {OWN_ANGLES}"
    for pair in (
        f"{text}, {told}",
        f"{told}, {text}",
        f"{told}, {text}, on slab",
        f"on slab, {told}, {text}",
    ):
        assert_same_rotation(made(pair).parentOrientation, OWN)


def test_beyond_takes_the_frame_of_what_it_is_seen_from() -> None:
    assert_same_rotation(made("beyond (9, 9, 9) by 2 from slab").parentOrientation, SLAB)
    assert_same_rotation(made("beyond (9, 9, 9) by 2 from (1, 1, 1)").parentOrientation, euler(0))


@pytest.mark.parametrize("names", list(combinations(POSITIONS, 2)), ids=" and ".join)
def test_two_positions_clash(names: tuple[str, str]) -> None:
    one, other = (POSITIONS[name][0] for name in names)
    error = failure(f"{WORLD}x = new Object {one}, {other}{TOLERANT}\n")
    assert isinstance(error, SpecifierError)
    assert "specified twice" in str(error)


@pytest.mark.parametrize("name", POSITIONS)
def test_positions_win_over_visibility(name: str) -> None:
    """`visible` and `not visible` give a position of priority 3 only: another one decides, without a clash."""
    text, _ = POSITIONS[name]
    for other in ("visible from slab", "not visible from slab"):
        try:
            scenario(f"{WORLD}x = new Object {other}, {text}{TOLERANT}\n")
        except InvalidScenarioError as error:
            # Whether it can be seen where it is told to be is another question.
            found: Exception = error
        else:
            continue
        assert not isinstance(found, SpecifierError)


ORIENTATIONS = {
    "facing": ("facing (0.4, 0.2, 0)", {"yaw", "pitch", "roll"}),
    "facing toward": ("facing toward (1, 1, 1)", {"yaw"}),
    "facing away from": ("facing away from (1, 1, 1)", {"yaw"}),
    "facing directly toward": ("facing directly toward (1, 1, 1)", {"yaw", "pitch"}),
    "facing directly away from": ("facing directly away from (1, 1, 1)", {"yaw", "pitch"}),
    "apparently facing": ("apparently facing 0.2", {"yaw"}),
}


@pytest.mark.parametrize("name", ORIENTATIONS)
def test_which_angles_are_taken(name: str) -> None:
    text, angles = ORIENTATIONS[name]
    for angle in ("yaw", "pitch", "roll"):
        program = f"{WORLD}x = new Object {text}, with {angle} 0.3{TOLERANT}\n"
        if angle in angles:
            error = failure(program)
            assert isinstance(error, SpecifierError)
            assert f"'{angle}' is specified twice" in str(error)
        else:
            assert getattr(thing(program), angle) == pytest.approx(0.3)


@pytest.mark.parametrize("names", list(combinations(ORIENTATIONS, 2)), ids=" and ".join)
def test_two_orientations_clash(names: tuple[str, str]) -> None:
    one, other = (ORIENTATIONS[name][0] for name in names)
    assert "'yaw' is specified twice" in str(failure(f"{WORLD}x = new Object {one}, {other}{TOLERANT}\n"))


def test_a_container_is_given_once() -> None:
    both = "contained in CircularRegion((0, 0), 50), with regionContainedIn everywhere"
    assert "'regionContainedIn' is specified twice" in str(failure(f"{WORLD}x = new Object {both}\n"))


@pytest.mark.parametrize("name", ["on", *POSITIONS])
def test_positions_are_no_heading(name: str) -> None:
    """No specifier of the position takes an angle: `with yaw` goes along with each."""
    text = "on slab" if name == "on" else POSITIONS[name][0]
    found = made(f"{text}, with yaw 0.3, with pitch 0.2, with roll 0.1")
    assert (found.yaw, found.pitch, found.roll) == pytest.approx((0.3, 0.2, 0.1))


# 5.1: properties, their defaults and flags.

D, F, A = "dynamic", "final", "additive"
POINT: dict[str, tuple[Any, set[str]]] = {
    "position": ((0, 0, 0), {D}),
    "width": (0, set()),
    "length": (0, set()),
    "height": (0, set()),
    "baseOffset": ((0, 0, 0), set()),
    "contactTolerance": (0, set()),
    "onDirection": (None, set()),
    "viewAngles": ((math.tau, math.pi), set()),
    "visibleDistance": (50, set()),
    "viewRayDensity": (5, set()),
    "viewRayCount": (None, set()),
    "viewRayDistanceScaling": (False, set()),
    "regionContainedIn": (None, set()),
    "mutationScale": (0, set()),
    "positionStdDev": ((1, 1, 0), set()),
    "mutator": (..., {A}),
}
ORIENTED = {
    **POINT,
    "yaw": (0, {D}),
    "pitch": (0, {D}),
    "roll": (0, {D}),
    "parentOrientation": ("identity", set()),
    "orientation": ("identity", {D, F}),
    "heading": (0, {D, F}),
    "viewAngle": (math.tau, set()),
    "headingStdDev": (math.radians(5), set()),
    "orientationStdDev": ((math.radians(5), 0, 0), set()),
}
OBJECT = {
    **ORIENTED,
    "shape": (..., set()),
    "width": (1, set()),
    "length": (1, set()),
    "height": (1, set()),
    "allowCollisions": (False, set()),
    "present": (True, set()),
    "baseOffset": ((0, 0, -0.5), set()),
    "contactTolerance": (1e-4, set()),
    "sideComponentThresholds": (((-0.5, 0.5),) * 3, set()),
    "cameraOffset": ((0, 0, 0), set()),
    "visionSensorOffset": ((0, 0.5, 0), set()),
    "requireVisible": (False, set()),
    "occluding": (True, set()),
    "showVisibleRegion": (False, set()),
    "color": (None, set()),
    "render": (True, set()),
    "velocity": ((0, 0, 0), {D}),
    "speed": (0, {D}),
    "angularVelocity": ((0, 0, 0), {D}),
    "angularSpeed": (0, {D}),
    "behavior": (None, set()),
    "lastActions": ((), set()),
    "sensors": ({}, set()),
    "observations": ({}, {F}),
}
CLASSES = {"Point": POINT, "OrientedPoint": ORIENTED, "Object": OBJECT}


@pytest.mark.parametrize("name", CLASSES)
def test_flags_of_properties(name: str) -> None:
    found = properties_of(name)
    assert set(found) == set(CLASSES[name])
    for each, (_, flags) in CLASSES[name].items():
        assert {flag for flag in (D, F, A) if getattr(found[each], flag)} == flags, each


@pytest.mark.parametrize("name", CLASSES)
def test_defaults(name: str) -> None:
    """Of a fixed instance while the program runs, and of one in a scene."""
    names = [each for each, (value, _) in CLASSES[name].items() if value is not ...]
    listed = ", ".join(f"p_{each} = x.{each}, q_{each} = y.{each}" for each in names)
    (found,) = [scene(f"x = new {name}\ny = new {name} at (Range(2, 3), 5, 0)\nparam {listed}\n").params]
    for each in names:
        value, _ = CLASSES[name][each]
        for prefix in ("p", "q"):
            if (prefix, each) != ("q", "position"):
                check_default(found[f"{prefix}_{each}"], value, each)


def check_default(found: Any, value: Any, name: str) -> None:
    if value == "identity":
        assert_same_rotation(found, euler(0))
    elif value is None or isinstance(value, bool | dict):
        assert (found is value) or (isinstance(value, dict) and found == value), name
    elif isinstance(value, tuple) and value and not isinstance(value[0], tuple):
        assert tuple(found) == pytest.approx(value, abs=0), name
    else:
        assert found == value, name


@pytest.mark.parametrize(
    ("specifiers", "name", "value"),
    [
        ("with height 3", "baseOffset", (0, 0, -1.5)),
        ("with length 3", "visionSensorOffset", (0, 1.5, 0)),
        ("with viewAngle 1.5", "viewAngles", (1.5, math.pi)),
        ("with headingStdDev 0.25", "orientationStdDev", (0.25, 0, 0)),
        ("with shape BoxShape((2, 3, 4))", "width", 2),
        ("with shape BoxShape((2, 3, 4))", "length", 3),
        ("with shape BoxShape((2, 3, 4))", "height", 4),
        ("with shape BoxShape((2, 3, 4), scale=2)", "baseOffset", (0, 0, -4)),
        ("facing (0.5, 0.2, 0), with parentOrientation 0.25", "heading", 0.5),
        ("with yaw 0.5, with parentOrientation 0.25", "heading", 0.75),
        (f"with speed 2, facing {math.pi / 2}", "velocity", (-2, 0, 0)),
        (f"with speed 2, facing (0, {math.pi / 2}, 0)", "velocity", (0, 0, 2)),
    ],
)
def test_defaults_that_follow_from_others(specifiers: str, name: str, value: Any) -> None:
    for drawn in ("", ", at (Range(0, 1), 0, 0)"):
        found = getattr(thing(f"x = new Object {specifiers}{drawn}\n"), name)
        expected = pytest.approx(value, abs=1e-12)
        assert (tuple(found) if isinstance(value, tuple) else found) == expected


@pytest.mark.parametrize(
    ("cls", "name"),
    [
        (cls, name)
        for cls, table in CLASSES.items()
        for name, (_, flags) in table.items()
        if F in flags and name != "heading"
    ],
)
def test_final_properties_cannot_be_specified(cls: str, name: str) -> None:
    error = failure(f"x = new {cls} with {name} 1\n")
    assert isinstance(error, SpecifierError)
    assert f"'{name}' cannot be directly specified" in str(error)


@pytest.mark.parametrize("name", [name for name, (_, flags) in OBJECT.items() if F not in flags])
def test_other_properties_can(name: str) -> None:
    """Whatever is wrong with the value, it is not that the property cannot be given."""
    try:
        scene(f"x = new Object with {name} 1\n")
    except Exception as found:  # noqa: BLE001 - whatever it is, it is looked at
        error = found
    else:
        return
    assert not isinstance(error, SpecifierError)
    assert place(error)[0] != "SC999"
