"""Checks that a candidate has to pass to become a scene, each over many lanes at a time."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.batch import Batch
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Node
from scenic.graph.operation import FAULT, OK, REJECTED
from scenic.language.spans import Span
from scenic.runtime.geometry.contact.collision import Body, Collider, collide
from scenic.runtime.geometry.contact.crowd import Crowd
from scenic.runtime.regions.stacked import body_of
from scenic.runtime.sampling.sizes import size_in_words

Mask = NDArray[np.bool_]

DRAWING = -1
"""Position of the drawing of values, before every requirement."""
BUILT_IN = 0
"""Position of the built-in requirements; those of the program follow, from 1."""


@dataclass(frozen=True, slots=True)
class CheckVerdict:
    """The verdict of a check on each lane: does it hold, and did evaluating it fail (shape ``(n,)`` each).

    In lanes that failed, ``holds`` means nothing. ``failed`` is ``None`` where none did.
    """

    holds: Mask
    failed: Mask | None = None

    @property
    def passes(self) -> Mask:
        """Lanes that it does not reject."""
        return self.holds if self.failed is None else self.holds | self.failed

    def unless(self, inactive: Mask) -> "CheckVerdict":
        """Return the verdict of a soft requirement, which passes lanes where it is not active."""
        failed = None if self.failed is None else self.failed & ~inactive
        return CheckVerdict(self.holds | inactive, failed)


class Check(Protocol):
    """One requirement as the engine sees it.

    ``position`` is its place in program order: of several errors in one candidate the first in the program is shown.
    ``cost`` orders checks before anything is measured; a ``separate`` one is too dear to be made beside others.
    """

    label: str
    span: Span | None
    position: int
    probability: float
    cost: float
    separate: bool
    filename: str | None

    @property
    def nodes(self) -> Sequence[Node]:
        """The nodes whose values it needs."""

    def test(self, batch: Batch) -> CheckVerdict:
        """Judge every lane of the batch."""

    def parts(self, batch: Batch) -> Sequence["CheckPart"]:
        """Return the requirements that it consists of, each with its own verdict, for reports."""


@dataclass(frozen=True, slots=True)
class CheckPart:
    """One requirement in a report: what it is called, where it comes from, in which lanes it holds."""

    label: str
    span: Span | None
    holds: Mask
    note: str = ""
    """A note that helps to understand why it never holds."""
    is_clause: bool = False
    """True if the label says of what there is no value, rather than what is required."""
    undecided: Mask | None = None
    """Lanes in which a value that it reads is missing; ``None`` if there are none."""

    def lacks_value(self) -> Mask:
        """Return the lanes in which a value that it reads is missing."""
        return np.zeros(len(self.holds), dtype=np.bool_) if self.undecided is None else self.undecided


def joined(parts: Sequence[CheckPart]) -> CheckPart:
    """Return one requirement on the lanes of several batches."""
    return replace(
        parts[0],
        holds=np.concatenate([part.holds for part in parts]),
        undecided=np.concatenate([part.lacks_value() for part in parts]),
    )


def _only_part(
    check: Check, batch: Batch, note: str = "", undecided: Mask | None = None
) -> Sequence[CheckPart]:
    verdict = check.test(batch)
    holds = verdict.holds if verdict.failed is None else verdict.holds & ~verdict.failed
    return [CheckPart(check.label, check.span, holds, note, undecided=undecided)]


def _any_rejected(batch: Batch, nodes: Sequence[Node]) -> Mask | None:
    """Return the mask of the lanes in which one of some nodes rejects the sample; ``None`` if there are none."""
    marks = [status == REJECTED for node in nodes if (status := batch.status(node)) is not None]
    return np.any(marks, axis=0) if marks else None


@dataclass(slots=True)
class NodeCheck:
    """A requirement that is a node of the graph."""

    node: Node
    label: str
    span: Span | None
    position: int
    probability: float = 1.0
    cost: float = 1.0
    separate: bool = False
    filename: str | None = None
    note: str = ""
    """For reports in which it rejects everything; see `CheckPart`."""

    @property
    def nodes(self) -> Sequence[Node]:
        return [self.node]

    def test(self, batch: Batch) -> CheckVerdict:
        holds = np.array(batch.full(self.node), dtype=np.bool_)
        status = batch.status(self.node)
        if status is None:
            return CheckVerdict(holds)
        holds &= status != REJECTED
        failed = status == FAULT
        return CheckVerdict(holds, failed if failed.any() else None)

    def parts(self, batch: Batch) -> Sequence[CheckPart]:
        return _only_part(self, batch, self.note, _any_rejected(batch, [self.node]))


@dataclass(slots=True)
class DrawingCheck:
    """A check that a value of the scene can be drawn: no empty range, no missing attribute, no miss of a surface."""

    node: Node
    label: str
    span: Span | None
    position: int = DRAWING
    probability: float = 1.0
    cost: float = 2.0
    separate: bool = False
    filename: str | None = None
    reason: str | None = None
    """The clause that says of lanes that have no value what is missing, in reports."""

    @property
    def nodes(self) -> Sequence[Node]:
        return [self.node]

    def test(self, batch: Batch) -> CheckVerdict:
        status = batch.status(self.node)
        if status is None:
            return CheckVerdict(np.ones(len(batch), dtype=np.bool_))
        failed = status == FAULT
        return CheckVerdict(status == OK, failed if failed.any() else None)

    def parts(self, batch: Batch) -> Sequence[CheckPart]:
        (part,) = _only_part(self, batch)
        # Below a choice nothing has a check of its own.
        operands = self.node.operands if self.node.operation.strict else ()
        undecided = _any_rejected(batch, operands)
        if self.reason is None:
            return [replace(part, undecided=undecided)]
        return [replace(part, label=self.reason, is_clause=True, undecided=undecided)]


@dataclass(frozen=True, slots=True)
class ObjectNodes:
    """The nodes that decide where an object is and what space it fills."""

    position: Node
    orientation: Node
    size: Node
    shape: Node
    allow_collisions: Node
    label: str
    """The name of the object in reports."""
    span: Span | None

    def body(self, batch: Batch) -> Body:
        """Return the object's body in every lane."""
        columns = [batch.column(node) for node in self.all[:4]]
        body = body_of(*columns)
        allow = batch.column(self.allow_collisions)
        for status in map(batch.status, self.all) if batch.has_faults else ():
            # Where it could not be computed it collides with nothing: the fault is not to be taken for a rejection.
            allow = allow if status is None else allow.astype(np.bool_) | (status != OK)
        return replace(body, allow=allow, is_fixed=self.is_fixed)

    @property
    def is_fixed(self) -> bool:
        """Return whether the object is the same in every scene."""
        return all(node.is_constant for node in self.all)

    @property
    def has_one_shape(self) -> bool:
        """Return whether its shape is the same in every scene, and whether it may collide a plain truth value."""
        return self.shape.is_constant and self.allow_collisions.kind is Kind.BOOLEAN

    @property
    def all(self) -> tuple[Node, ...]:
        """Every node, in the order of `body_operands`, then whether collisions are allowed."""
        return self.position, self.orientation, self.size, self.shape, self.allow_collisions


