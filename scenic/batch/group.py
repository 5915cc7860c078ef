"""Several simulators in processes of their own, which share the simulations of many scenes."""

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, redirect_stdout
from typing import Any

from scenic.batch import workers
from scenic.dataclass import dataclass
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene
from scenic.simulators.results import TerminationType
from scenic.simulators.simulator import Simulator

__all__ = ["GroupResult", "SimulatorGroup"]


@dataclass(frozen=True, slots=True)
class GroupResult:
    """The outcome of one simulation of a group.

    Attributes:
        name: of the simulation: the number of its scene, from 0.
        terminationType: why it ended; ``None`` if every try was rejected.
        terminationReason: the same in words.
        records: recorded values by name.
        finalState: the last state, if asked for.
        trajectory: all states, if asked for.
        replayBytes: scene and draws (`Scenario.simulationToBytes`), if asked for.
        externalSamplerInfo: always ``None``: what external samplers chose is among the parameters of the scene.

    """

    name: str
    terminationType: TerminationType | None
    terminationReason: str
    records: Mapping[str, Any]
    finalState: Any = None
    trajectory: tuple[Any, ...] | None = None
    replayBytes: bytes | None = None
    externalSamplerInfo: None = None


class SimulatorGroup:
    """Simulators that run in processes of their own.

    Args:
        numWorkers: how many; 0 simulates in this process.
        simulatorClass: makes a simulator, once in each process.
        simulatorParams: the keyword arguments for it.
        bufferSize: accepted for compatibility: scenes are taken when a process is free for them.
        mute: keep what programs and simulators print in the processes to themselves.
        returnFinalState: whether results hold the last state.
        returnTrajectory: whether results hold all states.
        returnBytes: whether results hold the bytes of scene and simulation.
        timeout: accepted for compatibility: a process that dies is replaced at once.

    """

    def __init__(
        self,
        numWorkers: int,
        simulatorClass: type[Simulator],
        simulatorParams: Mapping[str, Any] | None = None,
        bufferSize: int | None = None,
        mute: bool = True,
        returnFinalState: bool = True,
        returnTrajectory: bool = False,
        returnBytes: bool = False,
        timeout: float = 20,
    ) -> None:
        self.numWorkers = numWorkers
        self._make = (simulatorClass, dict(simulatorParams or {}))
        self._mute = mute
        self._wanted = (returnFinalState, returnTrajectory, returnBytes)

    def simulateBatch(
        self,
        scenario: Scenario,
        scenes: Iterable[Scene | bytes],
        simulateParams: Mapping[str, Any] | None = None,
        serialized: bool = False,
    ) -> list[GroupResult]:
        """The results of scenes, in their order; see `simulateStream`."""
        return list(self.simulateStream(scenario, scenes, simulateParams, serialized))

    def simulateStream(
        self,
        scenario: Scenario,
        scenes: Iterable[Scene | bytes],
        simulateParams: Mapping[str, Any] | None = None,
        serialized: bool = False,
        deterministic: bool = True,
    ) -> Iterator[GroupResult]:
        """Simulate scenes, of which there may be no end.

        Args:
            scenario: what the scenes were made of.
            scenes: the scenes; their bytes (`Scenario.sceneToBytes`) if ``serialized``.
            simulateParams: keyword arguments of `Simulator.simulate`.
            serialized: accepted for compatibility: bytes are known as such.
            deterministic: yield results in the order of scenes, rather than as they come.

        Raises:
            Exception: what a simulation raised.

        """
        job = _Job(scenario, self._make, dict(simulateParams or {}), self._wanted, self._mute)
        tasks: Iterator[tuple[int, Any]] = (
            (k, scene if isinstance(scene, bytes) else scenario.sceneToBytes(scene))
            for k, scene in enumerate(scenes)
        )
        if self.numWorkers < 1:
            yield from map(job, tasks)
            return
        results = workers.run(job.told, tasks, jobs=self.numWorkers, lost=_lost)
        if not deterministic:
            yield from (_checked(result) for _, result in results)
            return
        waiting: dict[int, GroupResult | Exception] = {}
        due = 0
        for index, result in results:
            waiting[index] = result
            while due in waiting:
                yield _checked(waiting.pop(due))
                due += 1


def _lost(task: tuple[int, Any], status: int) -> GroupResult | Exception:
    return RuntimeError(f"the process that simulated scene {task[0]} died (exit code {status})")


def _checked(result: GroupResult | Exception) -> GroupResult:
    if isinstance(result, Exception):
        raise result
    return result


class _Job:
    """Simulates a numbered scene; the simulator is made when the first one comes."""

    def __init__(
        self,
        scenario: Scenario,
        make: tuple[type[Simulator], Mapping[str, Any]],
        options: Mapping[str, Any],
        wanted: tuple[bool, bool, bool],
        mute: bool,
    ) -> None:
        self._scenario = scenario
        self._make = make
        self._options = options
        self._wanted = wanted
        self._mute = mute
        self._simulator: Simulator | None = None

    def told(self, task: tuple[int, bytes]) -> GroupResult | Exception:
        """Return the same, or what it raised."""
        try:
            return self(task)
        except Exception as error:  # noqa: BLE001 - raised again where the result is read
            return error

    def __call__(self, task: tuple[int, bytes]) -> GroupResult:
        number, data = task
        final, course, whole = self._wanted
        with ExitStack() as stack:
            if self._mute:
                stack.enter_context(redirect_stdout(stack.enter_context(open(os.devnull, "w"))))
            if self._simulator is None:
                kind, options = self._make
                self._simulator = kind(**options)
            scene = self._scenario.sceneFromBytes(data)
            simulation = self._simulator.simulate(scene, name=str(number), **self._options)
        if simulation is None or simulation.result is None:
            return GroupResult(str(number), None, "every simulation was rejected", {})
        result = simulation.result
        return GroupResult(
            str(number),
            result.terminationType,
            result.terminationReason,
            result.records,
            result.finalState if final else None,
            result.trajectory if course else None,
            self._scenario.simulationToBytes(simulation) if whole else None,
        )
