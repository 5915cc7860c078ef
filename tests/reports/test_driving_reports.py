"""Reports about driving: walkers, actions of cars, maps, what spawns."""

import re
import sys
import warnings
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from PIL import Image

from scenic.failures import diagnose
from scenic.formats.trajectory_reading import read_trajectory
from scenic.language.errors import (
    InvalidScenarioError,
    RejectionException,
    ScenicTypeError,
    ScenicWarning,
    SimulationCreationError,
)
from scenic.simulators.kinematic import KinematicSimulator
from scenic.simulators.newtonian.simulator import NewtonianSimulator
from scenic.simulators.numbered_simulations import simulate_number
from scenic.simulators.simulator import Simulator
from tests.cli.commands import run_here
from tests.maps import RoadText, lane, lanes, line, map_text, straight
from tests.reports.programs import Programs, programs, values  # noqa: F401 - a fixture


def test_walkers_walk(programs: Programs) -> None:  # noqa: F811
    """1.5 m/s towards -x for 2 s are 3 m."""
    result = programs.simulated(
        "behavior Walk():\n    take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(1.5)\n"
        "    while True:\n        wait\n"
        "ego = new Car\nwalker = new Pedestrian at (50, -4.5), facing 90 deg, with behavior Walk()\n"
        "record walker.position as place\n",
        20,
        map="street",
    )
    places = values(result, "place")
    assert tuple(places[-1] - places[0]) == pytest.approx((-3, 0, 0))


def test_the_library_lets_walkers_walk(programs: Programs) -> None:  # noqa: F811
    result = programs.simulated(
        "ego = new Car\nwalker = new Pedestrian at (50, -4.5), facing 90 deg, with behavior WalkForwardBehavior()\n"
        "record walker.position as place\n",
        20,
        map="street",
    )
    places = values(result, "place")
    assert abs(places[-1].x - places[0].x) > 1


def speeds(programs: Programs, actions: str) -> list[float]:  # noqa: F811
    """The speed along the heading at each of 21 states, from 5 m/s."""
    result = programs.simulated(
        f"behavior Act():\n    while True:\n        take {actions}\n"
        "ego = new Car at (50, -1.75), facing -90 deg, with speed 5, with behavior Act()\nrecord ego.velocity.x as v\n",
        20,
        map="street",
    )
    return values(result, "v")


def test_speed_actions(programs: Programs) -> None:  # noqa: F811
    assert speeds(programs, "SetSpeedAction(7)")[-1] == pytest.approx(7)


def test_reverse_is_backwards(programs: Programs) -> None:  # noqa: F811
    forwards = speeds(programs, "[SetThrottleAction(1)]")
    backwards = speeds(programs, "[SetReverseAction(True), SetThrottleAction(1)]")
    assert forwards[-1] > 5
    assert backwards[-1] < 0
    assert forwards[-1] - 5 == pytest.approx(5 - backwards[-1], rel=0.01)


def test_the_hand_brake_stops(programs: Programs) -> None:  # noqa: F811
    assert speeds(programs, "[SetThrottleAction(1), SetHandBrakeAction(True)]")[-1] == pytest.approx(0)


@pytest.mark.parametrize(
    "simulator", ["newtonian.driving_model", "carla.model", "metadrive.model", "sumo.model"]
)
def test_cars_of_every_simulator_take_the_actions(programs: Programs, simulator: str) -> None:  # noqa: F811
    """None is left to the domain's own methods, which refuse."""
    scenario = programs.compiled("ego = new Car\n", map="street", model=f"scenic.simulators.{simulator}")
    car = type(scenario.sample(1, seed=1)[0].egoObject)
    for name in ("setReverse", "setHandbrake", "setThrottle", "setBraking", "setSteering"):
        assert getattr(car, name).__module__ != "scenic.domains.driving.actions", name
    assert getattr(car, "setVelocity").__module__ != "scenic.domains.driving.model"  # noqa: B009 - by name, as above


def test_missing_opposite_lanes_give_a_reason(programs: Programs) -> None:  # noqa: F811
    with pytest.raises(InvalidScenarioError) as caught:
        programs.compiled("ego = new Car on network.lanes[0].group.opposite\n", map="one_way")
    assert caught.value.lineno == 3
    assert "has no opposite group" in str(caught.value.help)


