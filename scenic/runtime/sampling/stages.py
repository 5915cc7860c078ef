"""In which order, and how many at a time, the checks of a plan are made.

Cheap and rejecting checks come first. A *stage* is a run of checks whose nodes are evaluated together: stacking saves the
cost of interpreting nodes, at the price of evaluating them in lanes that the first check of the stage might have rejected.
So checks share a stage while their columns are small. None of this changes which candidates pass.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import Final

from scenic.dataclass import dataclass
from scenic.graph.node import Node
from scenic.graph.schedule import Schedule, Scheduler
from scenic.runtime.sampling.checks import Check

_STACKED: Final = 16_000
"""Elements of the columns of a stage, about: what stays in the processor's nearest cache."""

_KNOWN_LANES: Final = 64
"""Lanes after which a check's own figures are believed."""

_FADING: Final = 0.8


@dataclass(frozen=True, slots=True)
class Stage:
    """Checks made together, by their numbers; the nodes that they need, and what gets these after the stages before."""

    checks: tuple[int, ...]
    nodes: tuple[Node, ...]
    schedule: Schedule


@dataclass(slots=True)
class _Measured:
    """Cost and pass rate of a check."""

    lanes: float = 0.0
    seconds: float = 0.0
    passed: float = 0.0


class Stages:
    """The order of checks for any number of lanes, kept, and now and then made again from the measurements.

    Args:
        checks: the checks, in program order.
        outputs: what is needed of candidates that pass.
        scheduler: knows which nodes a check needs.

    """

    def __init__(self, checks: Sequence[Check], outputs: Sequence[Node], scheduler: Scheduler) -> None:
        self._checks = checks
        self._outputs = tuple(outputs)
        self._needs = [tuple(dict.fromkeys(check.nodes)) for check in checks]
        self._scheduler = scheduler
        self._measured = [_Measured() for _ in checks]
        self._plans: dict[int, tuple[Stage, ...]] = {}
        self._rounds = 0

    @cached_property
    def _below(self) -> list[frozenset[Node]]:
        """The nodes that are evaluated for each check. (Computed on demand, since engines that never sample
        do not need them.)
        """
        return [self._scheduler.below(nodes) for nodes in self._needs]

    def measure(self, index: int, lanes: int, seconds: float, passed: int) -> None:
        """Take into account that a check has judged ``lanes`` lanes."""
        measured = self._measured[index]
        measured.lanes = _FADING * measured.lanes + lanes
        measured.seconds = _FADING * measured.seconds + seconds
        measured.passed = _FADING * measured.passed + passed

    def renew(self) -> None:
        """Discard the order, so that it is made again from the measurements."""
        self._plans.clear()

    def order(self, lanes: int) -> tuple[Stage, ...]:
        """The stages for a batch with a number of lanes. The last stage has no checks: it evaluates the outputs."""
        if self._rounds and self._rounds & (self._rounds - 1) == 0:
            self.renew()  # after 1, 2, 4, 8, ... rounds
        self._rounds += 1
        return self.expected(lanes)

    def expected(self, lanes: int) -> tuple[Stage, ...]:
        """Make the stages for a possible batch in advance, so that the first batch does not have to wait for them."""
        size = max(1, lanes).bit_length()
        plan = self._plans.get(size)
        if plan is None:
            plan = self._plans[size] = self._plan(1 << size)
        return plan

    def _price(self, index: int) -> float:
        """Return the seconds that the check takes for each lane that it rejects."""
        measured = self._measured[index]
        if measured.lanes < _KNOWN_LANES:
            return self._checks[index].cost * 1e-7 / 0.5
        rejected = 1 - measured.passed / measured.lanes
        return measured.seconds / measured.lanes / max(rejected, 1e-4)

    def _alive(self, index: int) -> float:
        """The share of lanes that the check leaves."""
        measured = self._measured[index]
        return 1.0 if measured.lanes < _KNOWN_LANES else measured.passed / measured.lanes

    def _plan(self, lanes: int) -> tuple[Stage, ...]:
        order = sorted(range(len(self._checks)), key=lambda index: (self._price(index), index))
        stages: list[list[int]] = []
        there: set[Node] = set()
        members: list[int] = []
        elements = 0.0
        alive = float(lanes)
        entering = alive
        for index in order:
            fresh = len(self._below[index] - there)
            together = members and not self._checks[index].separate
            if not together or (fresh and elements + fresh * entering > _STACKED):
                if members:
                    stages.append(members)
                members, elements, entering = [], 0.0, alive
            members.append(index)
            there |= self._below[index]
            elements += fresh * entering
            alive *= self._alive(index)
            if self._checks[index].separate:
                stages.append(members)
                members, elements, entering = [], 0.0, alive
        if members:
            stages.append(members)
        nodes = [
            tuple(dict.fromkeys(node for index in members for node in self._needs[index]))
            for members in stages
        ]
        nodes.append(self._outputs)
        checks = [*map(tuple, stages), ()]
        return tuple(map(Stage, checks, nodes, self._scheduler.chain(nodes)))
