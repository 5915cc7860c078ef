"""One simulation as the language sees it: what runs, what has been drawn, and the procedure of a step (section 12.7)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

from scenic.language.errors import InvalidScenarioError, Located, RejectSimulationException
from scenic.language.spans import Span
from scenic.runtime.description.definitions import Behavior, Invocable, ModularScenario
from scenic.runtime.description.mutation import mutate_now
from scenic.runtime.description.outcome import Program
from scenic.runtime.dynamics.activations import Activation, Termination
from scenic.runtime.dynamics.copies import Copies
from scenic.runtime.dynamics.recording import Recording
from scenic.runtime.dynamics.requirements import Followed
from scenic.runtime.dynamics.run_context import RunContext
from scenic.runtime.dynamics.scenarios import ScenarioActivation
from scenic.runtime.dynamics.time_draws import Draws, Source
from scenic.runtime.ground.context import Locator, Namer, current, here, warn
from scenic.runtime.instances.objects import Object

__all__ = ["Ending", "Run", "Simulated"]


class Simulated(Protocol):
    """The part of a simulation that its run needs (`scenic.simulators.simulation.Simulation`)."""

    scene: Any
    name: str
    timestep: float
    currentTime: int
    objects: list[Any]
    agents: list[Any]
    records: dict[str, Any]

    def add(self, obj: object) -> None:
        """Create an object in the simulator."""

    def place_of(self, obj: object) -> Any:
        """Return where the program creates an object: span and file, each ``None`` if unknown."""

    def sense(self) -> None:
        """Let every object observe."""

    def look(self) -> None:
        """Let every sensor observe that has not been read."""

    def recordCurrentState(self) -> None:
        """Append to the trajectory."""

    def scheduleForAgents(self) -> Any:
        """The agents in the order in which they act."""

    def check_actions(self, agent: object, actions: tuple[Any, ...]) -> None:
        """Raise `InvalidScenarioError` for actions that cannot be taken together."""

    def act(self, actions: Mapping[Any, tuple[Any, ...]]) -> None:
        """Log and execute the actions of a step."""


class Ending:
    """The reason for which a simulation ends: the name of a member of ``TerminationType``, and a text."""

    __slots__ = ("kind", "reason")

    def __init__(self, kind: str, reason: str) -> None:
        self.kind = kind
        self.reason = reason


class Run:
    """The running program.

    Args:
        simulation: what it is part of.
        program: what was compiled.
        copies: the program's values in this simulation.
        source: of random numbers.
        locate: finds places of frames.
        name: names them, for the addresses of draws.
        mode_2d: whether the 2D compatibility mode is on.
        robustness: whether to follow by how much requirements hold, which needs memory for every step.
        keep_violations: whether a violated requirement is told, rather than rejects the simulation.
        keep_draws: whether to remember what was drawn.
        keep_files: whether to keep in memory, too, what is recorded to files.
        on_random: called for each random number that is used.

    """

    def __init__(
        self,
        simulation: Simulated,
        program: Program,
        copies: Copies,
        source: Source,
        locate: Locator,
        name: Namer,
        *,
        mode_2d: bool = False,
        robustness: bool = False,
        keep_violations: bool = False,
        keep_draws: bool = True,
        keep_files: bool = True,
        on_random: Callable[[], None] | None = None,
    ) -> None:
        self.simulation = simulation
        self.program = program
        self.copies = copies
        self.draws = Draws(
            source, self._where, lambda: simulation.currentTime, keep=keep_draws, on_random=on_random
        )
        self.context = RunContext(self, locate, name, mode_2d=mode_2d)
        self.wants_robustness = robustness
        self.keeps_violations = keep_violations
        self.keeps_files = keep_files
        self.failed_agent: Any = None
        """The agent whose behavior has raised an exception."""
        self.scenarios: list[ScenarioActivation] = []
        """The scenarios that run, in the order in which they started."""
        self.followed: list[Followed] = []
        self.modules: dict[Path, ModuleType] = {}
        """Modules of Scenic code that this simulation was the first to import, by path."""
        self.parameters: dict[str, Any] = {
            name: copies.value(value) for name, value in program.parameters.items()
        }
        self.agent: Any = None
        """The agent whose behavior is running."""
        self.ending: Ending | None = None
        self.unmet: RejectSimulationException | None = None
        """The rejection that is due because a requirement of a scenario failed while an exception stopped it;
        raised once the program has caught that exception."""
        self.in_first_setup = False
        """True if the set-up runs that is the first of the simulation: that of a program which only composes has been none."""
        self._has_set_up = program.top is None or program.top._definition.sets_up
        self._finished = False
        self._count = 0
        self._creating: ScenarioActivation | None = None
        self._new_agents: list[Any] = []
        self._numbers: dict[int, int] = {}
        self.recordings: list[Recording] = []
        """The recordings to files that have begun."""
        self.top = ScenarioActivation(self, None, None)
        self.current: ScenarioActivation = self.top

    # Where we are

    def number_of(self, _activation: ScenarioActivation) -> int:
        """A number for a scenario that is made ready, in order."""
        self._count += 1
        return self._count

    def _where(self) -> tuple[int, int | None, Any]:
        return (self.current.number, self._numbers.get(id(self.agent)), self.context.place_name())

    @contextmanager
    def active(self) -> Iterator[None]:
        """Code of the program runs within this."""
        token = current.set(self.context)
        try:
            yield
        finally:
            current.reset(token)

    @contextmanager
    def within(self, scenario: ScenarioActivation, *, creating: bool = False) -> Iterator[None]:
        """Code of a scenario runs within this; ``creating`` if it may create objects."""
        before, self.current = self.current, scenario
        allowed, self._creating = self._creating, scenario if creating else None
        try:
            yield
        finally:
            self.current = before
            self._creating = allowed

    @contextmanager
    def setting_up(self, scenario: ScenarioActivation, *, counts: bool) -> Iterator[None]:
        """The set-up of a scenario runs within this; ``counts`` if there is code of the program in it."""
        before, self.in_first_setup = self.in_first_setup, counts and not self._has_set_up
        self._has_set_up |= counts
        try:
            with self.within(scenario, creating=True):
                yield
        finally:
            self.in_first_setup = before

    @property
    def may_create(self) -> bool:
        """True if the code that runs may create objects: the set-up of a scenario may."""
        return self._creating is not None

    def evaluated(self, condition: Callable[[], Any], scenario: ScenarioActivation | None = None) -> Any:
        """Return the value of a condition, which draws and creates nothing; of one of a scenario, if given."""
        context = self.context
        before = context.evaluating, self.current, self._creating
        context.evaluating = True
        if scenario is not None:
            self.current, self._creating = scenario, None
        try:
            return condition()
        finally:
            context.evaluating, self.current, self._creating = before

    @contextmanager
    def guard(self) -> Iterator[None]:
        """A guard is evaluated within this, which creates nothing."""
        context = self.context
        before, context.guarding = context.guarding, True
        try:
            yield
        finally:
            context.guarding = before

    def holds(self, condition: Callable[[], Any]) -> bool:
        """Return whether a condition of an interrupt holds; one that reads a variable of a scenario that is not set yet does not."""
        context = self.context
        before = context.guarding
        context.guarding = True
        try:
            return bool(condition())
        except UnboundLocalError:
            return False
        except AttributeError as error:
            owner = getattr(error, "obj", None)
            if isinstance(owner, ModularScenario):
                return False
            if isinstance(owner, Invocable):
                raise NameError(
                    f"the variable {error.name!r} of {owner._kind} {owner._definition.name!r} is not set yet",
                    name=error.name,
                ) from error
            raise
        finally:
            context.guarding = before

    def activation(self, target: ModularScenario, parent: ScenarioActivation) -> ScenarioActivation:
        """A scenario, ready to be started by another one."""
        return ScenarioActivation(self, target, parent)

    # Objects and agents

    def create(self, instance: object) -> None:
        """Create a new instance of the running program."""
        instance.__dict__["_sample"] = self.copies  # Members read it where code of a simulator asks for them.
        scenario = self._creating
        if isinstance(instance, Object) and not instance.present:
            return
        if isinstance(instance, Object):
            if scenario is None:
                raise InvalidScenarioError(
                    "objects can be created during a simulation only in the setup of a scenario",
                    span=here(),
                    help="put the object into a scenario, and run it with `do` in a compose block",
                )
            scenario.objects.append(instance)
        if scenario is None or scenario.awaited is None:
            self._enter(instance)
        else:
            scenario.awaited.append(instance)

    def _enter(self, instance: Any) -> None:
        """A new instance gets its noise, and an object enters the simulator."""
        mutate_now(instance)
        if isinstance(instance, Object):
            self.simulation.add(instance)
            self._numbers[id(instance)] = len(self._numbers)

    def enter_awaited(self, scenario: ScenarioActivation) -> None:
        """The set-up of a scenario has ended: what it may have mutated enters the simulator."""
        awaited, scenario.awaited = scenario.awaited, None
        for instance in awaited or ():
            self._enter(instance)

    def check_mutable(self, targets: Sequence[object]) -> None:
        """Warn of objects that are in the simulator already, and stay where they are."""
        for target in targets:
            if id(target) in self._numbers:
                warn(
                    f"`mutate` has no effect on {target!r}, which the simulator has already",
                    help="mutate objects in the setup that creates them",
                )

    def start_behavior(self, agent: Any, scenario: ScenarioActivation) -> None:
        """Make the behavior of an agent ready for its first turn."""
        behavior = agent.behavior
        if behavior is None or (behavior._activation is not None and behavior._activation.agent is agent):
            return
        with self.within(scenario):
            try:
                Activation(self, behavior, agent, scenario).start()
            except InvalidScenarioError as error:
                error.at(self.simulation.place_of(agent))
                raise
        self.note_agent(agent)

    def note_agent(self, agent: object) -> None:
        """An object has a behavior."""
        if not any(known is agent for known in (*self.simulation.agents, *self._new_agents)):
            self._new_agents.append(agent)

    # The procedure

    def begin(self) -> None:
        """Start the top-level scenario, whose objects exist."""
        program, top, copies = self.program, self.top, self.copies
        top.ego = copies.value(program.ego)
        top.workspace = copies.value(program.workspace)
        top.declared = program.declared.within(copies)
        top.objects = list(self.simulation.objects)
        for number, obj in enumerate(top.objects):
            self._numbers[id(obj)] = number
            if isinstance(obj.behavior, type):
                # A random choice among classes of behaviors.
                obj.__dict__["behavior"] = obj.behavior()
        if program.top is not None:
            top.become(copies.value(program.top))
            top.instance._activation = top
        top.check_all()
        for requirement in program.requirements:
            if requirement.formula is not None and self.simulation.scene.enforces(requirement):
                top.require(requirement.formula.within(copies))
        top.go()

    def end(self, reason: str) -> None:
        """End the simulation, from a compose block."""
        self._remember("scenarioComplete", reason)

    def _remember(self, kind: str, reason: str) -> None:
        if self.ending is None:
            self.ending = Ending(kind, reason)

    def steps(self, max_steps: int | None) -> Iterator[None]:
        """Run the steps of the simulation; yields when the simulator has to advance. At the end ``ending`` has the reason."""
        simulation, top = self.simulation, self.top
        while True:
            # 1. Scenarios
            if top.running and top.resume() is None:
                # A limit of a scenario ends that scenario; one of a file alone ends the simulation by time.
                by_time = top.timed_out and top.instance is None
                self._remember("timeLimit" if by_time else "scenarioComplete", top.reason or "")
            if self.unmet is not None:
                raise self.unmet
            # 2. Sensors
            simulation.sense()
            # 3. Records
            self._record(simulation.currentTime)
            simulation.recordCurrentState()
            # 4. Monitors
            self._monitors()
            # 5. Is it over?
            if self.ending is None:
                self._end_conditions()
            if max_steps is not None and simulation.currentTime >= max_steps:
                self._remember("timeLimit", f"reached time limit ({max_steps} steps)")
            if self.ending is not None:
                return
            # 6. Behaviors
            actions = self._behaviors()
            if actions is None:
                return
            # 7. Actions; whoever runs this then lets the simulator advance and reads back
            simulation.act(actions)
            if top.instance is not None:  # compose blocks read the observations of the last step
                simulation.look()
            yield

    def _record(self, step: int) -> None:
        records = self.simulation.records
        # The top-level scenario may have stopped in this step, which belongs to it.
        top = self.top
        for scenario in [top, *[each for each in self.scenarios if each is not top]]:
            if not scenario.records:
                continue
            before, self.current, self._creating = (self.current, self._creating), scenario, None
            try:
                for recording in scenario.records:
                    if recording.use.moment == "initial" and not recording.begun:
                        recording.add(step, records)
                for recording in scenario.records:
                    if recording.use.moment is None:
                        recording.add(step, records)
            finally:
                self.current, self._creating = before

    def finish_records(self, scenario: ScenarioActivation) -> None:
        """A scenario has stopped: its final values, and its files. Those of the top-level scenario come last."""
        if scenario is not self.top or self._finished:
            with self.within(scenario):
                for recording in scenario.records:
                    if recording.use.moment == "final":
                        recording.add(self.simulation.currentTime, self.simulation.records)
                    recording.finish()

    def _monitors(self) -> None:
        """Resume all monitors; only then stop scenarios, so that every monitor sees the step, whatever the other monitors do."""
        reasons: dict[ScenarioActivation, str] = {}
        end: str | None = None
        for scenario in list(self.scenarios):
            if not scenario.monitors:
                continue
            finished_monitors = []
            # What a monitor asks for while it runs is a monitor of this step, too.
            for monitor in scenario.monitors:
                with self.within(scenario):
                    output = monitor.resume()
                if output is None:
                    finished_monitors.append(monitor)
                elif isinstance(output, Termination):
                    # Of several requests the last one gives the reason.
                    if output.simulation:
                        end = output.reason
                    else:
                        reasons[scenario] = output.reason
            if finished_monitors:
                scenario.monitors = [
                    monitor for monitor in scenario.monitors if monitor not in finished_monitors
                ]
        if end is not None:
            self._remember("terminatedByMonitor", end)
        for scenario, reason in reasons.items():
            scenario.stop(reason)
            if scenario is self.top:
                self._remember("terminatedByMonitor", reason)

    def _end_conditions(self) -> None:
        for scenario in self.scenarios:
            for end in scenario.declared.ends:
                if end.simulation and scenario.holds(end):
                    self._remember("simulationTerminationCondition", end.label)
                    return

    def _behaviors(self) -> dict[Any, tuple[Any, ...]] | None:
        """Return the actions of each agent in this step; ``None`` if a behavior ends the simulation."""
        simulation = self.simulation
        simulation.agents.extend(self._new_agents)
        self._new_agents = []
        for agent in simulation.agents:
            agent.__dict__["lastActions"] = ()
        turns: list[tuple[Any, tuple[Any, ...]]] = []
        agents = simulation.agents
        schedule = simulation.scheduleForAgents()
        if schedule is not agents:
            schedule = list(schedule)
            if schedule != agents and sorted(map(id, schedule)) != sorted(map(id, agents)):
                raise RuntimeError("the simulator's schedule does not hold all agents, and nothing else")
        for agent in tuple(schedule):
            actions = self._turn(agent)
            if actions is None:
                return None
            # Agents that decide later may look at it.
            agent.__dict__["lastActions"] = tuple(actions)
            turns.append((agent, actions))
        if schedule is not agents:
            # In the order of the agents, whatever the schedule was.
            places = {id(agent): place for place, agent in enumerate(agents)}
            turns.sort(key=lambda turn: places[id(turn[0])])
        # Agents whose behavior was taken back, as the override that gave it ended, are none any more.
        return {agent: actions for agent, actions in turns if actions or agent.behavior is not None}

    def _turn(self, agent: Any) -> tuple[Any, ...] | None:
        behavior: Behavior | None = agent.behavior
        activation: Activation | None = None if behavior is None else behavior._activation
        if activation is None or activation.agent is not agent:
            # It has ended; another agent may do it since.
            return ()
        before, self.current = self.current, activation.scenario
        self.agent = agent
        try:
            output = activation.resume()
        except Exception:
            self.failed_agent = agent
            raise
        finally:
            self.current = before
            self.agent = None
        if output is None:
            return ()
        if isinstance(output, Termination):
            if output.simulation:
                self._remember("terminatedByBehavior", output.reason)
                return None
            scenario = activation.scenario
            scenario.stop(output.reason)
            if scenario is self.top:
                self._remember("terminatedByBehavior", output.reason)
                return None
            return ()
        if output:
            try:
                self.simulation.check_actions(agent, output)
            except Located as error:
                error.at(self._waits_at(activation))
                raise
        return output

    def _waits_at(self, activation: Activation) -> tuple[Span | None, str | None]:
        """The place of the code of a behavior that has yielded: span and file."""
        frame = getattr(activation.generator, "gi_frame", None)
        return (None, None) if frame is None else (self.context.locator(frame), frame.f_code.co_filename)

    # The end

    def finish(self) -> None:
        """Stop scenarios that still run, newest first, evaluate what is recorded at the end, and let behaviors clean up."""
        top = self.top
        for scenario in reversed(list(self.scenarios)):
            scenario.stop("simulation ended")
        self._finished = True
        self.finish_records(top)
        for obj in self.simulation.objects:
            behavior = obj.behavior
            if isinstance(behavior, Behavior) and behavior._activation is not None:
                behavior._activation.stop()

    def abandon(self) -> None:
        """Give up after a rejection or an error: close what is open and remove what was recorded."""
        for scenario in reversed(list(self.scenarios)):
            scenario.followed = []
            scenario.records = []
            _quietly(scenario.stop)
        for recording in self.recordings:
            _quietly(recording.cancel)
        for obj in self.simulation.objects:
            behavior = obj.__dict__.get("behavior")
            if isinstance(behavior, Behavior) and behavior._activation is not None:
                _quietly(behavior._activation.stop)


def _quietly(stop: Callable[[], None]) -> None:
    """Stop something; what its clean-up raises comes second to what ended the simulation."""
    with suppress(Exception):  # code of the program, run while another exception is on its way
        stop()
