"""Debris on the shoulder and in a lane, before which a queue of cars brakes."""

param map = localPath('motorway.xodr')
model scenic.simulators.newtonian.driving_model

behavior Cautious(speed):
    try:
        do FollowLaneBehavior(target_speed=speed)
    interrupt when withinDistanceToObjsInLane(self, 30):
        take SetThrottleAction(0), SetBrakeAction(1)

lane = Uniform(*filter(lambda l: l._laneToRight is None, [s for l in network.lanes for s in l.sections])).lane
block = new Debris on lane.centerline, with width 2, with length 1
ego = new Car following roadDirection from block for Range(-60, -45),
    with speed 8,
    with behavior Cautious(12)
follower = new Car following roadDirection from ego for Range(-25, -15),
    with speed 8,
    with behavior Cautious(12)
new Debris on visible shoulder, with width 0.5, with length 0.5

require block in network.drivableRegion
require (distance from ego to lane.centerline[0]) > 100
