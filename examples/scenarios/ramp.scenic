"""Ramp: the ego joins a motorway from a ramp, between two cars, before its lane ends."""

param map = localPath('../driving/ramp.xodr')
model scenic.simulators.newtonian.driving_model
from scenic.domains.driving.measures import time_headway

ramp = network.elements['road2'].forwardLanes.lanes[0]
slow = network.elements['road3'].forwardLanes.lanes[0]
main = network.elements['road1'].forwardLanes.lanes[0]

def has_gap(car):
    """Cars in the lane to join are neither beside the car nor so fast behind it that they had to brake hard."""
    for other in traffic:
        ahead = other.position.x - car.position.x
        if -20 - 2 * max(0, other.speed - car.speed) < ahead < 12:
            return False
    return True

behavior Join():
    do FollowLaneBehavior(target_speed=20) until self._road is slow.road
    do FollowLaneBehavior(target_speed=15) until has_gap(self)
    do LaneChangeBehavior(self.laneSection.laneToLeft, target_speed=20)
    do FollowLaneBehavior(target_speed=22, follow_gap=1.2)

ego = new Car following roadDirection from ramp.centerline[0] for 120, with speed 15, with behavior Join(),
    with color (0.9, 0.75, 0.2)
first = new Car following roadDirection from main.centerline[0] for Range(130, 150), with speed 20,
    with behavior FollowLaneBehavior(target_speed=20, follow_gap=1.2), with color (0.2, 0.4, 0.8)
second = new Car following roadDirection from first for Range(-75, -60), with speed 20,
    with behavior FollowLaneBehavior(target_speed=20, follow_gap=1.2), with color (0.7, 0.2, 0.15)
traffic = [first, second]

record time_headway(second, ego) as 'time headway of the car behind'
require always time_headway(second, ego) > 0.6 as 'the car behind keeps 0.6 s'
require eventually ego._lane is not None and ego._lane.road is slow.road and ego._lane is not slow as 'the ego joins'
terminate after 26 seconds
