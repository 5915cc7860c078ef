"""The world model of the driving domain: a road network, cars and pedestrians on it, and what they do."""

import math
from typing import Optional
from scenic.core.sensors import Sensor
from scenic.core.simulators import Action
from scenic.domains.driving.actions import *
from scenic.domains.driving.behaviors import *
from scenic.domains.driving.controllers import (
    PIDLateralController, PIDLongitudinalController, PurePursuitLateralController,
)
from scenic.domains.driving.roads import (
    Intersection, Lane, LaneGroup, LaneSection, ManeuverType, Network, NetworkElement, PedestrianCrossing, Road,
    RoadSection, Shoulder, Sidewalk,
)
from scenic.domains.driving.signals import FreezeTrafficLightsAction, SetTrafficLightAction
from scenic.domains.driving.speed_profiles import Comfort
from scenic.domains.driving.sensors import RGBSensor, SSSensor
from scenic.domains.driving.setting import check_lights, is2DMode, nearer, network_of_program, standing
from scenic.runtime.program.builtins import present_objects
from scenic.domains.driving.workspace import DrivingWorkspace
from scenic.simulators.utils.colors import Color
from scenic.core.distributions import RejectionException

param use2DMap = is2DMode()
param map_options = {}
param traffic_lights = {}

network = network_of_program(globalParameters)
check_lights(globalParameters, network)
workspace = DrivingWorkspace(network)

road = network.drivableRegion
curb = network.curbRegion
sidewalk = network.sidewalkRegion
shoulder = network.shoulderRegion
roadOrShoulder = road.union(shoulder)
intersection = network.intersectionRegion
roadDirection = network.roadDirection


class DrivingObject:
    """Anything that takes part in traffic."""

    elevation[dynamic]: None if is2DMode() else float(self.position.z)
    requireVisible: False

    @property
    def isVehicle(self):
        return False

    @property
    def isCar(self):
        return False

    @property
    def isPedestrian(self):
        return False

    @property
    def roadNetwork(self) -> Network:
        return network

    @property
    def lane(self) -> Lane:
        return network.laneAt(self, reject='object is not in a lane')

    @property
    def _lane(self) -> Lane:
        return network.laneAt(self)

    @property
    def laneSection(self) -> LaneSection:
        return network.laneSectionAt(self, reject='object is not in a lane')

    @property
    def _laneSection(self) -> LaneSection:
        return network.laneSectionAt(self)

    @property
    def laneGroup(self) -> LaneGroup:
        return network.laneGroupAt(self, reject='object is not in a lane')

    @property
    def _laneGroup(self) -> LaneGroup:
        return network.laneGroupAt(self)

    @property
    def oppositeLaneGroup(self) -> LaneGroup:
        return self.laneGroup.opposite

    @property
    def road(self) -> Road:
        return network.roadAt(self, reject='object is not on a road')

    @property
    def _road(self) -> Road:
        return network.roadAt(self)

    @property
    def intersection(self) -> Intersection:
        return network.intersectionAt(self, reject='object is not in an intersection')

    @property
    def _intersection(self) -> Intersection:
        return network.intersectionAt(self)

    @property
    def crossing(self) -> PedestrianCrossing:
        return network.crossingAt(self, reject='object is not in a crossing')

    @property
    def _crossing(self) -> PedestrianCrossing:
        return network.crossingAt(self)

    @property
    def element(self) -> NetworkElement:
        return network.elementAt(self, reject='object is not on any network element')

    @property
    def _element(self) -> NetworkElement:
        return network.elementAt(self)

    def distanceToClosest(self, type):
        """The distance to the nearest other object of a class in metres; infinite if there is none."""
        closest = float('inf')
        for other in present_objects():
            if other is not self and isinstance(other, type):
                away = distance from self to other
                if 0 < away < closest:
                    closest = away
        return closest

    def setPosition(self, pos, elevation):
        raise NotImplementedError('the simulator does not say how objects are moved')

    def setOrientation(self, orientation):
        raise NotImplementedError('the simulator does not say how objects are turned')

    def setVelocity(self, vel):
        raise NotImplementedError('the simulator does not say how velocities are set')


