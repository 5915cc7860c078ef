"""World model for traffic at an intersection given by guideways: set the intersection first (`setLocalIntersection`)."""

from scenic.simulators.utils.colors import Color
from scenic.simulators.webots.guideways.intersection import intersection_of_program
from scenic.simulators.webots.simulator import OutsideWebots

intersection = intersection_of_program(globalParameters)
road = intersection.road
roadDirection = intersection.roadDirection
workspace = Workspace(road)

simulator OutsideWebots()


class Marker:
    """A point to be marked, small and in the way of nothing."""

    width: 0.1
    length: 0.1
    allowCollisions: True
    requireVisible: False


class Car:
    """A car on a guideway, along it."""

    position: new Point on road
    roadDeviation: 0
    parentOrientation: (roadDirection at self.position) + self.roadDeviation
    requireVisible: False
    width: 1.8
    length: 4.5
    viewAngle: 90 deg
    color: Color.defaultCarColor()
    webotsType: 'ToyotaPrius'
    webotsProto: 'ToyotaPrius'
    rotationOffset: (90 deg, 0, 0)
