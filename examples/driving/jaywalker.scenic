"""A pedestrian steps on the road in front of the ego, which brakes."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

behavior Careful():
    try:
        do FollowLaneBehavior(target_speed=8)
    interrupt when withinDistanceToAnyPedestrians(self, 14):
        take SetThrottleAction(0), SetBrakeAction(1)

behavior Cross():
    while (distance from self to ego) > 25:
        wait
    while True:
        take SetWalkingDirectionAction(self.heading), SetWalkingSpeedAction(1.5)

ego = new Car with behavior Careful()
spot = new OrientedPoint following roadDirection from ego for 30
walker = new Pedestrian right of spot by 3.5, facing 90 deg relative to spot.heading,
    with regionContainedIn None, with behavior Cross()

require (distance from ego to intersection) > 45
require ego._lane is not None and network.laneAt(spot) is ego._lane
