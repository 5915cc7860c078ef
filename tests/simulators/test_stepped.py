"""Simulations advanced by their caller, and simulators in processes of their own."""

import pytest

import scenic
from scenic.batch.group import SimulatorGroup
from scenic.simulators.dummy import DummySimulator
from scenic.simulators.results import TerminationType
from scenic.simulators.stepped import TerminatedSimulationException

PROGRAM = """
behavior Count():
    for number in range(9): take number
ego = new Object at (Range(0, 1), 0), with behavior Count
record ego.position.y as y
terminate after 3 steps
"""


def test_a_simulation_is_advanced_by_its_caller() -> None:
    (scene,) = scenic.scenarioFromString(PROGRAM).sample(1, seed=0)
    with DummySimulator(drift=1) as simulator:
        with simulator.simulateStepped(scene, maxSteps=9) as simulation:
            assert simulation.advance()
            assert (simulation.currentTime, simulation.result) == (0, None)
            while simulation.advance():
                pass
            assert [value for _, value in simulation.result.records["y"]] == [0, 1, 2, 3]
            with pytest.raises(TerminatedSimulationException):
                simulation.advance()
        with simulator.simulateStepped(scene) as simulation:
            simulation.advance()
            simulation.advance()
            simulation.terminateSimulation("enough")
            assert simulation.result.terminationType is TerminationType.terminatedByUser
            assert simulation.result.terminationReason == "enough"
            assert len(simulation.result.trajectory) == 2
        with simulator.simulateStepped(scene) as simulation:
            simulation.advance()
        assert simulation.result is None
    with pytest.raises(RuntimeError, match="destroyed"):
        simulator.simulate(scene)


def test_a_simulator_says_what_its_simulations_print(capsys: pytest.CaptureFixture[str]) -> None:
    (scene,) = scenic.scenarioFromString(PROGRAM).sample(1, seed=0)
    simulator = DummySimulator()
    simulator.verbosity = 2
    simulator.simulate(scene)
    assert "Starting simulation" in capsys.readouterr().out
    simulator.simulate(scene, verbosity=0)
    assert not capsys.readouterr().out


@pytest.mark.parametrize("workers", [0, 2])
def test_a_group_simulates_scenes_in_order(workers: int) -> None:
    scenario = scenic.scenarioFromString(PROGRAM)
    scenes = scenario.sample(4, seed=1)
    group = SimulatorGroup(workers, DummySimulator, {"drift": 1}, returnTrajectory=True, returnBytes=True)
    results = group.simulateBatch(scenario, scenes, {"maxSteps": 2})
    assert [result.name for result in results] == ["0", "1", "2", "3"]
    assert [result.finalState[0] for result in results] == [
        (scene.egoObject.position.x, 2, 0) for scene in scenes
    ]
    assert all(len(result.trajectory or ()) == 3 for result in results)
    assert results[0].replayBytes is not None
    again = scenario.simulationFromBytes(results[0].replayBytes, DummySimulator(drift=1), maxSteps=2)
    assert again.result.finalState == results[0].finalState
    if workers:
        wrong = scenic.scenarioFromString("ego = new Object\nrecord 1 / 0\n")
        data = map(wrong.sceneToBytes, wrong.sample(1, seed=0))
        with pytest.raises(ZeroDivisionError):
            next(group.simulateStream(wrong, data, serialized=True))
