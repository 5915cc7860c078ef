"""Three cars behind each other in one lane; the last ones keep their distance."""

param map = localPath('motorway.xodr')
model scenic.simulators.newtonian.driving_model

behavior Follow(leader, speed):
    try:
        do FollowLaneBehavior(target_speed=speed)
    interrupt when (distance from self to leader) < 12:
        take SetThrottleAction(0), SetBrakeAction(0.6)

ego = new Car with behavior FollowLaneBehavior(target_speed=10)
second = new Car following roadDirection from ego for Range(-20, -12), with behavior Follow(ego, 14)
third = new Car following roadDirection from second for Range(-20, -12), with behavior Follow(second, 14)

require second._lane is ego._lane and third._lane is ego._lane
require always (distance from ego to second) > 5
