"""Section 16 of the specification: where the reference is wrong, ours is right. One test for each tag.

Tags of what happens in simulations are those of the traces in ``tests/data/dynamics`` that differ from the reference.
"""

import math
import re
from typing import Any

import numpy as np
import pytest
from scipy import stats

import scenic
from scenic.language.errors import (
    InvalidScenarioError,
    RejectionException,
    ScenicSyntaxError,
    ScenicTypeError,
    ScenicValueError,
)
from scenic.simulators.dummy import DummySimulator
from scenic.simulators.results import TerminationType
from tests.dynamic_programs import FOLDER, programs
from tests.runtime.programs import (
    FALSE_ALARM,
    assert_same_rotation,
    draws,
    euler,
    failure,
    params,
    scenario,
    scene,
    thing,
)


def value(expression: str, before: str = "") -> Any:
    return params(f"{before}param value = {expression}\n")["value"]


def test_d1_every_requirement_of_visibility_knows_what_hides() -> None:
    text = (
        "ego = new Object\nwall = new Object at (0, 5, 0), with width 20, with length 0.1, with height 20{}\n"
        "a = new Object at (0, -5, 0), visible\nb = new Object at (0, 10, 0), visible\nc = new Object at (3, 20, 0){}\n"
    )
    scene(text.format(", with occluding False", ", visible"))
    for found in (failure(text.format("", "")), failure(text.format("", ", visible"))):
        assert isinstance(found, InvalidScenarioError)
        assert found.line == 4
    late = failure(text.replace("0), visible\nc", "0)\nc").format("", ", with requireVisible True"))
    assert isinstance(late, InvalidScenarioError)
    assert late.line == 5


@pytest.mark.parametrize("container", ["", ", with regionContainedIn CircularRegion((0, 0), 30)"])
def test_d2_visibility_changes_no_law(container: str) -> None:
    """What is seen is uniform in the view: the azimuth in its range, and the volume up to the distance."""
    text = (
        "ego = new Object facing 0.4, with viewAngles (1.2, 0.9), with visibleDistance 12\n"
        f"p = new Point visible{container}\nparam p = p.position\n"
    )
    places = np.array([tuple(found) for found in draws(text, "p", n=700, seed=3)])
    azimuth = np.arctan2(places[:, 1], places[:, 0]) - math.pi / 2 - 0.4
    azimuth = (azimuth + math.pi) % (2 * math.pi) - math.pi
    assert stats.kstest(azimuth, stats.uniform(-0.6, 1.2).cdf).pvalue > FALSE_ALARM
    distance = np.linalg.norm(places, axis=1)
    assert stats.kstest((distance / 12) ** 3, "uniform").pvalue > FALSE_ALARM


def test_d3_pruning_ends() -> None:
    text = (
        "shell = SpheroidRegion(dimensions=(9, 9, 9)).difference(SpheroidRegion(dimensions=(8, 8, 8)))\n"
        "workspace = Workspace(shell)\nego = new Object in shell, with width 0.1, with length 0.1, with height 0.1\n"
        "thin = new Object in BoxRegion((9, 9, 0.001)), with regionContainedIn everywhere, with allowCollisions True\n"
    )
    for item in scenario(text).sample(5, seed=1):
        assert 3.9 < np.linalg.norm(item.objects[0].position) < 4.5


def test_d4_a_misspelt_property_is_told() -> None:
    for _ in range(2):  # each program is told
        with pytest.warns(UserWarning, match="'widht', which is now created: did you mean 'width'"):
            assert thing("new Object with widht 3\n").widht == 3


def test_d5_what_rejected_is_told() -> None:
    text = "x = Range(0, 1)\ndef f(v): return v > 2\nrequire x < 2 or f(x)\nrequire f(x) as 'too much'\nrequire f(1 - x) or x < 0.5\n"
    with pytest.raises(RejectionException) as caught:
        scenario(text).generate(maxIterations=200)
    told = str(caught.value)
    assert re.search(r"too much.* rejected every candidate", told)
    assert re.search(r"100\.0% .*too much", told)
    (share,) = re.findall(r"(\d+\.\d)% +0\.0% +requirement on line 5", told)
    assert 30 < float(share) < 70


