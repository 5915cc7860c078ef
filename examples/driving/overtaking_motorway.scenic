"""The ego changes to the faster lane when the car ahead is slow."""

param map = localPath('motorway.xodr')
model scenic.simulators.newtonian.driving_model

behavior Overtake():
    try:
        do FollowLaneBehavior(target_speed=20)
    interrupt when (distance from self to slow) < 20 and self._lane is slow._lane:
        do LaneChangeBehavior(self.laneSection.fasterLane, target_speed=20)
        do FollowLaneBehavior(target_speed=20)

lane = Uniform(*filter(lambda l: l.sections[0]._fasterLane is not None, network.lanes))
slow = new Car on lane.centerline, with behavior FollowLaneBehavior(target_speed=8)
ego = new Car following roadDirection from slow for Range(-40, -25), with behavior Overtake()

require ego.laneSection._fasterLane is not None
require (distance from slow to lane.centerline[-1]) > 300
record ego.speed as speed
