"""The adapter to CARLA, written against the documented interface of its Python client.

CARLA's axes are left-handed: its y is south, and its yaw is in degrees clockwise from east. The package ``carla`` is needed only
where a simulation runs.
"""

import math
from collections.abc import Mapping
from typing import Any, Final

from scenic.domains.driving.simulators import DrivingSimulation, DrivingSimulator
from scenic.language.errors import SimulationCreationError, UnsupportedError
from scenic.language.spelling import nearest
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Vector

__all__ = ["CarlaSimulation", "CarlaSimulator", "TrafficLights"]

_LIFT: Final = 0.5
"""Metres by which actors are spawned above the ground, so that they do not touch it."""

_COLORS: Final = ("Red", "Yellow", "Green", "Off", "Unknown")


def _client_library() -> Any:
    try:
        import carla  # optional: the client comes with the simulator
    except ImportError as error:
        raise UnsupportedError(
            "simulating with CARLA needs the package carla and a running simulator",
            help="pip install carla in the version of the simulator; sampling scenes needs neither",
        ) from error
    return carla


class CarlaSimulator(DrivingSimulator):
    """A connection to a running CARLA server, made when the first simulation starts.

    Args:
        carla_map: name of the map in CARLA.
        map_path: the OpenDRIVE file, from which a world is generated if CARLA has no such map.
        address: of the server.
        port: of the server.
        timeout: seconds to wait for an answer.
        render: whether the server renders.
        record: folder for recordings, if any.
        timestep: seconds in a step.
        traffic_manager_port: of the traffic manager.

    """

    def __init__(
        self,
        carla_map: str,
        map_path: Any,
        address: str = "127.0.0.1",
        port: int = 2000,
        timeout: float = 10,
        render: bool = True,
        record: str = "",
        timestep: float = 0.1,
        traffic_manager_port: int | None = None,
    ) -> None:
        super().__init__()
        self.carla_map = carla_map
        self.map_path = map_path
        self.timestep = timestep
        self._where = (address, port)
        self._timeout = timeout
        self._render = render
        self._record = record
        self._manager_port = port + 6000 if traffic_manager_port is None else traffic_manager_port
        self._connected: tuple[Any, Any, Any] | None = None
        self._runs = 0

    def connect(self) -> tuple[Any, Any, Any]:
        """Return the client, the world and the traffic manager; raises `SimulationCreationError` if the server does not answer."""
        if self._connected is not None:
            return self._connected
        carla = _client_library()
        client = carla.Client(*self._where)
        client.set_timeout(self._timeout)
        try:
            names = [name.rpartition("/")[2] for name in client.get_available_maps()]
            if self.carla_map in names:
                world = client.load_world(self.carla_map)
            else:
                with open(self.map_path, encoding="utf-8") as stream:
                    world = client.generate_opendrive_world(stream.read())
        except RuntimeError as error:
            address, port = self._where
            raise SimulationCreationError(
                f"no CARLA server answers at {address}:{port}: {error}",
                help="start CARLA, or set `param address` and `param port`",
            ) from error
        manager = client.get_trafficmanager(self._manager_port)
        manager.set_synchronous_mode(True)
        settings = world.get_settings()
        settings.synchronous_mode = True
        settings.fixed_delta_seconds = self.timestep
        settings.no_rendering_mode = not self._render
        world.apply_settings(settings)
        self._connected = client, world, manager
        return self._connected

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> "CarlaSimulation":
        """Return a simulation that has run."""
        if timestep is not None and timestep != self.timestep:
            raise SimulationCreationError(
                "CARLA's step is fixed when the connection is made", help="set `param timestep`"
            )
        self._runs += 1
        client, world, manager = self.connect()
        recording = f"{self._record}/scenario{self._runs}.log" if self._record else ""
        return CarlaSimulation(scene, client, world, manager, recording, timestep=self.timestep, **options)

    def destroy(self) -> None:
        """Give the server its own pace back."""
        if self._connected is not None:
            _, world, manager = self._connected
            settings = world.get_settings()
            settings.synchronous_mode = False
            settings.fixed_delta_seconds = None
            world.apply_settings(settings)
            manager.set_synchronous_mode(False)
        super().destroy()


