"""A cyclist crosses in front of a car of CARLA, between things that lie about; sampled without the simulator."""

param map = localPath('crossing.xodr')
model scenic.simulators.carla.model

MODEL = 'vehicle.lincoln.mkz_2017'

behavior Careful(speed=8):
    try:
        do FollowLaneBehavior(target_speed=speed)
    interrupt when withinDistanceToAnyObjs(self, 12):
        take SetBrakeAction(1.0)

lane = Uniform(*filter(lambda l: l.maneuvers, network.lanes))
ego = new Car on lane.centerline,
    with blueprint MODEL,
    with rolename 'hero',
    with behavior Careful
spot = new OrientedPoint following roadDirection from ego for Range(20, 30)
cyclist = new Bicycle right of spot by 3,
    facing 90 deg relative to spot.heading,
    with regionContainedIn None,
    with behavior CrossingBehavior(ego, 2, 18)
bin = new Trash right of spot by Range(4, 5),
    with regionContainedIn None,
    with allowCollisions True

require (distance from ego to intersection) > 40
