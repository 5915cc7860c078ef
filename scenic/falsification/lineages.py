"""Runs that descend from one another by moves: a run is a point of the unit cube, and its children are points near it.

A draw of the program, of its scene or in time, has a number at its address. That of a first run is hashed, as always. A move replaces it, with
the chance ``share``, by a number near it: a step of preconditioned Crank and Nicolson after a map to a standard normal (Cotter, Roberts,
Stuart and White, "MCMC methods for functions: modifying old algorithms to make them faster", 2013). The new numbers of a move are hashed from
the number of its own run. So each address has a number in each run, whether it is drawn there or not, and a lineage is all that is kept.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.falsification.evaluating import RunTask
from scenic.graph.draws import Words, mix, open_unit, scene_keys, seed_words, words_of
from scenic.graph.operations.distributions import FIRST, LAST
from scenic.runtime.dynamics.time_draws import Draw, Seeded, Source
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.sampler import DEFAULT_ATTEMPTS
from scenic.runtime.scenes.saving import draws_of

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario
    from scenic.runtime.scenes.scene import Scene

__all__ = ["Ancestry", "Descent", "Held", "Lineage", "LineageStep", "SceneDraws", "lineages_of"]

Floats = NDArray[np.float64]

_MOVED: Final = np.uint64(0x6D6F7665)
"""Tells the keys of moves from those of scenes."""

_OTHER: Final = 0x5555555555555555
"""Tells the address of the choice whether a word changes from that of the word."""

_CHANCES: Final = 1 << 12
"""Chances that the unused bits of a word can tell apart."""

_NORMAL: Final = NormalDist()


class LineageStep(NamedTuple):
    """A move: the run that it made, its length from 0 (stay) to 1 (forget), the chance of each number to move."""

    run: int
    length: float
    share: float


@dataclass(frozen=True, slots=True)
class Lineage:
    """A run by its first ancestor, a run of the program's law, and the moves since."""

    first: int
    steps: tuple[LineageStep, ...] = ()

    @property
    def run(self) -> int:
        """The number of the run."""
        return self.steps[-1].run if self.steps else self.first

    def child(self, step: LineageStep) -> "Lineage":
        """The run that a move makes of this one."""
        return Lineage(self.first, (*self.steps, step))


@dataclass(frozen=True, slots=True)
class SceneDraws:
    """The draws of a scene: numbers of its axes as places of a standard normal ``(d,)``, and words ``(w,)``.

    Which soft requirements it has to meet, follows from the number of its run.
    """

    places: Floats
    words: Words


@dataclass(frozen=True, slots=True)
class Held:
    """A scene that all runs have, by its draws.

    Attributes:
        scene: its number in its seed.
        numbers: of its axes, by address.
        words: its further draws, by address.

    """

    scene: int
    numbers: Mapping[int, float]
    words: Mapping[int, int]

    @classmethod
    def of(cls, scene: "Scene") -> "Held":
        """Return the draws of a scene."""
        return cls(scene.k, *draws_of(scene.found, scene.lane))

    def to_data(self) -> dict[str, Any]:
        """Return the same as plain data."""
        return {
            "scene": self.scene,
            "numbers": {f"{name:016x}": number for name, number in sorted(self.numbers.items())},
            "words": {f"{name:016x}": f"{word:016x}" for name, word in sorted(self.words.items())},
        }

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> "Held":
        """Read the data of `to_data`."""
        numbers = {int(name, 16): float(number) for name, number in data["numbers"].items()}
        return cls(
            int(data["scene"]),
            numbers,
            {int(name, 16): int(word, 16) for name, word in data["words"].items()},
        )


def lineages_of(rows: Iterable[Mapping[str, object]]) -> dict[int, Lineage]:
    """The lineages of runs by their numbers, from rows whose ``move`` is the parent, a length and a share, or nothing."""
    lineages: dict[int, Lineage] = {}
    for row in rows:
        run, move = row["run"], row.get("move")
        assert isinstance(run, int)
        if isinstance(move, list):
            parent, length, share = move
            lineages[run] = lineages[parent].child(LineageStep(run, length, share))
        else:
            lineages[run] = Lineage(run)
    return lineages