def test_networks_depend_on_the_options_of_the_map(programs: Programs) -> None:  # noqa: F811
    text = (
        "param map = localPath('street.xodr'), map_options = {{'tolerance': {}}}\n"
        "model scenic.domains.driving.model\nego = new Object\nparam tolerance = network.tolerance\n"
    )
    found = [programs.compiled(text.format(t)).generate()[0].params["tolerance"] for t in (0.05, 0.5, 0.05)]
    assert found == [0.05, 0.5, 0.05]


def test_header_offsets_do_not_move_roads(programs: Programs) -> None:  # noqa: F811
    """Coordinates are those of the file; the offset is applied where they leave."""
    text = straight(300).replace(
        '<header revMajor="1" revMinor="4"/>',
        '<header revMajor="1" revMinor="4"><offset x="100" y="50" z="0" hdg="0"/></header>',
    )
    (programs.folder / "moved.xodr").write_text(text)
    starts = [
        programs.compiled("ego = new Car\nparam start = network.roads[0].centerline.points[0]\n", map=name)
        .generate()[0]
        .params["start"]
        for name in ("street", "moved")
    ]
    assert starts[0] == starts[1]


class _Carla:
    """A server that has one blueprint, and no room."""

    def get_server_version(self) -> str:
        return "0.9.15"

    def get_client_version(self) -> str:
        return "0.9.14"

    def set_timeout(self, _: float) -> None:
        """Wait so long for answers."""

    def get_available_maps(self) -> list[str]:
        return ["street"]

    def load_world(self, _: str) -> "_Carla":
        return self

    def get_trafficmanager(self, _: int) -> Any:
        return SimpleNamespace(set_synchronous_mode=lambda _: None)

    def get_settings(self) -> Any:
        return SimpleNamespace()

    def apply_settings(self, _: Any) -> None:
        """Take settings."""

    def set_weather(self, _: Any) -> None:
        """Let it rain."""

    def get_actors(self) -> Any:
        return SimpleNamespace(filter=lambda _: [])

    def get_blueprint_library(self) -> Any:
        blueprint = SimpleNamespace(id="vehicle.audi.tt", has_attribute=lambda _: False)
        library = [blueprint]
        return type(
            "Library",
            (list,),
            {"filter": lambda _, name: [each for each in library if each.id == name]},
        )(library)

    def try_spawn_actor(self, *_: Any) -> None:
        """Find something in the place."""


@pytest.mark.filterwarnings("ignore:CARLA's catalogues have no blueprint")
@pytest.mark.parametrize(
    ("blueprint", "message"),
    [
        (
            "vehicle.audi.ttt",
            r"this CARLA \(server 0.9.15, client 0.9.14\) has no blueprint 'vehicle.audi.ttt'",
        ),
        (
            "vehicle.audi.tt",
            r"CARLA cannot spawn <unnamed Car>, the blueprint 'vehicle.audi.tt', at \(50.00, -1.75, 0.00\)",
        ),
    ],
)
def test_what_cannot_be_spawned_is_named(
    programs: Programs,  # noqa: F811
    monkeypatch: pytest.MonkeyPatch,
    blueprint: str,
    message: str,
) -> None:
    fake: Any = ModuleType("carla")
    fake.Client = lambda *_: _Carla()
    fake.Location = fake.Rotation = lambda **values: SimpleNamespace(**values)
    fake.Transform = fake.WeatherParameters = lambda *_, **__: None
    monkeypatch.setitem(sys.modules, "carla", fake)
    warnings.simplefilter("ignore", ScenicWarning)  # of the first blueprint
    scenario = programs.compiled(
        f"param weather = {{'precipitation': 1}}\nego = new Car at (50, -1.75), facing -90 deg, with blueprint '{blueprint}'\n",
        map="street",
        model="scenic.simulators.carla.model",
    )
    with pytest.raises(SimulationCreationError, match=message):
        scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=1)


