"""What decides which scenes come out, and which errors: whatever the batch, the seed and the number of scenes."""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from scipy import stats

import scenic
from scenic.language.errors import RejectionException
from tests.amounts import amount
from tests.runtime.programs import FALSE_ALARM, draws, failure, fingerprint, scenario

ROOT = Path(__file__).parents[3]
LANES = (1, 64, 4096)

# Faults

RARE = """
x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)
def fails(value):
    if value > {limit}:
        raise KeyError("rare")
    return True
def small(value):
    return value < 0.05
param x = x, y = y
"""


@pytest.mark.parametrize("fault", ["fails(x)", "1 / (0 if x > 0.999 else 1) == 1", "fails(x) or y > 2"])
def test_a_rare_fault_that_a_rare_requirement_rejects(fault: str) -> None:
    """Of 4,000 candidates some fail, and each of them is rejected: by what stands before, between, or after."""
    conditions = ["x < 0.9 or z > 2", "small(y)", fault]
    for place in range(3):
        order = [*conditions[place:], *conditions[:place]]
        text = RARE.format(limit=0.999) + "".join(f"require {condition}\n" for condition in order)
        scenes = scenario(text).sample(200, seed=3)
        assert max(scene.params["x"] for scene in scenes) < 0.9
        assert sum(scene.attempts for scene in scenes) > 3000
    for lanes in LANES:
        count = amount(25, 200) if lanes == 1 else 200
        others = scenario(text).sample(count, seed=3, lanes=lanes)
        assert [fingerprint(scene) for scene in others] == [fingerprint(scene) for scene in scenes[:count]]


@pytest.mark.parametrize(
    "written", ["require fails(x)\nrequire small(y)\n", "require small(y)\nrequire fails(x)\n"]
)
def test_a_rare_fault_that_nothing_rejects(written: str) -> None:
    """It surfaces at one scene, after the same scenes, whatever the batch."""
    text = RARE.format(limit=0.98) + written
    found = set()
    for lanes in LANES:
        before = []
        with pytest.raises(KeyError, match="rare"):
            before.extend(
                fingerprint(scene)
                for scene in scenario(text.replace("0.05", "0.5")).stream(400, seed=5, lanes=lanes)
                if isinstance(scene, scenic.Scene)
            )
        found.add(tuple(before))
    assert len(found) == 1


def test_a_fault_is_that_of_the_first_scene_that_has_one() -> None:
    """A part of the scenes has the fault that the whole has there, if it has any."""
    text = RARE.format(limit=0.98) + "require small(y) or y < 0.5\nrequire fails(x)\n"

    def outcome(first: int, n: int, lanes: int) -> tuple[int, bool]:
        count = 0
        try:
            for _ in scenario(text).stream(n, seed=11, first=first, lanes=lanes):
                count += 1
        except KeyError:
            return count, True
        return count, False

    count, failed = outcome(0, 1000, 512)
    assert failed
    for lanes in LANES:
        assert outcome(0, count, lanes) == (count, False)
        assert outcome(count, 1, lanes) == (0, True)
        assert outcome(count - 1, 5, lanes) == (1, True)


def test_a_fault_is_told_with_its_scene_and_attempt() -> None:
    text = "x, y = Range(0, 1), Range(0, 1)\ndef f(v):\n    {body}\n    return True\ndef g(v, w): return v < 0.4\nrequire g(y, x)\nrequire f(x)\nparam x = x\n"
    free = scenario(text.format(body="pass")).sample(60, seed=3)
    first = next(scene for scene in free if scene.params["x"] > 0.95)
    assert first.k not in (0, first.attempts - 1)
    with pytest.raises(KeyError) as caught:
        scenario(text.format(body="if v > 0.95: raise KeyError('odd')")).sample(60, seed=3)
    (note,) = caught.value.__notes__
    assert f"(attempt {first.attempts - 1} at scene {first.k})" in note


