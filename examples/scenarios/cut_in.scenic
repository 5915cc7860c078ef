"""Cut-in: a car changes into the ego's lane, close in front of it; the ego keeps its distance again."""

param map = localPath('../driving/motorway.xodr')
model scenic.simulators.newtonian.driving_model
from scenic.domains.driving.measures import time_to_collision

lane = network.elements['road1'].forwardLanes.lanes[1]
section = lane.sections[0]
speed = Range(18, 22)

behavior CutIn():
    do FollowLaneBehavior(target_speed=speed) for Range(1, 2) seconds
    do LaneChangeBehavior(section, target_speed=speed - 3, duration=3)
    do FollowLaneBehavior(target_speed=speed - 3)

ego = new Car following roadDirection from lane.centerline[0] for 200, with speed speed,
    with behavior FollowLaneBehavior(target_speed=speed, follow_gap=1.2), with color (0.9, 0.75, 0.2)
ahead = new OrientedPoint following roadDirection from ego for Range(24, 30)
other = new Car left of ahead by 3.5, with speed speed, with behavior CutIn(), with color (0.2, 0.4, 0.8)

record time_to_collision(ego, other) as 'time to collision'
require always time_to_collision(ego, other) > 1.5 as 'never less than 1.5 s to a collision'
require eventually other._lane is lane as 'the other car cuts in'
terminate after 9 seconds
