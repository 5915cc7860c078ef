"""The driving world model for CARLA. Sampling needs neither the simulator nor its package."""

import pathlib
import warnings

from scenic.core.simulators import SimulatorInterfaceWarning
from scenic.domains.driving.model import *
from scenic.domains.driving.actions import Steers, Walks
from scenic.domains.driving.setting import is2DMode
from scenic.simulators.carla import blueprints
from scenic.simulators.carla.actions import *
from scenic.simulators.carla.behaviors import *
from scenic.simulators.carla.blueprints import check_map, dimension, ids, known_blueprint
from scenic.simulators.carla.simulator import CarlaSimulator
from scenic.simulators.carla.lights import (
    freezeTrafficLights, getClosestTrafficLightStatus, getTrafficLightStatus, setAllIntersectionTrafficLightsStatus,
    setClosestTrafficLightStatus, setTrafficLightStatus, unfreezeTrafficLights, withinDistanceToRedYellowTrafficLight,
    withinDistanceToTrafficLight,
)

map_town = pathlib.Path(globalParameters.map).stem
param carla_map = map_town
param address = '127.0.0.1'
param port = 2000
param timeout = 10
param render = 1
param record = ''
param timestep = 0.1
param snapToGroundDefault = is2DMode()
param weather = Uniform(
    'ClearNoon', 'CloudyNoon', 'WetNoon', 'WetCloudyNoon', 'SoftRainNoon', 'MidRainyNoon', 'HardRainNoon',
    'ClearSunset', 'CloudySunset', 'WetSunset', 'WetCloudySunset', 'SoftRainSunset', 'MidRainSunset', 'HardRainSunset',
)

check_map(globalParameters.carla_map, globalParameters.map)
if globalParameters.render not in (0, 1):
    raise ValueError('the parameter render is 0 or 1')

simulator CarlaSimulator(
    carla_map=globalParameters.carla_map,
    map_path=globalParameters.map,
    address=globalParameters.address,
    port=int(globalParameters.port),
    timeout=float(globalParameters.timeout),
    render=bool(globalParameters.render),
    record=globalParameters.record,
    timestep=float(globalParameters.timestep),
)


class CarlaActor(DrivingObject):
    """An actor of CARLA."""

    blueprint: None
    rolename: None
    physics: True
    snapToGround: globalParameters.snapToGroundDefault
    carlaActor: None
    defaultWidth: 1
    defaultLength: 1
    defaultHeight: 1
    width: dimension(known_blueprint(self.blueprint), 0, self.defaultWidth)
    length: dimension(self.blueprint, 1, self.defaultLength)
    height: dimension(self.blueprint, 2, self.defaultHeight)

    def setPosition(self, pos, elevation):
        simulation().place(self, pos)

    def setVelocity(self, vel):
        simulation().push(self, vel)


class Vehicle(CarlaActor, Vehicle, Steers):
    """A vehicle."""

    def setThrottle(self, throttle):
        simulation().control(self, throttle=throttle)

    def setSteering(self, steering):
        simulation().control(self, steer=steering)

    def setBraking(self, braking):
        simulation().control(self, brake=braking)

    def setHandbrake(self, handbrake):
        simulation().control(self, hand_brake=handbrake)

    def setReverse(self, reverse):
        simulation().control(self, reverse=reverse)


class Car(Vehicle):
    """A car."""

    blueprint: Uniform(*ids('car'))
    defaultWidth: 2
    defaultLength: 4.5
    defaultHeight: 1.5

    @property
    def isCar(self):
        return True


class NPCCar(Car):
    """A car that the traffic manager may drive."""


class Bicycle(Vehicle, Bicycle):
    blueprint: Uniform(*ids('bicycle'))
    defaultWidth: 1
    defaultLength: 2
    defaultHeight: 1.5


class Motorcycle(Vehicle, Motorcycle):
    blueprint: Uniform(*ids('motorcycle'))
    defaultWidth: 1
    defaultLength: 2
    defaultHeight: 1.5


class Truck(Vehicle, Truck):
    blueprint: Uniform(*ids('truck'))
    defaultWidth: 2.5
    defaultLength: 7.5
    defaultHeight: 3


class Van(Vehicle):
    blueprint: Uniform(*ids('van'))
    defaultWidth: 2
    defaultLength: 5
    defaultHeight: 2


class Bus(Vehicle, Bus):
    blueprint: Uniform(*ids('bus'))
    defaultWidth: 4
    defaultLength: 10
    defaultHeight: 4


class Pedestrian(CarlaActor, Pedestrian, Walks):
    """A pedestrian."""

    blueprint: Uniform(*ids('walker'))
    defaultWidth: 0.5
    defaultLength: 0.5
    defaultHeight: 1.5
    carlaController: None

    def setWalkingDirection(self, heading):
        simulation().walk(self, heading=heading)

    def setWalkingSpeed(self, speed):
        simulation().walk(self, speed=speed)


class Prop(CarlaActor):
    """Something that stands or lies on the road."""

    regionContainedIn: road
    position: new Point on road
    parentOrientation: Range(0, 360) deg
    physics: False
    defaultWidth: 0.5
    defaultLength: 0.5
    defaultHeight: 0.5


class Trash(Prop):
    blueprint: Uniform(*ids('trash'))


class Cone(Prop):
    blueprint: Uniform(*ids('cone'))


class Debris(Prop):
    blueprint: Uniform(*ids('debris'))


class VendingMachine(Prop):
    blueprint: Uniform(*ids('vending_machine'))


class Chair(Prop):
    blueprint: Uniform(*ids('chair'))


class BusStop(Prop):
    blueprint: Uniform(*ids('bus_stop'))


class Advertisement(Prop):
    blueprint: Uniform(*ids('advertisement'))


class Garbage(Prop):
    blueprint: Uniform(*ids('garbage'))


class Container(Prop):
    blueprint: Uniform(*ids('container'))


class Table(Prop):
    blueprint: Uniform(*ids('table'))


class Barrier(Prop):
    blueprint: Uniform(*ids('barrier'))


class PlantPot(Prop):
    blueprint: Uniform(*ids('plant_pot'))


class Mailbox(Prop):
    blueprint: Uniform(*ids('mailbox'))


class Gnome(Prop):
    blueprint: Uniform(*ids('gnome'))


class CreasedBox(Prop):
    blueprint: Uniform(*ids('creased_box'))


class Case(Prop):
    blueprint: Uniform(*ids('case'))


class Box(Prop):
    blueprint: Uniform(*ids('box'))


class Bench(Prop):
    blueprint: Uniform(*ids('bench'))


class Barrel(Prop):
    blueprint: Uniform(*ids('barrel'))


class ATM(Prop):
    blueprint: Uniform(*ids('atm'))


class Kiosk(Prop):
    blueprint: Uniform(*ids('kiosk'))


class IronPlate(Prop):
    blueprint: Uniform(*ids('iron_plate'))


class TrafficWarning(Prop):
    blueprint: Uniform(*ids('traffic_warning'))