@pytest.mark.parametrize("lanes", LANES)
def test_a_fault_among_many_scenes_is_told_with_its_own(lanes: int) -> None:
    text = (
        "limit = {}\ndef first(v, w): return v\ndef high(v): return 1 / (v >= limit)\nx, y = Range(0, 1), Range(0, 1)\n"
        "require first(x, y) > 0.8\nrequire high(y)\nparam y = y\n"
    )
    sound = scenario(text.format(0)).sample(20, seed=2)
    fails = next(item for item in sound if item.params["y"] < 0.2)
    assert fails.k > 0
    assert fails.attempts > 1
    with pytest.raises(ZeroDivisionError) as caught:
        scenario(text.format(0.2)).sample(20, seed=2, lanes=lanes)
    (note,) = caught.value.__notes__
    assert f"(attempt {fails.attempts - 1} at scene {fails.k})" in note


# Rejection


@pytest.mark.parametrize(
    "condition",
    [
        "not (k > 100)",
        "not f(k)",
        "not (k > 100 and n >= 0)",
        "not not (k >= 0)",
        "not (f(k) or k < 0)",
        "not min(k, 200) > 100",
        "(k > 100) == False",
        "not u > 100",
    ],
)
def test_a_rejected_operand_under_a_negation(condition: str) -> None:
    """Where a draw is rejected no condition holds, the negation of one no more than the condition."""
    text = f"n = DiscreteRange(0, 9)\nk = DiscreteRange(5, n)\nu = Uniform(k, k)\ndef f(v): return v > 100\nparam n = n\nrequire {condition}\n"
    for lanes in LANES:
        scenes = scenario(text).sample(60, seed=2, lanes=lanes)
        assert {scene.params["n"] for scene in scenes} == set(range(5, 10))


def test_a_rejected_value_that_is_only_an_output() -> None:
    text = "n = DiscreteRange(0, 9)\nparam n = n, k = DiscreteRange(5, n)\n"
    scenes = scenario(text).sample(80, seed=2)
    assert {scene.params["n"] for scene in scenes} == set(range(5, 10))
    assert all(5 <= scene.params["k"] <= scene.params["n"] for scene in scenes)


def test_what_is_not_drawn_does_not_reject() -> None:
    text = "n = DiscreteRange(0, 9)\nk = Uniform(7, DiscreteRange(5, n))\nparam n = n, k = k\n"
    scenes = scenario(text).sample(300, seed=4)
    assert {scene.params["n"] for scene in scenes if scene.params["k"] == 7} == set(range(10))
    assert all(scene.params["k"] == 7 or 5 <= scene.params["k"] <= scene.params["n"] for scene in scenes)


def test_the_error_is_that_of_the_part_that_counts() -> None:
    """What stands first, and is evaluated with it, but decides nothing, has an error too."""
    text = "z = DiscreteRange(0, 5)\nrequire (z > 9 and 1 / z > 2) or 5 % z >= 0\n"
    with pytest.raises(ZeroDivisionError, match="modulo"):
        scenario(text).sample(99, seed=0)
    text = "z = DiscreteRange(0, 5)\nrequire (z > 9 and 5 % z > 2) or 1 / z >= 0\n"
    with pytest.raises(ZeroDivisionError, match="division"):
        scenario(text).sample(99, seed=0)


def test_faults_count_as_rejections_in_reports_and_what_never_rejects_is_not_told() -> None:
    text = (
        "x = Range(0, 1)\ndef never(v): return v > 9\nrequire 1 / max(0, x - 0.5) > 0 as fails\n"
        "require 1 / max(0, x - 0.5) >= 0 as weaker\n"
        "require x > -1 as holds\nrequire never(x) as never\n"
    )
    (result,) = scenario(text).stream(1, seed=1, max_attempts=1000)
    assert not isinstance(result, scenic.Scene)
    found = {row.label: row.rejected for row in result.report.rows}
    assert set(found) == {"fails", "weaker", "never"}
    assert found["weaker"] == found["fails"]
    assert stats.binomtest(round(1000 * found["fails"]), 1000, 0.5).pvalue > FALSE_ALARM


# Seeds


