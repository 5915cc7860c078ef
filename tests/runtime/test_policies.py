"""What decides how much is done at once, ahead, and first: each by its own rules, without a clock."""

import random
from dataclasses import dataclass
from typing import Any

import pytest

from scenic.graph.node import Graph, Node, axis
from scenic.graph.schedule import Scheduler
from scenic.runtime.sampling.foresight import SEED_BITS, Foreseen
from scenic.runtime.sampling.pace import Pace
from scenic.runtime.sampling.stages import Stages
from tests.graph.programs import make

# Foresight


@dataclass(frozen=True)
class Foretold:
    """A scene, of which foresight knows the seed."""

    seed: int


def look_ahead(foreseen: Foreseen, *, seconds: float = 0.01, limit: int = 10) -> list[int]:
    seeds = foreseen.seeds()
    foreseen.keep([Foretold(seed) for seed in seeds], limit, seconds)  # type: ignore[misc] # all that it looks at
    return seeds


def test_the_seeds_that_python_would_draw_are_foreseen() -> None:
    random.seed(5)
    foreseen = Foreseen()
    (seed,) = look_ahead(foreseen)
    assert random.getrandbits(SEED_BITS) == seed
    foreseen._used = True
    seeds = look_ahead(foreseen)
    assert [random.getrandbits(SEED_BITS) for _ in range(3)] == seeds


def test_what_is_used_doubles_what_is_foreseen_and_a_miss_begins_anew() -> None:
    foreseen = Foreseen()
    counts = []
    for _ in range(11):
        seeds = look_ahead(foreseen)
        counts.append(len(seeds))
        foreseen._used = True
    assert counts == [1, 3, 7, 15, 31, 63, 127, 255, 256, 256, 256]
    foreseen._used = False
    assert look_ahead(foreseen) == []
    assert len(look_ahead(foreseen)) == 1


def test_slow_scenes_are_foreseen_less() -> None:
    foreseen = Foreseen()
    for _ in range(4):
        look_ahead(foreseen)
        foreseen._used = True
    look_ahead(foreseen, seconds=1.0)
    foreseen._used = True
    assert len(look_ahead(foreseen)) == 15


def test_a_foreseen_scene_is_given_once_and_for_its_limit_alone() -> None:
    foreseen = Foreseen()
    scenes: Any = [Foretold(1), Foretold(2)]
    foreseen.keep(scenes, 10, 0.01)
    assert foreseen.take(1, 10) is scenes[0]
    assert foreseen.take(1, 10) is None
    assert foreseen.take(2, 11) is None
    assert foreseen.take(2, 10) is None, "it was thrown away"


# Rounds


def paced(lanes: int, passed: int, rounds: int = 30) -> Pace:
    """After rounds of two sizes that cost a millisecond and a microsecond a lane."""
    pace = Pace(4096)
    for number in range(rounds):
        some = lanes if number % 2 else 2 * lanes
        pace.add(some, passed * some // lanes, 1e-3 + 1e-6 * some)
    return pace


def test_what_never_passed_may_pass() -> None:
    pace = paced(100, 0)
    assert 0 < pace.acceptance < 0.01
    assert paced(100, 50).acceptance == pytest.approx(0.5, abs=0.01)
    fixed, lane = pace.cost()
    assert (fixed, lane) == pytest.approx((1e-3, 1e-6), rel=1e-3)


def test_a_round_costs_least_for_what_it_finds() -> None:
    # A thousand scenes that nearly all pass: one attempt each. One scene that passes rarely: as many attempts as pay.
    assert (paced(100, 99).choose(1000, 4096).ahead, paced(100, 99).choose(1000, 4096).scenes) == (1, 1000)
    rare = paced(100, 1).choose(1, 4096)
    assert rare.scenes == 1
    assert 64 <= rare.ahead <= 1024


@pytest.mark.parametrize("most", [1, 7, 64, 4096])
@pytest.mark.parametrize("passed", [0, 1, 50])
def test_no_round_has_more_lanes_than_allowed(most: int, passed: int) -> None:
    for waiting in (1, 3, 5000):
        chosen = paced(100, passed).choose(waiting, most)
        assert 1 <= chosen.scenes <= waiting
        assert chosen.scenes * chosen.ahead <= most


# The order of checks


@dataclass(frozen=True)
class Stub:
    """A check, as far as stages look at it."""

    nodes: tuple[Node, ...]
    cost: float = 1.0
    separate: bool = False


def staged(*checks: Stub) -> Stages:
    graph = Graph([node for check in checks for node in check.nodes])
    return Stages(checks, Scheduler(graph))  # type: ignore[arg-type] # all that it looks at


def orders(stages: Stages, lanes: int = 64) -> list[tuple[int, ...]]:
    return [stage.checks for stage in stages.order(lanes)]


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
