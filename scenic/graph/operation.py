"""An entry of the table of operations: one operation, all its readings side by side."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Final, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Codec, Column, Kind

OK: Final = 0
FAULT: Final = 1
REJECTED: Final = 2
"""Status of a lane at a node. A lane that both faults and is rejected counts as rejected (the larger)."""

Status = NDArray[np.int8]


class Operand(Protocol):
    """The facts about an operand before anything is evaluated (`scenic.graph.node.Node`)."""

    @property
    def kind(self) -> Kind:
        """Its kind."""

    @property
    def payload(self) -> Any:
        """Its operation's data."""

    @property
    def limits(self) -> tuple[int, int] | None:
        """Exact bounds of an integer."""

    @property
    def is_constant(self) -> bool:
        """Return whether it is fixed."""

    @property
    def value(self) -> Any:
        """The value, where it is fixed."""


class Call:
    """One evaluation of an operation over the lanes of a batch, as its NumPy reading sees it.

    ``shape`` is that of a number's column: ``(n,)``, or ``(m, n)`` where the columns of ``m`` alike nodes are stacked.
    ``operands`` holds the statuses of the operands (``None`` where every lane is fine); only operations that are
    not strict look at them, through `inherit`. ``kinds`` are the kinds of the operands, ``kind`` that of the result;
    ``codec`` is there for operations that mix kinds.
    """

    __slots__ = ("codec", "culprit", "error", "kind", "kinds", "operands", "payload", "shape", "status")

    def __init__(
        self,
        shape: tuple[int, ...],
        payload: Any,
        operands: Sequence[Status | None],
        *,
        kinds: Sequence[Kind] = (),
        kind: Kind = Kind.SCALAR,
        codec: Codec | None = None,
    ) -> None:
        self.shape = shape
        self.payload = payload
        self.operands = operands
        self.kinds = kinds
        self.kind = kind
        self.codec = codec
        self.status: Status | None = None
        self.error: Exception | None = None
        self.culprit: int | None = None

    @property
    def lanes(self) -> int:
        """The number of lanes."""
        return self.shape[-1]

    def everywhere(self, *, value: bool) -> Column:
        """Return a truth value that is the same in every lane."""
        return np.full((1,) * len(self.shape), value, dtype=np.bool_)

    def reject(self, mask: Column) -> None:
        """Reject the lanes where ``mask`` (shape ``(n,)`` or ``(1,)``) holds."""
        self._mark(mask, REJECTED)

    def fault(self, mask: Column, error: Exception) -> None:
        """Let the lanes where ``mask`` holds fail with ``error``, if their values are used."""
        if self._mark(mask, FAULT) and self.error is None:
            self.error = error

    def inherit(self, position: int, mask: Column) -> None:
        """Let the lanes where ``mask`` holds share the fate of one operand (operations that are not strict)."""
        status = self.operands[position]
        if status is None:
            return
        fate = np.where(mask, status, np.int8(OK))
        if not fate.any():
            return
        if self.culprit is None and (fate == FAULT).any():
            self.culprit = position
        if self.status is None:
            self.status = np.zeros(self.shape, dtype=np.int8)
        np.maximum(self.status, fate, out=self.status)

    def _mark(self, mask: Column, mark: int) -> bool:
        if not mask.any():
            return False
        if self.status is None:
            self.status = np.zeros(self.shape, dtype=np.int8)
        np.maximum(self.status, np.where(mask, np.int8(mark), np.int8(OK)), out=self.status)
        return True


class Terms(Protocol):
    """The solver's terms, passed to solver readings so that the graph needs no solver.

    Numbers are real terms and truth values boolean ones, both with Python's operators (``& | ~`` for logic); a vector
    is a triple of real terms, a constant orientation four. Where nothing is known of a value its term is ``None``;
    strict readings never see one. Arithmetic is that of the real numbers: rounding is left out.
    """

    def real(self, value: float) -> Any:
        """Return the exact rational value of a float."""

    def number(self, term: Any) -> Any:
        """Return a truth value as 0 or 1; a number unchanged."""

    def constant(self, term: Any) -> float | None:
        """Return the value of a term that is a fixed number."""

    def either(self, condition: Any, then: Any, otherwise: Any) -> Any:
        """Return a term that equals ``then`` where ``condition`` holds, and ``otherwise`` elsewhere."""

    def fresh(self, kind: Kind) -> Any:
        """Return a term about which nothing is known; always a sound encoding of any value."""

    def integer_part(self, term: Any) -> Any:
        """Return the floor of a real term."""

    def define(self, condition: Any) -> None:
        """Assert a condition that defines a fresh term; every value of the other terms must allow some value of that term."""

    def support(self, condition: Any, phrase: str) -> None:
        """Assert a condition of the primitive value being encoded; ``phrase`` says it in words (``"is at most 10"``)."""


BatchReading = Callable[..., Column]
"""``(call, *columns) -> column``; elementwise over lanes."""

BoundsReading = Callable[..., Bounds | None]
"""``(payload, *operand bounds) -> bounds``, rounded outward; ``None`` where nothing is known.

Operands without bounds (Python objects) are ``None``; only operations that are not strict, or `partial`, see those. Known bounds mean that
the value is a number, a vector or an orientation, whatever the node's kind.
"""

