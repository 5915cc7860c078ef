"""The driving world model, simulated by SUMO."""

from scenic.domains.driving.model import *
from scenic.simulators.carla.lights import (
    freezeTrafficLights, getClosestTrafficLightStatus, getTrafficLightStatus, setAllIntersectionTrafficLightsStatus,
    setClosestTrafficLightStatus, setTrafficLightStatus, unfreezeTrafficLights, withinDistanceToRedYellowTrafficLight,
    withinDistanceToTrafficLight,
)
from scenic.simulators.newtonian.controls import Driven, Walking
from scenic.simulators.sumo.actions import *
from scenic.simulators.sumo.behaviors import *
from scenic.simulators.sumo.simulator import SumoSimulator

param timestep = 0.1

simulator SumoSimulator(globalParameters.map, timestep=float(globalParameters.timestep))


class SumoActor(DrivingObject):
    """Anything that SUMO knows of."""


class Vehicle(Driven, Vehicle, SumoActor):
    pass


class Car(Vehicle):
    @property
    def isCar(self):
        return True


class NPCCar(Car):
    """A car that SUMO drives, if it is given no other behavior."""

    behavior: SumoDriver()


class Bicycle(Vehicle, Bicycle):
    pass


class Motorcycle(Vehicle, Motorcycle):
    pass


class Truck(Vehicle, Truck):
    pass


class Bus(Vehicle, Bus):
    pass


class Pedestrian(Walking, Pedestrian, SumoActor):
    pass


class Debris(SumoActor):
    """Something on the road that does not move."""

    position: new Point on road
    yaw: Range(0, 360) deg