def test_seeds_of_either_sign_and_any_size() -> None:
    program = scenario("param x = Range(0, 1), y = Uniform(*range(1000)), z = Normal(0, 1)\n")
    seeds = (
        0,
        1,
        -1,
        3,
        -3,
        2**31,
        -(2**31),
        2**32 + 3,
        2**63,
        2**64,
        2**64 + 3,
        -(2**64) + 3,
        2**128 + 3,
        3 << 64,
    )
    found = {seed: [fingerprint(scene)[2:] for scene in program.sample(3, seed=seed)] for seed in seeds}
    everything = [item for scenes in found.values() for item in scenes]
    assert len(set(everything)) == len(everything)
    for seed in seeds:
        assert [fingerprint(scene)[2:] for scene in program.sample(3, seed=seed, lanes=1)] == found[seed]


def test_draws_of_neighbours_are_independent() -> None:
    """Scenes, seeds and draws next to each other: no correlation of more than chance gives."""
    program = scenario("param a = Range(0, 1), b = Range(0, 1), c = Range(0, 1)\n")
    rows = [
        [scene.params[name] for name in "abc"]
        for seed in range(40)
        for scene in program.sample(40, seed=seed)
    ]
    columns = list(zip(*rows, strict=True))
    for column in columns:
        assert stats.kstest(column, "uniform").pvalue > FALSE_ALARM
    pairs = [
        (columns[0], columns[1]),
        (columns[1], columns[2]),
        (columns[0][:-1], columns[0][1:]),
        (columns[0][:-1], columns[1][1:]),
        (columns[0][:-40], columns[0][40:]),
    ]
    for one, other in pairs:
        assert stats.pearsonr(one, other).pvalue > FALSE_ALARM


# Choices


def frequencies(values: list[object], expected: dict[object, float]) -> float:
    counts = Counter(values)
    assert set(counts) <= set(expected)
    n = len(values)
    observed = [counts[key] for key in expected]
    return float(stats.chisquare(observed, [n * share for share in expected.values()]).pvalue)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x = Uniform(*(1, 2, 3))", {1: 1 / 3, 2: 1 / 3, 3: 1 / 3}),
        (
            "xs = Uniform([1, 2, 3], [4, 5])\nx = Uniform(*xs)",
            {1: 1 / 6, 2: 1 / 6, 3: 1 / 6, 4: 1 / 4, 5: 1 / 4},
        ),
        ("xs = Uniform([1, 2], [3])\nx = Uniform(*xs, 9)", {1: 1 / 6, 2: 1 / 6, 9: 5 / 12, 3: 1 / 4}),
        (
            "xs = Uniform([1], [2, 3, 4])\nx = Uniform(0, *xs)",
            {0: 3 / 8, 1: 1 / 4, 2: 1 / 8, 3: 1 / 8, 4: 1 / 8},
        ),
        ("xs = Uniform([], [2, 3])\nx = Uniform(*xs)", {2: 1 / 2, 3: 1 / 2}),
        ("x = Uniform(*[1, 2], *Uniform([3], [4]))", {1: 1 / 3, 2: 1 / 3, 3: 1 / 6, 4: 1 / 6}),
        (
            "x = Uniform(*Uniform([1, 2], [3]), *Uniform([4], [5, 6, 7]))",
            {1: 2 / 15, 2: 2 / 15, 3: 3 / 16, 4: 5 / 24, 5: 9 / 80, 6: 9 / 80, 7: 9 / 80},
        ),
        (
            "x = Uniform(*Uniform([1, 2], Uniform([3], [4, 5])))",
            {1: 1 / 4, 2: 1 / 4, 3: 1 / 4, 4: 1 / 8, 5: 1 / 8},
        ),
        ("x = Discrete({1: 3, 2: 0, 3: 1})", {1: 3 / 4, 3: 1 / 4}),
        ("x = DiscreteRange(2, 4, (1, 0, 3))", {2: 1 / 4, 4: 3 / 4}),
        ("x = DiscreteRange(-2.5, 1.5)", {-2: 1 / 4, -1: 1 / 4, 0: 1 / 4, 1: 1 / 4}),
        ("x = DiscreteRange(2**53, 2**53 + 2)", {2**53: 1 / 3, 2**53 + 1: 1 / 3, 2**53 + 2: 1 / 3}),
        ("x = DiscreteRange(-(2**60) - 1, -(2**60))", {-(2**60) - 1: 1 / 2, -(2**60): 1 / 2}),
        (
            "n = DiscreteRange(2**53, 2**53 + 1)\nx = DiscreteRange(n, n + 1) - 2**53",
            {0: 1 / 4, 1: 1 / 2, 2: 1 / 4},
        ),
        ("x = Uniform(1, Uniform(2, 3))", {1: 1 / 2, 2: 1 / 4, 3: 1 / 4}),
        ("x = filter(lambda v: v > 1, Uniform([1, 2, 3], [4]))[0]", {2: 1 / 2, 4: 1 / 2}),
    ],
)
def test_choices_are_as_likely_as_they_say(text: str, expected: dict[object, float]) -> None:
    for n, seed in ((2000, 6), (2000, -6)):
        assert frequencies(draws(f"{text}\nparam x = x\n", n=n, seed=seed), expected) > FALSE_ALARM


