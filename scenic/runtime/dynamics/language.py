"""The part of the prelude that is about time: what generated code of dynamic statements calls.

What few programs use, or simulations alone, is imported by the methods that need it, since each start of a program waits for the rest.
"""

import inspect
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from scenic.language.errors import (
    RejectionException,
    RejectSimulationException,
    ScenicTypeError,
)
from scenic.runtime.description.declarations import Closure, End, MonitorUse, RecordUse, Required, label_of
from scenic.runtime.description.definitions import (
    Behavior,
    Definition,
    Guard,
    Invocable,
    ModularScenario,
    Monitor,
    define,
)
from scenic.runtime.dynamics import statements
from scenic.runtime.dynamics.activations import Termination, Yielded
from scenic.runtime.dynamics.run_context import RunContext
from scenic.runtime.ground.context import Context, current, here
from scenic.runtime.temporal.formulas import is_temporal
from scenic.runtime.values.lazy import MEMO, is_lazy, resolve
from scenic.runtime.values.values import describe, is_number

if TYPE_CHECKING:
    from scenic.runtime.description.outcome import Program, RunningModule
    from scenic.runtime.dynamics.run import Run

__all__ = ["Dynamics"]


class Dynamics:
    """Methods of the prelude for what takes time."""

    ABORT = statements.ABORT
    BREAK = statements.BREAK
    CONTINUE = statements.CONTINUE

    _program: "Program"
    _module: "RunningModule"

    @property
    def _context(self) -> Context:
        raise AssertionError

    @property
    def _run(self) -> "Run | None":
        """The running simulation."""
        active = current.get()
        return active.run if type(active) is RunContext else None

    # Definitions

    def behavior(
        self, preconditions: Sequence[Guard], invariants: Sequence[Guard]
    ) -> Callable[[Callable[..., Any]], Any]:
        """Return a behavior definition, given its guards; the function takes the instance, the agent and the arguments."""

        def make(body: Callable[..., Any]) -> Any:
            definition = Definition(
                body.__name__, _signature(body, 2), body, None, preconditions, invariants, here()
            )
            return self._defined(define(Behavior, definition, body.__doc__, body.__module__))

        return make

    def monitor(self) -> Callable[[Callable[..., Any]], Any]:
        """Return a monitor definition; the function takes the instance and the arguments."""

        def make(body: Callable[..., Any]) -> Any:
            definition = Definition(body.__name__, _signature(body, 1), body, span=here())
            return self._defined(define(Monitor, definition, body.__doc__, body.__module__))

        return make

    def scenario(
        self,
        preconditions: Sequence[Guard],
        invariants: Sequence[Guard],
        compose: Callable[..., Any] | None,
        sets_up: bool,
    ) -> Callable[[Callable[..., Any]], Any]:
        """Return a scenario definition, given guards and compose block; the function is its set-up, which may be empty."""

        def make(setup: Callable[..., Any]) -> Any:
            definition = Definition(
                setup.__name__,
                _signature(setup, 1),
                compose,
                setup,
                preconditions,
                invariants,
                here(),
                sets_up,
            )
            return self._defined(define(ModularScenario, definition, setup.__doc__, setup.__module__))

        return make

    def _defined(self, cls: Any) -> Any:
        if self._run is None:
            self._program.invocables.append(cls)
        return cls

    # Statements that take time; `instance` is what runs

    def take(self, instance: Invocable, *actions: Any) -> Yielded:
        """Return what ``take`` yields, or ``wait``, which takes nothing."""
        instance._activation.direct = True
        if len(actions) == 1 and isinstance(actions[0], list | tuple):
            actions = tuple(actions[0])
        if any(map(is_lazy, actions)):
            return tuple(self.at_present(action) for action in actions)
        return actions

    def terminate(self, instance: Invocable, *, simulation: bool) -> Yielded:
        """Return what ``terminate`` yields."""
        instance._activation.direct = True
        return Termination(simulation=simulation, span=here())

    def do(
        self, instance: Invocable, targets: Sequence[object], limit: object = None, unit: str | None = None
    ) -> Any:
        """Return what ``do`` delegates to."""
        return statements.do(instance._activation, targets, limit, unit)

    def wait(self, instance: Invocable, limit: object, unit: str) -> Any:
        """Return what ``wait for`` and ``wait until`` delegate to."""
        return statements.wait(instance._activation, limit, unit)

    def do_choose(self, instance: Invocable, *targets: Any) -> Any:
        """Return what ``do choose`` delegates to."""
        return statements.choose(instance._activation, targets)

    def do_shuffle(self, instance: Invocable, *targets: Any) -> Any:
        """Return what ``do shuffle`` delegates to."""
        return statements.shuffle(instance._activation, targets)

    def interruptible(
        self,
        instance: Invocable,
        body: Callable[[], Any],
        clauses: Sequence[tuple[Callable[[], Any], Callable[[], Any]]],
    ) -> Any:
        """Return what ``try-interrupt`` delegates to."""
        return statements.interruptible(instance._activation, body, clauses)

    def leave(self, value: object) -> statements.BlockEnding:
        """Return how ``return value`` ends a block of ``try-interrupt``."""
        return statements.BlockEnding("return", value)

    def returned(self, outcome: statements.BlockEnding | None) -> bool:
        """Return whether a block ended by ``return``."""
        return outcome is not None and outcome.way == "return"

    def margin(self, symbols: Sequence[str], operands: Sequence[object]) -> float | None:
        """Return by how much ``a < b <= c`` or the like holds, the least of its parts; ``None`` where that is not known."""
        from scenic.runtime.dynamics.margins import margin

        return margin(symbols, operands)

    def at_present(self, value: object) -> Any:
        """A value, at the present place of the agent whose behavior is running; in monitors and compose blocks, of the ego.

        In the set-up of a scenario it stays lazy: it may be about an object that is made there.
        """
        if not is_lazy(value):
            return value
        run = self._run
        if run is None or run.may_create:
            return value
        instance = next(
            (item for item in (run.agent, run.current.ego, self._module.ego) if item is not None), None
        )
        if instance is None:
            return value
        try:
            return resolve(value, instance)
        finally:
            instance.__dict__.pop(MEMO, None)

    # Statements that do not

    def override(self, target: object, *specifiers: Any) -> None:
        """Execute ``override``."""
        run = self._run
        if run is None:
            from scenic.runtime.dynamics.overriding import override_before

            override_before(target, specifiers, mode_2d=self._context.mode_2d)
        else:
            run.current.overrides.apply(target, specifiers)

    def require_monitor(self, monitor: object, *, name: object = None) -> None:
        """Execute ``require monitor``."""
        if not isinstance(monitor, Monitor):
            from scenic.runtime.dynamics.scenarios import not_a_monitor

            raise not_a_monitor(monitor)
        use = MonitorUse(monitor, label_of(name) or _numbered("monitor"))
        if self._run is not None:
            self._run.current.add_monitor(use)
        else:
            self._program.declared.monitors.append(use)

    def terminate_when(
        self, concrete: Callable[..., Any], captured: Sequence[object], *, simulation: bool, name: object
    ) -> None:
        """Execute ``terminate when``."""
        label = label_of(name) or _numbered("termination condition")
        self._declared.ends.append(End(Closure(concrete, captured), label, simulation))

    def terminate_after(self, value: object, unit: str) -> None:
        """Execute ``terminate after``."""
        if not is_number(value) or isinstance(value, bool):
            raise ScenicTypeError(
                f"`terminate after`: expected a fixed number of {unit}, not {describe(value)}",
                span=here(),
                help="write a number, or one that is computed of fixed numbers alone",
            )
        self._declared.limits.append((value, unit))

    def record(
        self,
        concrete: Callable[..., Any],
        captured: Sequence[object],
        *,
        moment: str | None,
        name: object,
        every: tuple[Any, str] | None = None,
        after: tuple[Any, str] | None = None,
        to: object = None,
    ) -> None:
        """Execute ``record``."""
        from scenic.runtime.dynamics.recording import check_duration, check_target

        span = here()
        check_duration(every, "every", 0, span)
        check_duration(after, "after", 0, span)
        check_target(to, span)
        key = label_of(name) or ("record" if span is None else f"record{span.line}")
        closure = Closure(concrete, captured)
        self._declared.records.append(
            RecordUse(closure, moment, key, every, after, to, span, self._module.filename)
        )

    @property
    def _declared(self) -> Any:
        run = self._run
        return self._program.declared if run is None else run.current.declared

    def _require_now(self, requirement: Required, chance: float) -> None:
        """Execute ``require`` while values are definite: a temporal condition is followed from now on, any other is checked immediately."""
        run, context = self._run, self._context
        if run is not None and is_temporal(requirement.formula):
            run.current.require(requirement)
            return
        if chance < 1 and (context.generator is None or context.generator.random() >= chance):
            return
        from scenic.runtime.temporal.monitors import FormulaMonitor as Follower

        before, context.evaluating = context.evaluating, True
        try:
            verdict = Follower(requirement.formula).add(lambda index: bool(requirement.atoms[index]()))
        finally:
            context.evaluating = before
        if not verdict:
            raise (RejectionException if run is None else RejectSimulationException)(
                f"{requirement.label} is violated"
            )


def _numbered(what: str) -> str:
    span = here()
    return what if span is None else f"{what} on line {span.line}"


def _signature(function: Callable[..., Any], own: int) -> inspect.Signature:
    """Return the signature of a definition, without the parameters that the compiler adds."""
    signature = inspect.signature(function)
    return signature.replace(parameters=list(signature.parameters.values())[own:])
