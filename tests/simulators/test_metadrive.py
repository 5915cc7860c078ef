"""The adapter to MetaDrive, over a stand-in for the documented interface of its environments.

Headings are anticlockwise from east there, positive steering is to the left, and the origin is the middle of SUMO's network.
"""

import math
import sys
from importlib import import_module
from inspect import signature
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import scenic
from scenic.language.errors import SimulationCreationError, UnsupportedError
from scenic.simulators.metadrive.library import environment, library
from scenic.simulators.metadrive.simulator import middle_of
from tests.maps import cross

NETWORK = '<net><location netOffset="{}" convBoundary="{}" origBoundary="" projParameter=""/></net>'
MIDDLE = (10.0, -4.0)


class Body:
    """Something in MetaDrive: its velocity is kept; vehicles turn and gain speed by their actions."""

    def __init__(self, **given: Any) -> None:
        self.given = given
        self.position = tuple(given["position"])
        self.heading_theta = float(given.get("heading", given.get("heading_theta")))
        self.velocity = (0.0, 0.0)
        self.enable_reverse = False
        self.actions: list[Any] = []

    def before_step(self, action: Any) -> None:
        self.actions.append(list(action))

    def set_position(self, position: Any) -> None:
        self.position = tuple(position)

    def set_heading_theta(self, theta: float) -> None:
        self.heading_theta = theta

    def set_velocity(self, direction: Any) -> None:
        self.velocity = tuple(direction)

    def advance(self, dt: float) -> None:
        if self.actions:
            steering, acceleration = self.actions[-1]
            speed = math.hypot(*self.velocity) + 5 * acceleration * dt
            self.heading_theta += steering * dt
            self.velocity = (speed * math.cos(self.heading_theta), speed * math.sin(self.heading_theta))
        self.position = tuple(
            place + part * dt for place, part in zip(self.position, self.velocity, strict=True)
        )


class Engine:
    def __init__(self) -> None:
        self.managers: dict[str, Any] = {}
        self.bodies: list[Any] = []

    def register_manager(self, name: str, manager: Any) -> None:
        self.managers[name] = manager

    def spawn_object(self, kind: type, **given: Any) -> Any:
        self.bodies.append(kind(**given))
        return self.bodies[-1]


class BaseEnv:
    """An environment with one agent."""

    made: "BaseEnv"

    def __init__(self, config: dict[str, Any]) -> None:
        assert config.keys() <= {
            "use_render", "decision_repeat", "physics_world_step_size", "vehicle_config", "log_level",
        }  # fmt: skip
        self.config = config
        self.shown: list[str] = []
        self.closed = 0
        type(self).__mro__[1].made = self  # type: ignore[attr-defined]

    def setup_engine(self) -> None:
        self.engine = Engine()

    def reset(self) -> Any:
        self.setup_engine()
        position, heading = self.config["vehicle_config"]["spawn_position_heading"]
        self.agent = self.engine.spawn_object(Vehicle, position=position, heading=heading)
        return self.get_single_observation(), {}  # type: ignore[attr-defined]

    def step(self, action: Any) -> Any:
        self.agent.before_step(action)
        for body in self.engine.bodies:
            body.advance(self.config["decision_repeat"] * self.config["physics_world_step_size"])
        return None, self.reward_function(self.agent)[0], self.done_function(self.agent)[0], False, {}  # type: ignore[attr-defined]

    def render(self, mode: str) -> None:
        self.shown.append(mode)

    def close(self) -> None:
        self.closed += 1


class Vehicle(Body):
    pass


class Pedestrian(Body):
    pass


class Barrier(Body):
    pass


PARTS = {
    "metadrive.envs.base_env": {"BaseEnv": BaseEnv},
    "metadrive.obs.observation_base": {"DummyObservation": object},
    "metadrive.manager.sumo_map_manager": {"SumoMapManager": lambda path: SimpleNamespace(path=path)},
    "metadrive.component.vehicle.vehicle_type": {"DefaultVehicle": Vehicle},
    "metadrive.component.traffic_participants.pedestrian": {"Pedestrian": Pedestrian},
    "metadrive.component.static_object.traffic_object": {"TrafficBarrier": Barrier},
}


