"""The engine: which scenes come out, whatever the batch; limits and reports; that pruning keeps the law."""

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from scenic.graph.domain import Domain
from scenic.graph.kinds import Kind
from scenic.graph.operation import FAULT, OK, REJECTED
from scenic.language.errors import RejectionException, SamplingError
from scenic.runtime.sampling.checks import NodeCheck
from scenic.runtime.sampling.engine import BATCH_BYTES, BODY_BYTES, DEFAULT_LANES, Engine
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.sampler import DEFAULT_ATTEMPTS
from tests.amounts import LONG
from tests.graph.programs import evaluate, faulty
from tests.runtime.programs import FALSE_ALARM, fingerprint, scenario, unpruned

PROGRAMS = {
    "no randomness": "ego = new Object\nnew Object at (5, 5)\n",
    "only parameters": "param x = Range(0, 1), y = Uniform('a', Normal(0, 1)), z = DiscreteRange(1, 10 ** 6)\n",
    "collisions": "for i in range(6):\n    new Object at (Range(-3, 3), Range(-3, 3), 0), facing Range(0, 7)\n",
    "spheres and a workspace": (
        "workspace = Workspace(CircularRegion((0, 0), 4))\nego = new Object with shape SpheroidShape()\n"
        "for i in range(3):\n    new Object in workspace, with shape Uniform(ConeShape(), BoxShape()), facing directly toward ego\n"
    ),
    "opaque requirements": (
        "import random\nx = Range(0, 1)\ndef f(v): return v < random.random()\nrequire f(x)\nrequire[0.5] f(x) or False\n"
        "param x = x\n"
    ),
    "soft and rare": "x, y = Range(0, 1), Normal(0, 1)\nrequire[0.7] y > 2\nrequire x < 0.05\nparam x = x, y = y\n",
    "faults that others reject": (
        "n, x = DiscreteRange(0, 3), Range(0, 1)\ndef positive(v): return v > 0\ndef low(a, b): return a * b < 0.2\n"
        "require positive(n)\nrequire low(1 / n, x)\nrequire low(x, 1 / n)\nparam n = n, x = x\n"
    ),
    "lifted": (
        "import numpy\n@distributionFunction\ndef f(x): return (x, float(numpy.random.rand()))\n"
        "param x = f(DiscreteRange(0, 9)), y = hypot(Range(0, 1), Range(0, 1)) ** 3 % 0.1\n"
    ),
    "standing on things": (
        "floor = new Object with width 9, with length 9, with height 1\nbox = new Object on floor, facing Range(0, 7)\n"
        "new Object on box, with width 0.5, with length 0.25, with height Range(0.1, 1), with allowCollisions True\n"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_scenes_do_not_depend_on_the_batch(name: str) -> None:
    text = PROGRAMS[name]
    expected = [fingerprint(scene) for scene in scenario(text).sample(12, seed=5, lanes=1)]
    for lanes in (2, 7, 512, 4096) if LONG else (7, 4096):
        program = scenario(text)
        assert [fingerprint(scene) for scene in program.sample(12, seed=5, lanes=lanes)] == expected
        # The same again from the same scenario, and a later part alone.
        assert [fingerprint(scene) for scene in program.sample(12, seed=5, lanes=lanes)] == expected
        assert [fingerprint(scene) for scene in program.stream(4, first=6, seed=5, lanes=lanes)] == expected[
            6:10
        ]


@pytest.mark.parametrize("name", [name for name in PROGRAMS if name != "no randomness"])
def test_seeds_and_numbers_give_different_scenes(name: str) -> None:
    program = scenario(PROGRAMS[name])
    scenes = [*program.sample(4, seed=1), *program.sample(4, seed=2), *program.sample(4, seed=-3), *program.sample(4, seed=2**70)]  # fmt: skip
    # Seeds are any integers: those that agree in 64 bits are different ones.
    scenes += [*program.sample(2, seed=2**64 + 1), *program.sample(2, seed=2**64 - 3)]
    assert len({fingerprint(scene)[2:] for scene in scenes}) == len(scenes)


def test_attempts_are_counted() -> None:
    scenes = scenario("x = Range(0, 1)\nrequire (lambda: x)() < 0.2\n").sample(500, seed=0)
    attempts = [scene.attempts for scene in scenes]
    assert min(attempts) == 1
    observed = [sum(a == n for a in attempts) for n in range(1, 8)]
    observed.append(500 - sum(observed))
    expected = [500 * 0.2 * 0.8 ** (n - 1) for n in range(1, 8)]
    expected.append(500 - sum(expected))
    assert stats.chisquare(observed, expected).pvalue > FALSE_ALARM


# Pruning keeps the law

PRUNED = {
    "interval": "x = Range(0, 10)\nrequire x > 7\nparam v = (x,)\n",
    "two axes": "x, y = Range(0, 1), Range(0, 1)\nrequire x + y > 1.5\nparam v = (x, y)\n",
    "a normal": "x = Normal(0, 1)\nrequire x > 1\nrequire x < 1.5\nparam v = (x,)\n",
    "discrete": "n = DiscreteRange(0, 9)\nx = Range(0, n)\nrequire n >= 6\nrequire x < 3\nparam v = (n, x)\n",
    "random parameters": "a = Range(0, 4)\nx = Range(a, a + 2)\nrequire x > 4\nparam v = (a, x)\n",
    "a choice": "x = Uniform(Range(0, 1), Range(5, 6), 3)\nrequire x > 2\nparam v = (x,)\n",
    "positions": (
        "ego = new Object\na = new Object at (Range(-20, 20), Range(-20, 20)), facing Range(-3, 3)\n"
        "require (distance to a) < 4\nrequire a.x > 1\nparam v = (a.x, a.y, a.heading)\n"
    ),
    "soft": "x = Range(0, 1)\nrequire[0.5] x > 0.9\nrequire x > 0.3\nparam v = (x,)\n",
    "a circle": (
        "p = new Point in CircularRegion((0, 0), 10)\nrequire p.x > 6\nrequire (angle from (0, 0) to p) < -1\nparam v = (p.x, p.y)\n"
    ),
}  # fmt: skip


def values(program: Any, seed: int) -> np.ndarray[Any, Any]:
    return np.array([scene.params["v"] for scene in program.sample(600, seed=seed)], dtype=float)


@pytest.mark.parametrize("name", list(PRUNED))
def test_pruning_keeps_the_law(name: str) -> None:
    pruned, whole = scenario(PRUNED[name]), scenario(PRUNED[name])
    whole = whole.within(Domain.whole(whole.outline.graph.dimension))
    found, expected = values(pruned, 1), values(whole, 2)
    for column in range(found.shape[1]):
        assert stats.ks_2samp(found[:, column], expected[:, column]).pvalue > FALSE_ALARM
    if found.shape[1] > 1:
        # The dependence too, by a projection that mixes the coordinates.
        mix = np.array([1, 0.7, -0.4])[: found.shape[1]]
        assert stats.ks_2samp(found @ mix, expected @ mix).pvalue > FALSE_ALARM
    # Most of the whole is rejected, less of what is left.
    tried = [sum(scene.attempts for scene in program.sample(200, seed=3)) for program in (pruned, whole)]
    assert tried[0] <= tried[1]


def test_every_scene_of_the_whole_lies_in_the_pruned_part() -> None:
    for text in PRUNED.values():
        pruned, whole = scenario(text), unpruned(text)
        low, high = values(pruned, 1).min(axis=0), values(pruned, 1).max(axis=0)
        spread = high - low
        found = values(whole, 2)
        assert np.all(found >= low - 0.2 * spread)
        assert np.all(found <= high + 0.2 * spread)


# Limits and reports


def rows(exhausted: Exhausted) -> dict[str, tuple[float, float]]:
    return {row.label: (row.rejected, row.alone) for row in exhausted.report.rows}


def test_the_report_of_a_program_computed_by_hand() -> None:
    # Of 8 equally likely candidates, (a, b, c) bits: A wants a = 1, B wants b = 1, C wants a = c; never all with n > 9.
    text = (
        "a, b, c = DiscreteRange(0, 1), DiscreteRange(0, 1), DiscreteRange(0, 1)\nn = DiscreteRange(0, 9)\n"
        "def same(v): return v\nrequire same(a == 1) as A\nrequire same(b == 1) as B\nrequire same(a == c) as C\n"
        "require same(n > 9) as D\n"
    )
    (result,) = unpruned(text).stream(1, seed=0, max_attempts=1000)
    assert isinstance(result, Exhausted)
    assert (result.reason, result.attempts, result.k, result.report.candidates) == ("attempts", 1000, 0, 1000)
    found = rows(result)
    for label, rejected, alone in [("A", 0.5, 0), ("B", 0.5, 0), ("C", 0.5, 0), ("D", 1, 1 / 8)]:
        for fraction, expected in zip(found[label], (rejected, alone), strict=True):
            assert (
                fraction == expected
                or stats.binomtest(round(1000 * fraction), 1000, expected).pvalue > FALSE_ALARM
            )
    assert [row.label for row in result.report.culprits()] == ["D"]
    # In words: what rejects most comes first.
    head, *lines = str(result.report).splitlines()
    assert head.split() == ["of", "1000", "candidates:", "rejected", "alone"]
    assert lines[0].split() == ["100.0%", f"{found['D'][1]:.1%}", "D", "(line", "7)"]
    told = {line.split()[2]: tuple(line.split()[:2]) for line in lines}
    assert told == {label: tuple(f"{part:.1%}" for part in parts) for label, parts in found.items()}
    assert [row[0] for row in told.values()] == sorted(
        (row[0] for row in told.values()), key=lambda each: -float(each[:-1])
    )


def test_collisions_are_reported_pair_by_pair_at_the_later_object() -> None:
    text = "new Object\nnew Object at (9, 9)\nnew Object at (Range(-0.2, 0.2), 0)\nnew Object at (Range(9.5, 10.5), 9)\n"
    (result,) = scenario(text).stream(1, seed=1, max_attempts=400)
    assert isinstance(result, Exhausted)
    always, half = result.report.rows
    found = [(row.label, row.span.line if row.span else 0) for row in (always, half)]
    assert found == [
        ("collision of Object (line 1) and Object (line 3)", 3),
        ("collision of Object (line 2) and Object (line 4)", 4),
    ]
    assert (always.rejected, half.alone) == (1, 0)
    assert 0.3 < half.rejected < 0.7
    assert always.alone == pytest.approx(1 - half.rejected)


def test_alone_means_that_nothing_else_rejects() -> None:
    # Each of the two rejects half; together, independent: each alone rejects a quarter. The third never holds in
    # what is left of the first two.
    text = (
        "x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)\ndef same(v): return v\n"
        "require same(x < 0.5) as A\nrequire same(y < 0.5) as B\nrequire same(z < 0.001) as C\n"
    )
    results = [
        item for item in scenario(text).stream(20, seed=3, max_attempts=400) if isinstance(item, Exhausted)
    ]
    assert results
    counts = np.zeros((3, 2))
    for item in results:
        found = rows(item)
        counts += [[part * 400 for part in found[label]] for label in "ABC"]
    tried = 400 * len(results)
    for (rejected, alone), (p, q) in zip(
        counts, [(0.5, 0.25 * 0.001), (0.5, 0.25 * 0.001), (0.999, 0.25)], strict=True
    ):
        assert stats.binomtest(round(rejected), tried, p).pvalue > FALSE_ALARM
        assert stats.binomtest(round(alone), tried, q).pvalue > FALSE_ALARM


def test_candidates_in_which_a_requirement_fails_count_as_rejected() -> None:
    """``1 / x`` fails in the very candidates that ``x == 1`` rejects: both say the same, and neither rejects alone."""
    text = (
        "x, y = DiscreteRange(0, 1), Range(0, 1)\ndef same(v): return v\n"
        "require 1 / x > 0.5 as A\nrequire same(x == 1) as B\nrequire same(y > 2) as C\n"
    )
    program = scenario(text)
    program = program.within(Domain.whole(program.outline.graph.dimension))
    (result,) = program.stream(1, seed=2, max_attempts=300)
    assert isinstance(result, Exhausted)
    found = rows(result)
    assert found["A"] == found["B"]
    assert 0.3 < found["A"][0] < 0.7
    assert found["C"] == pytest.approx((1, 1 - found["A"][0]))


def test_a_soft_requirement_that_fails_does_so_where_it_has_to_hold() -> None:
    text = "x = Range(0, 1)\ndef bad(v): raise KeyError(v)\nrequire[0.5] bad(x)\nego = new Object\n"
    program, outcomes = scenario(text), []
    for number in range(16):
        try:
            (found,) = program.stream(1, first=number, seed=3)
            outcomes.append(found.enforces(found.program.requirements[0]))
        except KeyError:
            outcomes.append(None)
    assert set(outcomes) == {None, False}


def test_soft_requirements_keep_their_own_chances() -> None:
    """Over scenes of which few are found at once: each holds always where it has to, and else as often as it may."""
    text = (
        "x, y, z = Range(0, 1), Range(0, 1), Range(0, 1)\ndef same(v): return v\nrequire same(z < 0.2)\n"
        "require[0.9] same(x < 0.5)\nrequire[0.2] same(y < 0.5)\nparam x = x, y = y\n"
    )
    scenes = scenario(text).sample(1500, seed=6, lanes=64)
    for name, chance in (("x", 0.9), ("y", 0.2)):
        held = sum(scene.params[name] < 0.5 for scene in scenes)
        assert stats.binomtest(held, len(scenes), (1 + chance) / 2).pvalue > FALSE_ALARM


@pytest.mark.parametrize("lanes", [1, 64, 4096])
def test_a_limit_of_attempts_is_exact(lanes: int) -> None:
    text = "x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0.1)\n"
    free = scenario(text).sample(60, seed=1, lanes=lanes)
    limited = list(scenario(text).stream(60, seed=1, max_attempts=10, lanes=lanes))
    for scene, found in zip(free, limited, strict=True):
        if scene.attempts <= 10:
            assert fingerprint(found) == fingerprint(scene)
        else:
            assert isinstance(found, Exhausted)
            assert (found.k, found.attempts) == (scene.k, 10)


def test_a_limit_of_time() -> None:
    text = "x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 1e-9) as rare\n"
    results = list(scenario(text).stream(3, seed=0, max_attempts=10**9, time_limit=0.2))
    assert [(item.reason, item.k) for item in results if isinstance(item, Exhausted)] == [("time", 0), ("time", 1), ("time", 2)]  # fmt: skip
    assert "rare" in str(results[0].report)


def test_what_is_proven_impossible_is_not_sampled() -> None:
    results = list(scenario("x = Range(0, 1)\nrequire x > 2 as far\n").stream(2, seed=0))
    assert [(item.reason, item.attempts) for item in results if isinstance(item, Exhausted)] == [
        ("impossible", 0)
    ] * 2
    later = scenario("x = Range(0, 1)\nrequire x > 2 as far\n").stream(2, seed=7, first=5)
    assert [(item.seed, item.k) for item in later if isinstance(item, Exhausted)] == [(7, 5), (7, 6)]
    with pytest.raises(RejectionException, match="no scene exists: the requirements cannot hold together"):
        scenario("x = Range(0, 1)\nrequire x > 2 as far\n").sample(1)
    program = scenario("x = Range(0, 1)\nrequire x > 2 as far\n")
    for _ in range(2):  # with seeds of Python's, too, and again
        with pytest.raises(
            RejectionException, match="no scene exists: the requirements cannot hold together"
        ):
            program.generate()


def test_a_program_without_randomness_is_tried_once() -> None:
    (result,) = scenario("x = 3\nrequire x > 4 as never\n").stream(1, seed=0)
    assert isinstance(result, Exhausted)
    assert result.attempts == 0
    # The program's own functions might draw random numbers, so that more attempts are worth something.
    (result,) = scenario("def f(): return 1 > 2\nrequire f() as never\n").stream(1, seed=0)
    assert isinstance(result, Exhausted)
    assert result.attempts == 1000


def test_more_attempts_than_usual_are_made_where_they_are_wanted() -> None:
    """What is so rare is looked for no shorter than asked, and no longer."""
    program = scenario("x = Range(0, 1)\nrequire (x * 1e6) % 1 < 1e-12 as rare\n")
    most = DEFAULT_ATTEMPTS + 7
    (result,) = program.stream(1, seed=0, max_attempts=most)
    assert isinstance(result, Exhausted)
    assert (result.reason, result.attempts) == ("attempts", most)


def test_functions_may_be_the_only_random_thing() -> None:
    text = "import random\ndef f(): return random.random()\nrequire f() < 0.2 as rare\n"
    attempts = [scene.attempts for scene in scenario(text).sample(200, seed=0)]
    assert 700 < sum(attempts) < 1400


# The established functions


def test_generate_follows_the_seed_of_random() -> None:
    program = scenario(PROGRAMS["collisions"])

    def generated(seed: int) -> Sequence[Any]:
        random.seed(seed)
        return [fingerprint(program.generate()[0]) for _ in range(3)]

    first = generated(1)
    assert first == generated(1)
    assert first != generated(2)
    assert len(set(first)) == 3


def test_generate_counts_and_gives_up() -> None:
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0.1) as small\n")
    scene, iterations = program.generate(seed=4)
    assert iterations == scene.attempts
    impossible = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0) as never\n")
    with pytest.raises(RejectionException, match=r"within 50 candidates\nnever rejected every candidate"):
        impossible.generate(maxIterations=50)


