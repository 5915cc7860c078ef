"""The ego turns left across the way of an oncoming car."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

crossing = Uniform(*filter(lambda i: i.is4Way, network.intersections))
turn = Uniform(*filter(lambda m: m.type is ManeuverType.LEFT_TURN, crossing.maneuvers))
oncoming = Uniform(*filter(lambda m: m.type is ManeuverType.STRAIGHT, turn.conflictingManeuvers))

ego = new Car on turn.startLane.centerline,
    with behavior FollowTrajectoryBehavior(6, [turn.startLane, turn.connectingLane, turn.endLane])
other = new Car on oncoming.startLane.centerline,
    with behavior FollowTrajectoryBehavior(8, [oncoming.startLane, oncoming.connectingLane, oncoming.endLane])

require 25 <= (distance from ego to crossing) <= 40
require 10 <= (distance from other to crossing) <= 20
require always (distance from ego to other) > 3
terminate when (distance from ego to crossing) > 20 and ego.lane is turn.endLane