@pytest.fixture
def metadrive(monkeypatch: pytest.MonkeyPatch) -> type[BaseEnv]:
    for name, content in PARTS.items():
        module = ModuleType(name)
        module.__dict__.update(content)
        parts = name.split(".")
        for count in range(1, len(parts)):
            monkeypatch.setitem(sys.modules, ".".join(parts[:count]), ModuleType(".".join(parts[:count])))
        monkeypatch.setitem(sys.modules, name, module)
    return BaseEnv


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "cross.xodr").write_text(cross(arm=100, half=15))
    # The middle of the network is (90, 54) of coordinates that are moved by (100, 50).
    (tmp_path / "cross.net.xml").write_text(NETWORK.format("100,50", "-10,-46,190,154"))
    return tmp_path


def simulated(folder: Path, text: str, steps: int = 10, **options: Any) -> Any:
    program = f"param map = localPath('cross.xodr')\nmodel scenic.simulators.metadrive.model\n{text}"
    scenario = scenic.scenarioFromString(program, filename=str(folder / "main.scenic"), mode2D=True)
    with scenario.getSimulator() as simulator:
        return simulator.simulate(scenario.sample(1, seed=1)[0], maxSteps=steps, **options)


SCENE = """
behavior Turn():
    take SetThrottleAction(0.5), SetSteerAction(0.2)
    for i in range(3):
        wait
    take SetBrakeAction(1)
    for i in range(2):
        wait
    take SetBrakeAction(0), SetReverseAction(True), SetThrottleAction(0.3)
behavior Walk():
    take SetWalkingDirectionAction(90 deg), SetWalkingSpeedAction(1.5)
walker = new Pedestrian at (-40, -6), facing 0, with regionContainedIn None, with behavior Walk
ego = new Car at (-40, -1.75), facing -90 deg, with behavior Turn, with velocity (2, 0, 0)
other = new Car at (40, 1.75), facing 90 deg
new Debris at (60, 1.75), facing 90 deg
record ego.position as place
record ego.heading as heading
record walker.position as walk
record ego.speed as speed
"""


def test_objects_are_created_driven_and_read_in_metadrives_coordinates(metadrive: Any, folder: Path) -> None:
    done = simulated(folder, SCENE)
    made = BaseEnv.made
    ego, other, walker, barrier = (
        next(body for body in made.engine.bodies if body.given["position"] == [x + MIDDLE[0], y + MIDDLE[1]])
        for x, y in ((-40, -1.75), (40, 1.75), (-40, -6), (60, 1.75))
    )
    assert ego is made.agent
    assert [type(body) for body in (ego, other, walker, barrier)] == [Vehicle, Vehicle, Pedestrian, Barrier]
    assert ego.given["heading"] == pytest.approx(0)
    assert other.given["heading"] == pytest.approx(math.pi)
    assert walker.given["heading_theta"] == pytest.approx(math.pi / 2)
    assert barrier.given["static"] is True
    assert made.config["decision_repeat"] == 5
    assert Path(made.engine.managers["map_manager"].path).name == "cross.net.xml"
    # Steering to the right is negative there; brakes, and the throttle in reverse, are negative accelerations.
    assert ego.actions[0] == [-0.2, 0.5]
    assert ego.actions[5] == [-0.2, -1.0]
    assert ego.actions[-1] == [-0.2, -0.3]
    assert ego.enable_reverse
    assert not other.enable_reverse
    assert all(action == [0, 0] for action in other.actions)
    records = done.result.records
    assert tuple(records["place"][0][1]) == pytest.approx((-40, -1.75, 0))
    assert records["speed"][1][1] == pytest.approx(2.25)
    assert tuple(records["place"][1][1])[:2] == pytest.approx(
        (-40 + 0.225 * math.cos(0.02), -1.75 - 0.225 * math.sin(0.02))
    )
    assert records["heading"][2][1] == pytest.approx(-math.pi / 2 - 0.04)
    # West, from the moment on that it is told.
    assert tuple(records["walk"][-1][1])[:2] == pytest.approx((-41.5, -6))
    assert made.closed == 1
    assert made.shown == []


def test_windows_and_steps(metadrive: Any, folder: Path) -> None:
    text = "param render = True, timestep = 0.04\nego = new Car at (-40, -1.75), facing -90 deg"
    assert simulated(folder, text, steps=3) is not None
    assert BaseEnv.made.shown == ["topdown"] * 3
    assert BaseEnv.made.config["decision_repeat"] == 2
    assert not BaseEnv.made.config["use_render"]
    simulated(folder, f"param render3D = True\n{text}", steps=1)
    assert BaseEnv.made.shown == []
    assert BaseEnv.made.config["use_render"]
    with pytest.raises(SimulationCreationError, match=r"a multiple of 0\.02 s, not 0\.05 s"):
        simulated(folder, text, timestep=0.05)