class Ancestry:
    """Finds the draws of scenes by their lineages.

    Args:
        scenario: the program.
        seed: of all runs.
        held: a scene that all runs have, so that only draws of simulations move.

    """

    def __init__(self, scenario: "Scenario", seed: int, held: Held | None = None) -> None:
        self._scenario = scenario
        self._seed = seed
        graph = scenario.outline.graph
        drawn_nodes = [node for node in graph.nodes if node.is_drawn]
        self.axes: Final = tuple(graph.address(node) for node in drawn_nodes if node.is_axis)
        """The addresses of the axes, in order."""
        self.keys: Final = tuple(graph.address(node) for node in drawn_nodes if not node.is_axis)
        """The addresses of the words, in order."""
        self._held = held
        self._known: dict[Lineage, SceneDraws] = {}

    def draws(self, lineage: Lineage) -> SceneDraws:
        """The draws of a run's scene."""
        (found,) = self.all_draws([lineage])
        return found

    def all_draws(self, lineages: Sequence[Lineage]) -> list[SceneDraws]:
        """The draws of the scenes of some runs."""
        draws_of = self._known
        missing = [item for item in lineages if item not in draws_of]
        for lineage in missing:
            if not lineage.steps:
                draws_of[lineage] = self._first(lineage.first)
        moving = [item for item in missing if item.steps]
        if moving:
            parents = self.all_draws([Lineage(item.first, item.steps[:-1]) for item in moving])
            draws_of |= zip(moving, self._moved(parents, [item.steps[-1] for item in moving]), strict=True)
        return [draws_of[item] for item in lineages]

    def _moved(self, parents: Sequence[SceneDraws], steps: Sequence[LineageStep]) -> list[SceneDraws]:
        """The draws that moves make of those of some runs."""
        runs = np.array([step.run for step in steps], dtype=np.int64)
        from scipy.special import ndtri

        lengths = np.array([step.length for step in steps])
        chances = np.array([step.share for step in steps]) * _CHANCES
        keys = mix(scene_keys(np.repeat(seed_words([self._seed]), len(runs)), runs) ^ _MOVED)
        random = words_of(keys, np.array(self.axes, dtype=np.uint64))
        before = np.array([parent.places for parent in parents]).reshape(len(runs), -1).T
        near = np.sqrt(1 - lengths**2) * before + lengths * ndtri(open_unit(random))
        places = np.where(_low(random) < chances, near, before)
        addresses = np.array(self.keys, dtype=np.uint64)
        changes = _low(words_of(keys, addresses ^ np.uint64(_OTHER))) < chances * lengths**2
        old = np.array([parent.words for parent in parents], dtype=np.uint64).reshape(len(runs), -1).T
        words = np.where(changes, words_of(keys, addresses), old)
        return [SceneDraws(places[:, k], words[:, k]) for k in range(len(steps))]

    def task(self, lineage: Lineage) -> RunTask:
        """The task to make a run."""
        source = Descent(self._seed, lineage) if lineage.steps else None
        if self._held is not None:
            return RunTask(lineage.run, self._held.numbers, self._held.words, source, self._held.scene)
        if not lineage.steps:
            return RunTask(lineage.run, {})
        numbers, words = self.numbers([self.draws(lineage)])
        return RunTask(
            lineage.run,
            {name: float(column[0]) for name, column in numbers.items()},
            {name: int(column[0]) for name, column in words.items()},
            source,
        )

    def numbers(self, draws: Sequence[SceneDraws]) -> tuple[dict[int, Floats], dict[int, Words]]:
        """Numbers and words ``(n,)`` of scenes, by address."""
        from scipy.special import ndtr

        columns = np.clip(
            ndtr(np.array([item.places for item in draws]).reshape(len(draws), -1).T), FIRST, LAST
        )
        words = np.array([item.words for item in draws], dtype=np.uint64).reshape(len(draws), -1).T
        return dict(zip(self.axes, columns, strict=True)), dict(zip(self.keys, words, strict=True))

    def _first(self, run: int) -> SceneDraws:
        (scene,) = self._scenario.chosen({}, 1, seed=self._seed, first=run, max_attempts=DEFAULT_ATTEMPTS)
        assert not isinstance(scene, Exhausted), run
        return self._of_scene(scene)

    def _of_scene(self, scene: "Scene") -> SceneDraws:
        from scipy.special import ndtri

        numbers, words = draws_of(scene.found, scene.lane)
        places = ndtri(np.array([numbers[name] for name in self.axes], dtype=np.float64))
        return SceneDraws(places, np.array([words[name] for name in self.keys], dtype=np.uint64))


def _low(words: Words) -> Floats:
    """Return the bits of words that `open_unit` does not use, as numbers."""
    return (words & np.uint64(_CHANCES - 1)).astype(np.float64)


@dataclass(frozen=True, slots=True)
class Descent:
    """The draws in time of a run, by its lineage; a `scenic.runtime.dynamics.chosen_draws.Sourcing`."""

    seed: int
    lineage: Lineage

    def __call__(self, _rest: Source) -> Source:
        """The source of the draws."""
        first, *others = [Seeded(f"{self.seed}:{run}:1".encode()) for run in self._runs]
        if not others:
            return first
        return _Descended(first, list(zip(others, self.lineage.steps, strict=True)))

    @property
    def _runs(self) -> list[int]:
        return [self.lineage.first, *(step.run for step in self.lineage.steps)]


class _Descended:
    """Numbers of a first run after some moves."""

    def __init__(self, first: Seeded, moves: Sequence[tuple[Seeded, LineageStep]]) -> None:
        self._first = first
        self._moves = [
            (source, step.length, math.sqrt(1 - step.length**2), step.share * _CHANCES, step.length**2)
            for source, step in moves
        ]

    def draw(self, place: int, what: Draw) -> float:
        """The number at an address."""
        quantile = _NORMAL.inv_cdf
        normal = quantile(self._first.draw(place, what))
        for source, length, rest, chances, _ in self._moves:
            word = source.word(place)
            if word % _CHANCES < chances:
                normal = rest * normal + length * quantile(((word >> 12) + 0.5) * 2.0**-52)
        return min(max(_NORMAL.cdf(normal), FIRST), LAST)

    def word(self, place: int) -> int:
        """Return 64 random bits at an address."""
        current = self._first.word(place)
        for source, _, _, chances, chance in self._moves:
            if source.word(place ^ _OTHER) % _CHANCES < chances * chance:
                current = source.word(place)
        return current
