"""Running scenarios: prepared, started, stepped, stopped (section 12.5 of the specification)."""

import inspect
import math
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from scenic.language.errors import (
    InvalidScenarioError,
    InvariantViolation,
    ScenicTypeError,
)
from scenic.runtime.description.declarations import Declared, End, MonitorUse, Required
from scenic.runtime.description.definitions import Guard, ModularScenario, Monitor
from scenic.runtime.dynamics.activations import Activation, Termination, Yielded
from scenic.runtime.dynamics.guards import Guarded
from scenic.runtime.dynamics.overriding import Overrides
from scenic.runtime.dynamics.recording import Recording
from scenic.runtime.dynamics.requirements import Followed
from scenic.runtime.dynamics.statements import limit_in_steps
from scenic.runtime.ground.context import here
from scenic.runtime.python.samples import mentions
from scenic.runtime.values.values import describe

if TYPE_CHECKING:
    from scenic.runtime.dynamics.run import Run

__all__ = ["ScenarioActivation"]


class ScenarioActivation(Guarded):
    """One run of a scenario.

    Args:
        run: the simulation.
        instance: the scenario; ``None`` for a program that is one scenario as a whole.
        parent: what started it; ``None`` for the top-level scenario.

    """

    composes = True

    def __init__(
        self, run: "Run", instance: ModularScenario | None, parent: "ScenarioActivation | None"
    ) -> None:
        if instance is not None and instance._activation is not None:
            raise InvalidScenarioError(
                f"scenario {instance!r} has been run already",
                span=here(),
                help=f"create one for each use: `{instance._definition.name}(...)`",
            )
        super().__init__(run, instance)
        self.parent = parent
        self.ego: Any = None if parent is None else parent.ego
        self.workspace: Any = None if parent is None else parent.workspace
        self.objects: list[Any] = []
        self.agents: list[Any] = []
        self.awaited: list[Any] | None = None
        """Objects that enter the simulator at the end of the set-up, where that may mutate them."""
        self.agent = None
        self.scenario = self
        self.declared = Declared()
        self.followed: list[Followed] = []
        self.monitors: list[Activation] = []
        self.records: list[Recording] = []
        self.overrides = Overrides(run)
        self.direct = True
        self.running = False
        self.reason: str | None = None
        """The reason why the scenario stopped."""
        self.timed_out = False
        """True if a ``terminate after`` stopped it."""
        self.number = run.number_of(self)
        self._elapsed = 0
        self._limit = math.inf
        self._compose: Generator[Yielded, None, Any] | None = None
        self._resumed = False

    # Beginning

    def start(self) -> None:
        """Prepare and start: guards, set-up, then the compose block, behaviors, monitors and records."""
        self.check_all()
        if self.instance is not None and self.parent is not None:
            self.instance._activation = self
            arguments = self.instance._arguments
            definition = self.instance._definition
            setup = self.run.copies.value(definition.setup)
            if mentions(setup.__code__, "mutate"):
                self.awaited = []
            with self.run.setting_up(self, counts=definition.sets_up):
                setup(self.instance, *arguments.args, **arguments.kwargs)
                self.run.enter_awaited(self)
        self.go()

    def go(self) -> None:
        """Start what has been set up."""
        run = self.run
        body = None if self.instance is None else self.instance._definition.body
        if body is not None:
            assert self.instance is not None
            if not inspect.isgeneratorfunction(body):
                definition = self.instance._definition
                raise InvalidScenarioError(
                    f"the compose block of scenario {definition.name!r} never waits",
                    help="use `do`, `wait` or `terminate` in it",
                ).at((definition.span, body.__code__.co_filename))
            self._compose = run.copies.value(body)(self.instance)
        timestep = run.simulation.timestep
        self._limit = min(
            (limit_in_steps(*limit, timestep, "`terminate after`") for limit in self.declared.limits),
            default=math.inf,
        )
        self.running = True
        run.scenarios.append(self)
        # The set-up may have given or taken a behavior after it has made an object.
        self.agents = [obj for obj in self.objects if obj.behavior is not None]
        for agent in self.agents:
            run.start_behavior(agent, self)
        for use in self.declared.monitors:
            self._start_monitor(use)
        self.records = [Recording(record, run) for record in self.declared.records]

    def require(self, requirement: Required) -> None:
        """Follow a requirement from the present step on."""
        followed = Followed(requirement, self.run)
        self.followed.append(followed)
        if self.running:
            followed.follow()

    def add_monitor(self, use: MonitorUse) -> None:
        """Run a monitor from the start, or from now on."""
        if not isinstance(use.monitor, Monitor):
            raise not_a_monitor(use.monitor)
        self.declared.monitors.append(use)
        if self.running:
            self._start_monitor(use)

    def _start_monitor(self, use: MonitorUse) -> None:
        activation = Activation(self.run, use.monitor, None, self)
        activation.start()
        self.monitors.append(activation)

    def _ask(self, guard: Guard) -> Any:
        with self.run.within(self), self.run.guard():
            return guard(self.instance)

    # Every step

    def resume(self) -> Yielded | None:
        """Take one step; ``None`` if the scenario has ended. Raises what its code raises."""
        if not self.running:
            return None
        run = self.run
        for requirement in self.followed:
            requirement.follow()
        if self._elapsed >= self._limit:
            self.timed_out = True
            return self._stopped("reached time limit")
        self._elapsed += 1
        if self.invariants or self._compose is not None:
            with run.within(self):
                has_stopped = self._go_on()
            if has_stopped:
                return None
        for end in self.declared.ends:
            if not end.simulation and self.holds(end):
                return self._stopped(end.label)
        return ()

    def _go_on(self) -> bool:
        """Check the invariants and resume the compose block; return whether that stopped the scenario."""
        violation: InvariantViolation | None = None
        if self.invariants and self.direct and (self._resumed or self._compose is None):
            try:
                self.check_invariants()
            except InvariantViolation as error:
                if self._compose is None:
                    raise
                violation = error
        if self._compose is None:
            return False
        self._resumed = True
        try:
            # A violation is raised where the block waits: there, or further out, it may be caught.
            output = next(self._compose) if violation is None else self._compose.throw(violation)
        except StopIteration:
            self.stop("finished compose block")
            return True
        if isinstance(output, Termination):
            if not output.simulation:
                self.stop(output.reason)
                return True
            self.run.end(output.reason)
        return False

    def holds(self, end: End) -> bool:
        """Return whether the condition of a ``terminate when`` holds."""
        return bool(self.run.evaluated(end.condition, self))

    # End

    def _stopped(self, reason: str) -> Yielded | None:
        """Stop within a step, which yields nothing then."""
        self.stop(reason)
        return None

    def stop(self, reason: str = "stopped") -> None:
        """End it, in this order: monitors, what its compose block runs, overrides, requirements, records."""
        if not self.running:
            return
        self.running = False
        self.reason = reason
        for monitor in self.monitors:
            monitor.stop()
        self.monitors = []
        compose, self._compose = self._compose, None
        if compose is not None:
            with self.run.within(self):
                compose.close()
        self.overrides.revert()
        self.run.scenarios.remove(self)
        for requirement in self.followed:
            requirement.finish()
        self.run.finish_records(self)
        if not self.agents:
            self.run.draws.forget(self.number)


def not_a_monitor(value: Any) -> Exception:
    """Return the error for something else where a monitor belongs."""
    is_class = isinstance(value, type) and issubclass(value, Monitor)
    hint = (
        f"write `require monitor {value.__name__}()`" if is_class else "monitors are defined with `monitor`"
    )
    return ScenicTypeError(
        f"`require monitor`: expected a monitor, not {describe(value)}", span=here(), help=hint
    )
