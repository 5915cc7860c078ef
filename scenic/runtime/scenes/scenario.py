"""A compiled scenario, from which scenes are sampled."""

import pickle
import random
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain, repeat
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NoReturn

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.domain import Domain
from scenic.graph.node import Graph
from scenic.graph.points import PointSet
from scenic.language.errors import (
    InvalidScenarioError,
    Located,
    RejectionException,
    SamplingError,
    annotate,
)
from scenic.language.spans import Span
from scenic.language.spelling import nearest_attribute
from scenic.runtime.description.declarations import Declared
from scenic.runtime.description.outcome import Program
from scenic.runtime.ground.arguments import check_limits, whole_number
from scenic.runtime.ground.choosable import Choosable
from scenic.runtime.ground.library_versions import own_version
from scenic.runtime.instances.objects import Object
from scenic.runtime.python.samples import dependencies
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.sampling.acceptance_rates import ComponentEstimate, estimate
from scenic.runtime.sampling.check_planning import Outline
from scenic.runtime.sampling.engine import Accepted, CandidateError
from scenic.runtime.sampling.profiling import Profile
from scenic.runtime.sampling.rejection_report import Approximation, Exhausted
from scenic.runtime.scenes.external_candidates import ExternalCandidates
from scenic.runtime.scenes.fingerprint import fingerprint
from scenic.runtime.scenes.generating import Generating
from scenic.runtime.scenes.pickled_values import ValueLayout
from scenic.runtime.scenes.population import Populations
from scenic.runtime.scenes.prefetching import SEED_BITS, Foreseen
from scenic.runtime.scenes.sampler import Sampler
from scenic.runtime.scenes.saving import draws_of
from scenic.runtime.scenes.scene import Scene, SceneFamily
from scenic.runtime.temporal.formulas import is_temporal

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from scenic.runtime.scenes.naming import DrawName


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis of the unit cube: one draw of the program, where it stands, and what it is called."""

    address: int
    span: Span | None
    name: "DrawName"


def _plain(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return options as JSON has them, without parameters that it cannot hold."""
    known: dict[str, Any] = {name: value for name, value in options.items() if name != "params"}
    params = {
        name: value
        for name, value in options.get("params", {}).items()
        if isinstance(value, str | int | float | bool | None)
    }
    return {**known, "params": params} if params else known


_KEPT: Final = frozenset({"_foreseen", "_external_candidates"})
"""Attributes of a scenario that conditions do not replace."""


def _is_drawn(region: Region, outline: Outline) -> bool:
    """Return whether scenes depend on every draw of a region; one on which none does is not drawn, and has no value."""
    return all(node in outline.graph.index for node in Graph(dependencies([region])).nodes if node.is_drawn)