def test_time_is_a_limit_only_when_it_is_up() -> None:
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0.5)\n")
    assert all(hasattr(scene, "objects") for scene in program.stream(3, seed=1, time_limit=600))
    late = list(program.stream(3, seed=1, time_limit=1e-9))
    assert [(item.k, item.reason) for item in late] == [(0, "time"), (1, "time"), (2, "time")]


def test_it_is_told_why_no_scene_was_found() -> None:
    """By the limit that was met, and every requirement that no candidate meets."""
    program = scenario(
        "x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0) as low\nrequire same(x < 2) as fine\nrequire same(x > 1) as high\n"
    )
    culprits = "\nlow rejected every candidate\nhigh rejected every candidate\nof {} candidates:"
    for options, head, looked in (
        ({"max_attempts": 7}, "no scene was found within 7 candidates", 7),
        ({"time_limit": 1e-9}, "no scene was found in the time given (0 candidates)", 1),
    ):
        with pytest.raises(RejectionException) as caught:
            program.sample(3, seed=1, **options)  # type: ignore[arg-type] # of several types
        assert str(caught.value).startswith(head + culprits.format(looked))


@pytest.mark.parametrize("attempts", [3, 1100])
def test_a_report_is_made_of_as_many_candidates_as_were_tried(attempts: int) -> None:
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0)\n")
    (given_up,) = program.stream(1, seed=1, max_attempts=attempts)
    assert given_up.attempts == attempts
    assert given_up.report.candidates == min(attempts, 1000)


