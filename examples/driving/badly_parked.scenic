"""A car that is parked badly pulls in front of the ego."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

ego = new Car with behavior FollowLaneBehavior(target_speed=8)

spot = new OrientedPoint on visible curb
parked = new Car left of spot by 0.5,
    facing Uniform(-1, 1) * Range(10, 20) deg relative to roadDirection,
    with regionContainedIn None

require (distance from ego to parked) > 8
