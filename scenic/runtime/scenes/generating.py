"""The methods of the established API that generate scenes, over those that sample them."""

import math
import random
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.language.errors import RejectionException, SerializationError
from scenic.runtime.ground.arguments import whole_number
from scenic.runtime.ground.choosable import Choosable
from scenic.runtime.instances.objects import Object
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.sampling.engine import Accepted, CandidateError
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.external_candidates import ExternalCandidates, ExternalPoints
from scenic.runtime.scenes.prefetching import SEED_BITS, Foreseen
from scenic.runtime.scenes.restoring import Restoring
from scenic.runtime.scenes.sampler import DEFAULT_ATTEMPTS
from scenic.runtime.scenes.scene import Scene

__all__ = ["Generating"]

_BY_HAND: Final = "a scenario that was made by hand cannot be compiled again"


class Generating(Restoring, ABC):
    """Base of scenarios: `generate` and its kind, in terms of `sample`, `stream` and `chosen`."""

    workspace: Workspace
    _foreseen: Foreseen
    _external_candidates: ExternalCandidates | None

    @property
    @abstractmethod
    def externals(self) -> Mapping[int, Choosable]:
        """The external parameters by address."""

    @property
    @abstractmethod
    def requirements(self) -> tuple[Any, ...]:
        """The ``require`` statements, in program order."""

    @abstractmethod
    def sample(
        self, n: int = 1, *, seed: int | None = None, max_attempts: int | None = None, processes: int = 1
    ) -> list[Scene]:
        """``n`` scenes of a seed."""

    @abstractmethod
    def stream(
        self, n: int, *, seed: int, first: int = 0, max_attempts: int | None = None
    ) -> Iterator[Scene | Exhausted]:
        """Scenes ``first`` to ``first + n`` of a seed, in order."""

    @abstractmethod
    def chosen(
        self, numbers: Mapping[int, NDArray[np.float64]], count: int, *, seed: int, first: int = 0
    ) -> Iterator[Scene | Exhausted]:
        """Return scenes in which some draws are given."""

    def __reduce__(self) -> tuple[Any, ...]:
        """A scenario is pickled as its program, which is compiled again when it is unpickled."""
        raise TypeError(_BY_HAND)

    def _in_processes(self, n: int, **options: Any) -> Iterator[Scene]:
        """Yield the scenes that other processes make, which compile the program for themselves."""
        raise TypeError(_BY_HAND)

    def _external_points(self) -> ExternalPoints:
        """The points of the external parameters, by the sampler that the program names."""
        raise TypeError(_BY_HAND)

    def _compiled_again(
        self, params: Mapping[str, object], settle: tuple[float, float, bool] | None = None
    ) -> Any:
        """Return the scenario of the same program with other values of parameters, or with settled objects."""
        raise TypeError(_BY_HAND)

    @abstractmethod
    def _first_candidates(
        self, numbers: Mapping[int, NDArray[np.float64]], count: int, seed: int, first: int
    ) -> list[tuple[int, Accepted | CandidateError]]:
        """Return the candidates that nothing rejects, one for each scene of a range, with their places."""

    @abstractmethod
    def _lanes_for(self, scenes: int) -> int:
        """Number of candidates that are best evaluated together where so many scenes are wanted."""

    @abstractmethod
    def _scene_of(self, result: Accepted | CandidateError) -> Scene:
        """Return the scene of a candidate; raises the program's error of one that failed."""

    def generate(
        self,
        maxIterations: int = 2000,
        verbosity: int = 0,
        feedback: object = None,
        *,
        seed: int | None = None,
    ) -> tuple[Scene, int]:
        """One scene, and the number of candidates tried for it.

        Without ``seed`` one is drawn from Python's ``random``, so that scripts which call ``random.seed`` repeat.
        ``verbosity`` is accepted for compatibility.

        The external parameters of a program get their values from its sampler, for each candidate anew. ``feedback`` is for that
        sampler: how good the scene before turned out to be, smaller being better. With ``seed`` they are drawn as all else is.

        Raises:
            RejectionException: if none of ``maxIterations`` candidates meets the requirements.

        """
        if seed is None and self.externals:
            return self._generate_chosen(maxIterations, feedback)
        if seed is None:
            result = self._foreseen.take(random.getrandbits(SEED_BITS), maxIterations)
            if isinstance(result, Exhausted):
                raise RejectionException(result.message())
            return result, result.attempts
        (scene,) = self.sample(1, seed=seed, max_attempts=maxIterations)
        return scene, scene.attempts

    def _generate_chosen(self, most: int, feedback: object) -> tuple[Scene, int]:
        """Return one scene whose external parameters their sampler chooses."""
        if self._external_candidates is None:
            self._external_candidates = ExternalCandidates(
                self._external_points(), self._first_candidates, self._lanes_for
            )
        result, attempts = self._external_candidates.take(random.getrandbits(SEED_BITS), most, feedback)
        if result is None:
            raise RejectionException(
                f"no scene was found within {most} candidates whose external parameters the sampler chose"
            )
        return self._scene_of(result), attempts

    def generateBatch(
        self,
        numScenes: int,
        maxIterations: float = math.inf,
        verbosity: int = 0,
        feedback: object = None,
        numWorkers: int = 0,
        mute: bool = True,
        serialized: bool = False,
    ) -> tuple[list[Any], int]:
        """Scenes, and the total number of candidates tried for them, ``maxIterations`` at most.

        Without that limit, a scene for which `DEFAULT_ATTEMPTS` candidates were rejected ends the search, too.

        Args:
            numScenes: how many.
            maxIterations: candidates tried for all of them.
            verbosity: accepted for compatibility.
            feedback: accepted for compatibility.
            numWorkers: processes that look for scenes; 0 is this one. The scenes are the same.
            mute: accepted for compatibility: nothing is printed.
            serialized: give scenes as bytes (`sceneToBytes`).

        Raises:
            RejectionException: if the scenes are not found within the limit.
            ValueError: for several processes with a limit of candidates or feedback.

        """
        _check_workers(numWorkers, maxIterations, feedback)
        most = DEFAULT_ATTEMPTS if maxIterations == math.inf else int(maxIterations)
        scenes = self.sample(numScenes, max_attempts=most, processes=max(1, numWorkers))
        attempts = sum(scene.attempts for scene in scenes)
        if attempts > maxIterations:
            raise RejectionException(f"failed to generate {numScenes} scenes in {maxIterations} iterations")
        return (list(map(self.sceneToBytes, scenes)) if serialized else scenes), attempts

    def generateStream(
        self,
        numScenes: float = math.inf,
        maxIterations: float = math.inf,
        verbosity: int = 0,
        feedback: object = None,
        numWorkers: int = 0,
        bufferSize: int | None = None,
        mute: bool = True,
        serialized: bool = False,
        deterministic: bool = True,
        iterationCount: bool = False,
    ) -> Iterator[Any]:
        """Scenes in order, looked for when they are wanted.

        Args:
            numScenes: how many; `math.inf` for a stream without an end.
            maxIterations: candidates tried for one scene.
            verbosity: accepted for compatibility.
            feedback: accepted for compatibility.
            numWorkers: processes that look for scenes; 0 is this one. The scenes are the same.
            bufferSize: scenes looked for at a time.
            mute: accepted for compatibility: nothing is printed.
            serialized: give scenes as bytes (`sceneToBytes`).
            deterministic: accepted for compatibility: scenes always come in order.
            iterationCount: yield pairs of a scene and the number of candidates tried for it.

        Raises:
            RejectionException: if a scene is not found.
            ValueError: for several processes with a limit of candidates or feedback, and numbers that are not allowed.

        """
        _check_workers(numWorkers, maxIterations, feedback)
        if numScenes != math.inf:
            whole_number(numScenes, "numScenes", 0)
        if bufferSize is not None:
            whole_number(bufferSize, "bufferSize", 1)
        limit = None if maxIterations == math.inf else int(maxIterations)
        return self._generated(
            numScenes,
            random.getrandbits(SEED_BITS),
            limit,
            numWorkers,
            bufferSize or 64 * max(1, numWorkers),
            serialized=serialized,
            counted=iterationCount,
        )

    def _generated(
        self,
        count: float,
        seed: int,
        limit: int | None,
        workers: int,
        block: int,
        *,
        serialized: bool,
        counted: bool,
    ) -> Iterator[Any]:
        """See `generateStream`."""
        first = 0
        while first < count:
            size = int(min(block, count - first))
            if workers > 0:
                results: Iterable[Scene | Exhausted] = self._in_processes(
                    size, seed=seed, first=first, processes=workers
                )
            else:
                results = self.stream(size, seed=seed, first=first, max_attempts=limit)
            for scene in results:
                if isinstance(scene, Exhausted):
                    raise RejectionException(scene.message())
                value = self.sceneToBytes(scene) if serialized else scene
                yield (value, scene.attempts) if counted else value
            first += size

    @property
    def userRequirements(self) -> tuple[Any, ...]:
        """The same as `requirements`."""
        return self.requirements

    def containerOfObject(self, obj: Object) -> Region:
        """Return the region that must hold an object: its own, else the workspace."""
        own = obj.regionContainedIn
        return self.workspace.region if own is None else own

    def resetExternalSampler(self) -> None:
        """Restart the sampler of the external parameters."""
        self._external_candidates = None

    @property
    def externalSampler(self) -> Any:
        """The sampler of the external parameters once a scene has been generated, if there are any."""
        candidates = self._external_candidates
        return None if candidates is None else candidates.points.sampler

    def simulationToBytes(self, simulation: Any, allowPickle: bool = False) -> bytes:
        """Return a simulation as data: its scene, and what has been drawn in it. `simulationFromBytes` runs it again."""
        scene = self.sceneToBytes(simulation.scene)
        return len(scene).to_bytes(4, "little") + scene + bytes(simulation.getReplay())

    def simulationFromBytes(
        self, data: bytes, simulator: Any, *, verify: bool = True, allowPickle: bool = False, **options: Any
    ) -> Any:
        """Run the simulation in the data of `simulationToBytes` again; ``options`` are those of `Simulator.simulate`.

        Raises:
            SerializationError: if the data is damaged, or of another program (not checked if ``verify`` is false).

        """
        end = 4 + int.from_bytes(data[:4], "little")
        if len(data) < end:
            raise SerializationError("the saved simulation is damaged", help="save it again")
        scene = self.sceneFromBytes(data[4:end], verify=verify)
        return simulator.replay(scene, data[end:], **options)


def _check_workers(workers: int, limit: float, feedback: object) -> None:
    whole_number(workers, "numWorkers", 0)
    if not limit >= 1:
        raise ValueError(f"`maxIterations` must be a number of at least 1, not {limit!r}")
    if workers > 0 and (limit != math.inf or feedback is not None):
        raise ValueError("several processes go without `maxIterations` and `feedback`")
