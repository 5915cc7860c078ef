"""What decides how much is done at once, ahead, and first: each by its own rules, without a clock."""

import random
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
import pytest

from scenic.graph.node import Graph, Node, axis
from scenic.graph.schedule import Scheduler
from scenic.runtime.sampling.pace import Pace, Round
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.stages import Stages
from scenic.runtime.scenes.prefetching import SEED_BITS, Foreseen
from tests.graph.programs import make

# Foresight


class Finding:
    """Finds a scene for each task, which is named by its seed, a few at a time; remembers what it was asked for."""

    def __init__(self, ahead: int = 3) -> None:
        self.begun: list[tuple[int, list[int]]] = []
        self.more: list[bool] = []
        self._ahead = ahead

    def __call__(self, tasks: Iterable[SceneTask], limit: int, more: bool) -> Iterator[Any]:
        seeds: list[int] = []
        self.more.append(more)
        self.begun.append((limit, seeds))
        waiting = iter(tasks)
        while some := list(islice(waiting, self._ahead)):
            seeds += [task.seed for task in some]
            for task in some:
                if task.seed == 13:
                    raise LookupError(task.seed)
                yield task.seed


def test_the_seeds_that_python_would_draw_are_foreseen() -> None:
    random.seed(5)
    find = Finding()
    foreseen = Foreseen(find)
    drawn = [random.getrandbits(SEED_BITS) for _ in range(5)]
    random.seed(5)
    assert [foreseen.take(random.getrandbits(SEED_BITS), 10) for _ in range(5)] == drawn
    ((limit, asked),) = find.begun
    assert (limit, asked[:5]) == (10, drawn)


def test_another_seed_or_limit_begins_anew() -> None:
    random.seed(5)
    find = Finding()
    foreseen = Foreseen(find)
    first = random.getrandbits(SEED_BITS)
    assert foreseen.take(first, 10) == first
    second = random.getrandbits(SEED_BITS)
    assert foreseen.take(second, 11) == second
    random.random()
    third = random.getrandbits(SEED_BITS)
    assert foreseen.take(third, 11) == third
    assert foreseen.take(third, 11) == third, "one that was given already"
    assert [(limit, seeds[0]) for limit, seeds in find.begun] == [
        (10, first),
        (11, second),
        (11, third),
        (11, third),
    ]


def test_more_scenes_are_expected_until_a_stream_ends_with_its_first() -> None:
    find = Finding()
    foreseen = Foreseen(find)
    for scenes in (1, 1, 2, 5, 1, 1):
        random.random()
        for _ in range(scenes):
            foreseen.take(random.getrandbits(SEED_BITS), 10)
    assert find.more == [True, False, False, True, True, False]


def test_a_stream_that_failed_is_not_asked_again() -> None:
    find = Finding()
    foreseen = Foreseen(find)
    with pytest.raises(LookupError):
        foreseen.take(13, 10)
    assert foreseen.take(14, 10) == 14
    assert len(find.begun) == 2


# Rounds


