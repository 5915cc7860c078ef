"""A car overtakes a slower one on a country road, as soon as the other lane is free."""

from math import atan2
from scenic.simulators.kinematic import *
simulator KinematicSimulator(timestep=0.1)

lane = 3.5
road = RectangularRegion((0, 150, 0), 0, 2 * lane, 500)
workspace = Workspace(road)

class Car:
    dynamics: 'bicycle'
    width: 1.9
    length: 4.5
    height: 1.5
    contactTolerance: 0

def towards(car, x):
    """The steering that leads a car on a road along Y to the line of that x."""
    wanted = atan2(car.position.x - x, 5 + 0.9 * car.speed)
    off = wanted - car.heading
    return atan2(sin(off), cos(off))

def gap(car, other):
    """How far another car is ahead, from bumper to bumper."""
    return other.position.y - car.position.y - (car.length + other.length) / 2

behavior Drive(speed, x):
    while True:
        take SetThrottle(max(-6, min(3, 1.5 * (speed - self.speed)))), SetSteering(towards(self, x))

behavior Come(speed):
    take SetThrottle(0)
    while True:
        wait

behavior Overtake(slow, coming, speed):
    try:
        do Drive(speed, lane / 2)
    interrupt when 0 < gap(self, slow) < 12:
        do Drive(slow.speed, lane / 2) for 0.5 seconds
    interrupt when 0 < gap(self, slow) < 20 and not (0 < gap(self, coming) < 160):
        do Drive(speed, -lane / 2) until gap(slow, self) > 8

fast = Range(22, 26)
slow = new Car at (lane / 2, Range(40, 60), 0.75), with speed Range(11, 15), with color (0.85, 0.6, 0.2)
coming = new Car at (-lane / 2, Range(120, 300), 0.75), facing 180 deg, with speed Range(18, 24), with color (0.35, 0.5, 0.75),
    with behavior Come(0)
ego = new Car at (lane / 2, 0, 0.75), with speed fast, with color (0.8, 0.25, 0.25),
    with behavior Overtake(slow, coming, fast)

require always (distance from ego to slow) > 2.2 as apart
require always (distance from ego to coming) > 2.2 as clear
require always abs(ego.position.x) < lane - 0.95 as 'on the road'
require eventually ego.position.y > slow.position.y + 12 as overtaken
terminate when ego.position.y > slow.position.y + 30
record ego.speed as speed
