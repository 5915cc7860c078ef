"""The ego turns right into the road that a car from the left crosses into, too."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

crossing = Uniform(*network.intersections)
start = Uniform(*crossing.incomingLanes)
turn = Uniform(*filter(lambda m: m.type is ManeuverType.RIGHT_TURN, start.maneuvers))
other_turn = Uniform(*filter(lambda m: m.endLane is turn.endLane, turn.conflictingManeuvers))

ego = new Car on turn.startLane.centerline,
    with behavior FollowTrajectoryBehavior(5, [turn.startLane, turn.connectingLane, turn.endLane])
other = new Car on other_turn.startLane.centerline,
    with behavior FollowTrajectoryBehavior(7, [other_turn.startLane, other_turn.connectingLane, other_turn.endLane])

require 10 <= (distance from ego to crossing) <= 25
require 15 <= (distance from other to crossing) <= 35
terminate when (distance to crossing) > 30 and (distance from other to crossing) > 30