def test_the_limit_of_one_scene_holds_with_and_without_a_seed() -> None:
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0.3)\n")
    for seed in range(12):
        scene, tried = program.generate(seed=seed)
        assert program.generate(maxIterations=tried, seed=seed)[0].attempts == scene.attempts == tried
        if tried > 1:
            with pytest.raises(RejectionException, match=f"within {tried - 1} candidate"):
                program.generate(maxIterations=tried - 1, seed=seed)


def test_a_batch_tries_no_more_than_its_limit() -> None:
    """Also where one scene is not found at all."""
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0)\n")
    for limit in (1, 50):
        with pytest.raises(RejectionException, match=f"within {limit} candidate"):
            program.generateBatch(3, maxIterations=limit)


def test_generate_batch() -> None:
    program = scenario("x = Range(0, 1)\ndef same(v): return v\nrequire same(x < 0.3)\n")
    random.seed(0)
    scenes, iterations = program.generateBatch(20)
    assert len(scenes) == 20
    assert iterations == sum(scene.attempts for scene in scenes) > 20
    random.seed(0)
    assert program.generateBatch(20, maxIterations=iterations)[1] == iterations
    random.seed(0)
    with pytest.raises(RejectionException):
        program.generateBatch(20, maxIterations=iterations - 1)


NEVER = "def never(v): return v > 1\n"


