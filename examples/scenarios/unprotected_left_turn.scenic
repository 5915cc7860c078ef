"""Unprotected left turn: the ego waits for a gap in the oncoming traffic, then turns."""

param map = localPath('../driving/crossing.xodr')
model scenic.simulators.newtonian.driving_model
from scenic.domains.driving.measures import post_encroachment_time

crossing = network.intersections[0]
turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, crossing.maneuvers))
oncoming = Uniform(*filter(lambda m: m.type is ManeuverType.STRAIGHT and m.startLane.road is not turn.endLane.road
                           and m.endLane.road is turn.startLane.road, turn.conflictingManeuvers))

behavior Drive(way, speed):
    do FollowTrajectoryBehavior(speed, [way.startLane, way.connectingLane, way.endLane], turn_speed=5)
    do FollowLaneBehavior(speed)

behavior Turn():
    try:
        do Drive(turn, 7)
    interrupt when (distance from self to crossing) < 8 and self._intersection is None and not is_free():
        take SetThrottleAction(0), SetBrakeAction(0.6)

def is_free():
    """Nobody comes within the next seconds."""
    return all(car._lane is oncoming.endLane or (distance from car to crossing) > 7 * car.speed for car in others)

ego = new Car on turn.startLane.centerline, with speed 6, with behavior Turn(), with color (0.9, 0.75, 0.2)
first = new Car on oncoming.startLane.centerline, with speed 8, with behavior Drive(oncoming, 8), with color (0.2, 0.4, 0.8)
second = new Car following roadDirection from first for Range(-30, -22), with speed 8, with behavior Drive(oncoming, 8),
    with color (0.7, 0.2, 0.15)
others = [first, second]

require 30 < (distance from ego to crossing) < 40
require 30 < (distance from first to crossing) < 45
require second._lane is oncoming.startLane
record min(distance from ego to first, distance from ego to second) as 'distance'
require always (distance from ego to first) > 3.2 and (distance from ego to second) > 3.2 as 'nobody is hit'
require eventually ego._lane is turn.endLane as 'the ego turns'
terminate after 25 seconds
