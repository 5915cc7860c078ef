"""The adapter to CARLA over the types of its real client library, of which no server is needed.

Objects of a server (client, world, actors, ...) are stand-ins: whatever the adapter asks of them has to be there in the library's
own class, and arguments have to be those that the signature there takes. Data (places, controls, weather, ...) are the library's.
"""

import math
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import scenic
from scenic.language.errors import SimulationCreationError
from tests.maps import cross

carla = pytest.importorskip("carla")

PARAMETER = re.compile(r"\((\w+)\)(\w+)")
PLAIN = {"int": int, "float": (int, float), "str": str, "bool": bool}
LIGHT = '<signal id="7" s="99" t="-4" zOffset="3" orientation="+" dynamic="yes" country="OpenDRIVE" type="1000001" subtype="-1"/>'


def fits(value: object, kind: str) -> bool:
    if kind in PLAIN:
        return isinstance(value, PLAIN[kind]) and (kind == "bool" or not isinstance(value, bool))
    if isinstance(value, Served):
        return issubclass(value.served, getattr(carla, kind))
    return kind == "object" or isinstance(value, getattr(carla, kind))


def takes(signature: str, given: tuple[Any, ...], named: dict[str, Any]) -> bool:
    """Return whether a signature of Boost, such as ``f( (T)self, (int)a [, (str)b='']) -> None``, takes arguments."""
    required, _, optional = signature.rpartition(" -> ")[0].partition("[")
    parameters = PARAMETER.findall(required)[1:]
    least, parameters = len(parameters), parameters + PARAMETER.findall(optional)
    names = [name for _, name in parameters]
    kinds = {name: kind for kind, name in parameters}
    if len(given) > len(names) or not set(named) <= set(names[len(given) :]):
        return False
    values = dict(zip(names, given, strict=False)) | named
    return set(names[:least]) <= set(values) and all(
        fits(value, kinds[name]) for name, value in values.items()
    )


class Served:
    """Stands for an object of a server: its answers are given, what it is asked is checked and kept."""

    def __init__(self, served: type, **answers: Any) -> None:
        self.served, self.answers = served, answers
        self.calls: list[tuple[Any, ...]] = []

    def __getattr__(self, name: str) -> Any:
        member = getattr(self.served, name)  # of the library
        if isinstance(member, property):
            return self.answers[name]
        signatures = [line for line in (member.__doc__ or "").splitlines() if line.startswith(f"{name}(")]
        assert signatures, f"{self.served.__name__}.{name} has no signature"

        def call(*given: Any, **named: Any) -> Any:
            assert any(takes(signature, given, named) for signature in signatures), (signatures, given, named)
            self.calls.append((name, *given, *named.values()))
            answer = self.answers.get(name)
            return answer(*given, **named) if callable(answer) else answer

        return call

    def __len__(self) -> int:
        return len(self.answers["items"])

    def __getitem__(self, index: int) -> Any:
        return self.answers["items"][index]

    def asked(self, name: str) -> list[Any]:
        return [call[1:] for call in self.calls if call[0] == name]


class Server:
    """A world with actors that move as they were told to, and a light that is red."""

    def __init__(self, has_map: bool = False, lacks: str = "") -> None:
        self.lacks = lacks
        self.actors: list[Served] = []
        self.settings = carla.WorldSettings()
        self.light = Served(
            carla.TrafficLight, get_state=carla.TrafficLightState.Red, get_location=carla.Location(20, -2, 0)
        )
        self.manager = Served(carla.TrafficManager, get_port=8000)
        self.world = Served(
            carla.World,
            get_settings=self.settings,
            get_blueprint_library=Served(carla.BlueprintLibrary, filter=self.blueprints, items=[]),
            ground_projection=None,
            try_spawn_actor=self.spawn,
            tick=self.tick,
            get_traffic_light_from_opendrive_id=self.light,
        )
        self.client = Served(
            carla.Client,
            get_available_maps=["/Game/Carla/Maps/map"] if has_map else [],
            load_world=self.world,
            generate_opendrive_world=self.world,
            get_trafficmanager=self.manager,
            get_server_version="0.9.16",
            get_client_version="0.9.16",
        )

    def blueprints(self, pattern: str) -> Any:
        blueprint = Served(
            carla.ActorBlueprint, id=pattern, has_attribute=lambda name: name in ("role_name", "color")
        )
        return Served(carla.BlueprintLibrary, items=[] if pattern == self.lacks else [blueprint])

    def spawn(self, blueprint: Served, transform: Any) -> Served:
        here = carla.Transform(transform.location, transform.rotation)
        state = SimpleNamespace(transform=here, velocity=carla.Vector3D())
        is_walker = blueprint.id.startswith("walker")
        actor = Served(
            carla.Walker if is_walker else carla.Vehicle,
            bounding_box=carla.BoundingBox(carla.Location(), carla.Vector3D(2.2, 0.9, 0.7)),
            get_transform=lambda: state.transform,
            get_velocity=lambda: state.velocity,
            get_angular_velocity=carla.Vector3D(0, 0, 90),
            set_target_velocity=lambda velocity: setattr(state, "velocity", velocity),
            set_transform=lambda transform: setattr(state, "transform", transform),
            set_location=lambda place: setattr(state.transform, "location", place),
            get_traffic_light=self.light,
        )
        actor.__dict__["state"] = state
        self.actors.append(actor)
        return actor

    def tick(self) -> int:
        for actor in self.actors:
            place, velocity = actor.state.transform.location, actor.state.velocity
            place.x, place.y = place.x + 0.1 * velocity.x, place.y + 0.1 * velocity.y
        return 1


