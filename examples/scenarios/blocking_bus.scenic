"""Blocking bus: a bus stands in the ego's lane; the ego passes it on the other side when nobody comes there."""

param map = localPath('../driving/crossing.xodr')
model scenic.simulators.newtonian.driving_model
from scenic.domains.driving.measures import time_to_collision

road1 = network.elements['road1']
section = road1.forwardLanes.lanes[0].sections[0]
back = road1.backwardLanes.lanes[0]

behavior Pass():
    do FollowLaneBehavior(target_speed=9, follow_gap=1.5) until (distance from self to bus) < 26
    while (distance from self to oncoming) < 75 and oncoming.position.x < self.position.x + 6:
        take SetThrottleAction(0), SetBrakeAction(0.5)
    do LaneChangeBehavior(section.laneToLeft, is_oppositeTraffic=True, target_speed=9, duration=3)
    do FollowLaneBehavior(target_speed=9, laneToFollow=back, is_oppositeTraffic=True) until self.position.x < bus.position.x - 12
    do LaneChangeBehavior(section, target_speed=9, duration=3)
    do FollowLaneBehavior(target_speed=9)

bus = new Bus following roadDirection from section.centerline[0] for 62, with color (0.85, 0.65, 0.1)
ego = new Car following roadDirection from section.centerline[0] for 8, with speed 8, with behavior Pass(),
    with color (0.9, 0.75, 0.2)
oncoming = new Car following roadDirection from back.centerline[0] for Range(20, 40), with speed 9,
    with behavior FollowLaneBehavior(target_speed=9), with color (0.2, 0.4, 0.8)

record (distance from ego to oncoming) as 'distance to the oncoming car'
require always not (ego intersects oncoming) and not (ego intersects bus) as 'nobody is hit'
require eventually ego._lane is section.lane and ego.position.x < bus.position.x - 8 as 'the ego passes the bus'
terminate after 24 seconds
