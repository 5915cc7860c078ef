"""World model for the roads of Webots worlds, in the plane: set the world first (`setLocalWorld`)."""

from scenic.simulators.utils.colors import Color
from scenic.simulators.webots.road.car_models import CarModel, carModels, modelWithName, smallVehicles
from scenic.simulators.webots.road.network import regions_of_program
from scenic.simulators.webots.simulator import OutsideWebots

_regions = regions_of_program(globalParameters)

roadDirection = _regions.direction
road = _regions.road
curb = _regions.curb or nowhere
intersection = _regions.intersection or nowhere
nonIntersection = _regions.outside_intersections or nowhere
sidewalk = _regions.sidewalk or nowhere
crossing = _regions.crossing or nowhere
walkway = _regions.walkway or nowhere
workspace = Workspace(_regions.everything)

simulator OutsideWebots()


class WebotsObject:
    """An object of a Webots world."""

    requireVisible: False
    elevation[dynamic]: None
    webotsName: None
    webotsType: None
    webotsProto: self.webotsType
    webotsObject: None
    controller: None
    customData: None
    battery[dynamic]: None
    resetController: True
    positionOffset: (0, 0, 0)
    rotationOffset: (0, 0, 0)
    density: None


class Car(WebotsObject):
    """A vehicle on the road, along it; `model` gives its size and its node.

    Vehicles of Webots look along their x axis, ours along y: `rotationOffset` turns them.
    """

    position: new Point on road
    roadDeviation: 0
    parentOrientation: (roadDirection at self.position) + self.roadDeviation
    model: Uniform(*carModels)
    appearance: 'car'
    width: self.model.width
    length: self.model.length
    webotsType: self.model.name
    viewAngle: 90 deg
    cameraOffset: (0, self.length / 2)
    color: Color.defaultCarColor()
    rotationOffset: (90 deg, 0, 0)


class SmallCar(Car):
    """A passenger car."""

    model: Uniform(*smallVehicles)


class BmwX5(Car):
    model: modelWithName['BmwX5']


class CitroenCZero(Car):
    model: modelWithName['CitroenCZero']


class LincolnMKZ(Car):
    model: modelWithName['LincolnMKZ']


class RangeRoverSportSVR(Car):
    model: modelWithName['RangeRoverSportSVR']


class ToyotaPrius(Car):
    model: modelWithName['ToyotaPrius']


class Bus(Car):
    model: modelWithName['Bus']
    appearance: 'bus'


class Truck(Car):
    model: modelWithName['Truck']
    appearance: 'truck'


class Tractor(Car):
    model: modelWithName['Tractor']


class Motorcycle(Car):
    """A motorcycle in two colours."""

    model: modelWithName['MotorBikeSimple']
    appearance: 'motorcycle'
    primaryColor: self.color
    secondaryColor: Color.defaultCarColor()


class Pedestrian(WebotsObject):
    """Somebody on a sidewalk or a crossing, facing anywhere."""

    position: new Point on walkway
    parentOrientation: Range(0, 360) deg
    appearance: 'pedestrian'
    width: 0.5
    length: 0.5
    webotsType: 'Pedestrian'
    rotationOffset: (90 deg, 0, 0)
    shirtColor: Color.uniformColor()
    pantsColor: Color.uniformColor()
    shoesColor: Color.uniformColor()


class OilBarrel(WebotsObject):
    width: 0.61
    length: 0.61
    webotsType: 'OilBarrel'


class SolidBox(WebotsObject):
    width: 2
    length: 2
    webotsType: 'SolidBox'


class TrafficCone(WebotsObject):
    width: 0.4
    length: 0.4
    webotsType: 'TrafficCone'


class WorkBarrier(WebotsObject):
    width: 1.2
    length: 0.4
    webotsType: 'WorkBarrier'
