"""In which order, and in which groups, nodes are evaluated.

Interpreting a node costs microseconds whatever the number of lanes; a scene of a hundred objects has thousands of nodes,
most of them alike. So nodes of one *signature* (operation, payload, kinds) that do not need each other are evaluated in one
call over members x lanes. Operations that stack are elementwise, so that the results are bitwise those of single calls.

A `Scheduler` is kept as long as its graph: what has to be evaluated to get some nodes, when others are there already, is
worked out once; and so is, for a chain of stages, after which step nobody needs a column any more.
"""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.draws import Words
from scenic.graph.kinds import Column, Kind
from scenic.graph.merging import Merger, is_choice_of_draws
from scenic.graph.node import Graph, Node
from scenic.graph.operation import Operation

Slot = int
"""The index under which a batch stores the columns of a group."""


@dataclass(frozen=True, slots=True)
class ColumnPlace:
    """The location of the column of a node: the group and the member in it."""

    slot: Slot
    member: int


@dataclass(frozen=True, slots=True)
class Fixed:
    """An operand that is the same in all lanes: a column with leading dimensions (members or 1, 1)."""

    column: Column


@dataclass(frozen=True, slots=True)
class ColumnRun:
    """An operand whose columns are members of one group at equal distances."""

    slot: Slot
    members: slice


@dataclass(frozen=True, slots=True)
class Gathered:
    """An operand whose columns stand in several places, or that is fixed for some members only."""

    parts: tuple[ColumnPlace | Column, ...]


Gather = Fixed | ColumnRun | Gathered


@dataclass(frozen=True, slots=True)
class Step:
    """One call: an operation over the members of a group, each with its operands."""

    slot: Slot
    operation: Operation
    payload: Any
    kind: Kind
    kinds: tuple[Kind, ...]
    operands: tuple[Gather, ...]
    nodes: tuple[Node, ...]
    stacked: bool
    """True if the operation takes the dimension of the members; if not there is one member."""
    is_python: bool
    """True if Python's own function evaluates it lane by lane."""
    may_mark: bool
    """True if the operation declares that lanes may fail or be rejected."""


@dataclass(frozen=True, slots=True)
class DrawStep:
    """Axes (or keys) drawn together."""

    slot: Slot
    addresses: Words
    axes: np.ndarray[Any, np.dtype[np.intp]] | None
    """Numbers of the axes in the domain; ``None`` for keys."""


@dataclass(frozen=True, slots=True)
class ChosenDraw:
    """Of several axes each lane draws one."""

    slot: Slot
    index: Gather
    """Number of the stage."""
    addresses: Words
    axes: np.ndarray[Any, np.dtype[np.intp]]
    """Numbers of the axes in the domain."""


AnyStep = DrawStep | ChosenDraw | Step


@dataclass(frozen=True, slots=True)
class Schedule:
    """The steps to take to get some nodes; afterwards they, and what else is kept, are at ``places``."""

    steps: tuple[AnyStep, ...]
    places: Mapping[Node, ColumnPlace]
    unused: tuple[tuple[Slot, ...], ...] = ()
    """Of a schedule in a chain: what nobody needs any more, before the first step and then after each. ``places`` are those of all
    of the chain, also of what is not evaluated yet or is kept no longer. Empty where all is kept."""


_START: Final = Schedule((), {})


