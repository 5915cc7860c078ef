"""Scenes under way: each keeps its own row, whoever leaves and whoever comes."""

import numpy as np
import pytest

from scenic.graph.draws import Counter, scene_keys, seed_word
from scenic.runtime.sampling.pace import Pace
from scenic.runtime.sampling.pending import Pending, SceneTask, soft_address

CHANCES = np.array([0.1, 0.5, 0.9])


def needed(seed: int, k: int) -> list[bool]:
    """Which soft requirements need not hold in a scene, from the draws of that scene alone."""
    key = scene_keys(np.array([seed_word(seed)], dtype=np.uint64), np.array([k], dtype=np.int64))
    return [
        bool(Counter(key).uniforms(np.array([soft_address(place)], dtype=np.uint64))[0, 0] >= chance)
        for place, chance in enumerate(CHANCES.tolist())
    ]


def test_rows_stay_together() -> None:
    random = np.random.default_rng(4)
    pending = Pending(CHANCES, range(len(CHANCES)))
    tasks: list[tuple[int, int]] = []
    tried: dict[int, int] = {}
    alive: list[int] = []
    for step in range(12):
        # Of one seed, of several, of seeds of any size and sign; sometimes none.
        seeds = [7] if step % 3 else [7, -1, 2**70]
        added = [(seeds[number % len(seeds)], 5 * step + number) for number in range(step % 5)]
        alive += range(len(tasks), len(tasks) + len(added))
        tasks += added
        pending.add(added)
        pending.attempts += 1
        for number in alive:
            tried[number] = tried.get(number, 0) + 1
        finished = random.random(len(pending)) < 0.3
        pending.leave(finished)
        alive = [number for number, gone in zip(alive, finished.tolist(), strict=True) if not gone]
        assert len(pending) == len(alive)
        assert pending.number.tolist() == alive
        assert pending.attempts.tolist() == [tried[number] for number in alive]
        for row, number in enumerate(alive):
            seed, k = tasks[number]
            assert pending.task(row) == SceneTask(seed, k)
            assert pending.seed[row] == seed_word(seed)
            (key,) = scene_keys(pending.seed[row : row + 1], np.array([k], dtype=np.int64))
            assert pending.key[row] == key
            assert pending.inactive[row].tolist() == needed(seed, k)
    assert len(tasks) > 20
    assert 0 < len(alive) < len(tasks)


def test_chances_are_those_of_the_requirements() -> None:
    """Shares of scenes in which each is not needed, and independent ones."""
    pending = Pending(CHANCES, range(len(CHANCES)))
    pending.add([(3, k) for k in range(20_000)])
    shares = pending.inactive.mean(axis=0)
    assert shares == pytest.approx([0.9, 0.5, 0.1], abs=0.02)
    assert (pending.inactive[:, 0] & pending.inactive[:, 1]).mean() == pytest.approx(0.45, abs=0.02)


@pytest.mark.parametrize("more", [False, True])
@pytest.mark.parametrize("acceptance", [1.0, 0.3, 0.001, 0.0])
def test_rounds_keep_to_their_lanes(acceptance: float, more: bool) -> None:
    """Whatever was measured, a round has scenes that wait, an attempt for each at least, and no more lanes than it may."""
    for most in (1, 2, 7, 64, 4096):
        for waiting in (1, 2, 7, 63, 64, 65, 5000):
            for seconds in (1e-7, 1e-3, 50.0):
                pace = Pace(4096)
                for lanes in (1, 64, 4096):
                    pace.add(lanes, int(acceptance * lanes), seconds * (1 + lanes / 100))
                chosen = pace.choose(min(waiting, most), most, more=more)
                assert 1 <= chosen.scenes <= min(waiting, most)
                assert chosen.ahead >= 1
                assert chosen.scenes * chosen.ahead <= most


def test_rounds_take_little_time_and_grow_step_by_step() -> None:
    """A lane of a tenth of a second: two seconds are twenty lanes. A cheap one: not many times as many as were ever made."""
    slow = Pace(4096)
    for lanes in (10, 20, 40):
        slow.add(lanes, 0, lanes / 10)
    chosen = slow.choose(100, 4096, more=True)
    assert chosen.scenes * chosen.ahead <= 20
    unmeasured = Pace(4096, calls_code=True)
    chosen = unmeasured.choose(100, 4096, more=True)
    assert chosen.scenes * chosen.ahead <= 16
    cheap = Pace(1 << 20)
    for lanes in (100, 200, 400):
        cheap.add(lanes, 0, 0.01 + lanes * 1e-9)
    cheap.lanes = 1e7  # none of so many was a scene
    chosen = cheap.choose(1, 1 << 20, more=False)
    assert 400 < chosen.scenes * chosen.ahead <= 4 * 400
