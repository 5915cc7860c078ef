"""SUMO beside the built-in simulator; all but the last tests need its packages."""

import math
import os
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.language.errors import SimulationCreationError, SimulationError, UnsupportedError
from scenic.simulators.sumo.actions import SumoDrivingAction
from scenic.simulators.sumo.library import convert, library
from tests.maps import cross

MAPS = os.environ.get("SCENIC_TEST_MAPS")
needs_sumo = pytest.mark.skipif(find_spec("libsumo") is None, reason="the extra sumo is not installed")

TEN = """
param map = {map!r}
model scenic.simulators.{model}
for i in range(5):
    new Car with behavior FollowLaneBehavior(target_speed=8)
for i in range(5):
    new NPCCar
"""


@pytest.fixture
def crossing(tmp_path: Path) -> Path:
    (tmp_path / "cross.xodr").write_text(cross(arm=100, half=15))
    return tmp_path


def simulated(text: str, steps: int, watch: Any = None, folder: Path | None = None) -> Any:
    """The states of a simulation (x, y, heading of each object) and what it was; ``watch`` is called for each state."""
    scenario = scenic.scenarioFromString(text, filename=str((folder or Path()) / "main.scenic"), mode2D=True)
    states = []

    def see(simulation: Any, *_: Any) -> None:
        states.append([(*obj.position[:2], obj.heading) for obj in simulation.objects])
        if watch is not None:
            watch(simulation)

    with scenario.getSimulator() as simulator:
        scene = scenario.sample(1, seed=3)[0]
        done = simulator.simulate(scene, maxSteps=steps, key=b"3", on_state=see)
    return states, done


@needs_sumo
@pytest.mark.skipif(MAPS is None, reason="SCENIC_TEST_MAPS names no folder")
def test_ten_vehicles_on_a_town() -> None:
    road_map = str(Path(MAPS or "") / "Town01.xodr")
    sumo = library()
    excess, collisions, apart = [], [], []

    def watch(simulation: Any) -> None:
        if simulation.currentTime == 0:
            return
        collisions.extend(sumo.simulation.getCollisions())
        for obj in simulation.objects[:5]:
            place = simulation.place_in_sumo(obj)
            apart.append(math.dist((place.x, place.y), obj.position[:2]))
        cars = [f"object{number}" for number in range(5, 10)]
        excess.extend(sumo.vehicle.getSpeed(car) - sumo.vehicle.getAllowedSpeed(car) for car in cars)

    ours, _ = simulated(TEN.format(map=road_map, model="newtonian.driving_model"), 300)
    theirs, _ = simulated(TEN.format(map=road_map, model="sumo.model"), 300, watch)
    assert len(ours) == len(theirs) == 301
    for one, other in zip(ours, theirs, strict=True):
        for left, right in zip(one[:5], other[:5], strict=True):
            assert left == pytest.approx(right, abs=1e-3)
    # SUMO has what is steered where we have it.
    assert max(apart) < 1e-3
    assert max(excess) < 1e-6
    assert collisions == []
    assert (
        max(math.dist(start[:2], end[:2]) for start, end in zip(theirs[0][5:], theirs[-1][5:], strict=True))
        > 50
    )


@needs_sumo
def test_drivers_stop_behind_what_the_program_steers_and_go_on_as_before(crossing: Path) -> None:
    text = """
param map = localPath('cross.xodr')
model scenic.simulators.sumo.model
behavior Stop():
    do SumoDriver() for 2 seconds
    take SetBrakeAction(1)
ego = new Car at (-40, -1.75), facing -90 deg, with behavior Stop
follower = new NPCCar at (-60, -1.75), facing -90 deg
record distance from ego to follower as gap
record follower.speed as speed
"""
    states, done = simulated(text, 150, folder=crossing)
    records = done.result.records
    assert records["speed"][-1][1] == pytest.approx(0, abs=1e-3)
    assert 4.5 < records["gap"][-1][1] < 9.5
    # Taken from SUMO, the car goes on from where it was.
    steps = [math.dist(one[0][:2], other[0][:2]) for one, other in pairwise(states)]
    assert max(steps[2:]) < 1.4
    again, _ = simulated(text, 150, folder=crossing)
    assert states == again


@needs_sumo
@pytest.mark.parametrize("speed", [0, 6])
def test_sumo_takes_cars_over_at_their_own_speed(crossing: Path, speed: int) -> None:
    text = f"""
param map = localPath('cross.xodr')
model scenic.simulators.sumo.model
ego = new Car at (-90, -1.75), facing -90 deg, with speed {speed}, with behavior SumoDriver
record ego.speed as speed
"""
    _, done = simulated(text, 40, folder=crossing)
    speeds = [value for _, value in done.result.records["speed"]]
    assert speeds[1] == pytest.approx(speed)
    # SUMO's cars accelerate by 2.6 m/s^2.
    assert max(after - before for before, after in pairwise(speeds)) < 0.35
    assert speeds[-1] > speed + 5


@needs_sumo
def test_what_cannot_be_simulated_says_why(crossing: Path) -> None:
    lost = """
param map = localPath('cross.xodr')
model scenic.simulators.sumo.model
behavior Lost():
    take SetPositionAction((5000, 5000))
    do SumoDriver()
ego = new Car at (-40, -1.75), facing -90 deg, with behavior Lost
"""
    with pytest.raises(SimulationError, match="no lane for a vehicle at"):
        simulated(lost, 5, folder=crossing)
    # That one was ended; of two that run, the second is refused.
    scenario = scenic.scenarioFromString(lost, filename=str(crossing / "main.scenic"), mode2D=True)
    scene = scenario.sample(1, seed=1)[0]
    with (
        scenario.getSimulator() as simulator,
        simulator.simulateStepped(scene),
        pytest.raises(SimulationCreationError, match="one simulation at a time"),
    ):
        simulator.simulate(scene, maxSteps=1)
    empty = crossing / "empty.xodr"
    empty.write_text("<OpenDRIVE></OpenDRIVE>")
    with pytest.raises(SimulationCreationError, match="SUMO cannot read the map"):
        convert(empty, crossing / "empty.net.xml")


def test_without_its_packages_programs_sample_and_simulations_say_what_is_missing(
    crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "libsumo", None)
    text = "param map = localPath('cross.xodr')\nmodel scenic.simulators.sumo.model\nego = new NPCCar"
    with pytest.raises(UnsupportedError, match="needs the packages libsumo"):
        simulated(text, 5, folder=crossing)


def test_only_vehicles_are_left_to_sumo_and_factors_are_positive(crossing: Path) -> None:
    text = "param map = localPath('cross.xodr')\nmodel scenic.simulators.sumo.model\nego = new Car\nnew Pedestrian"
    scenario = scenic.scenarioFromString(text, filename=str(crossing / "main.scenic"), mode2D=True)
    car, walker = scenario.sample(1, seed=1)[0].objects
    assert SumoDrivingAction().canBeTakenBy(car)
    assert not SumoDrivingAction().canBeTakenBy(walker)
    with pytest.raises(RuntimeError, match="must be positive"):
        SumoDrivingAction(0)