class Scheduler:
    """Schedules of one graph.

    Args:
        graph: the graph, which numbers axes and addresses.
        grouped: whether to evaluate alike nodes together; changes speed, never a value.

    """

    def __init__(self, graph: Graph, *, grouped: bool = True) -> None:
        self.graph = graph
        self._grouped = grouped
        self._known: dict[tuple[int, tuple[Node, ...]], Schedule] = {}
        self._kept: list[Schedule] = []
        self._chains: dict[tuple[tuple[Node, ...], ...], tuple[Schedule, ...]] = {}
        self._gathers: dict[tuple[int, tuple[Node, ...]], Gather] = {}
        self._slots = 0
        self._merger: Final = Merger()

    @property
    def start(self) -> Schedule:
        """The schedule of nothing."""
        return _START

    def after(self, before: Schedule, roots: tuple[Node, ...]) -> Schedule:
        """Return the schedule that gets ``roots`` once ``before``, which keeps all, has been done."""
        key = (id(before), roots)
        schedule = self._known.get(key)
        if schedule is None:
            places = dict(before.places)
            steps = tuple(self._steps(roots, places))
            schedule = self._known[key] = Schedule(steps, places)
            self._kept.append(schedule)  # alive, so that its identity stays its own
        return schedule

    def chain(self, stages: Sequence[Sequence[Node]]) -> tuple[Schedule, ...]:
        """Return schedules that evaluate the stages in turn, starting empty, and free each column after its last use.

        A stage's nodes can be read until the next one begins; those of the last are kept.
        """
        key = tuple(map(tuple, stages))
        chain = self._chains.get(key)
        if chain is None:
            chain = self._chains[key] = self._chain(key)
        return chain

    def _chain(self, stages: Sequence[Sequence[Node]]) -> tuple[Schedule, ...]:
        places: dict[Node, ColumnPlace] = {}
        steps = [self._steps(roots, places) for roots in stages]
        # When each slot is used for the last time: before a step (or the end) of a stage.
        last: dict[Slot, tuple[int, int]] = {}
        for stage, (roots, mine) in enumerate(zip(stages, steps, strict=True)):
            for number, step in enumerate(mine):
                last |= dict.fromkeys(_slots_read(step), (stage, number + 1))
            last |= dict.fromkeys(
                (places[node].slot for node in roots if not node.is_constant), (stage + 1, 0)
            )
        drops_of_stage: list[list[list[Slot]]] = [[[] for _ in range(len(mine) + 1)] for mine in steps]
        for slot, (stage, number) in last.items():
            if stage < len(stages):
                drops_of_stage[stage][number].append(slot)
        return tuple(
            Schedule(tuple(mine), places, tuple(map(tuple, drops)))
            for mine, drops in zip(steps, drops_of_stage, strict=True)
        )

    def below(self, roots: Iterable[Node]) -> frozenset[Node]:
        """Return the nodes that are evaluated to get some nodes when nothing is there."""
        return frozenset(self._missing(roots, {}))

    def without_python(self, roots: Sequence[Node]) -> tuple[Node, ...]:
        """Return those of the nodes that are evaluated without a call of the program's own Python code."""
        clear: dict[Node, bool] = {}
        for node in self._missing(roots, {}):
            clear[node] = not node.runs_python and all(
                clear.get(needed, True) for needed in self._needed(node)
            )
        return tuple(node for node in roots if clear.get(node, True))

    def gather(self, schedule: Schedule, nodes: tuple[Node, ...]) -> Gather:
        """Return the way to get the columns of ``nodes`` after ``schedule`` has run."""
        key = (id(schedule), nodes)
        gather = self._gathers.get(key)
        if gather is None:
            gather = self._gathers[key] = _gather(nodes, schedule.places)
        return gather

    def _steps(self, roots: Sequence[Node], places: dict[Node, ColumnPlace]) -> list[AnyStep]:
        """Return the steps that evaluate ``roots`` when the nodes of ``places`` are evaluated, and add the
        places of their results.
        """
        missing = self._missing(roots, places)
        steps: list[AnyStep] = []
        levels: dict[Node, int] = {}
        groups: dict[tuple[int, Hashable], list[Node]] = {}
        for node in missing:
            level = 1 + max((levels.get(operand, 0) for operand in self._needed(node)), default=-1)
            levels[node] = level
            groups.setdefault((level, self._signature(node)), []).append(node)
        for (_, signature), members in sorted(groups.items(), key=lambda item: item[0][0]):
            replacement = self._merged(members[0])
            if signature in ("axis", "key"):
                steps.append(self._draw(members, places, axes=signature == "axis"))
            elif replacement is not members[0]:
                places[members[0]] = places[replacement]
            elif self._grouped and is_choice_of_draws(replacement):
                steps.append(self._chosen_draw(replacement, places))
            else:
                steps.append(self._step(members, places))
        return steps

    def _merged(self, node: Node) -> Node:
        """Return the node that is evaluated in place of a node. (Single lanes evaluate the node itself, which
        shows what failed.)
        """
        return self._merger(node) if self._grouped else node

    def _needed(self, node: Node) -> Sequence[Node]:
        """Return the nodes that must be evaluated before a node."""
        merged = self._merged(node)
        if merged is not node:
            return (merged,)
        return node.operands[:1] if self._grouped and is_choice_of_draws(node) else node.operands

    def _missing(self, roots: Iterable[Node], there: Mapping[Node, ColumnPlace]) -> list[Node]:
        """Return the nodes below ``roots`` that are neither there nor constant, operands first."""
        result: dict[Node, None] = {}
        for root in roots:
            if root.is_constant or root in there or root in result:
                continue
            stack: list[tuple[Node, int]] = [(root, 0)]
            while stack:
                node, position = stack.pop()
                operands = self._needed(node)
                if position < len(operands):
                    stack.append((node, position + 1))
                    operand = operands[position]
                    if not operand.is_constant and operand not in there and operand not in result:
                        stack.append((operand, 0))
                elif node not in result:
                    result[node] = None
        return list(result)

    def _signature(self, node: Node) -> Hashable:
        """Return a key that is equal for nodes that can be evaluated together."""
        if node.is_axis:
            return "axis"
        if node.is_drawn:
            return "key"
        if not (self._grouped and node.operation.stacks) or _is_python(node):
            return id(node)
        return node.likeness

    def _slot(self, members: Sequence[Node], places: dict[Node, ColumnPlace]) -> Slot:
        slot = self._slots
        self._slots += 1
        for member, node in enumerate(members):
            places[node] = ColumnPlace(slot, member)
        return slot

    def _draw(self, members: Sequence[Node], places: dict[Node, ColumnPlace], *, axes: bool) -> DrawStep:
        numbers = np.array([self.graph.axes[node] for node in members], dtype=np.intp) if axes else None
        return DrawStep(self._slot(members, places), self.graph.addresses(members), numbers)

    def _chosen_draw(self, node: Node, places: dict[Node, ColumnPlace]) -> ChosenDraw:
        index, *axes = node.operands
        numbers = np.array([self.graph.axes[axis] for axis in axes], dtype=np.intp)
        gather = _gather([index], places)
        return ChosenDraw(self._slot([node], places), gather, self.graph.addresses(axes), numbers)

    def _step(self, members: list[Node], places: dict[Node, ColumnPlace]) -> Step:
        first = members[0]
        if len(members) > 1:
            members = sorted(members, key=lambda node: _order(node, places))
        operands = tuple(
            _gather([node.operands[position] for node in members], places)
            for position in range(len(first.operands))
        )
        operation = first.operation
        may_mark = any(
            operation.may_fault(node.operands, node.payload, node.kind)
            or operation.may_reject(node.operands, node.payload, node.kind)
            for node in members
        )
        return Step(
            self._slot(members, places),
            operation,
            first.payload,
            first.kind,
            tuple(operand.kind for operand in first.operands),
            operands,
            tuple(members),
            operation.stacks and not _is_python(first),
            _is_python(first),
            may_mark or not operation.strict,
        )