def test_what_cannot_be_simulated_says_why(
    metadrive: Any, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(SimulationCreationError, match="MetaDrive needs a vehicle"):
        simulated(folder, "ego = new Pedestrian")
    monkeypatch.setitem(sys.modules, "metadrive.envs.base_env", None)
    with pytest.raises(UnsupportedError, match="needs the packages metadrive-simulator and sumolib"):
        simulated(folder, "ego = new Car")
    (folder / "cross.net.xml").write_text("<net/>")
    with pytest.raises((SimulationCreationError, UnsupportedError)):
        simulated(folder, "ego = new Car")


@pytest.mark.parametrize(
    ("offset", "boundary", "projection"),
    [
        # As netconvert 1.2x writes them for a map from (1000, 2000) to (1100, 2000), normalized and not.
        ("-1000.00,-2000.00", "0.00,0.00,100.00,0.00", "!"),
        ("0.00,0.00", "1000.00,2000.00,1100.00,2000.00", "!"),
        ("-692000.00,-5337000.00", "0.00,0.00,100.00,0.00", "+proj=utm +zone=32"),
        ("-691000.00,-5335000.00", "1000.00,2000.00,1100.00,2000.00", "+proj=utm +zone=32"),
    ],
)
def test_the_middle_of_georeferenced_maps(
    tmp_path: Path, offset: str, boundary: str, projection: str
) -> None:
    file = tmp_path / "map.net.xml"
    text = NETWORK.format(offset, boundary).replace('projParameter=""', f'projParameter="{projection}"')
    file.write_text(text)
    x, y = middle_of(file, SimpleNamespace(offset=(691000.0, 5335000.0, 0.0, 0.0)))
    assert (1050 + x, 2000 + y) == (0, 0)


def test_the_library_takes_what_it_is_given(tmp_path: Path) -> None:
    pytest.importorskip("metadrive")
    pytest.importorskip("sumolib")
    parts = library()
    vehicle, engine = parts.DefaultVehicle, import_module("metadrive.engine.base_engine").BaseEngine
    place = [0.0, 0.0]
    calls: list[tuple[Any, tuple[Any, ...], dict[str, Any]]] = [
        (engine.spawn_object, (None, vehicle), {"vehicle_config": {}, "position": place, "heading": 0.0}),
        (vehicle, (), {"vehicle_config": {}, "position": place, "heading": 0.0}),
        (parts.Pedestrian, (), {"position": place, "heading_theta": 0.0}),
        (parts.TrafficBarrier, (), {"position": place, "heading_theta": 0.0, "static": True}),
        (vehicle.before_step, (None, [0.0, 0.0]), {}),
        (engine.register_manager, (None, "map_manager", None), {}),
        (parts.SumoMapManager, ("map.net.xml",), {}),
        (parts.BaseEnv.step, (None, [0.0, 0.0]), {}),
        (parts.BaseEnv.render, (None,), {"mode": "topdown"}),
    ]
    for kind in (vehicle, parts.Pedestrian, parts.TrafficBarrier):
        calls += [
            (kind.set_position, (None, place), {}),
            (kind.set_heading_theta, (None, 0.0), {}),
            (kind.set_velocity, (None, place), {}),
        ]
        for name in ("position", "velocity", "heading_theta"):
            assert isinstance(getattr(kind, name), property)
    for function, given, named in calls:
        signature(function).bind(*given, **named)
    # An unknown setting is an error there.
    made = environment(
        parts,
        tmp_path / "map.net.xml",
        use_render=False,
        decision_repeat=5,
        physics_world_step_size=0.02,
        vehicle_config={"spawn_position_heading": [place, 0.5]},
        log_level=50,
    )
    assert made.config["vehicle_config"]["spawn_position_heading"] == [place, 0.5]
    for name in ("reward_function", "cost_function", "done_function", "get_single_observation"):
        here, there = (signature(getattr(kind, name)).parameters for kind in (type(made), parts.BaseEnv))
        assert len(here) == len(there)