def test_d8_beyond_takes_the_orientation_of_the_observer() -> None:
    before = "ego = new Object facing (0.3, 0.2, 0.1)\nc = new OrientedPoint facing (1, 0.5, 0)\n"
    for specifier, angles in (
        ("beyond (9, 9, 9) by 2", (0.3, 0.2, 0.1)),
        ("beyond (9, 9, 9) by 2 from c", (1, 0.5, 0)),
        ("beyond (9, 9, 9) by 2 from (1, 1, 1)", (0, 0, 0)),
        ("beyond (9, 9, 9) by 2 from new Point at (1, 1, 1)", (0, 0, 0)),
    ):
        found = thing(f"{before}new Object {specifier}\n")
        assert_same_rotation(found.parentOrientation, euler(*angles))
        assert_same_rotation(found.orientation, euler(*angles))


FLAT = [
    "CircularRegion((0, 0, 3), 2)",
    "SectorRegion((0, 0, 3), 2, 0, 6)",
    "RectangularRegion((0, 0, 3), 0, 4, 4)",
    "PolygonalRegion([(-2, -2), (2, -2), (2, 2), (-2, 2)], z=3)",
]


@pytest.mark.parametrize("region", FLAT)
def test_d9_flat_regions_ignore_z_and_keep_theirs(region: str) -> None:
    assert value(f"[{region}.containsPoint((0, 1, z)) for z in (-7, 3, 9)]") == [True] * 3
    other = "PolygonalRegion([(-1, -1), (5, -1), (5, 5), (-1, 5)], z=3)"
    for method in ("intersect", "union", "difference"):
        found = value(f"[(new Point in {region}.{method}({other})).position.z for i in range(3)]")
        assert found == [3, 3, 3]
        elsewhere = other.replace("z=3", "z=4")
        if method == "intersect":
            assert value(f"repr({region}.intersect({elsewhere}))") == repr(
                scenic.scenarioFromString("x = nowhere\nparam x = x").sample(1)[0].params["x"]
            )


PROJECTIONS = [
    # (what lies under `on`, where from, where it lands)
    ("BoxRegion((2, 2, 2), onDirection=(1, 0, 0))", (-5, 0.5, 0.3), (-1, 0.5, 0.3)),
    ("BoxRegion((2, 2, 2), onDirection=(1, 0, 0))", (5, 0.5, 0.3), (1, 0.5, 0.3)),
    ("BoxRegion((2, 2, 2))", (0.5, 0.3, 5), (0.5, 0.3, 1)),
    ("BoxRegion((2, 2, 2))", (0.5, 0.3, -5), (0.5, 0.3, -1)),
    ("BoxRegion((2, 2, 2)).getSurfaceRegion()", (0.5, 0.3, 5), (0.5, 0.3, 1)),
    ("BoxRegion((2, 2, 2)).getSurfaceRegion()", (0.5, 0.3, 0.4), (0.5, 0.3, 1)),
    ("BoxRegion((2, 2, 2)).getSurfaceRegion()", (0.5, 0.3, -0.4), (0.5, 0.3, -1)),
    ("CircularRegion((0, 0, 2), 3)", (1, 1, -7), (1, 1, 2)),
    ("PolygonalRegion([(-2, -2), (2, -2), (2, 2)], z=2)", (1, 0, -7), (1, 0, 2)),
    ("Workspace(RectangularRegion((0, 0, 2), 0.3, 4, 4))", (1, 1, 9), (1, 1, 2)),
    ("everywhere", (1, 1, 9), (1, 1, 9)),
]  # fmt: skip


@pytest.mark.parametrize(("region", "start", "end"), PROJECTIONS)
def test_d10_projection_takes_the_nearest_hit_along_the_direction(
    region: str, start: tuple[float, ...], end: tuple[float, ...]
) -> None:
    assert tuple(value(f"(new Point at {start}, on {region}).position")) == pytest.approx(end)


def test_d10_a_point_beside_lands_nowhere() -> None:
    for region in ("CircularRegion((0, 0, 2), 3)", "BoxRegion((2, 2, 2))", "nowhere"):
        found = failure(f"x = new Point at (Range(5, 6), 0, 5), on {region}\nparam x = x\n", n=1)
        assert isinstance(found, RejectionException | InvalidScenarioError)


def test_d11_a_point_sees_as_far_as_it_says() -> None:
    before = "p = new Point at (1, 2, 3), with visibleDistance 10\n"
    assert value("[p.visibleRegion.containsPoint((1, 2 + d, 3)) for d in (4.9, 9.9, 10.1)]", before) == [True, True, False]  # fmt: skip