def test_rejections_by_lanes_name_object_time_and_line(programs: Programs) -> None:  # noqa: F811
    """A car drives off the end of its street at 20 m/s."""
    scenario = programs.compiled(
        "behavior B():\n    while True:\n        here = self.lane\n        wait\n"
        "ego = new Car at (290, -2), with velocity (20, 0, 0), with behavior B()\n",
        map="street",
        mode2D=True,
    )
    found = simulate_number(scenario, NewtonianSimulator(), seed=1, k=0, tries=3, maxSteps=40, timestep=0.1)
    ((reason, times),) = found.rejections
    assert (found.simulation, found.is_random, times) == (None, False, 1)
    assert re.fullmatch(r"object is not in a lane: ego \(line 7\), at [0-9.]+ s, line 5", reason)


def test_tables_of_rejections_quote_what_is_missing(programs: Programs) -> None:  # noqa: F811
    """Some places are in no lane."""
    scenario = programs.compiled(
        "ego = new Object in RectangularRegion((150, 0), 0, 300, 40), with regionContainedIn everywhere\n"
        "x = network.laneAt(ego, reject=True)\nrequire ego.x > 1000\nparam lane = x.uid\n",
        map="street",
    )
    with pytest.raises(RejectionException) as caught:
        scenario.sample(1, seed=1, max_attempts=50)
    assert "`x.uid` is missing (line 6)" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "simulator", "message"),
    [
        (
            "ego = new Car at (50, -2), with behavior FollowLaneBehavior(8)\n",
            KinematicSimulator,
            "KinematicSimulation cannot drive cars and knows no traffic lights",
        ),
        (
            "monitor Lights():\n    freezeTrafficLights()\n    wait\nego = new Car at (50, -2)\nrequire monitor Lights()\n",
            KinematicSimulator,
            "KinematicSimulation cannot drive cars and knows no traffic lights",
        ),
        (
            "ego = new Car at (50, -2)\n",
            NewtonianSimulator,
            "<unnamed Car> is a vehicle of another simulator's model",
        ),
    ],
)
def test_cars_of_one_simulator_in_another_say_what_to_do(
    programs: Programs,  # noqa: F811
    text: str,
    simulator: type[Simulator],
    message: str,
) -> None:
    scene = programs.compiled(text, map="street", model="scenic.simulators.carla.model", mode2D=True).sample(
        1
    )[0]
    with pytest.raises((InvalidScenarioError, SimulationCreationError), match=message) as caught:
        simulator().simulate(scene, maxSteps=2)
    assert "scenic.simulators.newtonian.driving_model" in (caught.value.help or "")


@pytest.mark.parametrize(
    ("call", "line", "message"),
    [
        (
            "FollowLaneBehavior(target_speed='fast')",
            13,
            "`target_speed` of FollowLaneBehavior: expected a number, not 'fast' (str)",
        ),
        ("Own(text)", 4, "`target_speed` of FollowLaneBehavior: expected a number, not 'fast' (str)"),
        ("Other(lane)", 6, "the lane to change to: expected a lane or a lane section, not None"),
        ("Third(4)", 8, "the trajectory: expected lanes or lines in a list that is not empty"),
        ("Fourth(4)", 10, "where to walk: expected places, not 4 (int)"),
        ("FollowLaneBehavior(comfort=3)", 13, "`comfort`: expected a `Comfort`, not 3 (int)"),
        ("FollowLaneBehavior(laneToFollow=network.roads[0])", 13, "`laneToFollow`: expected a lane, not"),
        ("FollowLaneBehavior(follow_gap=-1)", 13, "no car keeps -1 s behind others"),
        ("FollowVehicleBehavior(3)", 13, "the vehicle to follow: expected an object of the simulation"),
        ("DriveByRulesBehavior(ignore=3)", 13, "`ignore`: expected names of rules in a set, not 3 (int)"),
        ("FollowLaneBehavior(comfort=Comfort(jerk=0))", 13, "jerk of `Comfort` must be more than 0, not 0"),
    ],
)
def test_errors_of_library_behaviors_are_at_the_program(
    programs: Programs,  # noqa: F811
    call: str,
    line: int,
    message: str,
) -> None:
    text = (
        "behavior Own(x):\n    do FollowLaneBehavior(x)\n"
        "behavior Other(x):\n    do LaneChangeBehavior(laneSectionToSwitch=x)\n"
        "behavior Third(x):\n    do FollowTrajectoryBehavior(trajectory=x)\n"
        "behavior Fourth(x):\n    do Walk(x)\n"
        "text = Uniform('fast', 'fast')\nlane = Uniform(None, None)\n"
    )
    kind = "Pedestrian" if "Fourth" in call else "Car"
    with pytest.raises((ScenicTypeError, InvalidScenarioError)) as caught:
        programs.simulated(text + f"ego = new {kind} with behavior {call}\n", 3, map="street")
    found = diagnose(caught.value)
    assert found is not None
    assert found.span is not None
    assert (found.filename, found.span.line) == (str(programs.path), line)
    assert found.message.startswith(message)


