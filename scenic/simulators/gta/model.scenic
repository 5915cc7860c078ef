"""The world model for images of Grand Theft Auto V: cars on roads. Its scenes can be sampled; the game itself is not run.

The roads are those of a map in OpenDRIVE, `param map`; the game's own map is not part of this package.
"""

from scenic.domains.driving.model import *
from scenic.simulators.absent.placeholder import AbsentSimulator
from scenic.simulators.gta.interface import CarModel

param time = Range(0, 1440)
param weather = Uniform(
    'NEUTRAL', 'CLEAR', 'EXTRASUNNY', 'CLOUDS', 'OVERCAST', 'RAIN', 'THUNDER', 'CLEARING', 'XMAS', 'FOGGY', 'SMOG',
    'SNOWLIGHT', 'BLIZZARD', 'SNOW',
)

simulator AbsentSimulator('Grand Theft Auto V', 'it would need the game, with a plugin that places cars and takes pictures')


class Car(Car):
    """A car of the game."""

    model: CarModel.defaultModel()
    width: self.model.width
    length: self.model.length
    viewAngle: 80 deg
    visibleDistance: 30


class EgoCar(Car):
    """The car that takes the pictures."""

    model: CarModel.egoModel()


class Bus(Car):
    """A bus."""

    model: CarModel.models['BUS']
    appearance: 'bus'


class Compact(Car):
    """A small car."""

    model: CarModel.models['BLISTA']


def _again(value):
    """A value drawn anew, where that is possible."""
    try:
        return resample(value)
    except TypeError:
        return value


def createPlatoonAt(car, numCars, model=None, dist=Range(2, 8), shift=Range(-0.5, 0.5), wiggle=0):
    """Cars one behind the other: a list that begins with the car given.

    Arguments:
        car: the first.
        numCars: how many.
        model: of the others; random if there is none.
        dist: metres between two.
        shift: sideways, metres.
        wiggle: of headings, radians.
    """
    cars = [car]
    for number in range(numCars - 1):
        last = cars[-1]
        chosen = CarModel.defaultModel() if model is None else _again(model)
        place = new OrientedPoint following roadDirection from last.front for _again(dist)
        cars.append(new Car ahead of place by (_again(shift), 0), with model chosen, facing _again(wiggle) relative to roadDirection)
    return cars


def carAheadOfCar(car, gap, offsetX=0, wiggle=0):
    """A car ahead of another one.

    Arguments:
        car: the other one.
        gap: metres between the two.
        offsetX: metres by which it is to the right.
        wiggle: of its heading to that of the road, radians.
    """
    place = new OrientedPoint at car.front offset by (offsetX, gap), facing _again(wiggle) relative to roadDirection
    return new Car ahead of place