@pytest.mark.parametrize(
    "condition",
    [
        "(always x > -1) implies (eventually x > -1)",
        "(always x > -1) as foo",
        "((always x > -1)) as foo",
        "not (eventually x < 0) implies (always (x > -1 implies next x > -1))",
    ],
)
def test_d12_temporal_groups(condition: str) -> None:
    assert scenario(f"x = Range(0, 1)\nrequire {condition}\n").sample(1)


@pytest.mark.parametrize(
    ("condition", "word"),
    [
        ("(always x > -1) if y else x > -1", "always"),
        ("x > -1 if y else (eventually x > 3)", "eventually"),
        ("x > 0 if (next x > 5) else x > 1", "next"),
        ("(x > 0 until x > 1) if y else x > -1", "until"),
        ("lambda: (always x > 0)", "always"),
    ],
)
def test_d12_temporal_operators_in_other_expressions(condition: str, word: str) -> None:
    found = failure(f"x, y = Range(0, 1), True\nrequire {condition}\n")
    assert isinstance(found, ScenicSyntaxError)
    assert re.search(f"`{word}` cannot (stand inside|be part of) an? ", found.message)


@pytest.mark.parametrize("name", ["ego", "workspace", "globalParameters", "int", "float", "str"])
@pytest.mark.parametrize(
    "text",
    [
        "import math as {}",
        "from math import pi as {}",
        "def {}(): pass",
        "class {}: pass",
        "def f({}): pass",
        "def f(*, {}=3): pass",
        "f = lambda {}: 3",
        "try:\n    pass\nexcept ValueError as {}:\n    pass",
    ],
)
def test_d13_reserved_names_are_not_bound(name: str, text: str) -> None:
    found = failure(text.format(name) + "\n")
    assert isinstance(found, ScenicSyntaxError)
    assert name in found.message


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("x = 1 if False else 2 if False else 3", 3),
        ("x = (1 if False else lambda: 4)()", 4),
        ("x = 1; param y = 2; x = globalParameters.y", 2),
        ("if True: param y = 7; x = globalParameters.y", 7),
        ("x = 0\nfor i in range(3): x += i; require x >= 0", 3),
    ],
)
def test_d14_what_one_line_may_hold(text: str, result: int) -> None:
    assert params(f"{text}\nparam found = x\n")["found"] == result


@pytest.mark.parametrize(
    "text",
    [
        "behavior B(): wait\ndo choose B()",
        "class A(Object):\n    require True",
        "abort",
        "behavior B():\n    wait\n    abort",
        "behavior B():\n    def f():\n        take 3\n    wait",
        "behavior B():\n    def f():\n        wait\n    wait",
        "monitor M():\n    take 3",
        "record 3 every 4",
        "behavior B():\n    record 3",
        "terminate",
        "behavior B():\n    mutate",
    ],
)
def test_d15_misplaced_statements_are_told(text: str) -> None:
    found = failure(text + "\n")
    assert isinstance(found, ScenicSyntaxError)
    assert found.line is not None


@pytest.mark.parametrize("name", ["width", "length", "height"])
def test_d16_sizes_are_positive(name: str) -> None:
    for size in ("0", "-1"):
        assert isinstance(failure(f"new Object with {name} {size}\n"), ScenicValueError)
    for item in scenario(f"new Object with {name} Range(-1, 1)\n").sample(20, seed=1):
        assert getattr(item.objects[0], name) > 0


def test_d17_values_of_dictionaries_are_sampled() -> None:
    text = "x = Range(0, 1)\nego = new Object with tag {'a': x, 'b': [x, {'c': x}]}\nparam d = {'x': x, 'tag': (x, {1: x})}\n"
    found = scene(text)
    x = found.params["d"]["x"]
    assert 0 < x < 1
    assert found.params["d"] == {"x": x, "tag": (x, {1: x})}
    assert found.objects[0].tag == {"a": x, "b": [x, {"c": x}]}


def test_d18_points_are_mutated() -> None:
    text = "p = new Point\nq = new OrientedPoint\nmutate p, q by 2\nparam p = p, q = q\n"
    found = params(text)
    assert found["p"].position.x != 0
    assert found["q"].position.x != 0
    assert found["q"].yaw != 0