@pytest.mark.parametrize(
    ("text", "ask", "tried"),
    [
        ("x = Range(0, 1)\nrequire never(x)\n", lambda program: program.generate(), 2000),
        ("x = Range(0, 1)\nrequire never(x)\n", lambda program: program.generate(7), 7),
        ("x = Range(0, 1)\nrequire never(x)\n", lambda program: program.generate(seed=3), 2000),
        ("x = Range(0, 1)\nrequire never(x)\n", lambda program: program.generateBatch(2, 30), 30),
        ("x = Range(0, 1)\nrequire never(x)\n", lambda program: program.sample(2, max_attempts=30), 30),
        ("x = Range(0, 1)\nrequire never(x)\n", lambda program: program.sample(), 100_000),
        ("import random\nrequire never(random.random())\n", lambda program: program.sample(), 1000),
        (
            "import random\nrequire never(random.random())\n",
            lambda program: program.sample(max_attempts=9),
            9,
        ),
        ("def f(): return False\nrequire f()\n", lambda program: program.generate(), 1000),
        ("def f(): return False\nrequire f()\n", lambda program: program.generateBatch(1), 1000),
    ],
)
def test_how_long_a_scene_is_looked_for(text: str, ask: Callable[[Any], Any], tried: int) -> None:
    with pytest.raises(RejectionException, match=f"within {tried} candidates"):
        ask(scenario(NEVER + text))


