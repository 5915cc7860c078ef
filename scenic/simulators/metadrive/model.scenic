"""The driving world model for MetaDrive. Sampling needs neither the simulator nor its package."""

import pathlib

from scenic.domains.driving.model import *
from scenic.simulators.metadrive.simulator import MetaDriveSimulator
from scenic.simulators.newtonian.controls import Driven, Walking

param timestep = 0.1
param render = False
param render3D = False
param real_time = False
param sumo_map = pathlib.Path(globalParameters.map).with_suffix('.net.xml')

simulator MetaDriveSimulator(
    sumo_map=globalParameters.sumo_map,
    map_path=globalParameters.map,
    timestep=float(globalParameters.timestep),
    render=bool(globalParameters.render),
    render3D=bool(globalParameters.render3D),
    real_time=bool(globalParameters.real_time),
)


class MetaDriveActor(DrivingObject):
    """An object of MetaDrive."""

    metaDriveActor: None


class Vehicle(Driven, Vehicle, MetaDriveActor):
    """A vehicle."""


class Car(Vehicle):
    """A car."""

    @property
    def isCar(self):
        return True


class NPCCar(Car):
    """A car."""


class Bicycle(Vehicle, Bicycle):
    pass


class Motorcycle(Vehicle, Motorcycle):
    pass


class Truck(Vehicle, Truck):
    pass


class Bus(Vehicle, Bus):
    pass


class Pedestrian(Walking, Pedestrian, MetaDriveActor):
    """A pedestrian."""


class Debris(MetaDriveActor):
    """Something on the road that does not move; MetaDrive shows it as a barrier."""

    position: new Point on road
    yaw: Range(0, 360) deg
