"""The driving world model for LGSVL, which is discontinued: programs for it can be sampled."""

from scenic.domains.driving.model import *
from scenic.simulators.lgsvl.actions import *
from scenic.simulators.lgsvl.behaviors import *
from scenic.simulators.lgsvl.simulator import LGSVLSimulator

param time_step = 1 / 10

simulator LGSVLSimulator()


class LGSVLObject(DrivingObject):
    """An object of LGSVL."""

    lgsvlObject: None
    lgsvlName: None


class Vehicle(Vehicle, LGSVLObject):
    """A vehicle."""


class Car(Vehicle):
    """A car."""

    @property
    def isCar(self):
        return True


class EgoCar(Car):
    """A car with an autopilot."""


class NPCCar(Car):
    """A car that the simulator drives."""


class Pedestrian(Pedestrian, LGSVLObject):
    """A pedestrian."""