def test_what_is_restricted_is_so_at_once() -> None:
    """Scenes that were foreseen are of the whole cube."""
    program = scenario("param x = Range(0, 1)\n")
    random.seed(1)
    for _ in range(20):
        program.generate()
    program = program.within(Domain(np.array([[0.25]]), np.array([[0.5]])))
    assert all(0.25 <= program.generate()[0].params["x"] <= 0.5 for _ in range(20))


def test_sampling_leaves_the_generators_alone() -> None:
    program = scenario(PROGRAMS["opaque requirements"])
    random.seed(7)
    np.random.seed(7)  # noqa: NPY002 - what programs use
    before = random.getstate(), np.random.get_state()[1].tolist()  # noqa: NPY002
    program.sample(5, seed=0)
    after = random.getstate(), np.random.get_state()[1].tolist()  # noqa: NPY002
    assert after == before


def test_no_scenes() -> None:
    assert scenario("ego = new Object").sample(0, seed=0) == []


def test_every_attempt_has_draws_of_its_own() -> None:
    """However many there are: past the size of a batch and past 16 bits."""
    seen: list[float] = []
    SEEN.append(seen.append)
    program = scenario(
        f"from {__name__} import SEEN\ndef note(v):\n    SEEN[-1](v)\n    return False\nx = Range(0, 1)\nrequire note(x)\n"
    )
    with pytest.raises(RejectionException):
        program.sample(1, seed=4, max_attempts=70_000)
    # Reports try some of them again.
    assert len(set(seen)) == 70_000


