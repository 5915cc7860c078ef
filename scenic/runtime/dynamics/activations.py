"""Running behaviors and monitors, and what all that runs yields."""

import inspect
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from scenic.language.errors import InvalidScenarioError, InvariantViolation
from scenic.language.spans import Span
from scenic.runtime.description.definitions import Guard, Invocable
from scenic.runtime.dynamics.guards import Guarded
from scenic.runtime.ground.context import here

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run
    from scenic.runtime.dynamics.scenarios import ScenarioActivation

__all__ = ["Activation", "Termination", "Yielded"]

WAIT: tuple[Any, ...] = ()


class Termination:
    """The value that ``terminate`` yields."""

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
"""A value that running code yields to the simulation: actions (none for ``wait``), or a request to end something."""


class Activation(Guarded):
    """One run of a behavior or monitor.

    Args:
        run: the simulation.
        instance: the behavior or monitor.
        agent: who behaves; ``None`` for monitors.
        scenario: on whose behalf: the one that created the agent, or that asked for the monitor.

    """

    composes = False
    """True if it runs scenarios."""
    __slots__ = ("agent", "direct", "generator", "scenario")

    def __init__(
        self, run: "Run", instance: Invocable, agent: object, scenario: "ScenarioActivation"
    ) -> None:
        if instance._activation is not None:
            raise InvalidScenarioError(
                f"{instance._kind} {instance!r} is running already",
                span=here(),
                help=f"create one for each use: `{instance._definition.name}(...)`",
            )
        super().__init__(run, instance)
        self.agent = agent
        self.scenario = scenario
        self.direct = True
        """True if the last yield was by a statement of its own, not by something that it does."""
        self.generator: Generator[Yielded, None, Any] | None = None

    def start(self) -> None:
        """Check the guards and get ready; the code begins to run when it is first resumed."""
        self.check_all()
        arguments = self.instance._arguments
        body = self.run.copies.value(self.instance._definition.body)
        self.generator = body(*self._own, *arguments.args, **arguments.kwargs)
        self.instance._activation = self

    def resume(self) -> Yielded | None:
        """Return the next value that it yields; ``None`` if it has ended. Raises what its code raises, and guard violations."""
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

    @property
    def _own(self) -> tuple[Any, ...]:
        """The first arguments of its code and of its guards."""
        return (self.instance, self.agent) if self.instance._kind == "behavior" else (self.instance,)

    def _ask(self, guard: Guard) -> Any:
        with self.run.guard():
            return guard(*self._own)
