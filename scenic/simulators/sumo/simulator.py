"""Traffic simulated by SUMO, in this process and without a window.

Vehicles that the program steers move as in the built-in simulator, and are put to their places in SUMO, whose drivers see them.
Those that take `SumoDrivingAction` are driven by SUMO.
"""

import math
import random
import tempfile
from pathlib import Path
from typing import Any

from scenic.domains.driving.simulators import DrivingSimulator
from scenic.language.errors import SimulationCreationError
from scenic.runtime.scenes.scene import Scene
from scenic.simulators.newtonian.simulator import NewtonianSimulation
from scenic.simulators.sumo.library import convert, library
from scenic.simulators.sumo.traffic import Pose, SumoBody, SumoTraffic

__all__ = ["SumoSimulation", "SumoSimulator"]


class SumoSimulation(NewtonianSimulation):
    """One run; see `SumoSimulator`."""

    _may_interrupt_steps = False
    _notes_contacts = False  # Vehicles that have left the map stay in the scene, where others reach them.

    def __init__(self, scene: Scene, network: Path, *, timestep: float, **options: Any) -> None:
        self._network = network
        self._sumo = library()
        self._started = False
        self._traffic = SumoTraffic(self._sumo)
        self._bodies: dict[int, SumoBody] = {}
        self._released: dict[int, float] = {}
        self._heights: dict[int, float] = {}
        super().__init__(scene, timestep=timestep, **options)

    def setup(self) -> None:
        """Start SUMO with the network and create the objects.

        Raises:
            SimulationCreationError: another simulation is running in this process.

        """
        if self._sumo.isLoaded():
            raise SimulationCreationError(
                "SUMO runs one simulation at a time in a process",
                help="end the other one first, or simulate in several processes (`-j N`, `processes=N`)",
            )
        self._sumo.start(
            [
                "sumo",
                *("--net-file", str(self._network), "--step-length", repr(float(self.timestep))),
                # The simulation has its own generator here, so that runs of a seed are alike.
                *("--seed", str(random.getrandbits(31))),
                # Drivers keep to the limit, and nobody vanishes.
                *("--default.speeddev", "0", "--time-to-teleport", "-1", "--collision.action", "none"),
                *("--no-step-log", "true", "--no-warnings", "true", "--duration-log.disable", "true"),
            ]
        )
        self._started = True
        super().setup()
        # Bodies enter SUMO on lanes, in a step of its own before the first.
        self._move_bodies()

    def createObjectInSimulator(self, obj: Any) -> None:
        """Add the object to SUMO."""
        super().createObjectInSimulator(obj)
        size = float(obj.width), float(obj.length), float(obj.height)
        max_speed = float(getattr(obj, "maxSpeed", 0) or 1)
        self._bodies[id(obj)] = self._traffic.add(f"object{len(self._bodies)}", size, max_speed)

    def let_drive(self, agent: object, speed_factor: float) -> None:
        """Let SUMO drive a vehicle in the coming step.

        Args:
            agent: the vehicle.
            speed_factor: of the speed limit.

        """
        self._released[id(agent)] = speed_factor

    def place_in_sumo(self, obj: object) -> Pose | None:
        """Return the pose of an object in SUMO after the last step; ``None`` after it has left the map at a dead end."""
        return self._traffic.pose(self._bodies[id(obj)])

    def steered(self) -> list[Any]:
        """Return the objects that SUMO does not drive already."""
        return [obj for obj in self.objects if not self._drives(obj)]

    def _drives(self, obj: object) -> bool:
        return id(obj) in self._released and self._bodies[id(obj)].speed_factor is not None

    def step(self) -> None:
        """Advance what is steered, then SUMO, and read back what SUMO drives."""
        super().step()
        self._move_bodies()
        for obj in self.objects:
            if id(obj) in self._released:
                self._read(obj)
        self._released.clear()

    def _move_bodies(self) -> None:
        traffic = self._traffic
        for obj in self.objects:
            body, state = self._bodies[id(obj)], self.state_of(obj)
            x, y, _ = state.position
            factor = self._released.get(id(obj))
            if factor is None:
                traffic.put(body, x, y, state.heading)
            else:
                traffic.release(body, x, y, state.heading, state.speed, factor)
        traffic.step(list(self._bodies.values()))

    def _read(self, obj: object) -> None:
        state, pose = self.state_of(obj), self.place_in_sumo(obj)
        if pose is None:
            state.rest()
            return
        # SUMO's heights are those of the road, ours those of the middle of objects.
        above = self._heights.setdefault(id(obj), state.position[2] - pose.z)
        heading_change = (pose.heading - state.heading + math.pi) % (2 * math.pi) - math.pi
        state.rate = heading_change / float(self.timestep)
        state.position = (pose.x, pose.y, pose.z + above)
        state.heading, state.speed = pose.heading, pose.speed
        state.velocity = (-pose.speed * math.sin(pose.heading), pose.speed * math.cos(pose.heading), 0.0)

    def destroy(self) -> None:
        """End SUMO's simulation."""
        super().destroy()
        if self._started:
            self._started = False
            self._sumo.close()


class SumoSimulator(DrivingSimulator):
    """Simulates traffic by SUMO (extra ``sumo``), whose network is made of the map when the first simulation starts.

    Args:
        map_path: the OpenDRIVE file.
        timestep: seconds in a step, unless a simulation asks for another one.

    """

    def __init__(self, map_path: Any, timestep: float = 0.1) -> None:
        super().__init__()
        self.map_path = Path(map_path)
        self.timestep = timestep
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def network(self) -> Path:
        """SUMO's network of the map, a file that lasts as long as the simulator.

        Raises:
            SimulationCreationError: SUMO cannot read the map.

        """
        if self._folder is None:
            folder = tempfile.TemporaryDirectory(prefix="scenic-sumo-")
            try:
                convert(self.map_path, Path(folder.name) / "map.net.xml")
            except BaseException:
                folder.cleanup()
                raise
            self._folder = folder
        return Path(self._folder.name) / "map.net.xml"

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> SumoSimulation:
        """Return a simulation that has run."""
        library()  # Says that it is missing before a map is converted for nothing.
        return SumoSimulation(
            scene, self.network(), timestep=self.timestep if timestep is None else timestep, **options
        )

    def destroy(self) -> None:
        """Remove the network."""
        super().destroy()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None
