"""Pedestrians on sidewalks: one goes along, one crosses the road around a bin and yields to cars."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

side = Uniform(*network.sidewalks)
ego = new Car on road, with behavior FollowLaneBehavior(target_speed=6)
along = new Pedestrian on side, with behavior WalkForwardBehavior
start = new OrientedPoint on side.centerline
far = start offset by (-10, 0)  # sidewalks have the road on their left
crossing_over = new Pedestrian at start,
    with regionContainedIn None,
    with behavior Walk([far])
bin = new Debris at start offset by (-3, 0),
    with width 0.6,
    with length 0.6

require 8 < (distance from ego to crossing_over) < 60
require 3 < (distance from along to crossing_over) < 100
