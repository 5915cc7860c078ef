"""The adapter to MetaDrive, written against the documented interface of its environments.

MetaDrive's headings are anticlockwise from east, and the origin of its maps is the middle of SUMO's network.
"""

import math
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree

from scenic.domains.driving.simulators import DrivingSimulation, DrivingSimulator
from scenic.language.errors import SimulationCreationError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Vector
from scenic.simulators.cameras import Cameras
from scenic.simulators.metadrive.library import environment, library
from scenic.simulators.newtonian.controls import Walking
from scenic.simulators.sumo.library import convert

__all__ = ["MetaDriveSimulation", "MetaDriveSimulator"]

_PHYSICS_STEP: Final = 0.02
"""Seconds of a step of MetaDrive's physics, of which a step of the simulation has several."""


class MetaDriveSimulator(DrivingSimulator):
    """Runs MetaDrive in this process; an environment is made for each simulation.

    Args:
        sumo_map: SUMO's network of the map, a ``.net.xml`` file; made of ``map_path`` by ``netconvert`` if there is none.
        map_path: the OpenDRIVE file.
        timestep: seconds in a step, a multiple of 0.02.
        render: whether to show a window.
        render3D: whether that shows the scene in space, rather than from above.
        real_time: whether a step takes as long as it simulates, at least.

    """

    def __init__(
        self,
        sumo_map: Any = None,
        map_path: Any = None,
        timestep: float = 0.1,
        render: bool = False,
        render3D: bool = False,
        real_time: bool = False,
    ) -> None:
        super().__init__()
        self.timestep = timestep
        self._sumo_map = sumo_map
        self._map_path = map_path
        self._shown = render, render3D
        self._real_time = real_time
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def network(self) -> Path:
        """SUMO's network of the map: that which was given, or lies beside the map, or is made of it.

        Raises:
            SimulationCreationError: there is no map, or SUMO cannot read it.

        """
        if self._sumo_map is not None and Path(self._sumo_map).is_file():
            return Path(self._sumo_map)
        if self._map_path is None:
            raise SimulationCreationError(
                f"there is no SUMO network {self._sumo_map}", help="make it by `netconvert --opendrive-files`"
            )
        if self._folder is None:
            folder = tempfile.TemporaryDirectory(prefix="scenic-metadrive-")
            convert(Path(self._map_path), Path(folder.name) / "map.net.xml")
            self._folder = folder
        return Path(self._folder.name) / "map.net.xml"

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> "MetaDriveSimulation":
        """Return a simulation that has run."""
        step = self.timestep if timestep is None else timestep
        if not math.isclose(step, round(step / _PHYSICS_STEP) * _PHYSICS_STEP) or step <= 0:
            raise SimulationCreationError(
                f"MetaDrive's step is a multiple of {_PHYSICS_STEP} s, not {step:g} s",
                help="set `param timestep`",
            )
        return MetaDriveSimulation(
            scene, self.network(), shown=self._shown, real_time=self._real_time, timestep=step, **options
        )

    def destroy(self) -> None:
        """Remove what was made of the map."""
        super().destroy()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None