InverseReading = Callable[..., Sequence[Bounds | None]]
"""``(payload, result bounds, *operand bounds) -> narrowed operand bounds``, rounded outward.

``None`` for an operand says nothing about it. Narrowed bounds must hold every operand value for which the result can
lie in the result bounds; they are intersected with the old ones by the caller. An operation that is not strict leaves both
ends infinite in boxes where the operand may not be evaluated at all.
"""

SolverReading = Callable[..., Any]
"""``(terms, payload, *operand terms) -> term``."""

KindRule = Callable[[Sequence[Any], Any], Kind]
"""``(operands, payload) -> kind`` of the result; the operands are each an `Operand`."""

Declared = bool | Callable[[Sequence[Any], Any], bool]
"""True if something may happen in some lane: a fact of the operation, or of its operands and payload."""

CutsReading = Callable[[Any, Sequence[Any]], Any]
"""``(payload, operands) -> cuts``: the first points ``(m,)`` of the axis, ascending, from which a discrete value is the next one.

``None`` where they are not known.
"""

Rewriting = Callable[[Sequence[Any], Any], Any]
"""``(operands, payload) -> node``: a simpler node of the same value, ``None`` where there is none."""


_Operand = TypeVar("_Operand")


@dataclass(frozen=True, slots=True, eq=False)
class Operation:
    """An entry of the table.

    ``batch`` is the NumPy reading. ``python`` is Python's own function of the same meaning where there is one: it
    evaluates constants and lanes that hold Python objects, so that results equal Python's. ``scalar`` is the batch reading's
    formula on plain Python numbers, ``(payload, *operands)`` with vectors and quaternions as tuples: what is computed at
    once (while a program is loaded, during a simulation) takes no arrays, and the result is the same in every bit. It
    gives ``NotImplemented`` for operands that it leaves to the other readings. ``bounds``, ``inverse`` and
    ``solver`` may be missing: analysis then knows nothing of the result, never something wrong. An operation that is
    not ``strict`` decides itself which operands' faults and rejections reach its result (a choice ignores the options
    that were not drawn). ``pure`` operations with constant operands are evaluated at once; equal ones are one node.

    ``faults`` and ``rejects`` declare that a lane may fail with an exception, or have no value and be rejected; doing either
    undeclared is an internal error. An operation that ``stacks`` evaluates the columns of several alike nodes in one
    call: it is elementwise over all leading dimensions. A ``partial`` one has readings of bounds that take operands of which
    nothing is known, and may look at some operands only: ``looks_at`` says which, from the payload. ``rewrite`` simplifies a node
    before it is made. ``together`` is ``python`` over the lists of all lanes' values, or ``None`` where it leaves them to
    ``python``. ``calls_code`` says that evaluation calls the program's own Python code, lane by lane. ``missing`` says in a user's words what there is none of where a lane has no value.
    """

    name: str
    kind: KindRule
    batch: BatchReading
    doc: str
    python: Callable[..., Any] | None = None
    together: Callable[..., list[Any] | None] | None = None
    scalar: Callable[..., Any] | None = None
    bounds: BoundsReading | None = None
    inverse: InverseReading | None = None
    solver: SolverReading | None = None
    strict: bool = True
    pure: bool = True
    faults: Declared = False
    rejects: Declared = False
    stacks: bool = False
    partial: bool = False
    looks_at: Callable[[Any], slice] | None = None
    rewrite: Rewriting | None = None
    cuts: CutsReading | None = None
    calls_code: bool = False
    missing: str = "value"

    def may_fault(self, operands: Sequence[Operand], payload: Any, kind: Kind) -> bool:
        """Return whether a lane may fail at a node of this operation, given fine operands."""
        if self.is_python(operands, kind):
            return True
        return self.faults(operands, payload) if callable(self.faults) else self.faults

    def may_reject(self, operands: Sequence[Operand], payload: Any, kind: Kind) -> bool:
        """Return whether a lane may have no value at a node of this operation, given fine operands."""
        if self.is_python(operands, kind):
            return True
        return self.rejects(operands, payload) if callable(self.rejects) else self.rejects

    def bounding(self, operands: Sequence[_Operand], payload: Any) -> Sequence[_Operand]:
        """Return the operands that readings of bounds look at."""
        return operands if self.looks_at is None else operands[self.looks_at(payload)]

    def is_python(self, operands: Sequence[Operand], kind: Kind) -> bool:
        """Return whether a node is evaluated lane by lane by the ``python`` function, which may raise anything."""
        if self.python is None or not self.strict:
            return False
        return kind.is_boxed or any(operand.kind.is_boxed for operand in operands)

    def runs_python(self, operands: Sequence[Operand], kind: Kind) -> bool:
        """Return whether evaluation of a node calls Python functions lane by lane, which may be the program's own."""
        return self.calls_code or self.is_python(operands, kind)


stacking: Final = partial(Operation, stacks=True)
"""Makes an operation that is elementwise over all leading dimensions, so that it stacks."""


def by_lane(_call: Call, *_columns: Column) -> Column:
    """Return the NumPy reading of an operation that is only ever evaluated by its ``python`` function, lane by lane."""
    raise AssertionError("evaluated lane by lane")


def always(kind: Kind) -> KindRule:
    """Return the rule of an operation whose result is of one kind whatever its operands."""
    return lambda _operands, _payload: kind