class Vehicle(DrivingObject):
    """A vehicle somewhere on the road, facing along it."""

    regionContainedIn: roadOrShoulder
    position: new Point on road
    roadDeviation: 0
    parentOrientation: (roadDirection at self.position) + self.roadDeviation
    viewAngle: 90 deg
    width: 2
    length: 4.5
    height: 1.5
    color: Color.defaultCarColor()
    appearance: 'car'
    wheelbase: 0.6 * self.length
    maxSteeringAngle: 35 deg
    wheelDiameter: 0.7
    trackWidth: 0.85 * self.width
    groundClearance: 0.5 * self.wheelDiameter
    maxSpeed: 45
    maxAcceleration: 5
    maxDeceleration: 10
    longitudinalController: None
    lateralController: None

    @property
    def isVehicle(self):
        return True


if network.is_elevated:

    class Vehicle(Vehicle):
        """A vehicle that stands on the road, inclined as it is."""

        position: standing(new OrientedPoint on road)


class Car(Vehicle):
    """A car."""

    @property
    def isCar(self):
        return True


class NPCCar(Car):
    """A car that may be simulated coarsely."""


class Bicycle(Vehicle):
    """A bicycle with its rider."""

    appearance: 'bicycle'
    width: 0.6
    length: 1.8
    height: 1.7
    maxSteeringAngle: 45 deg
    maxSpeed: 12
    maxAcceleration: 1.5
    maxDeceleration: 4


class Motorcycle(Vehicle):
    """A motorcycle with its rider."""

    appearance: 'motorcycle'
    width: 0.8
    length: 2.2
    height: 1.6
    wheelbase: 0.65 * self.length
    maxSteeringAngle: 40 deg
    maxSpeed: 55
    maxAcceleration: 6


class Truck(Vehicle):
    """A truck."""

    appearance: 'truck'
    width: 2.5
    length: 7.5
    height: 3.2
    maxSteeringAngle: 40 deg
    wheelDiameter: 1.0
    maxSpeed: 30
    maxAcceleration: 1.5
    maxDeceleration: 7


class Bus(Vehicle):
    """A bus."""

    appearance: 'bus'
    width: 2.5
    length: 11
    height: 3.1
    wheelbase: 0.52 * self.length
    maxSteeringAngle: 45 deg
    wheelDiameter: 1.0
    maxSpeed: 28
    maxAcceleration: 1.5
    maxDeceleration: 7


class Pedestrian(DrivingObject):
    """A pedestrian somewhere on a sidewalk or a crossing."""

    regionContainedIn: network.walkableRegion
    position: new Point on network.walkableRegion
    parentOrientation: Range(0, 360) deg
    viewAngle: 90 deg
    width: 0.75
    length: 0.75
    height: 1.75
    color: [0, 0.5, 1]
    appearance: 'pedestrian'
    mass: 65

    @property
    def isPedestrian(self):
        return True


if network.is_elevated:

    class Pedestrian(Pedestrian):
        """A pedestrian who stands upright on the ground."""

        position: standing(new Point on network.walkableRegion)


def withinDistanceToAnyCars(car, thresholdDistance):
    """Whether some other vehicle is nearer than the threshold, in any direction."""
    return bool(nearer(present_objects(), car, thresholdDistance, Vehicle))


def withinDistanceToAnyObjs(vehicle, thresholdDistance):
    """Whether the vehicle sees some object nearer than the threshold."""
    return any(vehicle can see other for other in nearer(present_objects(), vehicle, thresholdDistance, Object))


def withinDistanceToAnyPedestrians(vehicle, thresholdDistance):
    """Whether the vehicle sees a pedestrian nearer than the threshold to its front."""
    front = front of vehicle
    for other in nearer(present_objects(), vehicle, thresholdDistance + vehicle.length, Pedestrian):
        if (distance from front to other) < thresholdDistance and (vehicle can see other):
            return True
    return False


def withinDistanceToObjsInLane(vehicle, thresholdDistance):
    """Whether the vehicle sees some object nearer than the threshold in its lane, or in its intersection."""
    for other in nearer(present_objects(), vehicle, thresholdDistance, Object):
        if not (vehicle can see other):
            continue
        inter = network.intersectionAt(vehicle)
        if inter is not None:
            if inter is network.intersectionAt(other):
                return True
        else:
            own = network.laneAt(vehicle)
            if own is not None and own is network.laneAt(other):
                return True
    return False