SEEN: list[Any] = []


def test_the_first_error_of_the_program_is_told() -> None:
    """Also where few candidates come so far that two checks of the program fail."""
    text = (
        "def first(v): raise ValueError('first')\ndef second(v): raise KeyError('second')\nx = Range(0, 1)\n"
        "def same(v): return v\nrequire same(x) > 0.95\nrequire first(x)\nrequire second(x)\n"
    )
    for seed in range(30):
        program = scenario(text)
        for check in program._sampler.engine.plan.checks:
            check.separate = seed % 2 == 0  # each looks at those alone that the ones before leave
        with pytest.raises(ValueError, match="first"):
            program.sample(1, seed=seed)


@pytest.mark.parametrize("reverse", [False, True])
def test_of_values_that_fail_together_the_first_is_told(reverse: bool) -> None:
    """Whichever of them the engine looks at first, by what they have cost."""
    program = scenario(
        "@distributionFunction\ndef first(v): raise KeyError(v)\n@distributionFunction\ndef second(v): raise ValueError(v)\n"
        "x = Range(0, 1)\nparam a = first(x), b = second(x)\n"
    )
    for number, check in enumerate(program._sampler.engine.plan.checks):
        check.cost = 1000.0 - number if reverse else number
    with pytest.raises(KeyError):
        program.sample(1, seed=1)


def test_reports_do_not_depend_on_how_many_lanes_there_are() -> None:
    program = scenario(
        "x = Range(0, 1)\ny = Range(0, 1)\ndef same(v): return v\nrequire same(x) > 2\nrequire same(y) > 0.5\n"
    )
    engine = program._sampler.engine
    report = engine.report(SceneTask(3, 0), 500)
    first, second = (row.rejected for row in report.rows)
    assert first == 1
    assert 0.4 < second < 0.6
    engine._pace.most = 64
    assert engine.report(SceneTask(3, 0), 500) == report


def test_reports_are_of_the_candidates_that_were_tried() -> None:
    """Of that scene of that seed, from its first attempt on, and once for each check."""
    seen: list[float] = []
    SEEN.append(seen.append)
    engine = scenario(
        f"from {__name__} import SEEN\ndef note(v):\n    SEEN[-1](v)\n    return False\nx = Range(0, 1)\nrequire note(x)\n"
    )._sampler.engine
    for seed, k in ((0, 0), (3, 0), (0, 4), (3, 4), (-1, 7), (2**70, 1)):
        seen.clear()
        (given_up,) = engine.scenes([(seed, k)], max_attempts=40, lanes=7)
        assert isinstance(given_up, Exhausted)
        assert (given_up.seed, given_up.k, given_up.attempts) == (seed, k, 40)
        tried, reported = seen[:40], seen[40:]
        assert len(set(tried)) == 40
        assert reported == tried
        seen.clear()
        engine.report(SceneTask(seed, k), 12)
        assert seen == tried[:12]