# Reports


@pytest.mark.parametrize(("moved", "pair"), [("a", "bc"), ("b", "ac"), ("c", "ab")])
def test_the_report_of_a_collision_names_the_right_pair(moved: str, pair: str) -> None:
    """Two of three collide in every candidate; the third is elsewhere."""
    lines = [
        f"{name} = new Object at ({'Range(50, 51)' if name == moved else 'Range(0, 0.1)'}, Range(0, 0.1), 0)"
        for name in "abc"
    ]
    (result,) = scenario("\n".join(lines) + "\n").stream(1, seed=0, max_attempts=50)
    assert not isinstance(result, scenic.Scene)
    told = [row for row in result.report.rows if "collision" in row.label]
    assert [(row.rejected, row.alone) for row in told if row.rejected] == [(1.0, 1.0)]
    (row,) = (row for row in told if row.rejected)
    label = row.label
    assert row.span is not None
    assert row.span.line == max("abc".index(name) for name in pair) + 1
    for name in "abc":
        assert (f"line {'abc'.index(name) + 1}" in label) == (name in pair)


def test_reports_count_pairs_for_themselves() -> None:
    """Three objects; by construction the pairs collide in 1/2, 1/4 and none of the candidates."""
    text = (
        "i, j = DiscreteRange(0, 1), DiscreteRange(0, 3)\na = new Object at (0, 0, 0)\n"
        "b = new Object at (9 * i + 0.2, 0, 0)\nc = new Object at (0, 5 * min(j, 1) + 0.3, 30 * min(i, 0) + 0.2)\n"
        "def never(v): return v > 9\nrequire never(j)\n"
    )
    (result,) = scenario(text).stream(1, seed=1, max_attempts=4000)
    assert not isinstance(result, scenic.Scene)
    found = {row.label: row.rejected for row in result.report.rows}
    shares = {lines: share for label, share in found.items() for lines in ["23", "24", "34"] if all(f"(line {n})" in label for n in lines)}  # fmt: skip
    n = result.report.candidates
    for lines, expected in (("23", 0.5), ("24", 0.25), ("34", 0.125)):
        observed = round(shares.get(lines, 0.0) * n)
        assert stats.binomtest(observed, n, expected).pvalue > FALSE_ALARM


# Memory

STREAM = """
import gc
import sys
import tracemalloc
import scenic
scenario = scenic.scenarioFromString(sys.argv[1])
tracemalloc.start()
used = {}
for number, _ in enumerate(scenario.stream(5001, seed=1, lanes=256)):
    if number in (1000, 5000):
        gc.collect()
        used[number], _ = tracemalloc.get_traced_memory()
print(used[5000] - used[1000])
"""


@pytest.mark.slow
def test_memory_of_a_long_stream_is_bounded() -> None:
    """By what Python and NumPy have allocated: a process's peak also moves by its allocator's habits."""
    text = (
        "ego = new Object at (Range(-9, 9), 0, 0), with note [Range(0, 1) for i in range(20)]\n"
        "new Object at (0, Range(3, 9), 0)\ndef f(x): return x > 0\nrequire f(ego.x)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", STREAM, text], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) < 300_000  # bytes; 4,000 scenes that are kept take 2,000,000


def test_a_condition_that_is_false_elsewhere_than_where_it_rejects() -> None:
    text = (
        "from scenic.language.errors import RejectionException\nx = Range(0, 1)\nparam x = x\n"
        "def f(x):\n    if x < 0.3:\n        raise RejectionException('never')\n    return x < 0.5\nrequire f(x)\n"
    )
    for lanes in LANES:
        values = [scene.params["x"] for scene in scenario(text).sample(60, seed=2, lanes=lanes)]
        assert 0.3 <= min(values) < 0.35 < 0.45 < max(values) < 0.5