def _slots_read(step: AnyStep) -> Iterator[Slot]:
    if isinstance(step, DrawStep):
        return
    for gather in step.operands if isinstance(step, Step) else (step.index,):
        if isinstance(gather, ColumnRun):
            yield gather.slot
        elif isinstance(gather, Gathered):
            yield from (part.slot for part in gather.parts if isinstance(part, ColumnPlace))


def _is_python(node: Node) -> bool:
    return node.operation.is_python(node.operands, node.kind)


def _order(node: Node, places: Mapping[Node, ColumnPlace]) -> tuple[tuple[int, int], ...]:
    """Members are sorted by where their operands are, so that most operands are runs."""
    return tuple(
        (places[operand].slot, places[operand].member) for operand in node.operands if operand in places
    )


def _gather(operands: Sequence[Node], places: Mapping[Node, ColumnPlace]) -> Gather:
    """Return the way to get the columns of one operand for all members of a group."""
    if all(operand.is_constant for operand in operands):
        columns = [operand.payload.column for operand in operands]
        if all(column is columns[0] for column in columns[1:]) or _equal_constants(operands):
            return Fixed(columns[0][np.newaxis])
        return Fixed(np.stack(columns))
    if not any(operand.is_constant for operand in operands):
        operand_places = [places[operand] for operand in operands]
        run = _run(operand_places)
        if run is not None:
            return run
        return Gathered(tuple(operand_places))
    return Gathered(
        tuple(operand.payload.column if operand.is_constant else places[operand] for operand in operands)
    )


def _equal_constants(operands: Sequence[Node]) -> bool:
    first = operands[0].payload.key
    return all(operand.payload.key == first for operand in operands[1:])


def _run(places: Sequence[ColumnPlace]) -> ColumnRun | None:
    slot = places[0].slot
    if any(place.slot != slot for place in places):
        return None
    members = [place.member for place in places]
    if len(members) == 1:
        return ColumnRun(slot, slice(members[0], members[0] + 1))
    step = members[1] - members[0]
    if step <= 0 or any(b - a != step for a, b in pairwise(members)):
        if all(member == members[0] for member in members):
            return ColumnRun(slot, slice(members[0], members[0] + 1))
        return None
    return ColumnRun(slot, slice(members[0], members[-1] + 1, step))


__all__ = [
    "AnyStep",
    "ChosenDraw",
    "ColumnPlace",
    "ColumnRun",
    "DrawStep",
    "Fixed",
    "Gather",
    "Gathered",
    "Schedule",
    "Scheduler",
    "Step",
]
