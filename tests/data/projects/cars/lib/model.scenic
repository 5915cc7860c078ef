"""A world with cars."""
from lib.base import *
import math

param weather = 'sunny'

class Car(Vehicle):
    speed: 5
    topSpeed: self.speed * 2
    width: 2

class Truck(Car):
    load[final]: 3

behavior Drive(target, gas=1, *, brake=0):
    take target

monitor Watch(limit):
    wait

scenario Crossing(cars, *, far=False):
    setup:
        new Car

def lanes(count, width=3.5):
    return [width] * count

_hidden = 1
roadway = math.pi
