"""Approximate scenes of groups that only meet (`scenic.runtime.sampling.apart`), for crowds too dense to be put together by halves.

The law of a scene is the product of the groups' own laws, conditioned on no collision. A scene begins empty. Group after group is drawn
from its own law until it fits; after some of them, and at the end several times, each group in turn is drawn again, and stays
where it was if the new place collides. Such moves (Metropolis and Hastings, with proposals that do not depend on the present place)
keep the law, so that the chain comes as close to it as one likes.

Each scene is a chain of its own, whose draws are the accepted attempts at its groups, in order: scenes are independent of each other, and
depend on seed and number alone.

Two chains with the same proposals, which differ in one group, differ after a sweep in fewer than ``2 c`` groups on average, where a
group collides with ``c`` others on average (path coupling: R. Bubley and M. Dyer, 1997). So many sweeps are made that less than
`_REMAINING` of that is left of a scene in which all groups differ; for dense crowds, where ``2 c`` says nothing, as if it were `_SLOWEST`.
"""

import math
import time
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.runtime.sampling.apart import Apart
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.group_candidates import LEAVES, GroupCandidates
from scenic.runtime.sampling.joining import Joined
from scenic.runtime.sampling.rejection_report import Approximation

__all__ = ["is_loose", "settle"]

Indices = NDArray[np.intp]
Masks = NDArray[np.bool_]

_DENSEST: Final = 1.5
"""Collisions of a group with others, on average, from which on moves are hardly ever accepted."""

_STAGES: Final = 8
"""Parts of a crowd that are put into a scene one after the other, with a sweep after each."""

_ROUNDS: Final = 400
"""Times that a group of a part is drawn before the scene is given up."""

_UNJAM: Final = 8
"""Such times after which those that are there already are moved."""

_REMAINING: Final = 0.01
"""Groups that may still differ, on average, between a scene and one of the exact law."""

_SLOWEST: Final = 0.8
"""Largest share of the groups that differ that a sweep is assumed to leave."""

_MOST_KEPT: Final = 1 << 18
"""Candidates for groups above which those that no scene holds are forgotten."""


def is_loose(apart: Apart) -> bool:
    """Return whether groups have so much room that single ones can be moved."""
    return apart.crowding <= _DENSEST


def settle(
    engine: Engine, apart: Apart, tasks: Sequence[tuple[int, int]], *, max_attempts: int
) -> tuple[Joined, Approximation]:
    """Make scenes whose law is nearly that of the program; returns their attempts, and how they came about.

    Args:
        engine: of the whole plan.
        apart: the groups.
        tasks: which scenes: seeds, and numbers in the run of a seed.
        max_attempts: candidates tried for one group of one scene.

    """
    return _Chains(engine, apart, tasks, max_attempts).run()


