model scenic.simulators.carla.model
from scenic.domains.driving.roads import *
from scenic.core.vectors import Vector as V
ego = new Car on road, with behavior FollowLaneBehavior(3)
new Pedestrian left of ego by V(1, 2)
