"""Declarations of a scenario beside its objects: requirements, monitors, ends, records.

The same for the scenario that is compiled and for those that are set up during a simulation.
"""

from collections.abc import Callable, Sequence
from dataclasses import field, replace
from typing import Any, Protocol

from scenic.dataclass import dataclass
from scenic.language.errors import ScenicTypeError
from scenic.language.spans import Span
from scenic.runtime.ground.context import here
from scenic.runtime.temporal.formulas import Atom, Compound, Formula
from scenic.runtime.values.values import describe

__all__ = [
    "Closure",
    "Copier",
    "Declared",
    "End",
    "MonitorUse",
    "RecordUse",
    "Required",
    "Tree",
    "label_of",
    "required",
]


def label_of(name: object) -> str | None:
    """The name that a statement is given with ``as``, which may be an expression.

    Raises:
        ScenicTypeError: the name is not a text.

    """
    if name is None or isinstance(name, str):
        return name
    raise ScenicTypeError(
        f"a name after `as` is a text, not {describe(name)}",
        span=here(),
        help="write a name, a string, or an expression that gives a string which does not depend on chance",
    )


class Copier(Protocol):
    """Gives the values of a program in a simulation."""

    def value(self, value: object) -> Any:
        """Return the value in the simulation."""


@dataclass(frozen=True, slots=True)
class Closure:
    """An expression to be evaluated later: a function, and the values of the names in it when the statement ran.

    ``margin`` gives instead of the truth of a comparison by how much it holds, if it is one.
    """

    function: Callable[..., Any]
    captured: Sequence[Any]
    margin: Callable[..., Any] | None = None

    def within(self, copier: Copier) -> "Closure":
        """Return the same over the values of a simulation."""
        return Closure(
            copier.value(self.function),
            [copier.value(item) for item in self.captured],
            copier.value(self.margin),
        )

    def __call__(self) -> Any:
        return self.function(*self.captured)

    def random_parts(self) -> list[Any]:
        """Return the values in the closure that may be random."""
        return [self.function, *self.captured]


Tree = Closure | tuple[Any, ...]
"""A condition: an atom, or an operator's name with its operands."""


@dataclass(frozen=True, slots=True)
class Required:
    """A requirement as a simulation checks it: a formula over atoms."""

    formula: Formula
    atoms: Sequence[Closure]
    label: str
    span: Span | None = None
    filename: str | None = None

    def within(self, copier: Copier) -> "Required":
        """Return the same over the values of a simulation."""
        atoms = [atom.within(copier) for atom in self.atoms]
        return Required(self.formula, atoms, self.label, self.span, self.filename)


def required(tree: Tree, label: str, span: Span | None, filename: str | None) -> Required:
    """Return the requirement of a condition."""
    atoms: list[Closure] = []

    def formula(part: Tree) -> Formula:
        if isinstance(part, Closure):
            atoms.append(part)
            return Atom(len(atoms) - 1)
        operator, *operands = part
        return Compound(operator, tuple(formula(operand) for operand in operands))

    return Required(formula(tree), atoms, label, span, filename)


@dataclass(frozen=True, slots=True)
class End:
    """``terminate when``; ``simulation`` if it ends all."""

    condition: Closure
    label: str
    simulation: bool

    def within(self, copier: Copier) -> "End":
        """Return the same over the values of a simulation."""
        return End(self.condition.within(copier), self.label, self.simulation)


@dataclass(frozen=True, slots=True)
class MonitorUse:
    """``require monitor``."""

    monitor: Any
    label: str


@dataclass(frozen=True, slots=True)
class RecordUse:
    """``record``. ``every`` and ``after`` are numbers with their units; ``to`` is a recorder or a pattern of names."""

    value: Closure
    moment: str | None
    name: str
    every: tuple[float, str] | None = None
    after: tuple[float, str] | None = None
    to: Any = None
    span: Span | None = None
    filename: str | None = None

    def within(self, copier: Copier) -> "RecordUse":
        """Return the same over the values of a simulation."""
        return replace(self, value=self.value.within(copier), to=copier.value(self.to))


@dataclass(slots=True)
class Declared:
    """Declarations of one scenario, in program order."""

    ends: list[End] = field(default_factory=list)
    monitors: list[MonitorUse] = field(default_factory=list)
    records: list[RecordUse] = field(default_factory=list)
    limits: list[tuple[float, str]] = field(default_factory=list)
    """Of ``terminate after``: numbers with their units; the earliest counts."""

    def within(self, copier: Copier) -> "Declared":
        """Return the same over the values of a simulation."""
        return Declared(
            [item.within(copier) for item in self.ends],
            [MonitorUse(copier.value(item.monitor), item.label) for item in self.monitors],
            [item.within(copier) for item in self.records],
            self.limits,
        )

    def random_parts(self) -> list[Any]:
        """Return the values in the declarations that may be random, for sampling."""
        parts: list[Any] = [item.monitor for item in self.monitors]
        for item in self.ends:
            parts += item.condition.random_parts()
        for record in self.records:
            parts += [*record.value.random_parts(), record.to]
        return parts