def _crowd(batch: Batch, objects: Sequence[ObjectNodes]) -> Crowd:
    """Return the crowd of objects of fixed shapes as stacked columns, without a body for each."""
    count = len(objects)
    number = {
        mesh: index for index, mesh in enumerate(dict.fromkeys(item.shape.value.mesh for item in objects))
    }
    position, orientation, size, allow = (
        _rows(batch.stack([getattr(item, name) for item in objects]), count)
        for name in ("position", "orientation", "size", "allow_collisions")
    )
    meshes = np.array([number[item.shape.value.mesh] for item in objects], dtype=np.intp)
    return Crowd.stacked(count, tuple(number), position, orientation, size, meshes, allow)


def _rows(columns: Column, count: int) -> Column:
    """Reshape columns (members or 1, lanes or 1, ...) to rows, one member after the other; a column that is the same everywhere becomes one row."""
    if columns.shape[0] == 1 and columns.shape[1] > 1:
        columns = np.broadcast_to(columns, (count, *columns.shape[1:]))
    return columns.reshape(-1, *columns.shape[2:])


@dataclass(slots=True)
class CollisionCheck:
    """A check that no two objects share a point, except objects that allow collisions."""

    objects: Sequence[ObjectNodes]
    pairs: NDArray[np.intp]
    label: str = "collision of objects"
    span: Span | None = None
    position: int = BUILT_IN
    probability: float = 1.0
    cost: float = 100.0
    separate: bool = True
    filename: str | None = None
    _collider: Collider | None = None

    def of_pairs(self, pairs: NDArray[np.intp]) -> "CollisionCheck":
        """The check of some pairs ``(p, 2)`` only, and of the objects in them."""
        members, numbered = np.unique(pairs, return_inverse=True)
        objects = [self.objects[member] for member in members.tolist()]
        return replace(self, objects=objects, pairs=numbered.reshape(-1, 2), _collider=None)

    @classmethod
    def joined(cls, checks: Sequence["CollisionCheck"]) -> "CollisionCheck":
        """The check of all pairs of several checks."""
        objects = list({id(item): item for check in checks for item in check.objects}.values())
        number = {id(item): place for place, item in enumerate(objects)}
        pairs = [
            [number[id(check.objects[one])], number[id(check.objects[other])]]
            for check in checks
            for one, other in check.pairs.tolist()
        ]
        return replace(
            checks[0], objects=objects, pairs=np.array(sorted(pairs), dtype=np.intp), _collider=None
        )

    @property
    def nodes(self) -> Sequence[Node]:
        return [node for item in self.objects for node in item.all]

    def test(self, batch: Batch) -> CheckVerdict:
        if self._collider is None:
            self._collider = Collider([item.body(batch) for item in self.objects], self.pairs)
        moving = [item for item in self.objects if not item.is_fixed]
        cast: Sequence[Body] | Crowd
        if moving and not batch.has_faults and all(item.has_one_shape for item in moving):
            cast = _crowd(batch, moving)
        else:
            cast = [item.body(batch) for item in self.objects]
        return CheckVerdict(self._collider.test(cast, len(batch)).free)

    def parts(self, batch: Batch) -> Sequence[CheckPart]:
        bodies = [item.body(batch) for item in self.objects]
        meetings = collide(bodies, self.pairs, lanes=len(batch), exhaustive=True).pairs
        assert meetings is not None
        sizes = [size_in_words(item.size) for item in self.objects]
        notes = [
            f"{item.label} is {size}" if size else "" for item, size in zip(self.objects, sizes, strict=True)
        ]
        return [
            CheckPart(
                f"collision of {self.objects[first].label} and {self.objects[second].label}",
                self.objects[second].span,
                ~meetings[:, pair],
                ", ".join(filter(None, (notes[first], notes[second]))),
            )
            for pair, (first, second) in enumerate(self.pairs.tolist())
        ]
