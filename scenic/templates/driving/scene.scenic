"""A car follows a slower one and keeps its distance."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

behavior KeepDistance(speed):
    try:
        do FollowLaneBehavior(target_speed=speed)
    interrupt when withinDistanceToObjsInLane(self, 12):
        take SetBrakeAction(1)

ego = new Car with behavior KeepDistance(9)
slow = new Car ahead of ego by Range(15, 25), with behavior FollowLaneBehavior(target_speed=3)

require (distance from slow to intersection) > 20
require always (distance from ego to slow) > 5 as 'keeps its distance'
record (distance from ego to slow) as gap
terminate after 8 seconds