PROGRAM = """
import carla
param map = localPath('map.xodr'), weather = 'ClearNoon', record = 'films'
model scenic.simulators.carla.model
behavior Drive():
    setClosestTrafficLightStatus(self, 'green')
    freezeTrafficLights()
    take SetThrottleAction(0.5), SetSteerAction(-0.25), SetVehicleLightStateAction(carla.VehicleLightState.Brake)
    take SetBrakeAction(1), SetHandBrakeAction(True), SetReverseAction(True)
    take SetAngularVelocityAction((0, 0, 1)), SetTransformAction((10, 1.75, 0), 90 deg), SetSpeedAction(3)
    take SetAutopilotAction(True, vehicle_percentage_speed_difference=30, auto_lane_change=False)
behavior Stroll():
    take SetWalkingDirectionAction(90 deg), SetWalkingSpeedAction(1.5)
ego = new Car at (40, 1.75), facing 90 deg, with behavior Drive, with velocity (-5, 0, 0), with blueprint 'vehicle.tesla.model3',
    with color (1, 0.5, 0), with rolename 'hero'
new Pedestrian at (30, 8), with regionContainedIn everywhere, with behavior Stroll
record final (ego.width, ego.length, ego.height) as size
record getClosestTrafficLightStatus(ego) as light
record getTrafficLightStatus(network.signals[0]) as same
"""


def simulated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, server: Server, program: str) -> Any:
    (tmp_path / "map.xodr").write_text(cross(arm=100, half=15, signal=LIGHT))
    monkeypatch.setattr(carla, "Client", lambda address, port: server.client)
    scenario = scenic.scenarioFromString(program, filename=str(tmp_path / "main.scenic"), mode2D=True)
    simulator = scenario.getSimulator()
    done = simulator.simulate(scenario.sample(1, seed=1)[0], maxSteps=4)
    simulator.destroy()
    return done


@pytest.mark.parametrize("has_map", [False, True])
def test_what_it_asks_of_the_server_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_map: bool
) -> None:
    server = Server(has_map)
    done = simulated(tmp_path, monkeypatch, server, PROGRAM)
    car, walker = server.actors
    assert len(server.client.asked("load_world" if has_map else "generate_opendrive_world")) == 1
    assert (server.settings.synchronous_mode, server.settings.fixed_delta_seconds) == (False, None)
    assert server.world.asked("set_weather") == [(carla.WeatherParameters.ClearNoon,)]
    # CARLA's y is south, its yaw clockwise from east: west is 180 degrees.
    ((blueprint, transform), _) = server.world.asked("try_spawn_actor")
    assert (transform.location.x, transform.location.y) == pytest.approx((40, -1.75))
    assert math.cos(math.radians(transform.rotation.yaw)) == pytest.approx(-1)
    assert blueprint.asked("set_attribute") == [("role_name", "hero"), ("color", "255,128,0")]
    assert done.result.records["size"] == pytest.approx((1.8, 4.4, 1.4))
    states = [state.positions[0] for state in done.trajectory]
    assert [state[0] for state in states[:3]] == pytest.approx([40, 39.5, 39])
    assert states[3][:2] == pytest.approx((10 - 0.3, 1.75))
    # The controls are objects that the adapter changes, so that what was applied last is what all show.
    (control,) = {id(call[0]): call[0] for call in car.asked("apply_control")}.values()
    shown = (control.throttle, control.steer, control.brake, control.hand_brake, control.reverse)
    assert shown == pytest.approx((0.5, -0.25, 1, True, True))
    assert car.asked("set_light_state") == [(carla.VehicleLightState.Brake,)]
    assert car.asked("set_autopilot") == [(True, 8000)]
    assert server.manager.asked("vehicle_percentage_speed_difference") == [(car, 30)]
    walking = walker.asked("apply_control")[-1][0]
    assert walking.speed == pytest.approx(1.5)
    assert (walking.direction.x, walking.direction.y) == pytest.approx((-1, 0), abs=1e-6)
    assert {value for _, value in done.result.records["light"]} == {"red"}
    assert {value for _, value in done.result.records["same"]} == {"red"}
    assert server.light.asked("set_state") == [(carla.TrafficLightState.Green,)]
    assert server.world.asked("freeze_all_traffic_lights") == [(True,)]
    assert all(actor.asked("destroy") for actor in server.actors)


def test_a_blueprint_that_the_server_lacks_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = "vehicle.tesla.model3"
    with pytest.raises(
        SimulationCreationError, match=rf"server 0\.9\.16, client 0\.9\.16.*no blueprint '{name}'"
    ):
        simulated(tmp_path, monkeypatch, Server(lacks=name), PROGRAM)


def test_a_server_that_does_not_answer_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "map.xodr").write_text(cross())
    text = "param map = localPath('map.xodr'), port = 1, timeout = 0.2\nmodel scenic.simulators.carla.model\nego = new Car\n"
    scenario = scenic.scenarioFromString(text, filename=str(tmp_path / "main.scenic"), mode2D=True)
    with pytest.raises(SimulationCreationError, match=r"no CARLA server answers at 127\.0\.0\.1:1"):
        scenario.getSimulator().simulate(scenario.sample(1, seed=1)[0], maxSteps=1)


def test_weathers_of_the_model_are_there() -> None:
    model = (Path(scenic.__file__).parent / "simulators" / "carla" / "model.scenic").read_text()
    (names,) = re.findall(r"param weather = Uniform\((.*?)\)", model, re.DOTALL)
    weathers = re.findall(r"'(\w+)'", names)
    assert len(weathers) == 14
    for weather in weathers:
        assert isinstance(getattr(carla.WeatherParameters, weather), carla.WeatherParameters)