class Scenario(Generating):
    """A compiled program, which samples scenes and simulates them.

    Made by `scenic.load` and by the established `scenarioFromFile` and `scenarioFromString`.
    """

    def __init__(
        self,
        program: Program,
        outline: Outline,
        *,
        filename: str,
        text: str,
        ego: Object | None,
        workspace: Workspace,
        names: Mapping[int, str],
        regions: Mapping[str, Region],
        sampler: Sampler,
        digest: Callable[[], str] = str,
        options: Mapping[str, object] = MappingProxyType({}),
    ) -> None:
        self.filename = filename
        self.text = text
        """The program's text."""
        self._digest = digest
        self.workspace = workspace
        self.egoObject = ego
        self.outline: Outline = outline
        self._program = program
        self.options = options
        """The keyword arguments of `scenic.load` with which the program was compiled."""
        self._regions = {name: region for name, region in regions.items() if _is_drawn(region, outline)}
        self._names = names
        self._sampler = sampler
        self._foreseen = Foreseen(self._foresee)
        self._choosing: Sampler | None = None
        self._external_candidates: ExternalCandidates | None = None
        self._draw_names: dict[int, DrawName] | None = None
        self._idle_draws: frozenset[int] | None = None
        self._approximation: Approximation | None = None
        self._family = SceneFamily(
            program,
            ego,
            Populations(self.objects, [*program.parameters.values(), *self._regions.values()], program.names),
            workspace,
            names,
            digest,
            self.sceneToBytes,
            ValueLayout(outline.outputs),
            self,
            self._regions,
        )
        self._unconditioned = {name: value for name, value in vars(self).items() if name not in _KEPT}

    def within(self, domain: Domain) -> "Scenario":
        """Return the same scenario, sampled from another part of the cube, which must contain all points that meet the requirements."""
        return type(self)(
            self._program,
            self.outline,
            filename=self.filename,
            text=self.text,
            ego=self.egoObject,
            workspace=self.workspace,
            names=self._names,
            regions=self._regions,
            sampler=Sampler(self.outline, domain),
            digest=self._digest,
            options=self.options,
        )

    @property
    def digest(self) -> str:
        """The digest of the program in saved scenes; made when it is first needed, from all of the text."""
        return self._digest()

    @property
    def objects(self) -> tuple[Object, ...]:
        """The objects of the program, whose properties may be random: the ego first, then in order of creation."""
        others = tuple(item for item in self._program.objects if item is not self.egoObject)
        return others if self.egoObject is None else (self.egoObject, *others)

    def variable(self, thing: Object) -> str | None:
        """Return the variable of the program that refers to one of the `objects`, if any."""
        return self._names.get(id(thing))

    @property
    def params(self) -> dict[str, Any]:
        """The global parameters, which may be random."""
        return dict(self._program.parameters)

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The axes of the unit cube that scenes are drawn from: the columns of `scenic.GivenPoints`."""
        graph, names = self.outline.graph, self.draw_names
        return tuple(
            Axis(address, node.span if isinstance(node.span, Span) else None, names[address])
            for node, address in ((node, graph.address(node)) for node in graph.axes)
        )

    @property
    def draw_names(self) -> "Mapping[int, DrawName]":
        """The names of the program's draws, by address."""
        from scenic.runtime.scenes.naming import names_of_draws

        if self._draw_names is None:
            self._draw_names = names_of_draws(self._program, self.outline.graph)
        return self._draw_names

    @property
    def idle_draws(self) -> frozenset[int]:
        """The addresses of the draws on which neither requirements nor simulations depend."""
        from scenic.runtime.scenes.idle_draws import idle_draws

        if self._idle_draws is None:
            self._idle_draws = idle_draws(self._program, self.outline.graph, self.text)
        return self._idle_draws

    def line_of(self, span: Span | None, thing: str) -> int | None:
        """Return the line of the program that a draw belongs to: of a draw in a library, the line that creates the thing's owner."""
        quotation = None if span is None else self._program.context.quote(span)
        if span is None or quotation is None or quotation[0] == self.filename:
            return None if span is None else span.line
        owner = next(
            (item for item, name in self.instance_names.items() if name == thing.partition(".")[0]), None
        )
        place, filename = self._program.places.get(owner or 0, (None, None))
        return place.line if place is not None and filename == self.filename else None

    @property
    def externals(self) -> Mapping[int, Choosable]:
        """The external parameters by the addresses of their draws, in the order in which the program makes them."""
        return self._program.context.record.externals

    @property
    def instance_names(self) -> Mapping[int, str]:
        """The names of all instances, by identity: the variable, else the class, with a number if there are several."""
        from scenic.runtime.scenes.naming import names_of_instances

        return names_of_instances(self._program)

    def chosen(
        self,
        numbers: Mapping[int, NDArray[np.float64]],
        count: int,
        *,
        seed: int,
        first: int = 0,
        max_attempts: int = 1,
    ) -> Iterator[Scene | Exhausted]:
        """Scenes ``first`` to ``first + count`` of a seed, in which some draws are given; the others are hashed.

        Args:
            numbers: numbers ``(count,)`` of the open unit interval, by address.
            count: how many scenes.
            seed: any integer.
            first: number of the first scene.
            max_attempts: candidates tried for one scene, all with the given numbers.

        """
        sampler = self._without_narrowing
        yield from self._scenes(
            sampler.chosen(numbers, count, seed=seed, first=first, max_attempts=max_attempts)
        )

    def of_draws(
        self,
        numbers: Mapping[int, NDArray[np.float64]],
        words: Mapping[int, NDArray[np.uint64]],
        count: int,
        *,
        seed: int,
        first: int = 0,
    ) -> Iterator[Scene | Exhausted]:
        """Scenes ``first`` to ``first + count`` of a seed all of whose draws are given, as `scenic.runtime.scenes.saving.draws_of` tells them.

        Args:
            numbers: numbers ``(count,)`` of the axes, by address.
            words: words ``(count,)`` of further draws, by address.
            count: how many scenes.
            seed: any integer.
            first: number of the first scene; it decides which soft requirements a scene has to meet.

        """
        yield from self._scenes(self._sampler.given(numbers, words, count, seed=seed, first=first))

    @property
    def _without_narrowing(self) -> Sampler:
        """The sampler for external parameters that are chosen, whose axes it leaves whole."""
        if self._choosing is None:
            self._choosing = self._sampler.without_narrowing(self.externals)
        return self._choosing

    @property
    def program(self) -> Program:
        """The results of running the program."""
        return self._program

    @property
    def requirements(self) -> tuple[Any, ...]:
        """The ``require`` statements, in program order."""
        return tuple(self._program.requirements)

    @property
    def domain(self) -> Domain:
        """The part of the unit cube that is sampled."""
        return self._sampler.plan.domain

    @property
    def approximation(self) -> Approximation | None:
        """The making of the approximate scenes that were sampled last, if there were any."""
        return self._approximation

    @property
    def impossible(self) -> tuple[str, ...]:
        """Labels of requirements that are proven to fail in every scene."""
        return self._sampler.impossible

    def estimates(self, *, seed: int, candidates: int) -> tuple[ComponentEstimate, ...]:
        """Estimates of how often candidates pass, for each independent component of the scenes, from a number of candidates of each at most."""
        with self._program.undisturbed():
            return estimate(self._sampler.engines, seed=seed, candidates=candidates)

    def prepare(self) -> None:
        """Do the one-time work that the first scene would otherwise wait for."""
        self._sampler.prepare()

    def stream(
        self,
        n: int,
        *,
        seed: int,
        first: int = 0,
        max_attempts: int | None = None,
        time_limit: float | None = None,
        lanes: int | None = None,
        source: PointSet | None = None,
        approximate: int | None = None,
    ) -> Iterator[Scene | Exhausted]:
        """Scenes ``first`` to ``first + n`` of a seed, in order, as they are found.

        Args:
            n: how many.
            seed: any integer; scene ``k`` of a seed is always the same.
            first: number of the first scene.
            max_attempts: candidates tried for one scene before it is given up as `Exhausted`.
            time_limit: seconds for all of them; scenes not found by then are `Exhausted`.
            lanes: candidates evaluated at a time. Changes speed and memory, never the scenes.
            source: the source of random numbers, if they are not hashed: `scenic.Sobol` for scenes that are spread evenly,
                `scenic.GivenPoints` for points of the cube that somebody chose. The words that key draws which take tries
                are hashed all the same.
            approximate: make so many scenes together, whose law comes the closer to the program's the more these are: for
                programs whose requirements rejection hardly ever meets. `Scene.approximation` tells how well that went. It
                goes without ``lanes``, ``source`` and ``time_limit``.

        Raises:
            SamplingError: if a requirement or property fails on a candidate; an exception of the program's own code keeps
                its type, and tells the place in a note.
            ValueError: for options that do not go together.

        """
        n, first = whole_number(n, "n", 0), whole_number(first, "first", 0)
        seed = whole_number(seed, "seed")
        check_limits(max_attempts, time_limit, lanes)
        if approximate is not None:
            if approximate < 2 or any(item is not None for item in (lanes, source, time_limit)):
                raise ValueError(
                    "approximate scenes are made two or more together, without `lanes`, `source` and `time_limit`"
                )
            yield from self._approximated(seed, first, n, approximate, max_attempts)
            return
        tasks = zip(repeat(seed), range(first, first + n))  # one of them has no end
        deadline = None if time_limit is None else time.monotonic() + time_limit
        results = self._sampler.find(
            tasks, max_attempts=max_attempts, deadline=deadline, lanes=lanes, source=source
        )
        yield from self._scenes(results)

    def _approximated(
        self, seed: int, first: int, n: int, together: int, max_attempts: int | None
    ) -> Iterator[Scene | Exhausted]:
        results = self._sampler.approximate(seed, first, n, lanes=together, max_attempts=max_attempts)
        for result in self._scenes(results):
            if isinstance(result, Scene):
                self._approximation = result.approximation
            yield result

    def _foresee(
        self, tasks: Iterable[tuple[int, int]], max_attempts: int, more: bool
    ) -> Iterator[Scene | Exhausted]:
        return self._scenes(self._sampler.foresee(tasks, max_attempts, more))

    def _scenes(self, results: Iterator[Accepted | Exhausted]) -> Iterator[Scene | Exhausted]:
        family = self._family
        try:
            while True:
                with self._program.undisturbed():
                    result = next(results, None)
                if result is None:
                    return
                if isinstance(result, Exhausted):
                    yield result
                else:
                    accepted_lanes, lane = result
                    yield self.scene_class(accepted_lanes, lane, family)
        except CandidateError as error:
            failure = error
        self._raise(failure)

    def _first_candidates(
        self, numbers: Mapping[int, NDArray[np.float64]], count: int, seed: int, first: int
    ) -> list[tuple[int, Accepted | CandidateError]]:
        with self._program.undisturbed():
            return self._without_narrowing.first_candidates(numbers, count, seed=seed, first=first)

    def _lanes_for(self, scenes: int) -> int:
        return self._without_narrowing.engine.lanes_for(scenes)

    def _scene_of(self, result: Accepted | CandidateError) -> Scene:
        if isinstance(result, CandidateError):
            self._raise(result)
        return self.scene_class(*result, self._family)

    def _raise(self, failure: CandidateError) -> NoReturn:
        problem = self._sampling_error(failure)
        if problem is failure.__cause__:
            raise problem  # which may have a cause of its own
        raise problem from failure.__cause__

    def sample(
        self,
        n: int = 1,
        *,
        seed: int | None = None,
        max_attempts: int | None = None,
        time_limit: float | None = None,
        lanes: int | None = None,
        source: PointSet | None = None,
        approximate: int | None = None,
        processes: int = 1,
        executor: "Executor | None" = None,
        settle: float | None = None,
        settle_keep: bool = False,
    ) -> list[Scene]:
        """``n`` scenes of a seed (drawn from Python's ``random`` if not given).

        Args:
            n: how many.
            seed: any integer; scene ``k`` of a seed is always the same.
            max_attempts: candidates tried for one scene before it is given up.
            time_limit: seconds for all of them.
            lanes: candidates evaluated at a time. Changes speed and memory, never the scenes.
            source: random numbers that are not hashed; see `stream`.
            approximate: scenes made together, of nearly the program's law; see `stream`. It goes without several processes.
            processes: how many processes look for scenes. Changes speed, never the scenes.
            executor: looks for scenes in place of processes of our own, ``processes`` ranges at a time.
            settle: seconds of a simulation in MuJoCo in which no object may move, as of `scenic.load`.
            settle_keep: give scenes the poses after that simulation instead.

        Raises:
            RejectionException: if a scene is not found within the limits; the message lists what rejected it.
            SamplingError: if a requirement or property fails on a candidate; an exception of the program's own code keeps
                its type, and tells the place in a note.

        """
        limits: dict[str, Any] = {
            "max_attempts": max_attempts,
            "time_limit": time_limit,
            "source": source,
            "executor": executor,
        }
        if settle is not None:
            other: Scenario = self._compiled_again({}, settle=(settle, 0.01, settle_keep))
            return other.sample(
                n, seed=seed, lanes=lanes, approximate=approximate, processes=processes, **limits
            )
        n = whole_number(n, "n", 0)
        processes = whole_number(processes, "processes", 1)
        start = random.getrandbits(SEED_BITS) if seed is None else whole_number(seed, "seed")
        check_limits(max_attempts, time_limit, lanes)
        if approximate is not None and (processes > 1 or executor is not None):
            raise ValueError("approximate scenes are made together, in one process")
        if processes > 1 or executor is not None:
            return list(self._in_processes(n, seed=start, processes=processes, **limits))
        scenes = []
        for result in self.stream(
            n,
            seed=start,
            max_attempts=max_attempts,
            time_limit=time_limit,
            lanes=lanes,
            source=source,
            approximate=approximate,
        ):
            if isinstance(result, Exhausted):
                raise RejectionException(result.message())
            scenes.append(result)
        return scenes

    def profile(
        self,
        n: int = 200,
        *,
        seed: int = 0,
        first: int = 0,
        max_attempts: int | None = None,
        time_limit: float | None = None,
        source: PointSet | None = None,
    ) -> Profile:
        """Sample scenes and return the profile of the time: by operation and line of the program, and by requirement.

        The arguments are those of `stream`. Scenes that are not found within the limits are left out.

        Raises:
            SamplingError: if a requirement or property fails on a candidate.

        """
        n, first = whole_number(n, "n", 0), whole_number(first, "first", 0)
        seed = whole_number(seed, "seed")
        check_limits(max_attempts, time_limit, None)
        deadline = None if time_limit is None else time.monotonic() + time_limit
        tasks = [(seed, k) for k in range(first, first + n)]
        try:
            with self._program.undisturbed():
                return self._sampler.profile(
                    tasks, max_attempts=max_attempts, deadline=deadline, source=source
                )
        except CandidateError as error:
            failure = error
        raise self._sampling_error(failure) from failure.__cause__

    @property
    def origin(self) -> dict[str, Any]:
        """The file of the program, those `options` that are plain data, and the version of this library: what it takes to load it again."""
        return {"file": self.filename, "options": _plain(self.options), "scenic": own_version()}

    @property
    def fingerprint(self) -> str:
        """Digest of the graph and of the narrowed domain; see `scenic.runtime.scenes.fingerprint`."""
        return fingerprint(self.outline.graph, self.domain)

    def found(
        self,
        seed: int,
        numbers: NDArray[np.int64],
        attempts: NDArray[np.int64],
        *,
        source: PointSet | None = None,
    ) -> Iterator[Scene]:
        """Scenes of a seed, given how many candidates each took.

        Only the accepted candidates are evaluated, and no requirement is checked again.

        Args:
            seed: their seed.
            numbers: which scenes of the seed, ``(n,)``.
            attempts: candidates tried for each, the accepted one included, ``(n,)``; of scenes put together from components
                ``(n, components)``, or scenes are looked for again.
            source: random numbers that are not hashed; see `stream`.

        Raises:
            ValueError: for numbers below 0, and scenes without a candidate.

        """
        seed = whole_number(seed, "seed")
        for name, values, least in (("numbers", numbers, 0), ("attempts", attempts, 1)):
            if not np.issubdtype(values.dtype, np.integer) or (values < least).any():
                raise ValueError(f"`{name}` must be integers of at least {least}, not {values.tolist()}")
        with self._program.undisturbed():
            pairs = self._sampler.accepted(seed, numbers, attempts, source)
        return (self.scene_class(found, lane, self._family) for found, lane in pairs)

    def _sampling_error(self, error: CandidateError) -> Exception:
        cause, check = error.__cause__, error.check
        if isinstance(cause, Located) and not isinstance(cause, SamplingError):
            cause.span = cause.span or check.span
            cause.filename = cause.filename or check.filename or self.filename
            return cause
        near = None if cause is None else nearest_attribute(cause)
        wrapper = SamplingError(
            f"{check.label} failed" + ("" if cause is None else f": {type(cause).__name__}: {cause}"),
            span=check.span,
            filename=check.filename or self.filename,
            help=f"did you mean `{near}`?"
            if near
            else "this came up in a sampled candidate; guard against the value, or reject it by a `require`",
        )
        if not isinstance(cause, Exception) or isinstance(cause, Located):
            return wrapper
        # The program's own exception keeps its type; a note tells where it came up.
        annotate(cause, wrapper.diagnostic(), f"{wrapper} (attempt {error.attempt} at scene {error.k})")
        return cause

    def validate(self) -> None:
        """Do nothing: fixed values are checked when the program is loaded."""

    def setSampleChecker(self, checker: object) -> None:
        """Do nothing: the order of checks follows their cost and rejections."""

    # Scenes as data

    @cached_property
    def recipe_bytes(self) -> bytes:
        """The program as its scenes are pickled with it."""
        return pickle.dumps(self.__reduce__(), protocol=5)

    def __deepcopy__(self, _memo: object) -> "Scenario":
        return self  # scenes do not depend on what has been sampled before

    def __copy__(self) -> "Scenario":
        return self

    @property
    def is_timeless(self) -> bool:
        """Return whether nothing in the program is about time: no simulator, behavior, monitor, record or temporal requirement."""
        program = self._program
        return (
            program.simulator is None
            and program.top is None
            and not program.invocables
            and program.declared == Declared()
            and not any(
                item.formula is not None and is_temporal(item.formula.formula)
                for item in program.requirements
            )
        )

    @property
    def has_simulator(self) -> bool:
        """Return whether the program selects its simulator."""
        return self._program.simulator is not None

    def getSimulator(self) -> Any:
        """Return the simulator of the program's ``simulator`` statement; raises ``RuntimeError`` if it has none."""
        if self._program.simulator is None:
            raise RuntimeError("the program has no `simulator` statement, so no simulator is known")
        return self._program.simulator()

    def conditionOn(
        self,
        scene: Scene | None = None,
        objects: Sequence[object] = (),
        params: Mapping[str, Any] | Sequence[str] = (),
    ) -> None:
        """Fix the values of objects and parameters in all later scenes; the others vary as before.

        Without arguments earlier conditions are lifted; otherwise they stay.

        Args:
            scene: a scene of this scenario, for values of it. All random values that they depend on are fixed, also where
                others depend on them too.
            objects: objects of the scenario, or their places in its `objects`, that are to be as in the scene.
            params: names of global parameters that are to be as in the scene; or a mapping from names to values or
                distributions, which the parameters have then wherever the program reads them.

        Raises:
            InvalidScenarioError: if there is no such object or parameter.

        """
        parameters: Mapping[str, Any] = params if isinstance(params, Mapping) else {}
        names: Sequence[str] = () if isinstance(params, Mapping) else params
        if scene is None and (objects or names):
            raise InvalidScenarioError(
                "`conditionOn` without a scene has no values for objects, or for parameters that are only named",
                help="pass the scene whose values they are to have, or `params={name: value}`",
            )
        for name in (*names, *parameters):
            self._check_parameter(name)
        if scene is not None:
            values = [scene.sources[self._number(item)] for item in objects]
            values += [scene.program.parameters[name] for name in names]
            nodes = Graph(dependencies(values)).nodes
            self._sampler = self._sampler.fixed(*draws_of(scene.found, scene.lane, nodes))
        elif not parameters:
            vars(self).update(self._unconditioned)
        if parameters:
            self._take_parameters(parameters)
        self._choosing = None
        if self._external_candidates is not None:
            self._external_candidates.forget()
        self._foreseen = Foreseen(self._foresee)
        vars(self).pop("recipe_bytes", None)

    def _take_parameters(self, given: Mapping[str, object]) -> None:
        """Go on as the same program with other values of parameters, under the conditions so far."""
        other = self._compiled_again(given)
        other._sampler = self._sampler.on(other._sampler)
        vars(self).update({name: vars(other)[name] for name in self._unconditioned})
        self._external_candidates = None

    def _number(self, item: object) -> int:
        """The place of an object, which is given by itself or by its place."""
        if not isinstance(item, int):
            families: tuple[SceneFamily, ...] = (self._family, self._unconditioned["_family"])
            sources = [enumerate(family.populations.objects) for family in families]
            return next(number for number, obj in chain(*sources) if obj is item)
        count = len(self.objects)
        if not -count <= item < count:
            raise InvalidScenarioError(
                f"there is no object {item} in the scenario, which has {count}",
                help="places count from 0, in the order of the scenario's `objects`",
            )
        return item

    def _check_parameter(self, name: str) -> None:
        parameters = self._program.parameters
        if name not in parameters:
            raise InvalidScenarioError(
                f"the scenario has no parameter {name!r}",
                help=f"its parameters are {', '.join(parameters)}" if parameters else "it has none",
            )
