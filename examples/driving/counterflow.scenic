"""Two cars that meet on neighbouring lanes of opposite directions."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

ego = new Car with behavior FollowLaneBehavior(target_speed=7)
other = new Car on ego.oppositeLaneGroup, with behavior FollowLaneBehavior(target_speed=7)

require abs(relative heading of other from ego) > 150 deg
require 20 < (distance from ego to other) < 60
require other.road is ego.road
