"""The driving world model, simulated by the built-in simulator."""

from scenic.domains.driving.model import *
from scenic.simulators.carla.lights import (
    freezeTrafficLights, getClosestTrafficLightStatus, getTrafficLightStatus, setAllIntersectionTrafficLightsStatus,
    setClosestTrafficLightStatus, setTrafficLightStatus, unfreezeTrafficLights, withinDistanceToRedYellowTrafficLight,
    withinDistanceToTrafficLight,
)
from scenic.simulators.newtonian.controls import Driven, Walking
from scenic.simulators.newtonian.simulator import NewtonianSimulator

param render = False
render = globalParameters.render

simulator NewtonianSimulator(network)


class NewtonianActor(DrivingObject):
    """An object of the built-in simulator."""


class Vehicle(Driven, Vehicle, NewtonianActor):
    pass


class Car(Vehicle):
    @property
    def isCar(self):
        return True


class NPCCar(Car):
    pass


class Bicycle(Vehicle, Bicycle):
    pass


class Motorcycle(Vehicle, Motorcycle):
    pass


class Truck(Vehicle, Truck):
    pass


class Bus(Vehicle, Bus):
    pass


class Pedestrian(Walking, Pedestrian, NewtonianActor):
    pass


class Debris:
    """Something on the road that does not move."""

    position: new Point on road
    yaw: Range(0, 360) deg


if network.is_elevated:

    class Debris(Debris):
        """Something that lies on the road, inclined as it is."""

        position: standing(new OrientedPoint on road)
        parentOrientation: roadDirection at self.position