def test_soft_requirements_that_always_hold_take_no_number_of_others() -> None:
    text = "x = Range(0, 1)\nego = new Object at (x, 0)\nrequire[0.3] 1 < 2\nrequire[0.5] x > 0.5\nrequire[0.4] x < 0.6\n"
    scenes = scenario(text).sample(60, seed=2)
    constant, *others = scenes[0].program.requirements
    assert all(scene.enforces(constant) for scene in scenes)
    for requirement, holds in zip(others, (lambda x: x > 0.5, lambda x: x < 0.6), strict=True):
        enforced = [scene for scene in scenes if scene.enforces(requirement)]
        assert 0 < len(enforced) < len(scenes)
        assert all(holds(scene.egoObject.x) for scene in enforced)


def test_sizes_that_objects_share_are_those_of_each() -> None:
    """Three cubes of one random size, whose neighbours touch only when it is large."""
    text = (
        "size = Range(0.5, 3)\n"
        + "".join(
            f"new Object at ({x}, 0), with width size, with length size, with height size\n"
            for x in (0, 2, 4)
        )
        + "param size = size\n"
    )
    for lanes in LANES:
        sizes = [scene.params["size"] for scene in scenario(text).sample(80, seed=2, lanes=lanes)]
        assert 1.8 < max(sizes) < 2


@pytest.mark.parametrize("order", ["ab", "ba"])
@pytest.mark.parametrize("second", ["b(x)", "1 / (x - x - 0 * y) > 3 or b(x)"])
def test_of_several_faults_of_a_candidate_the_first_in_the_program_is_told(order: str, second: str) -> None:
    """Whichever is looked at first."""
    conditions = {"a": "a(x)", "b": second}
    text = "x, y = Range(0, 1), Range(0, 1)\ndef a(v):\n    raise KeyError('a')\ndef b(v):\n    raise LookupError('b')\n"
    text += "".join(f"require {conditions[name]}\n" for name in order)
    for lanes in LANES:
        with pytest.raises(Exception) as caught:  # noqa: PT011 - of several types
            scenario(text).sample(20, seed=0, lanes=lanes)
        (note,) = caught.value.__notes__
        assert "requirement on line 6 failed" in note


FAILING = """
@distributionFunction
def missing(value):
    return {}[value]
y = missing(Range(0, 1))
ego = new Object with width 3, with length 3, with height 3
new Object at (9, 9)
"""


@pytest.mark.parametrize(
    "specifiers",
    [
        "at y",
        "at (y, 0)",
        "at (5, 5), facing y",
        "at (5, 5), with width y",
        "at (5, 5), with shape y",
        "at (1, 1), with allowCollisions y",
    ],
)
def test_what_cannot_be_computed_is_no_collision(specifiers: str) -> None:
    """Its lanes hold anything; that this meets another object does not hide the fault."""
    assert isinstance(failure(f"{FAILING}new Object {specifiers}\n"), KeyError)
    others = "new Object at (20, 0)\nx = new Object at (Range(19.2, 20.8), 1.5), with height Range(1, 1.1)\n"
    assert isinstance(failure(f"{FAILING}{others}new Object {specifiers}\n"), KeyError)


def test_others_that_collide_reject_a_candidate_that_fails() -> None:
    error = failure(f"{FAILING}new Object at (Range(-1, 1), 0)\nnew Object at (y, 30)\n")
    assert isinstance(error, RejectionException)


def test_a_sum_is_rejected_where_either_part_is() -> None:
    """Also as an option: the empty range rejects the candidates that draw it."""
    text = (
        "n = DiscreteRange(0, 1)\nm = DiscreteRange(0, 1)\n"
        "x = Uniform(DiscreteRange(1, n) + DiscreteRange(1, m), 7)\nparam p = (n, m, x)\n"
    )
    found = {item.params["p"] for item in scenario(text).sample(100, seed=1)}
    assert found == {(1, 1, 2), *((n, m, 7) for n in (0, 1) for m in (0, 1))}
