"""The driving examples sample and run, and show what they say."""

import math
from pathlib import Path
from typing import Any

import pytest
import shapely
import shapely.affinity

import scenic

FOLDER = Path(__file__).parents[2] / "examples" / "driving"
PROGRAMS = sorted(path.stem for path in FOLDER.glob("*.scenic"))


def loaded(name: str) -> Any:
    return scenic.scenarioFromFile(FOLDER / f"{name}.scenic", mode2D=True)


def simulated(name: str, steps: int, seed: int = 2) -> tuple[Any, Any, dict[str, int]]:
    """Network, simulation, and the numbers of objects by variable."""
    scenario = loaded(name)
    [scene] = scenario.sample(1, seed=seed)
    done = scenario.getSimulator().simulate(scene, maxSteps=steps, name="1")
    assert done is not None
    numbers = {label: index for index, thing in enumerate(scene.objects) if (label := scene.names.get(thing))}
    return scene.objects[0].roadNetwork, done, numbers


def outline(thing: Any, position: Any, orientation: Any) -> Any:
    box = shapely.box(-thing.width / 2, -thing.length / 2, thing.width / 2, thing.length / 2)
    turned = shapely.affinity.rotate(box, orientation.yaw, (0, 0), use_radians=True)
    return shapely.affinity.translate(turned, position.x, position.y)


def apart(done: Any, one: int, other: int) -> float:
    """The least distance in metres between the outlines of two objects during a simulation."""
    things = done.scene.objects
    return min(
        outline(things[one], state.positions[one], state.orientations[one]).distance(
            outline(things[other], state.positions[other], state.orientations[other])
        )
        for state in done.trajectory
    )


@pytest.mark.parametrize("name", PROGRAMS)
def test_examples_sample(name: str) -> None:
    for scene in loaded(name).sample(4, seed=1):
        network = scene.objects[0].roadNetwork
        road = shapely.union_all(
            [item.polygon for item in (*network.allRoads, *network.intersections, *network.shoulders)]
        )
        for thing in scene.objects:
            region = getattr(thing, "regionContainedIn", None)
            if getattr(thing, "isVehicle", False) and getattr(region, "polygons", None) is not None:
                assert road.buffer(0.01).contains(outline(thing, thing.position, thing.orientation))


@pytest.mark.parametrize("name", [name for name in PROGRAMS if not name.startswith("carla")])
def test_examples_run(name: str) -> None:
    scenario = loaded(name)
    done = scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=20, maxIterations=5)
    assert done is not None
    assert done.currentTime > 0


def test_fifteen_programs() -> None:
    assert len(PROGRAMS) >= 15


def test_a_standing_car_is_passed() -> None:
    network, done, numbers = simulated("bypassing", 200)
    ego, standing = numbers["ego"], numbers["standing"]
    assert apart(done, ego, standing) > 0.3
    first, last = done.trajectory[0], done.trajectory[-1]
    obstacle = first.positions[standing]
    assert last.positions[ego].distanceTo(obstacle) > 20
    lanes = {network.laneAt(state.positions[ego]) for state in done.trajectory}
    assert len(lanes) >= 2
    assert network.laneAt(last.positions[ego]) is network.laneAt(first.positions[ego])


def test_a_slow_car_is_overtaken_by_the_oncoming_lane() -> None:
    network, done, numbers = simulated("oncoming_lane", 200)
    ego, slow = numbers["ego"], numbers["slow"]
    assert apart(done, ego, slow) > 0.3
    courses = [[network.laneAt(state.positions[k]) for state in done.trajectory] for k in (ego, slow)]
    assert any(
        lane is not None and lane.uid.startswith("road1") and lane is not courses[1][0] for lane in courses[0]
    )


def test_the_speeds_of_a_trajectory_are_reached() -> None:
    network, done, _ = simulated("trajectory", 200)
    speeds = [speed for _, speed in done.result.records["speed"]]
    assert speeds[-1] == pytest.approx(15, abs=1)
    lane = network.laneAt(done.trajectory[-1].positions[0])
    assert lane is network.roads[0].forwardLanes.lanes[0].adjacentLanes[0]
    assert lane.centerline.distanceTo(done.trajectory[-1].positions[0]) < 0.3


def test_cars_stop_before_what_lies_in_their_lane() -> None:
    _, done, numbers = simulated("roadworks", 150)
    ego, follower, block = (numbers[name] for name in ("ego", "follower", "block"))
    assert apart(done, ego, block) > 0.5
    assert apart(done, follower, ego) > 0.5
    last, before = done.trajectory[-1], done.trajectory[-5]
    assert last.positions[ego].distanceTo(before.positions[ego]) < 0.01


@pytest.mark.parametrize("seed", range(4))
def test_walkers_cross_the_road_unharmed(seed: int) -> None:
    network, done, numbers = simulated("walkers", 200, seed)
    ego, walker, obstacle = (numbers[name] for name in ("ego", "crossing_over", "bin"))
    assert apart(done, walker, obstacle) > 0
    assert apart(done, walker, ego) > 0.3
    ways = [state.positions[walker] for state in done.trajectory]
    assert ways[0].distanceTo(ways[-1]) == pytest.approx(10, abs=0.2)
    assert any(network.laneAt(place) is not None for place in ways)
    assert network.sidewalkAt(ways[0]) is not network.sidewalkAt(ways[-1])


@pytest.mark.parametrize("seed", range(3))
def test_turning_cars_end_in_the_same_lane(seed: int) -> None:
    network, done, _ = simulated("right_turn", 260, seed)
    assert done.result.terminationType.name != "timeLimit"
    ends = [network.laneAt(position) for position in done.trajectory[-1].positions]
    assert ends[0] is not None
    assert ends[0] is ends[1]
    headings = [state.orientations[0].yaw for state in done.trajectory]
    turned = math.remainder(headings[-1] - headings[0], 2 * math.pi)
    assert turned == pytest.approx(-math.pi / 2, abs=0.1)