def test_lanes_are_bounded_by_their_memory() -> None:
    def most(objects: int) -> int:
        plan = replace(scenario("x = Range(0, 1)\n")._sampler.engine.plan, bodies=objects)
        return Engine(plan)._pace.most

    assert most(1) == DEFAULT_LANES
    assert most(1000) == pytest.approx(BATCH_BYTES / (1000 * BODY_BYTES), rel=0.01)
    assert most(10**7) == 64


@pytest.mark.parametrize("holds", [True, False])
def test_a_rejected_or_failed_value_meets_no_requirement(holds: bool) -> None:
    statuses = [OK, FAULT, REJECTED, OK]
    node = faulty(Kind.BOOLEAN, [holds] * 4, statuses, ValueError())
    verdict = NodeCheck(node, "", None, 0).test(evaluate(node, 4))
    failed = np.zeros(4, dtype=bool) if verdict.failed is None else verdict.failed
    assert failed.tolist() == [False, True, False, False]
    assert (verdict.holds & ~failed).tolist() == [holds, False, False, holds]


def test_objects_of_a_scene_are_its_own_whether_anything_in_them_is_random() -> None:
    """Also those that are the same in all scenes of a batch, and in later ones."""
    program = scenario(
        "x = Range(0, 1)\nclass Post:\n    def read(self): return x\n"
        "ego = new Object at (x, 0)\nnew Post at (9, 9), with marks [1]\n"
        "new Object at (Range(20, 30), 9), with marks [1]\n"
    )
    scenes = program.sample(6, seed=0)
    for item in scenes[0].objects[1:]:
        item.marks.append(2)
        item.kind = "changed"
    for later in (*scenes[1:], *program.sample(6, seed=0)):
        for item in later.objects[1:]:
            assert item.marks == [1]
            assert not hasattr(item, "kind")
    assert [item.marks for item in scenes[0].objects[1:]] == [[1, 2], [1, 2]]
    assert len({id(item) for scene in scenes for item in scene.objects}) == 18
    assert [scene.objects[1].read() for scene in scenes] == [scene.egoObject.x for scene in scenes]


def test_scenes_that_were_found_ahead_know_which_soft_requirements_they_had_to_meet() -> None:
    """`generate` finds scenes of several seeds in one round."""
    program = scenario("ego = new Object at (Range(0, 1), 0)\nrequire[0.5] ego.x > 0.5\n")
    random.seed(4)
    found = [program.generate()[0] for _ in range(40)]
    told = [(scene.enforces(scene.program.requirements[0]), scene.egoObject.x > 0.5) for scene in found]
    assert set(told) == {(True, True), (False, True), (False, False)}
    for scene, (enforced, _) in zip(found, told, strict=True):
        (alone,) = program.sample(1, seed=scene.seed)
        assert alone.enforces(program.requirements[0]) is enforced


def test_values_of_a_scene_are_the_same_objects_each_time() -> None:
    text = "x = [Range(0, 1)]\nego = new Object with tag x, with other Uniform([1], [2])\nparam x = x\n"
    for found in scenario(text).sample(3, seed=1):
        assert found.params["x"] is found.params["x"] is found.egoObject.tag
        assert found.egoObject.other is found.egoObject.other
        found.egoObject.tag.append(7)
        assert found.params["x"][1:] == [7]


@pytest.mark.parametrize(
    ("rest", "cause"),
    [
        ("def bad(v):\n    raise KeyError(v)\nrequire bad(x)\n", KeyError),
        (
            "def bad(v):\n    try:\n        [][3]\n    except IndexError as error:\n        raise KeyError(v) from error\nrequire bad(x)\n",
            IndexError,
        ),
        ("param y = 1 / (x * 0)\n", ZeroDivisionError),
        ("require {1: 2}[x]\n", KeyError),
    ],
)
def test_causes_of_exceptions_end(rest: str, cause: type[Exception]) -> None:
    with pytest.raises((KeyError, ZeroDivisionError, SamplingError)) as caught:
        scenario(f"ego = new Object\nx = Range(0, 1)\n{rest}").sample(1, seed=1)
    chain: list[BaseException] = []
    error: BaseException | None = caught.value
    while error is not None:
        assert not any(error is other for other in chain)
        chain.append(error)
        error = error.__cause__
    assert isinstance(chain[-1], cause)
