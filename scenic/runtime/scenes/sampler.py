"""A plan being sampled: the engine that knows what its rounds cost, and what is fixed in every scene."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scenic.graph.domain import Domain
from scenic.graph.draws import Counter, LaneOwners, NumberSource, Points, Words
from scenic.graph.node import Node
from scenic.graph.points import PointSet
from scenic.runtime.sampling.apart import OFTEN, rehearsed
from scenic.runtime.sampling.check_planning import Outline
from scenic.runtime.sampling.checks import NodeCheck
from scenic.runtime.sampling.components import Components, components_of, crowd_of, divided
from scenic.runtime.sampling.engine import Accepted, CandidateError, Engine, Plan
from scenic.runtime.sampling.halving import SELDOM
from scenic.runtime.sampling.pending import SceneTask
from scenic.runtime.sampling.piecewise import PiecewiseEngine
from scenic.runtime.sampling.point_set_draws import driven
from scenic.runtime.sampling.profiling import Meter, Profile
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.saving import fixed_draws

PROOF_CANDIDATES = 200
"""Candidates that illustrate why no scene exists, where that is proven."""

OPAQUE_ATTEMPTS = 1000
"""Candidates tried for one scene of a program whose only random numbers could be those of its own functions."""

DEFAULT_ATTEMPTS = 100_000
"""Default number of candidates tried for one scene before giving up."""

Results = Iterator[Accepted | Exhausted]


class Sampler:
    """Finds the scenes of an outline.

    Args:
        outline: the checks and the graph of the program.
        domain: the part of the cube to sample from; it must hold every point that meets the requirements.
        impossible: labels of requirements that are proven to fail everywhere; then nothing is sampled.
        numbers: draws of axes that are fixed in every scene, by address.
        words: draws of keys that are fixed in every scene, by address.

    """

    def __init__(
        self,
        outline: Outline,
        domain: Domain | None = None,
        *,
        impossible: Sequence[str] = (),
        numbers: Mapping[int, float] | None = None,
        words: Mapping[int, int] | None = None,
    ) -> None:
        self._outline = outline
        self.impossible: Final = tuple(impossible)
        """Labels of requirements that are proven to fail everywhere."""
        self._numbers, self._words = dict(numbers or {}), dict(words or {})
        self.engine = Engine(outline.plan(domain), self._fixing(lambda lanes: Counter(lanes.keys)))
        """The engine of the whole plan."""
        self._components = None if self.impossible else components_of(self.engine.plan)
        self._finder = self._finder_of(self._components)
        self._may_divide = False
        self._whole: Engine | None = None
        """The engine of the whole cube, where it has been needed."""

    @property
    def plan(self) -> Plan:
        """The plan that is sampled."""
        return self.engine.plan

    @property
    def engines(self) -> list[Engine]:
        """An engine for each of the components that scenes are put together from."""
        return self._finder.engines if isinstance(self._finder, PiecewiseEngine) else [self.engine]

    def prepare(self) -> None:
        """Do the one-time work that the first scene would otherwise wait for."""
        if self.impossible or self._separate():
            return
        self._finder.prepare()
        masks = list(self.engine.met.values())
        passed = self.engine.rehearsed
        if passed is None and masks:
            passed = int(np.count_nonzero(np.logical_and.reduce(masks)))
        self._may_divide = passed is not None and passed <= SELDOM * self.engine.rehearsed_of

    def _separate(self) -> bool:
        """Divide a crowd before anything of the whole is evaluated, so that this takes as long as for one thing of each kind.

        Returns:
            Whether the program is one, of which not nearly all candidates pass.

        """
        engine = self.engine
        apart = crowd_of(engine) if self._components is None else None
        if apart is None:
            return False
        pairs, passes = rehearsed(engine, apart)
        if passes > OFTEN * engine.rehearsed_of:
            return False
        engine.met.update(pairs)
        engine.rehearsed = passes
        self._components = Components((engine.plan,), apart.owners(), (apart,))
        self._finder = self._finder_of(self._components)
        return True

    def met(self) -> dict[Node, NDArray[np.bool_]]:
        """Return the masks ``(n,)`` of the rehearsal's candidates that met each requirement, by its node.

        Requirements that the rehearsal could not evaluate are absent.
        """
        checks = self.plan.checks
        return {
            check.node: mask
            for index, mask in self.engine.met.items()
            if isinstance(check := checks[index], NodeCheck)
        }

    def fixed(self, numbers: Mapping[int, float], words: Mapping[int, int]) -> "Sampler":
        """Return a sampler in which these draws are fixed, too.

        It samples the whole cube, since the fixed values may lie outside of the narrowed domain.
        """
        return Sampler(self._outline, numbers={**self._numbers, **numbers}, words={**self._words, **words})

    def on(self, other: "Sampler") -> "Sampler":
        """Return the sampler of another program with the draws fixed that are fixed in this one."""
        return other.fixed(self._numbers, self._words) if self._numbers or self._words else other

    def find(
        self,
        tasks: Iterable[tuple[int, int]],
        *,
        max_attempts: int | None,
        deadline: float | None = None,
        lanes: int | None = None,
        source: PointSet | None = None,
    ) -> Results:
        """The scenes of ``tasks``, in order; the arguments are those of `Scenario.stream`."""
        if self.impossible:
            return self._not_found(tasks)
        engine = self._engine_of(source)
        limit = self._limit(max_attempts, source)
        return engine.scenes(tasks, max_attempts=limit, deadline=deadline, lanes=lanes)

    def approximate(
        self, seed: int, first: int, count: int, *, lanes: int, max_attempts: int | None
    ) -> Results:
        """Scenes of a seed that are only approximately of the program's law; see `Scenario.stream`."""
        if self.impossible:
            return self._not_found((seed, k) for k in range(first, first + count))
        self._divide()
        limit = self._most_attempts(max_attempts)
        if isinstance(self._finder, PiecewiseEngine) and self._finder.can_approximate():
            scene_numbers = [(seed, k) for k in range(first, first + count)]
            return self._finder.approximate(scene_numbers, max_attempts=limit, together=lanes)
        from scenic.runtime.sampling.approximate import approximated  # few runs want it

        return approximated(
            self.engine,
            seed,
            first,
            count,
            lanes=lanes,
            max_attempts=limit,
            checks=[check for engine in self.engines for check in engine.plan.checks],
            fixing=self._fixed,
        )

    def profile(
        self,
        tasks: Sequence[tuple[int, int]],
        *,
        max_attempts: int | None,
        deadline: float | None,
        source: PointSet | None,
    ) -> Profile:
        """Find scenes and return the profile of the time that it takes; the arguments are those of `find`."""
        engine = self._engine_of(source).metered(Meter())
        limit = self._limit(max_attempts, source)
        some = () if self.impossible else engine.scenes(tasks, max_attempts=limit, deadline=deadline)
        return engine.profile(sum(not isinstance(result, Exhausted) for result in some))

    def foresee(self, tasks: Iterable[tuple[int, int]], max_attempts: int, more: bool) -> Results:
        """The scenes of tasks without end; ``more`` is true if more than the first scene will probably be wanted."""
        if self.impossible:
            return self._not_found(tasks)
        self._divide()
        return self._finder.foresee(tasks, max_attempts=self._most_attempts(max_attempts), more=more)

    def accepted(
        self, seed: int, numbers: NDArray[np.int64], attempts: NDArray[np.int64], source: PointSet | None
    ) -> list[Accepted]:
        """Scenes of a seed of which the accepted candidates are known, or are looked for again; see `Scenario.found`."""
        engine = self._engine_of(source)
        if attempts.ndim == 1 and isinstance(engine, PiecewiseEngine):
            tasks = ((seed, k) for k in numbers.tolist())
            found = self.find(tasks, max_attempts=int(attempts.max(initial=1)), source=source)
            return [item for item in found if not isinstance(item, Exhausted)]
        return engine.accepted(seed, numbers, attempts)

    def without_narrowing(self, addresses: Collection[int]) -> "Sampler":
        """Return a sampler that narrows none of the axes at these addresses."""
        graph = self.plan.graph
        free = np.array([graph.address(node) in addresses for node in graph.axes], dtype=np.bool_)
        domain = self.plan.domain
        return Sampler(
            self._outline,
            domain.freed(free) if free.any() else domain,
            impossible=self.impossible,
            numbers=self._numbers,
            words=self._words,
        )

    def chosen(
        self,
        numbers: Mapping[int, NDArray[np.float64]],
        count: int,
        *,
        seed: int,
        first: int,
        max_attempts: int,
    ) -> Results:
        """Scenes ``first`` to ``first + count`` of a seed, in each of which some draws ``(count,)``, by address, are given."""
        if self.impossible:
            return self._not_found((seed, k) for k in range(first, first + count))

        self._divide()
        engine = self._finder.driven(self._fixing(_given(numbers, first)))
        tasks = ((seed, k) for k in range(first, first + count))
        return engine.scenes(tasks, max_attempts=max_attempts)

    def given(
        self,
        numbers: Mapping[int, NDArray[np.float64]],
        words: Mapping[int, Words],
        count: int,
        *,
        seed: int,
        first: int,
    ) -> Results:
        """Scenes ``first`` to ``first + count`` of a seed whose draws ``(count,)``, by address, are given as those of the whole cube."""
        if self.impossible:
            return self._not_found((seed, k) for k in range(first, first + count))
        if self._whole is None:
            self._whole = Sampler(self._outline, numbers=self._numbers, words=self._words).engine
        engine = self._whole.driven(self._fixing(_given(numbers, first, words)))
        return engine.scenes(((seed, k) for k in range(first, first + count)), max_attempts=1)

    def first_candidates(
        self, numbers: Mapping[int, NDArray[np.float64]], count: int, *, seed: int, first: int
    ) -> list[tuple[int, Accepted | CandidateError]]:
        """One candidate for each of scenes ``first`` to ``first + count`` of a seed, with given draws ``(count,)`` by address.

        Returns those that nothing rejects, with their places from 0 on.
        """
        source = self._fixing(_given(numbers, first))
        return self.engine.driven(source).first_candidates([(seed, first + place) for place in range(count)])

    def _divide(self) -> None:
        """Divide components of which hardly any candidate passes, when the first scene is wanted."""
        if not self._may_divide:
            return
        self._may_divide = False
        components = divided(self.engine, self._components)
        if components is not self._components:
            self._components = components
            self._finder = self._finder_of(components)

    def _finder_of(self, components: Components | None) -> Engine | PiecewiseEngine:
        """Return the engine that finds scenes, for a program divided into components if any are given."""
        return self.engine if components is None else PiecewiseEngine(self.engine, components)

    def _not_found(self, tasks: Iterable[tuple[int, int]]) -> Iterator[Exhausted]:
        report = None
        for seed, k in tasks:
            report = report or self.engine.report(SceneTask(seed, k), PROOF_CANDIDATES)
            yield Exhausted(seed, k, 0, "impossible", report)

    def _limit(self, wanted: int | None, source: PointSet | None) -> int:
        return 1 if source is not None and not source.retries else self._most_attempts(wanted)

    def _most_attempts(self, wanted: int | None) -> int:
        limit = DEFAULT_ATTEMPTS if wanted is None else wanted
        nodes = self.plan.graph.nodes
        if any(node.is_axis for node in nodes):
            return limit
        # Every attempt is the same, unless the program's own functions draw random numbers.
        return min(limit, OPAQUE_ATTEMPTS if any(node.is_drawn for node in nodes) else 1)

    def _fixing(self, source: Callable[[LaneOwners], NumberSource]) -> Callable[[LaneOwners], NumberSource]:
        if not self._numbers and not self._words:
            return source
        return lambda lanes: self._fixed(source(lanes))

    def _fixed(self, source: NumberSource) -> NumberSource:
        return fixed_draws(self._numbers, self._words, source) if self._numbers or self._words else source

    def _engine_of(self, points: PointSet | None) -> Engine | PiecewiseEngine:
        """Return the engine that samples rows of a point set; the usual engine where there is none."""
        self._divide()
        if points is None:
            return self._finder
        return self._finder.driven(self._fixing(driven(points, self.plan.graph)))


def _given(
    numbers: Mapping[int, NDArray[np.float64]], first: int, words: Mapping[int, Words] = MappingProxyType({})
) -> Callable[[LaneOwners], NumberSource]:
    """Return a function that makes the sources of lanes whose scenes, from ``first`` on, have these numbers and words."""

    def source(lanes: LaneOwners) -> NumberSource:
        rows = lanes.scenes - first
        return Points(
            {place: column[rows] for place, column in numbers.items()},
            Counter(lanes.keys),
            {place: column[rows] for place, column in words.items()},
        )

    return source


__all__ = ["DEFAULT_ATTEMPTS", "Sampler"]
