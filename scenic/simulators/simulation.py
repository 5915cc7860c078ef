"""One simulation: the part of the interface that a simulator fills in, and what joins it to the running program."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import ExitStack
from types import FrameType
from typing import Any, ClassVar, Final, TypeAlias

from scenic.graph.kinds import Kind
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import (
    GuardViolation,
    InternalError,
    InvalidScenarioError,
    Located,
    RejectionException,
    RejectSimulationException,
    SimulationCreationError,
    StuckBehaviorError,
    annotate,
)
from scenic.language.spans import Span
from scenic.language.spelling import nearest_attribute
from scenic.runtime.description.definitions import running_in
from scenic.runtime.dynamics.chosen_draws import Sourcing
from scenic.runtime.dynamics.copies import Copies
from scenic.runtime.dynamics.run import Ending, Run
from scenic.runtime.elements.sensors import Sensor
from scenic.runtime.ground.missing_items import missing_item
from scenic.runtime.ground.reported_places import Place, argument_span, is_library, reported
from scenic.runtime.instances.properties import Finals
from scenic.runtime.python.random_state import is_as, preserved, restore, seed_globals, states
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.ownership import PRELUDE
from scenic.runtime.values.values import Orientation, Vector, describe, kind_of
from scenic.simulators.replays import Replay, Tape, fresh_key
from scenic.simulators.results import (
    ActionsTaken,
    Latest,
    SimulationResult,
    SimulationState,
    TerminationType,
    kept,
)
from scenic.simulators.step_watchdog import Watch, patience

__all__ = ["OnState", "Poses", "Simulation"]

Poses: TypeAlias = tuple[tuple[Any, Any], ...]
"""Position (metres) and orientation of each object in one state."""

OnState: TypeAlias = Callable[["Simulation", Poses, ActionsTaken], None]
"""Called for each state of a simulation with what was then done, before the simulator advances."""


def _tape(replay: bytes | None, key: bytes | None, **options: Any) -> Tape:
    """Return the tape of a simulation: of an earlier one, with its key, where there is one."""
    earlier = None if replay is None else Replay.decoded(replay)
    if earlier is not None:
        key = earlier.key
    return Tape(earlier, key=fresh_key() if key is None else key, **options)


class Simulation(ABC):
    """One run of a scene; it has run when the constructor returns.

    A simulator's subclass provides `createObjectInSimulator`, `step` and `getProperties`, and passes the keywords that it does
    not know to this constructor.

    Args:
        scene: what to simulate.
        maxSteps: largest number of steps; ``None`` for no limit.
        name: of the simulation, for files and messages.
        timestep: seconds in a step (1 if ``None``).
        replay: the bytes of an earlier simulation's `getReplay`, whose random draws are used again.
        enableReplay: keep the data that `getReplay` needs.
        allowPickle: accepted for compatibility; replays contain numbers only.
        enableDivergenceCheck: whether to keep the dynamic properties of all steps, and to compare with those of a replay.
        divergenceTolerance: largest difference between numbers that is not a divergence.
        continueAfterDivergence: continue with new draws after a divergence, rather than raise `DivergenceError`.
        verbosity: what to print, 3 for objects, steps and actions.
        key: decides all random draws; drawn from Python's ``random`` if ``None``.
        source: function that returns the source of random numbers, given the source that hashes with the key; ``None`` for the latter.
        robustness: compute the robustness of the requirements.
        keep_violations: let a simulation in which a requirement is violated run to its end, rather than reject it.
        stuck_after: seconds that the program's code may run in one step before `StuckBehaviorWarning` names its line; 0 for ever,
            `patience` by default.
        stuck_is_error: raise `StuckBehaviorError` then.
        keep_course: keep all states and actions, and records in files. If false, only other records need more memory with
            each step, and the result contains the last state and the last actions.
        keep_poses: keep position and orientation of every object at every step in `poses`.
        on_state: called for each state.
        on_random: called when a random number is used, of a distribution or of Python's or NumPy's global generators.
        deferred: do not run now: the caller calls `begin`, then `advanceOnce` until it returns false.

    Attributes:
        objects: the objects, first those of the scene. While the simulation runs they are copies, whose properties change; then
            again those of the scene.
        agents: those with behaviors.
        result: a `SimulationResult`, once the simulation has ended.
        records: the records so far.
        notes: step, number of the object, and what is noted of it, such as why its behavior ended; see `note`.
        currentTime: steps made.
        trajectory: the states so far.

    """

    _may_interrupt_steps: ClassVar[bool] = False
    """True if `step` bears interruptions by a signal."""

    def __init__(
        self,
        scene: Scene,
        *,
        maxSteps: int | None,
        name: str,
        timestep: float | None,
        replay: bytes | None = None,
        enableReplay: bool = True,
        allowPickle: bool = False,
        enableDivergenceCheck: bool = False,
        divergenceTolerance: float = 0,
        continueAfterDivergence: bool = False,
        verbosity: int = 0,
        key: bytes | None = None,
        source: Sourcing | None = None,
        robustness: bool = False,
        keep_violations: bool = False,
        stuck_after: float | None = None,
        stuck_is_error: bool = False,
        keep_course: bool = True,
        keep_poses: bool = False,
        on_state: OnState | None = None,
        on_random: Callable[[], None] | None = None,
        deferred: bool = False,
    ) -> None:
        self.result: SimulationResult | None = None
        self.scene = scene
        self.objects: list[Any] = []
        self.agents: list[Any] = []
        self.trajectory: list[Any] | Latest = [] if keep_course else Latest("state")
        self.poses: list[Poses] | None = [] if keep_poses else None
        self.actionSequence: list[ActionsTaken] | Latest = [] if keep_course else Latest("actions")
        self.records: dict[str, Any] = {}
        self.notes: list[tuple[int, int, str]] = []
        self.currentTime = 0
        self.timestep = 1 if timestep is None else timestep
        self.verbosity = verbosity
        self.name = name
        self.screen: Any = None
        self.worker_num = 0
        self._max_steps = maxSteps
        self._on_state = on_state
        self._now: Poses = ()
        self._enable_replay = enableReplay
        self._original = scene
        self._copies = Copies(scene.found.batch, scene.lane, scene.program.originals)
        self._properties: dict[type, tuple[str, ...]] = {}
        self._sets: dict[type, frozenset[str]] = {}
        self._finals: dict[type, Finals] = {}
        self._inputs: dict[int, tuple[Any, ...]] = {}
        self._adopted: dict[tuple[int, str], Any] = {}
        self._destroyed = False
        self._tape = _tape(
            replay,
            key,
            keep_draws=enableReplay,
            keep_states=enableDivergenceCheck,
            tolerance=divergenceTolerance,
            go_on=continueAfterDivergence,
            sourcing=source,
        )
        self._run = self._new_run(
            robustness=robustness,
            keep_violations=keep_violations,
            keep_draws=enableReplay,
            keep_files=keep_course,
            on_random=on_random,
        )
        self._tape.draws = self._run.draws
        self._watch = Watch(
            patience() if stuck_after is None else stuck_after,
            self._where_now,
            is_error=stuck_is_error,
            throughout=self._may_interrupt_steps,
        )
        self._isolated = _Isolated(self._run, self._watch)
        self._loop = self._whole()
        if not deferred:
            self.runToEnd()

    def _new_run(self, **options: Any) -> Run:
        program, context = self.scene.program, self.scene.program.context
        return Run(
            self,
            program,
            self._copies,
            self._tape.source,
            context.locator,
            context.namer,
            mode_2d=context.mode_2d,
            **options,
        )

    def note(self, agent: object, text: str) -> None:
        """Note something about an object at the present step, such as why its behavior ends; files of simulations contain notes."""
        number = next(number for number, thing in enumerate(self.objects) if thing is agent)
        self.notes.append((self.currentTime, number, text))

    # Running

    def runToEnd(self) -> None:
        """Run until the simulation ends."""
        with self._isolated:
            for _ in self._loop:
                pass

    def begin(self) -> None:
        """Set the scene up in the simulator and start the program."""
        with self._isolated:
            next(self._loop)

    def advanceOnce(self) -> bool:
        """Make one step; false once the simulation has ended."""
        with self._isolated:
            return next(self._loop, None) is not None

    def take(self, agent: object, actions: Sequence[object]) -> None:
        """Let an agent take actions from outside in the present step, on top of what its behavior has done.

        For simulations that are advanced step by step, before `advanceOnce`.

        Raises:
            InvalidScenarioError: the agent cannot take these actions in one step.

        """
        if not actions:
            return
        with self._isolated:
            self.check_actions(agent, tuple(actions))
            actions_of_step = self.actionSequence[-1]
            actions_of_step[agent] = (*actions_of_step.get(agent, ()), *actions)
            self.executeActions({agent: tuple(actions)})
            agent.__dict__["lastActions"] = actions_of_step[agent]

    @property
    def is_over(self) -> bool:
        """Return whether the simulation has ended or was given up."""
        return self._destroyed

    def end(self, reason: str) -> None:
        """End a simulation that is advanced step by step, in the present state."""
        self._run.ending = Ending("terminatedByUser", reason)
        self.advanceOnce()

    def cancel(self) -> None:
        """Give up a simulation that is advanced step by step: there is no result, and no file of its records remains."""
        with self._isolated:
            self._loop.close()
        self._destroy_once()

    def _whole(self) -> Generator[bool, None, None]:
        """The simulation from its set-up to its end, a step at a time."""
        run = self._run
        has_ended = False
        try:
            self.scene = self._original.within(self._copies)
            self.setup()
            run.begin()
            self._check_objects()
            self.updateObjects()
            yield True
            steps = run.steps(self._max_steps)
            while True:
                with self._watch:
                    going = next(steps, self) is not self
                if not going:
                    break
                yield True
                if run.ending is not None:  # somebody outside has ended it
                    break
                self._tell_state(self.actionSequence[-1])
                self.advance()
            self._tell_state(ActionsTaken())
            run.finish()
            self.conclude()
            assert run.ending is not None
            self._restore()
            self.result = SimulationResult(
                kept(self.trajectory),
                kept(self.actionSequence),
                TerminationType[run.ending.kind],
                run.ending.reason,
                self.records,
                [item.outcome for item in run.followed],
            )
            has_ended = True
        except Exception as error:
            self._say_where(error)
            raise
        finally:
            if not has_ended:
                run.abandon()
                self._restore()
            self._copies.release()
            self._destroy_once()

    def _where_now(self, frame: FrameType) -> tuple[str | None, str | None]:
        """Return the behavior, monitor or scenario whose code a frame runs, and the line of the program."""
        place = self._run.context.locator(frame)
        runner = running_in(frame)
        words = None if runner is None else f"{runner._kind} {runner._definition.name!r}"
        return words, None if place is None else f"line {place.line}"

    def _destroy_once(self) -> None:
        if not self._destroyed:
            self._destroyed = True
            for obj in self.objects:
                for sensor in obj.sensors.values():
                    if isinstance(sensor, Sensor):
                        sensor.forget()
            self.destroy()

    def _say_where(self, error: Exception) -> None:
        """Give an exception of the program its place."""
        context, traceback = self._run.context, error.__traceback__
        place = None if traceback is None else context.place_of(traceback)
        filename = None
        while traceback is not None:
            if PRELUDE in traceback.tb_frame.f_globals:
                filename = traceback.tb_frame.f_code.co_filename
            traceback = traceback.tb_next
        own_place = context.program_place(error.__traceback__), context.filename
        if own_place[0] is None and self._run.failed_agent is not None:
            own_place = self._place_of_behavior(self._run.failed_agent, error)
        elif getattr(error, "argument", None) is not None:
            own_place = self._place_of_argument(error) or own_place
        if isinstance(error, Located):
            raise_place = error.span or place, error.filename or filename
            (error.span, error.filename), error.labels = reported(raise_place, own_place)
        elif isinstance(error, RejectionException):
            error.add_note(self._details(error, own_place[0] or place))
        elif place is not None and not isinstance(error, RejectSimulationException | GuardViolation):
            (span, filename), labels = reported((place, filename), own_place)
            near = nearest_attribute(error)
            words = f"{type(error).__name__}: {error}"
            hint = "the program raised this exception during a simulation"
            if labels and is_library(labels[0].filename or ""):
                hint = "the library raised this exception during a simulation: check what it is given here"
            hint = f"did you mean `{near}`?" if near else missing_item(error, context) or hint
            if isinstance(error, StuckBehaviorError):
                words, hint = str(error), "if it only computes for long, allow it more time (`--step-limit`)"
            diagnostic = Diagnostic("SC400", words, span, filename=filename, help=hint, labels=labels)
            line = place.line if span is None else span.line
            annotate(
                error, diagnostic, f"{filename}:{line}: raised at step {self.currentTime} of a simulation"
            )

    def _place_of_behavior(self, agent: Any, error: Exception) -> Place:
        """The argument of an agent's behavior that an exception is about; else the behavior, else the agent."""
        behavior = agent.behavior
        return (None if behavior is None else self._place_in_call(behavior, error)) or self.place_of(agent)

    def _place_of_argument(self, error: Exception) -> Place | None:
        """The argument of the library's behavior that the program does, which an exception is about; ``None`` if that is not known."""
        traceback = error.__traceback__
        while traceback is not None:
            behavior = running_in(traceback.tb_frame)
            place = None if behavior is None else self._place_in_call(behavior, error)
            if place is not None:
                return place
            traceback = traceback.tb_next
        return None

    def _place_in_call(self, behavior: Any, error: Exception) -> Place | None:
        """The argument that an exception is about in the call that makes a behavior; the call where the argument is not seen in it."""
        context, span = self._run.context, getattr(behavior, "_place", None)
        quotation = None if span is None else context.quote(span)
        if span is None or quotation is None:
            return None
        parameters = list(behavior._definition.signature.parameters)
        name = getattr(error, "argument", None)
        return argument_span(span, quotation[1], parameters, name), context.filename

    def _details(self, error: RejectionException, place: Span | None) -> str:
        """Return the object that a rejection is about, the time and the line of the program, in words."""
        subject = error.subject
        parts = []
        if subject is not None:
            span, _ = self.place_of(subject)
            pairs = zip(self.objects, self._original.objects, strict=False)
            names = self._original.names
            name = next((names.get(original) for item, original in pairs if item is subject), None)
            name = name or str(subject)
            parts.append(name if span is None else f"{name} (line {span.line})")
        parts.append(f"at {self.currentRealTime:g} s")
        if place is not None:
            parts.append(f"line {place.line}")
        return ", ".join(parts)

    def _restore(self) -> None:
        """Replace the copies that the simulation has changed by the scene's own objects."""
        copies = list(self.scene.objects) if self.scene is not self._original else []
        back = {id(copy): item for copy, item in zip(copies, self._original.objects, strict=False)}
        self.objects = [back.get(id(item), item) for item in self.objects]
        self.agents = [back.get(id(item), item) for item in self.agents]
        for step in kept(self.actionSequence):
            original_actions = {back.get(id(agent), agent): actions for agent, actions in step.items()}
            step.clear()
            step.update(original_actions)
        self.scene = self._original

    # What a simulator provides

    def setup(self) -> None:
        """Set the simulation up; creates the scene's objects. Overrides call this one."""
        for obj in self.scene.objects:
            self.add(obj)

    @abstractmethod
    def createObjectInSimulator(self, obj: object) -> None:
        """Create an object; raises `SimulationCreationError` if that is impossible."""

    @abstractmethod
    def step(self) -> None:
        """Advance by ``timestep`` seconds."""

    @abstractmethod
    def getProperties(self, obj: object, properties: object) -> Mapping[str, Any]:
        """Return the present values of exactly these properties of an object."""

    def scheduleForAgents(self) -> Sequence[Any]:
        """The agents, in the order in which they choose their actions."""
        return self.agents

    def actionsAreCompatible(self, agent: object, actions: Sequence[object]) -> bool:
        """Return whether an agent can take these actions in one step."""
        for action in actions:
            if action is not None and not (hasattr(action, "canBeTakenBy") and action.canBeTakenBy(agent)):
                return False
        return True

    def executeActions(self, allActions: Mapping[Any, Sequence[Any]]) -> None:
        """Execute the actions of all agents; ``None`` is taken, and does nothing."""
        for agent, actions in allActions.items():
            for action in actions:
                if action is not None:
                    action.applyTo(agent, self)

    def currentState(self) -> Any:
        """The present state for the trajectory: positions and orientations of the objects."""
        return SimulationState(
            tuple([obj.position for obj in self.objects]), tuple([obj.orientation for obj in self.objects])
        )

    def valuesHaveDiverged(self, obj: object, prop: str, expected: object, actual: object) -> bool:
        """Return whether a property differs from the replayed simulation's by more than the tolerance."""
        return self._tape.differ(expected, actual)

    def destroy(self) -> None:  # noqa: B027 - most simulators have nothing to clean up
        """Clean up, once, however the simulation ended."""

    @property
    def currentRealTime(self) -> float:
        """Seconds simulated."""
        return self.currentTime * self.timestep

    # What the program calls

    def add(self, obj: Any) -> None:
        """Create an object in the simulator, and add it to the simulation."""
        if self.verbosity >= 3:
            self._tell(f"      Creating object {obj!r}")
        self.objects.append(obj)
        try:
            self.createObjectInSimulator(obj)
        except SimulationCreationError as error:
            error.at(self.place_of(obj))
            raise
        obj.startDynamicSimulation()
        if self._run.top.running:
            self._update(obj)

    _createObject = add

    def place_of(self, obj: object) -> tuple[Span | None, str | None]:
        """Return the span and file where the program creates an object, each ``None`` if unknown."""
        number = next((index for index, item in enumerate(self.objects) if item is obj), len(self.objects))
        if number < len(self._original.objects):
            return self._original.place(number)
        return self._original.program.places.get(id(obj), (None, None))

    def _tell(self, line: str) -> None:
        print(line)  # noqa: T201 - asked for by the user

    def sense(self) -> None:
        """Let every object with sensors observe."""
        for obj in self.objects:
            if obj.sensors:
                # Sensors that wait to be read stand for their observations, and the whole is made when it is read.
                obj.__dict__["_observed"] = {
                    name: sensor if getattr(sensor, "is_waiting", False) else sensor.getObservation()
                    for name, sensor in obj.sensors.items()
                }
                obj.__dict__.pop("observations", None)

    def conclude(self) -> None:
        """Do what is due at the end, while the objects are in their last state."""
        self.look()

    def look(self) -> None:
        """Let every sensor observe that has not been read in this step, since it may be read later."""
        for obj in self.objects:
            _ = obj.observations

    def recordCurrentState(self) -> None:
        """Append the state to the trajectory."""
        self.trajectory.append(self.currentState())
        if self.poses is not None or self._on_state is not None:
            self._now = tuple([(obj.position, obj.orientation) for obj in self.objects])
            if self.poses is not None:
                self.poses.append(self._now)

    def _tell_state(self, actions: ActionsTaken) -> None:
        if self._on_state is not None:
            self._on_state(self, self._now, actions)

    def check_actions(self, agent: object, actions: tuple[Any, ...]) -> None:
        """Raise `InvalidScenarioError` for actions that cannot be taken together."""
        if not self.actionsAreCompatible(agent, actions):
            listed = ", ".join(describe(action) for action in actions)
            raise InvalidScenarioError(
                f"agent {agent!r} cannot take these actions in one step: {listed}",
                help="actions derive from `Action`; see its `canBeTakenBy`, and the simulator's rules",
            )

    def act(self, actions: Mapping[Any, tuple[Any, ...]]) -> None:
        """Log and execute the actions of a step."""
        self.actionSequence.append(ActionsTaken(actions))
        if self.verbosity >= 3:
            self._tell(f"    Time step {self.currentTime}:")
            for agent, taken in actions.items():
                self._tell(f"      Agent {agent!r} takes action(s) {taken!r}")
        self.executeActions(actions)

    def advance(self) -> None:
        """One step of the simulator, after which properties are read back."""
        self.step()
        self.currentTime += 1
        self.updateObjects()

    # Dynamic properties

    def _dynamic(self, cls: type) -> tuple[str, ...]:
        """Return the properties that the simulator decides."""
        names = self._properties.get(cls)
        if names is None:
            entries = cls.scenic_properties.items()  # type: ignore[attr-defined] # classes of objects have them
            names = tuple(name for name, entry in entries if entry.dynamic and not entry.final)
            self._properties[cls] = names
            self._sets[cls] = frozenset(names)
            self._finals[cls] = Finals.of(cls.scenic_properties)  # type: ignore[attr-defined] # as above
        return names

    def _check_objects(self) -> None:
        present = {id(obj) for obj in self.objects}
        for obj in self.scene.objects:
            if id(obj) not in present:
                raise InternalError("setup() did not create all objects: it should call super().setup()")

    def updateObjects(self) -> None:
        """Read the dynamic properties of all objects back from the simulator."""
        self._tape.begin_state(self.currentTime)
        for obj in self.objects:
            self._update(obj)

    def _update(self, obj: object) -> None:
        cls = type(obj)
        names = self._dynamic(cls)
        values = self.getProperties(obj, set(names))
        if values.keys() != self._sets[cls]:
            wrong = set(names) ^ set(values)
            raise RuntimeError(
                f"simulator gave other properties of {obj!r} than it was asked for: {', '.join(sorted(wrong))}"
            )
        attributes = obj.__dict__
        for name in names:
            value, old = values[name], attributes[name]
            if value is not old:
                is_as_before = type(value) is type(old) and type(old) in _SIMPLE
                attributes[name] = value if is_as_before else self._checked(obj, name, old, value)
        finals = self._finals[cls]
        inputs = tuple([attributes[name] for name in finals.inputs])
        if inputs != self._inputs.get(id(obj)):
            # The simulator's angles are global where the object's own frame is turned.
            self._inputs[id(obj)] = inputs
            for entry in finals.builtin:
                attributes[entry.name] = entry.default(obj)
        finals.renew_own(obj)
        self._tape.note(self, obj, names)

    def _checked(self, obj: object, name: str, old: Any, value: Any) -> Any:
        """Return the value as the object stores it; raises ``RuntimeError`` for one of another type than before."""
        kind, old_kind = kind_of(value), kind_of(old)
        if (
            old_kind.is_number
            and old_kind is not Kind.BOOLEAN
            and kind.is_number
            and kind is not Kind.BOOLEAN
        ):
            return float(value) if type(old) is float else value
        if old_kind is kind and (not kind.is_boxed or old is None or isinstance(value, type(old))):
            return value
        if old is None:
            adopted_kind = self._adopted.setdefault((id(obj), name), kind)
            if adopted_kind is kind:
                return value
        raise RuntimeError(
            f"simulator gave property {name!r} of {obj!r} a value of type {type(value).__name__}, "
            f"where the type is {type(old).__name__}"
        )

    # Replay

    def getReplay(self) -> bytes:
        """The random draws of the simulation, with the data for detecting a divergence, as bytes.

        Raises:
            RuntimeError: the simulation ran with ``enableReplay=False``.

        """
        if not self._enable_replay:
            raise RuntimeError("there is no replay of a simulation that ran with enableReplay=False")
        return self._tape.replay().encoded()

    @property
    def replaying(self) -> bool:
        """Return whether draws of an earlier simulation are still used."""
        return self._tape.replaying


_SIMPLE: Final = frozenset({float, bool, Vector, Orientation})
"""Types whose values are all of one kind."""


class _Isolated:
    """Within this the simulation goes on: in the run's context, with Python's and NumPy's global generators for itself."""

    def __init__(self, run: Run, watch: Watch) -> None:
        self._run = run
        self._watch = watch
        self._states: Any = None
        self._before: Any = None
        self._open: ExitStack | None = None

    def __enter__(self) -> None:
        self._open = ExitStack()
        self._open.enter_context(self._run.active())
        self._open.enter_context(preserved())
        if self._states is None:
            seed_globals(self._run.draws.seed("global generators"))
        else:
            restore(self._states)
        self._before = states()

    def __exit__(self, *details: object) -> None:
        assert self._open is not None
        self._watch.release()
        if not is_as(self._before):
            self._run.draws.report_use()
        self._states = states()
        self._open.close()