def test_the_built_in_simulator_drives_cars_of_the_plain_driving_model(programs: Programs) -> None:  # noqa: F811
    """Its option brings the model that it needs; by itself such a car keeps its velocity."""
    plain = {"map": "street", "model": "scenic.domains.driving.model"}
    programs.compiled("ego = new Car at (50, -2), with behavior FollowLaneBehavior(8)\n", **plain)
    course = run_here(
        [
            "simulate",
            programs.path,
            "--simulator",
            "newtonian",
            "--steps",
            30,
            "-o",
            programs.folder / "driven",
        ]
    )
    assert course.returncode == 0, course.stderr
    (kept,) = (programs.folder / "driven").glob("*.jsonl")
    x, *_ = read_trajectory(kept).position(0)[-1]
    assert x > 55
    scene = programs.compiled("ego = new Car at (50, -2), with velocity (4, 0, 0)\n", **plain).sample(1)[0]
    coasted = NewtonianSimulator().simulate(scene, maxSteps=10, timestep=0.1)
    assert coasted is not None
    assert coasted.result.trajectory[-1].positions[0] == pytest.approx((54, -2, 0))


def test_errors_of_library_defaults_are_at_the_program(programs: Programs) -> None:  # noqa: F811
    with pytest.raises(ScenicTypeError) as caught:
        programs.compiled("ego = new Car with roadDeviation 'y'\n", map="street")
    assert (caught.value.filename, caught.value.line) == (str(programs.path), 3)
    assert [label.text for label in caught.value.labels] == ["raised here"]


def test_films_are_written_without_a_display(
    programs: Programs,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = programs.compiled("ego = new Car at (50, -2), with velocity (10, 0, 0)\n", map="street").sample(
        1, seed=1
    )[0]
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    simulator = NewtonianSimulator(render=True, export_gif=True)
    assert simulator.simulate(scene, maxSteps=3, timestep=0.1) is not None
    with Image.open(tmp_path / "simulation.gif") as film:
        assert (film.n_frames, film.info["duration"]) == (4, 100)
    NewtonianSimulator(render=True).simulate(scene, maxSteps=1)
    assert [path.name for path in tmp_path.iterdir()] == ["simulation.gif"]


def test_regions_looked_up_at_random_places_contain_objects(programs: Programs) -> None:  # noqa: F811
    """The second lane has one to its left; where the look-up gives none, the object may be anywhere."""
    two = RoadText("1", 200, line(0, 0, 0, 200), lanes("", lane(-1) + lane(-2)))
    (programs.folder / "two.xodr").write_text(map_text([two]))
    scenario = programs.compiled(
        "ego = new Car\nother = new Object at (Range(20, 180), Range(-6.5, -0.5)), with allowCollisions True,\n"
        "    with regionContainedIn network.laneSectionAt(ego)._laneToLeft\n",
        map="two",
        mode2D=True,
    )
    network = scenario.sample(1, seed=1)[0].egoObject.roadNetwork
    places: dict[bool, list[float]] = {True: [], False: []}
    for scene in scenario.sample(60, seed=1):
        ego, other = scene.objects
        places[network.laneSectionAt(ego)._laneToLeft is None].append(other.position.y)
    assert len(places[False]) > 9
    assert all(-3.5 <= y <= 0 for y in places[False])
    assert min(places[True]) < -4
    assert max(places[True]) > -3
