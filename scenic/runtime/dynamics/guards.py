"""Preconditions and invariants of what runs: behaviors, monitors and scenarios."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from scenic.language.errors import (
    GuardViolation,
    InvariantViolation,
    PreconditionViolation,
    RejectionException,
)
from scenic.runtime.description.definitions import Guard

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["Guarded"]


class Guarded(ABC):
    """One run of something that has guards.

    Attributes:
        run: the simulation.
        instance: what runs.
        preconditions: what has to hold when it starts.
        invariants: what has to hold then and whenever it is resumed.

    """

    __slots__ = ("instance", "invariants", "preconditions", "run")

    def __init__(self, run: "Run", instance: object) -> None:
        self.run = run
        self.preconditions: list[Guard] = []
        self.invariants: list[Guard] = []
        self.become(instance)

    def become(self, instance: Any) -> None:
        """It is a run of this, whose guards count from now on; of ``None`` there are none."""
        self.instance: Any = instance
        if instance is not None:
            value = self.run.copies.value
            self.preconditions = [value(guard) for guard in instance._definition.preconditions]
            self.invariants = [value(guard) for guard in instance._definition.invariants]

    def check_all(self) -> None:
        """Raise `GuardViolation` unless all guards hold."""
        if self.instance is not None:
            self.instance.settle()
        for guard in self.preconditions:
            self._check(guard, PreconditionViolation)
        self.check_invariants()

    def check_invariants(self) -> None:
        """Raise `InvariantViolation` unless all invariants hold."""
        for guard in self.invariants:
            self._check(guard, InvariantViolation)

    def may_start(self) -> bool:
        """Return whether all guards hold."""
        try:
            self.check_all()
        except GuardViolation:
            return False
        return True

    def _check(self, guard: Guard, violation: type[GuardViolation]) -> None:
        try:
            holds = bool(self._ask(guard))
        except RejectionException:
            holds = False
        if not holds:
            raise violation(self.instance, guard.__code__.co_firstlineno)

    @abstractmethod
    def _ask(self, guard: Guard) -> Any:
        """Call a guard, a condition of the behavior or monitor, and return its value."""
