"""A car turns left at a crossing, after those that come towards it have passed; another one waits for it at a stop line."""

from math import atan2
from scenic.simulators.kinematic import *
simulator KinematicSimulator(timestep=0.1)

lane = 3.5
along = RectangularRegion((0, 0, 0), 0, 2 * lane, 120)
across = RectangularRegion((0, 0, 0), 0, 120, 2 * lane)
workspace = Workspace(along.union(across))
crossing = RectangularRegion((0, 0, 0), 0, 2 * lane, 2 * lane)
exit = RectangularRegion((-40, lane / 2, 0), 0, 40, lane)

class Car:
    dynamics: 'bicycle'
    width: 1.8
    length: 4.3
    height: 1.5
    contactTolerance: 0

behavior Keep(speed, heading, line):
    """Drive so fast in a direction, on the line through the crossing that is so far to its left."""
    while True:
        side = self.position.x * cos(heading) + self.position.y * sin(heading) + line
        off = heading + atan2(side, 4 + 0.6 * self.speed) - self.heading
        pace = max(-6, min(2.5, 2 * (speed - self.speed)))
        take SetThrottle(pace), SetSteering(1.5 * atan2(sin(off), cos(off)))

behavior Straight(speed, heading):
    do Keep(speed, heading, -lane / 2)

behavior TurnLeft(speed, coming):
    do Keep(speed, 0, -lane / 2) until self.position.y > -16
    while -10 < coming.position.y < 35:
        do Keep(0, 0, -lane / 2) for 0.5 seconds
    do Keep(6, 0, -lane / 2) until self.position.y > -4.5
    do Keep(6, 90 deg, -lane / 2) until self.position.x < -12
    do Keep(speed, 90 deg, -lane / 2)

behavior Wait(first):
    take SetThrottle(-3)
    while first.position.x > -12:
        wait
    do Straight(9, 90 deg)

pace = Range(9, 13)
coming = new Car at (-lane / 2, Range(25, 55), 0.75), facing 180 deg, with speed pace, with color (0.35, 0.5, 0.75),
    with behavior Straight(pace, 180 deg)
waiting = new Car at (Range(8, 12), lane / 2, 0.75), facing 90 deg, with color (0.85, 0.6, 0.2)
ego = new Car at (lane / 2, Range(-50, -35), 0.75), with speed 10, with color (0.8, 0.25, 0.25),
    with behavior TurnLeft(10, coming)
waiting.behavior = Wait(ego)

require always (distance from ego to coming) > 3 as 'gives way'
require always (distance from ego to waiting) > 3 as apart
require eventually (ego in exit) as turned
require (waiting.position not in crossing) until (ego in exit) as 'waits its turn'
terminate when ego.position.x < -35
record ego.speed as speed