class CarlaSimulation(DrivingSimulation):
    """One run in CARLA."""

    def __init__(
        self, scene: Scene, client: Any, world: Any, manager: Any, recording: str, **options: Any
    ) -> None:
        self._carla = _client_library()
        self._client, self._world, self._manager = client, world, manager
        self._recording = recording
        self._actors: dict[int, Any] = {}
        self._controls: dict[int, Any] = {}
        self.traffic_lights = TrafficLights(self._carla, world)
        """The traffic lights of the world."""
        super().__init__(scene, **options)

    def setup(self) -> None:
        """Set the weather, create the actors and let them settle."""
        weather = self.scene.params.get("weather")
        if isinstance(weather, str):
            self._world.set_weather(getattr(self._carla.WeatherParameters, weather))
        elif isinstance(weather, Mapping):
            self._world.set_weather(self._carla.WeatherParameters(**weather))
        if self._recording:
            self._client.start_recorder(self._recording)
        super().setup()
        self._world.tick()
        for obj in self.objects:
            if any(obj.velocity):
                self.push(obj, obj.velocity)

    def createObjectInSimulator(self, obj: Any) -> None:
        """Spawn the object's blueprint."""
        if obj.blueprint is None:
            raise SimulationCreationError(
                f"{obj!r} has no blueprint, so CARLA cannot create it", help="use a class of the CARLA model"
            )
        library = self._world.get_blueprint_library()
        blueprints = library.filter(obj.blueprint)
        if not len(blueprints):
            versions = (
                f"server {self._client.get_server_version()}, client {self._client.get_client_version()}"
            )
            near = nearest(obj.blueprint, (each.id for each in library))
            raise SimulationCreationError(
                f"this CARLA ({versions}) has no blueprint {obj.blueprint!r}",
                help="give another one, `with blueprint ...`" if near is None else f"did you mean {near!r}?",
            )
        blueprint = blueprints[0]
        if obj.rolename is not None and blueprint.has_attribute("role_name"):
            blueprint.set_attribute("role_name", obj.rolename)
        if blueprint.has_attribute("is_invincible"):
            blueprint.set_attribute("is_invincible", "False")
        if blueprint.has_attribute("color") and getattr(obj, "color", None) is not None:
            blueprint.set_attribute("color", ",".join(str(round(255 * part)) for part in obj.color[:3]))
        transform = self._carla.Transform(self._location(obj), self._rotation(obj.heading))
        actor = self._world.try_spawn_actor(blueprint, transform)
        if actor is None:
            place = ", ".join(f"{part:.2f}" for part in obj.position)
            raise SimulationCreationError(
                f"CARLA cannot spawn {obj!r}, the blueprint {obj.blueprint!r}, at ({place})",
                help="something may be in its place",
            )
        actor.set_simulate_physics(obj.physics)
        self._actors[id(obj)] = actor
        obj.__dict__["carlaActor"] = actor
        extent = actor.bounding_box.extent
        if min(extent.x, extent.y, extent.z) > 0:
            obj.__dict__.update(width=2 * extent.y, length=2 * extent.x, height=2 * extent.z)
        if getattr(obj, "isVehicle", False):
            self._controls[id(obj)] = self._carla.VehicleControl()
        elif getattr(obj, "isPedestrian", False):
            self._controls[id(obj)] = self._carla.WalkerControl()
            self.walk(obj, heading=obj.heading, speed=0.0)

    def _location(self, obj: Any) -> Any:
        x, y, z = obj.position
        location = self._carla.Location(x=x, y=-y, z=z)
        if obj.snapToGround:
            location.z = 1000.0
            ground = self._world.ground_projection(location, 2000.0)
            location.z = (0.0 if ground is None else ground.location.z) + _LIFT
        return location

    def _rotation(self, heading: float) -> Any:
        return self._carla.Rotation(yaw=-math.degrees(heading) - 90)

    # Commands

    def place(self, obj: Any, position: Any) -> None:
        """Teleport an actor."""
        x, y, z = position
        self._actors[id(obj)].set_location(self._carla.Location(x=x, y=-y, z=z))

    def set_transform(self, obj: Any, position: Any, heading: float) -> None:
        """Teleport and turn an actor."""
        x, y, z = position
        location = self._carla.Location(x=x, y=-y, z=z)
        self._actors[id(obj)].set_transform(self._carla.Transform(location, self._rotation(heading)))

    def push(self, obj: Any, velocity: Any) -> None:
        """Set an actor's velocity; a walker's by its own control."""
        x, y, z = velocity
        speed = math.sqrt(x * x + y * y + z * z)
        if getattr(obj, "isPedestrian", False):
            control = self._controls[id(obj)]
            control.speed = speed
            if speed:
                control.direction = self._carla.Vector3D(x=x / speed, y=-y / speed, z=z / speed)
        else:
            self._actors[id(obj)].set_target_velocity(self._carla.Vector3D(x=x, y=-y, z=z))

    def walk(self, obj: object, *, heading: float | None = None, speed: float | None = None) -> None:
        """Set the direction (radians, anticlockwise from north) or the speed (m/s) of a walker; the other one stays."""
        control = self._controls[id(obj)]
        if heading is not None:
            control.direction = self._carla.Vector3D(x=-math.sin(heading), y=-math.cos(heading), z=0.0)
        if speed is not None:
            control.speed = speed

    def set_angular_velocity(self, obj: object, velocity: Any) -> None:
        """Set an actor's angular velocity (radians a second)."""
        x, y, z = (math.degrees(part) for part in velocity)
        self._actors[id(obj)].set_target_angular_velocity(self._carla.Vector3D(x=-x, y=y, z=-z))

    def control(self, obj: object, **values: Any) -> None:
        """Set parts of a vehicle's control."""
        for name, value in values.items():
            setattr(self._controls[id(obj)], name, value)

    def set_autopilot(self, obj: Any, enabled: bool, **options: Any) -> None:
        """Let the traffic manager drive a vehicle."""
        actor = self._actors[id(obj)]
        actor.set_autopilot(enabled, self._manager.get_port())
        self._controls.pop(id(obj), None)
        for name, value in options.items():
            getattr(self._manager, name)(actor, value)

    def track_waypoints(self, obj: Any, waypoints: Any, speed: float) -> None:
        """Steer a vehicle to the first waypoint that is ahead of it."""
        for point in waypoints:
            offset = point - obj.position
            ahead = offset.y * math.cos(obj.heading) - offset.x * math.sin(obj.heading)
            if ahead > 2:
                aside = offset.x * math.cos(obj.heading) + offset.y * math.sin(obj.heading)
                self.control(obj, steer=max(-1.0, min(1.0, math.atan2(aside, ahead))))
                break
        self.control(obj, throttle=0.5 if obj.speed < speed else 0.0)

    # Steps

    def executeActions(self, allActions: Any) -> None:
        """Let the actions set controls, and send these."""
        super().executeActions(allActions)
        for obj in self.agents:
            control = self._controls.get(id(obj))
            if control is not None:
                self._actors[id(obj)].apply_control(control)

    def step(self) -> None:
        """Advance the server by one tick."""
        self._world.tick()

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """The present state of an actor."""
        actor = self._actors[id(obj)]
        transform, speed, spin = actor.get_transform(), actor.get_velocity(), actor.get_angular_velocity()
        heading = -math.radians(transform.rotation.yaw) - math.pi / 2
        yaw = (heading - obj.parentOrientation.yaw + math.pi) % (2 * math.pi) - math.pi
        location = transform.location
        velocity = Vector.of((speed.x, -speed.y, speed.z))
        angular = Vector.of((-math.radians(spin.x), math.radians(spin.y), -math.radians(spin.z)))
        values: dict[str, Any] = {
            "position": Vector.of((location.x, -location.y, location.z)),
            "velocity": velocity,
            "speed": velocity.norm(),
            "angularVelocity": angular,
            "angularSpeed": angular.norm(),
            "yaw": yaw,
            "pitch": math.radians(transform.rotation.pitch),
            "roll": math.radians(transform.rotation.roll),
            "elevation": location.z,
        }
        attributes = obj.__dict__
        return {name: values[name] if name in values else attributes[name] for name in properties}

    def closest_traffic_light(self, vehicle: object, distance: float) -> str:
        """Return the colour of the light that governs a vehicle within a distance, in small letters; ``none`` if there is none."""
        light = self._closest(vehicle, distance)
        return "none" if light is None else str(light.get_state()).rpartition(".")[2].lower()

    def set_closest_traffic_light(self, vehicle: object, color: str, distance: float) -> None:
        """Set the light that governs a vehicle within a distance."""
        light = self._closest(vehicle, distance)
        if light is not None:
            light.set_state(self.traffic_lights.state(color))

    def _closest(self, vehicle: Any, distance: float) -> Any:
        light = self._actors[id(vehicle)].get_traffic_light()
        if light is None:
            return None
        place = light.get_location()
        x, y, _ = vehicle.position
        return light if math.hypot(place.x - x, -place.y - y) <= distance else None

    def destroy(self) -> None:
        """Remove the actors."""
        for actor in self._actors.values():
            actor.destroy()
        if self._recording:
            self._client.stop_recorder()
        super().destroy()


class TrafficLights:
    """The traffic lights of a world."""

    def __init__(self, carla: Any, world: Any) -> None:
        self._carla, self._world = carla, world

    def state(self, color: str) -> Any:
        """CARLA's state for a colour; raises ``ValueError`` for unknown ones."""
        name = color.capitalize()
        if name not in _COLORS:
            raise ValueError(f"a traffic light is {', '.join(map(str.lower, _COLORS))}, not {color!r}")
        return getattr(self._carla.TrafficLightState, name)

    def set(self, signal: Any, color: str) -> None:
        """Set the light of a signal of the road network."""
        light = self._world.get_traffic_light_from_opendrive_id(signal.openDriveID)
        if light is not None:
            light.set_state(self.state(color))

    def get(self, signal: Any) -> str:
        """Return the colour of the light of a signal, in small letters; ``none`` if the world has no such light."""
        light = self._world.get_traffic_light_from_opendrive_id(signal.openDriveID)
        return "none" if light is None else str(light.get_state()).rpartition(".")[2].lower()

    def freeze(self, frozen: bool) -> None:
        """Stop all lights, or let them change again."""
        self._world.freeze_all_traffic_lights(frozen)