class MetaDriveSimulation(DrivingSimulation):
    """One run in MetaDrive."""

    def __init__(
        self, scene: Scene, network: Path, *, shown: tuple[bool, bool], real_time: bool, **options: Any
    ) -> None:
        self._library = library()
        self._network = network
        self._shown = shown
        self._real_time = real_time
        self._middle = middle_of(network, getattr(scene.workspace, "network", None))
        self._environment: Any = None
        self._first: Any = None
        self._actors: dict[int, Any] = {}
        self._cameras = Cameras()
        super().__init__(scene, **options)

    def setup(self) -> None:
        """Start MetaDrive with the first vehicle as its agent, and create the others.

        Raises:
            SimulationCreationError: the scene has no vehicle.

        """
        self._first = next((obj for obj in self.scene.objects if getattr(obj, "isVehicle", False)), None)
        if self._first is None:
            raise SimulationCreationError(
                "MetaDrive needs a vehicle, which is its agent", help="put a car into the scene"
            )
        render, space = self._shown
        self._environment = environment(
            self._library,
            self._network,
            use_render=render and space,
            decision_repeat=round(float(self.timestep) / _PHYSICS_STEP),
            physics_world_step_size=_PHYSICS_STEP,
            vehicle_config={
                "spawn_position_heading": [self._place(self._first.position), _theta(self._first.heading)]
            },
            log_level=50,
        )
        self._environment.reset()
        super().setup()

    def createObjectInSimulator(self, obj: Any) -> None:
        """Spawn a vehicle, a pedestrian or, for anything else, a barrier."""
        place, theta = self._place(obj.position), _theta(obj.heading)
        spawn = self._environment.engine.spawn_object
        if obj is self._first:
            actor = self._environment.agent
        elif getattr(obj, "isVehicle", False):
            actor = spawn(self._library.DefaultVehicle, vehicle_config={}, position=place, heading=theta)
        elif getattr(obj, "isPedestrian", False):
            actor = spawn(self._library.Pedestrian, position=place, heading_theta=theta)
        else:
            actor = spawn(self._library.TrafficBarrier, position=place, heading_theta=theta, static=True)
        self._actors[id(obj)] = actor
        obj.__dict__["metaDriveActor"] = actor
        if getattr(obj, "isVehicle", False):
            obj.resetControls()
        if isinstance(obj, Walking):
            obj.resetGait()
        if any(obj.velocity):
            self.push(obj, obj.velocity)

    # What actions and behaviors do

    def place(self, obj: object, position: object) -> None:
        """Move an object."""
        self._actors[id(obj)].set_position(self._place(position))

    def turn(self, obj: object, heading: float) -> None:
        """Turn an object to a heading in radians."""
        self._actors[id(obj)].set_heading_theta(_theta(heading))

    def push(self, obj: Any, velocity: Any) -> None:
        """Set the velocity of an object."""
        x, y, *_ = velocity
        self._actors[id(obj)].set_velocity([x, y])

    def sense(self) -> None:
        """Let cameras see, by the built-in renderer."""
        self._cameras.deliver(self)
        super().sense()

    def step(self) -> None:
        """Drive every vehicle by its controls, and advance the environment."""
        start_time = time.monotonic()
        ego_action = [0.0, 0.0]
        for obj in self.objects:
            if getattr(obj, "isVehicle", False):
                actor = self._actors[id(obj)]
                action = _action(actor, obj.controls)
                if actor is self._environment.agent:
                    ego_action = action
                else:
                    actor.before_step(action)
        self._environment.step(ego_action)
        render, space = self._shown
        if render and not space:
            self._environment.render(mode="topdown")
        if self._real_time:
            time.sleep(max(0.0, float(self.timestep) - (time.monotonic() - start_time)))

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """The present state of an object."""
        actor, attributes = self._actors[id(obj)], obj.__dict__
        x, y = (float(part) for part in actor.position[:2])
        vx, vy = (float(part) for part in actor.velocity[:2])
        heading = actor.heading_theta - math.pi / 2
        yaw = (heading - obj.parentOrientation.yaw + math.pi) % (2 * math.pi) - math.pi
        values: dict[str, Any] = {
            "position": Vector.of((x - self._middle[0], y - self._middle[1], obj.position.z)),
            "velocity": Vector.of((vx, vy, 0.0)),
            "speed": math.hypot(vx, vy),
            "yaw": yaw,
        }
        return {name: values[name] if name in values else attributes[name] for name in properties}

    def _place(self, position: Any) -> list[float]:
        x, y, *_ = position
        return [float(x) + self._middle[0], float(y) + self._middle[1]]

    def destroy(self) -> None:
        """Close the environment."""
        super().destroy()
        if self._environment is not None:
            self._environment.close()
            self._environment = None


def _theta(heading: float) -> float:
    """Convert a heading from north to MetaDrive's, from east; radians."""
    return float(heading) + math.pi / 2


def _action(actor: Any, controls: Any) -> list[float]:
    """Return steering, to the left from 0 to 1, and acceleration from -1 to 1."""
    brake = max(controls.brake, controls.handbrake)
    # MetaDrive takes negative accelerations for the brake, or for driving backwards.
    actor.enable_reverse = controls.reverse and not brake
    acceleration = -brake if brake else -controls.throttle if controls.reverse else controls.throttle
    return [-float(controls.steering), float(acceleration)]


def middle_of(network: Path, roads: Any) -> tuple[float, float]:
    """Return what MetaDrive adds to the coordinates of the map: SUMO's offset, and the vector from the middle of its network to 0.

    SUMO's offset of a georeferenced network is that from the projection: the offset of the map's header counts in it.

    Args:
        network: SUMO's network.
        roads: the network of the map; ``None`` if the scene has none.

    """
    for _, element in ElementTree.iterparse(network):
        if element.tag == "location":
            left, bottom, right, top = map(float, element.attrib["convBoundary"].split(","))
            x, y = map(float, element.attrib["netOffset"].split(","))
            if roads is not None and element.attrib.get("projParameter", "!") not in ("", "!"):
                x, y = x + roads.offset[0], y + roads.offset[1]
            return x - (left + right) / 2, y - (bottom + top) / 2
    raise SimulationCreationError(
        f"{network} is no network of SUMO: it has no location",
        help="make it by `netconvert --opendrive-files`",
    )
