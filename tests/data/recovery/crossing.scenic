"""Two cars meet at a crossing, and one of them has to give way."""
import math
from collections import namedtuple

param time = Range(8, 18), weather = Uniform("rain", "sun")
param 'start delay' = 3

Lane = namedtuple("Lane", ["offset", "heading"])
LANES = [
    Lane(offset=-2, heading=0),
    Lane(offset=2, heading=180 deg),
    Lane(offset=6, heading=90 deg),
]
SPEED = 12.5
MARGIN = 2 * math.pi / 180

class Vehicle(Object):
    width: Range(1.8, 2.1)
    length: self.width * 2.3
    height: 1.5
    speed[dynamic]: SPEED
    allowCollisions: False

    def distance_ahead(self, other, margin=0.5):
        gap = distance from self to other
        if gap < margin:
            return 0
        return gap - margin

behavior GiveWay(other, limit=10):
    precondition: other is not None
    invariant: self.speed >= 0
    try:
        do Cruise(SPEED)
    interrupt when (distance from self to other) < limit:
        take Brake(0.5), Steer(0)
        wait
    interrupt when self.speed > SPEED * 2:
        take Brake(1)
    except ValueError as problem:
        print(problem)
        wait

behavior Cruise(target):
    while True:
        if self.speed < target:
            take Throttle(0.3)
        else:
            take Throttle(0)

def Brake(amount):
    return ("brake", amount)

def Steer(angle):
    return ("steer", angle)

def Throttle(amount):
    return ("throttle", amount)

ego = new Vehicle at (0, -20, 0),
    facing 0 deg,
    with speed Range(5, 10),
    with behavior GiveWay(None)
other = new Vehicle ahead of ego by Range(10, 20),
    facing 90 deg,
    with behavior Cruise(8)

require (distance from ego to other) > 5
require[0.8] other.speed < ego.speed + 3
require always (distance from ego to other) > 1
record ego.speed every 2 steps as speed
record final (distance from ego to other) as gap
terminate when ego.speed > 30
terminate after 20 seconds