def test_d20_no_steps_are_none() -> None:
    text = "behavior B():\n    while True:\n        take 1\nego = new Object with behavior B\n"
    done = DummySimulator().simulate(scene(text), maxSteps=0)
    assert done is not None
    assert done.result is not None
    assert done.result.terminationType is TerminationType.timeLimit
    assert (len(done.result.trajectory), len(done.result.actions)) == (1, 0)


def test_d24_a_scale_of_mutation_is_enough() -> None:
    for how in ("new Object with mutationScale 1", "ego = new Object\nmutate ego by 1"):
        found = [item.objects[0].position.x for item in scenario(how + "\n").sample(200, seed=1)]
        assert stats.kstest(found, "norm").pvalue > FALSE_ALARM


def test_d25_what_is_not_drawn_rejects_nothing() -> None:
    text = "n = DiscreteRange(0, 9)\nparam x = Uniform(7, DiscreteRange(5, n), DiscreteRange(5, 4))\n"
    shares = [item.params["x"] == 7 for item in scenario(text).sample(600, seed=2)]
    # One third each: the second is there in half of the draws, the third never.
    assert stats.binomtest(sum(shares), len(shares), 2 / 3).pvalue > FALSE_ALARM


def test_d30_whether_an_object_must_be_seen_is_drawn() -> None:
    text = (
        "ego = new Object with viewAngle 2\nseen = Uniform(True, False)\n"
        "new Object at (Range(-9, 9), Uniform(-9, 9)), with requireVisible seen\nparam seen = seen\n"
    )
    found = {(item.params["seen"], item.objects[1].y > 0) for item in scenario(text).sample(80, seed=1)}
    assert found == {(True, True), (False, True), (False, False)}


def test_d31_what_is_at_the_camera_is_seen() -> None:
    text = (
        "ego = new Object with cameraOffset (0, 1, 1), with viewAngles (0.5, 0.5)\np = new Point at (0, 1, 1)\n"
        "around = new Object at (0, 3, 1), with width 0.1, with length 3.9, with height 0.1, with allowCollisions True\n"
        "require ego can see (0, 1, 1)\nrequire ego can see p\nrequire ego can see around\n"
        "require p can see (0, 1, 1)\nrequire not (ego can see (0, 0.9, 1))\n"
    )
    assert scene(text).attempts == 1


def test_d32_an_offset_camera_has_its_window_around_it() -> None:
    text = "ego = new Object facing (0.5, 0.3, 0.2), with cameraOffset (1, 2, 10), with viewAngles (0.6, 0.4), with visibleDistance 9\n"
    for local, seen in (
        ((1, 6, 10), True),
        ((1, 10.9, 10), True),
        ((1, 11.1, 10), False),
        ((1 + 4 * math.tan(0.29), 6, 10), True),
        ((1 + 4 * math.tan(0.31), 6, 10), False),
        ((1, 6, 10 + 4 * math.tan(0.19)), True),
        ((1, 6, 10 + 4 * math.tan(0.21)), False),
        ((0, 6, 0), False),
    ):
        wanted = "" if seen else "not "
        assert scene(f"{text}require {wanted}(ego can see ego.relativePosition({local}))\n").attempts == 1


DYNAMIC = {
    "D6": "test_ends_and_records_of_invoked_scenarios_are_theirs",
    "D7": "test_soft_requirements_count_only_where_they_were_active",
    "D19": "test_all_overrides_are_reverted",
    "D21": "test_periods_and_delays_select_steps",
    "D22": None,
    "D23": "test_nothing_survives_a_failure",
    "D26": "test_an_interrupted_scenario_goes_on",
    "D27": "test_a_monitor_of_an_invoked_scenario_ends_that_scenario",
    "D28": None,
    "D29": None,
}
"""Tags of what happens in simulations, and the tests of those that no trace shows."""


def test_every_tag_has_its_test() -> None:
    static = {found.group(1).upper() for name in globals() if (found := re.match(r"test_(d\d+)_", name))}
    assert static | DYNAMIC.keys() == {f"D{number}" for number in range(1, 33)}
    traced = {item.differs for file in FOLDER.glob("*.txt") for item in programs(file).values()}
    others = (FOLDER.parents[1] / "simulators" / "test_simulations.py").read_text(encoding="utf-8")
    for tag, name in DYNAMIC.items():
        assert tag in traced if name is None else f"def {name}(" in others


def test_a_type_that_no_conversion_knows() -> None:
    """What is left of the open points: values that are refused keep being refused."""
    assert isinstance(failure("new Object facing (1, 2)\n"), ScenicTypeError)
