"""Running behaviors and monitors, and what all that runs has in common: guards, and being resumed."""

import inspect
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from scenic.language.errors import (
    GuardViolation,
    InvalidScenarioError,
    InvariantViolation,
    PreconditionViolation,
    RejectionException,
)
from scenic.language.spans import Span
from scenic.runtime.context import here
from scenic.runtime.dynamics.definitions import Guard, Invocable

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run
    from scenic.runtime.dynamics.scenarios import ScenarioActivation

__all__ = ["Activation", "Termination", "Yielded"]

WAIT: tuple[Any, ...] = ()


class Termination:
    """What ``terminate`` yields."""

    __slots__ = ("simulation", "span")

    def __init__(self, *, simulation: bool, span: Span | None) -> None:
        self.simulation = simulation
        self.span = span

    @property
    def reason(self) -> str:
        """In words."""
        what = "terminate simulation" if self.simulation else "terminate"
        return f'"{what}" executed on line {"?" if self.span is None else self.span.line}'


Yielded = tuple[Any, ...] | Termination
"""What running code yields to the simulation: actions (none for ``wait``), or a request to end something."""


class Activation:
    """One run of a behavior or monitor.

    Args:
        run: the simulation.
        instance: the behavior or monitor.
        agent: who behaves; ``None`` for monitors.
        scenario: on whose behalf: the one that created the agent, or that asked for the monitor.

    """

    composes = False
    """Whether it runs scenarios."""
    __slots__ = ("agent", "direct", "generator", "instance", "invariants", "preconditions", "run", "scenario")

    def __init__(self, run: "Run", instance: Invocable, agent: Any, scenario: "ScenarioActivation") -> None:
        if instance._activation is not None:
            raise InvalidScenarioError(
                f"{instance._kind} {instance!r} is running already",
                span=here(),
                help=f"create one for each use: `{instance._definition.name}(...)`",
            )
        definition = instance._definition
        self.run = run
        self.instance = instance
        self.agent = agent
        self.scenario = scenario
        self.direct = True
        """Whether the last yield was by a statement of its own, not by something that it does."""
        self.generator: Generator[Yielded, None, Any] | None = None
        value = run.copies.value
        self.preconditions: list[Guard] = [value(guard) for guard in definition.preconditions]
        self.invariants: list[Guard] = [value(guard) for guard in definition.invariants]

    def start(self) -> None:
        """Check the guards and get ready; the code begins to run when it is first resumed."""
        self.check_all()
        arguments = self.instance._arguments
        body = self.run.copies.value(self.instance._definition.body)
        own = (self.instance, self.agent) if self.instance._kind == "behavior" else (self.instance,)
        self.generator = body(*own, *arguments.args, **arguments.kwargs)
        self.instance._activation = self

    def resume(self) -> Yielded | None:
        """What it yields next; ``None`` if it has ended. Raises what its code raises, and guard violations."""
        generator = self.generator
        if generator is None:
            return None
        try:
            if (
                self.invariants
                and self.direct
                and inspect.getgeneratorstate(generator) != inspect.GEN_CREATED
            ):
                try:
                    self.check_invariants()
                except InvariantViolation as violation:
                    # Raised where the code waits: there, or further out, it may be caught.
                    return generator.throw(violation)
            return next(generator)
        except StopIteration:
            self.stop()
            return None
        except BaseException:
            self.stop()
            raise

    def stop(self) -> None:
        """End it, whatever it is doing."""
        generator, self.generator = self.generator, None
        if generator is not None:
            self.instance._activation = None
            generator.close()

    # Guards

    def check_all(self) -> None:
        """Raise `GuardViolation` unless all guards hold."""
        for guard in self.preconditions:
            self._check(guard, PreconditionViolation)
        self.check_invariants()

    def check_invariants(self) -> None:
        """Raise `InvariantViolation` unless all invariants hold."""
        for guard in self.invariants:
            self._check(guard, InvariantViolation)

    def _check(self, guard: Guard, violation: type[GuardViolation]) -> None:
        own = (self.instance, self.agent) if self.instance._kind == "behavior" else (self.instance,)
        try:
            with self.run.guard():
                holds = bool(guard(*own))
        except RejectionException:
            holds = False
        if not holds:
            raise violation(self.instance, guard.__code__.co_firstlineno)

    def may_start(self) -> bool:
        """Whether all guards hold."""
        try:
            self.check_all()
        except GuardViolation:
            return False
        return True