class _Chains:
    def __init__(
        self, engine: Engine, apart: Apart, tasks: Sequence[tuple[int, int]], max_attempts: int
    ) -> None:
        self._engine = engine
        self._apart = apart
        slots = np.arange(apart.leaves)
        self._candidates = GroupCandidates(engine, apart, tasks, max_attempts, engine.most_lanes, slots)
        self._now = np.full((len(tasks), apart.leaves), -1, dtype=np.intp)
        """The candidate for each group that a scene has at present; -1 for a group that is not there yet."""
        self._alive = np.ones(len(tasks), dtype=np.bool_)
        self._most_made = _MOST_KEPT

    def run(self) -> tuple[Joined, Approximation]:
        leaves = self._apart.leaves
        fits = np.ones(leaves)
        edges = np.unique(np.linspace(0, leaves, _STAGES + 1).astype(np.intp)).tolist()
        for start, stop in pairwise(edges):
            fits[start:stop] = self._insert(start, stop)
            self._sweep(stop)
        sweeps = _sweeps(self._apart)
        has_moved = np.zeros(self._now.shape, dtype=np.bool_)
        for _ in range(sweeps):
            has_moved |= self._sweep(leaves)
        attempts = np.zeros(self._now.shape, dtype=np.int64)
        attempts[self._alive] = self._candidates.attempts(self._now[self._alive])
        candidates = Joined(attempts, self._candidates.tried.max(axis=1), in_time=True)
        return candidates, self._report(fits, sweeps, has_moved)

    def _report(self, fits: NDArray[np.float64], sweeps: int, moved: Masks) -> Approximation:
        own = np.array([passed / judged for judged, passed in self._candidates.rates])
        survival = np.maximum(fits, 0.5 / len(self._now)) * own[self._apart.kind]
        alive = int(np.count_nonzero(self._alive))
        stuck = 1 - float(moved[self._alive].mean()) if alive else 1.0
        total = float(np.log(survival).sum())
        return Approximation(len(self._now), total, alive, tuple(survival.tolist()), sweeps, stuck)

    def _insert(self, start: int, stop: int) -> NDArray[np.float64]:
        """Put groups into all scenes; returns the share of scenes in which each fits at once, ``(stop - start,)``."""
        fits = np.ones(stop - start)
        for number in range(_ROUNDS):
            absent = np.zeros(self._now.shape, dtype=np.bool_)
            absent[:, start:stop] = (self._now[:, start:stop] < 0) & self._alive[:, np.newaxis]
            waiting = np.asarray(absent.any(axis=1))
            if not waiting.any():
                return fits
            if number % _UNJAM == _UNJAM - 1:
                self._move((self._now >= 0) & waiting[:, np.newaxis])
            is_accepted = self._move(absent)
            if number == 0 and self._alive.any():
                fits = np.asarray(is_accepted[self._alive, start:stop].mean(axis=0))
        self._alive &= (self._now[:, :stop] >= 0).all(axis=1)
        return fits

    def _sweep(self, stop: int) -> Masks:
        """Draw each of the first groups of each scene again, in turn; returns a mask of those that have moved."""
        mask = np.zeros(self._now.shape, dtype=np.bool_)
        mask[self._alive, :stop] = True
        return self._move(mask)

    def _move(self, mask: Masks) -> Masks:
        """Draw some groups of scenes again, one after the other; returns a mask of those that have a new place."""
        proposals = np.full(self._now.shape, -1, dtype=np.intp)
        rows = np.flatnonzero(mask & self._alive[:, np.newaxis])
        proposals.flat[rows] = self._draw(rows)
        self._alive &= ~self._candidates.is_over
        proposals[~self._alive] = -1
        is_accepted = proposals >= 0
        start_time = time.perf_counter()
        step = max(1, LEAVES // (2 * proposals.shape[1]))
        for start in range(0, len(proposals), step):
            some = slice(start, start + step)
            self._settle(self._now[some], proposals[some], is_accepted[some])
        self._engine.note(
            self._apart.number,
            len(rows),
            int(np.count_nonzero(is_accepted)),
            time.perf_counter() - start_time,
        )
        self._now = np.where(is_accepted, proposals, self._now)
        if self._candidates.count > self._most_made:
            self._now = self._candidates.forget([self._now])[self._now]
            self._most_made = max(_MOST_KEPT, 2 * self._candidates.count)
        return is_accepted

    def _draw(self, rows: Indices) -> Indices:
        """The next candidates for the groups of some rows; of scenes that reach the limit of attempts whatever is there."""
        queues = self._candidates.queues
        while True:
            over = self._candidates.is_over[rows // self._apart.leaves]
            missing = rows[(queues.count[rows] == 0) & ~over]
            if not len(missing):
                break
            self._candidates.supply(missing, np.ones(len(missing), dtype=np.int64))
        ones, zeros = np.ones(len(rows), dtype=np.int64), np.zeros(len(rows), dtype=np.int64)
        proposals = queues.take(rows, ones, zeros, np.arange(len(rows)))[:, 0]
        return np.where(over, -1, proposals)

    def _settle(self, now: Indices, drawn: Indices, accepted: Masks) -> None:
        """Clear those of the proposals ``drawn`` from ``accepted`` that collide when they are made one after the other.

        Proposals that collide with nothing, neither at present nor proposed, stand; the others are decided in their order.
        """
        lanes, leaves, places_of_leaves, is_new = [], [], [], []
        for places in (now, drawn):
            lane, leaf = np.nonzero(places >= 0)
            lanes.append(lane)
            leaves.append(leaf)
            places_of_leaves.append(places[lane, leaf])
            is_new.append(np.full(len(lane), places is drawn))
        lane, leaf, every, new = (np.concatenate(each) for each in (lanes, leaves, places_of_leaves, is_new))
        order = np.argsort(lane, kind="stable")
        lane, leaf, every, new = lane[order], leaf[order], every[order], new[order]
        bodies, owner = self._candidates.spread(every)
        first, second = self._candidates.bodies.meetings(
            bodies, lane[owner], leaf[owner], new[owner], self._apart.may_meet
        )
        one, two = owner[first], owner[second]
        for scene, group, others in _conflicts(lane, leaf, new, one, two):
            stands = accepted[scene]
            # Of a group that comes earlier the place counts that it has got, of a later one the place that it has yet.
            if any((other < group and stands[other]) == is_proposal for other, is_proposal in others):
                stands[group] = False


def _conflicts(
    lane: Indices, leaf: Indices, new: Masks, one: Indices, two: Indices
) -> Iterator[tuple[int, int, list[tuple[int, bool]]]]:
    """Yield the proposals that collide with something, in order: lane, group, and with which groups' present or proposed places."""
    subject, other = np.concatenate([one, two]), np.concatenate([two, one])
    are_proposals = new[subject]
    subject, other = subject[are_proposals], other[are_proposals]
    order = np.lexsort((leaf[subject], lane[subject]))
    subject, other = subject[order], other[order]
    starts = np.flatnonzero(np.diff(subject, prepend=-1)).tolist()
    stops = [*starts[1:], len(subject)] if starts else []
    leaves, is_new = leaf[other].tolist(), new[other].tolist()
    for start, stop in zip(starts, stops, strict=True):
        item = int(subject[start])
        yield int(lane[item]), int(leaf[item]), list(zip(leaves[start:stop], is_new[start:stop], strict=True))


def _sweeps(apart: Apart) -> int:
    """The number of sweeps after all groups are in their scenes."""
    rate = min(max(2 * apart.crowding, 0.01), _SLOWEST)
    return math.ceil(math.log(apart.leaves / _REMAINING) / -math.log(rate))
