"""Cars that wait at a traffic light, each a little behind the next."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

crossing = network.intersections[0]
lane = Uniform(*crossing.incomingLanes)
ego = new Car at (new OrientedPoint at lane.centerline[-1], facing roadDirection) offset by (0, -3)

previous = ego
for i in range(4):
    previous = new Car following roadDirection from previous for Range(-9, -6.5)

require crossing.hasTrafficLights