def paced(lanes: int, passed: int, rounds: int = 30) -> Pace:
    """After rounds of two sizes that cost a millisecond and four microseconds a lane."""
    pace = Pace(4096)
    for number in range(rounds):
        some = lanes if number % 2 else 2 * lanes
        pace.add(some, passed * some // lanes, 1e-3 + 4e-6 * some)
    return pace


def test_what_never_passed_may_pass() -> None:
    pace = paced(100, 0)
    assert 0 < pace.acceptance < 0.01
    assert paced(100, 50).acceptance == pytest.approx(0.5, abs=0.01)
    fixed, lane = pace.cost()
    assert (fixed, lane) == pytest.approx((1e-3, 4e-6), rel=1e-3)


def test_lanes_are_never_free() -> None:
    """Even if a small round took longer than a large one, by what was made in it."""
    pace = Pace(4096)
    for lanes, seconds in ((500, 0.02), (400, 0.01), (100, 0.012)):
        pace.add(lanes, lanes // 2, seconds)
    fixed, lane = pace.cost()
    assert lane > 0.2 * 0.01 / 400
    assert fixed + 250 * lane == pytest.approx(0.011, rel=0.1)


def test_a_round_costs_least_for_what_it_finds() -> None:
    # A thousand scenes that nearly all pass: one attempt each. One scene that passes rarely: as many attempts as pay.
    assert paced(100, 99).choose(1000, 4096, more=True) == Round(1000, 1)
    rare = paced(100, 1).choose(1, 4096, more=True)
    assert rare.scenes == 1
    assert 64 <= rare.ahead <= 1024
    # More attempts at one scene than it takes find no more of it.
    for waiting in (1, 3):
        common = paced(100, 50).choose(waiting, 4096, more=True)
        assert common.scenes == waiting
        assert common.ahead <= 16


@pytest.mark.parametrize("most", [1, 7, 64, 4096])
@pytest.mark.parametrize("passed", [0, 1, 50])
@pytest.mark.parametrize("more", [False, True])
def test_no_round_has_more_lanes_than_allowed(most: int, passed: int, more: bool) -> None:
    for waiting in (1, 3, 5000):
        chosen = paced(100, passed).choose(waiting, most, more=more)
        assert 1 <= chosen.scenes <= waiting
        assert chosen.scenes * chosen.ahead <= most


@pytest.mark.parametrize(("passed", "waiting"), [(20, 5), (50, 3), (60, 400), (85, 60), (95, 1000)])
def test_the_last_rounds_take_least_time_together(passed: int, waiting: int) -> None:
    pace = paced(100, passed)
    fixed, lane = pace.cost()
    pass_chance = pace.acceptance
    generator = np.random.default_rng(0)

    def seconds(ahead: Callable[[int], int]) -> float:
        """Until the last of the scenes is found, on average."""
        total = 0.0
        for left in [waiting] * 200:
            while left:
                tried = ahead(left)
                total += fixed + lane * left * tried
                left = generator.binomial(left, (1 - pass_chance) ** tried)
        return total

    planned = seconds(lambda left: pace.choose(left, 1 << 20, more=False).ahead)
    others = [
        seconds(lambda left: pace.choose(left, 1 << 20, more=True).ahead),
        *(seconds(lambda left, tried=tried: tried) for tried in (1, 2, 3, 5, 9)),
    ]
    assert planned < 1.05 * min(others)
    assert planned < 0.8 * max(others)


# The order of checks


@dataclass(frozen=True)
class Stub:
    """A check, as far as stages look at it."""

    nodes: tuple[Node, ...]
    cost: float = 1.0
    separate: bool = False


def staged(*checks: Stub) -> Stages:
    graph = Graph([node for check in checks for node in check.nodes])
    return Stages(checks, (), Scheduler(graph))  # type: ignore[arg-type] # all that it looks at


def orders(stages: Stages, lanes: int = 64) -> list[tuple[int, ...]]:
    return [stage.checks for stage in stages.order(lanes)[:-1]]


def node(address: int) -> Node:
    return make("add", axis(None, address), 1.0)


def test_what_is_cheap_and_rejects_comes_first_as_soon_as_it_is_known() -> None:
    stages = staged(*(Stub((node(number),)) for number in range(3)))
    assert orders(stages) == [(0, 1, 2)]
    for _ in range(3):
        stages.measure(0, 1000, 1e-3, 999)
        stages.measure(1, 1000, 1e-3, 500)
        stages.measure(2, 1000, 1e-4, 500)
    assert [order for (order,) in (orders(stages) for _ in range(3))][-1] == (2, 1, 0)


def test_old_measurements_of_what_passed_fade_as_fast_as_those_of_what_came() -> None:
    """Or a check that rejects half of what comes would soon seem to reject nothing."""
    stages = staged(*(Stub((node(number),)) for number in range(2)))
    for _ in range(60):
        stages.measure(0, 1000, 1e-3, 990)
        stages.measure(1, 1000, 2e-3, 500)
    assert [order for (order,) in (orders(stages) for _ in range(8))][-1] == (1, 0)


def test_a_check_that_is_dear_stands_alone() -> None:
    stages = staged(Stub((node(1),)), Stub((node(2),), cost=2.0, separate=True), Stub((node(3),), cost=3.0))
    assert orders(stages) == [(0,), (1,), (2,)]


def test_checks_share_a_stage_while_their_columns_are_small() -> None:
    first, second = (tuple(node(100 * part + number) for number in range(50)) for part in (1, 2))
    stages = staged(Stub(first), Stub(second, cost=2.0))
    assert orders(stages, 15) == [(0, 1)]
    assert orders(stages, 4000) == [(0,), (1,)]
    same = staged(Stub(first), Stub(first, cost=2.0))
    assert orders(same, 4000) == [(0, 1)], "what is there already costs nothing"
