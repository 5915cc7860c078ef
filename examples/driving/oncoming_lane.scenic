"""The ego overtakes a slow car by the lane of oncoming traffic."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

behavior Overtake(section):
    do FollowLaneBehavior(target_speed=9) until (distance from self to slow) < 32
    do LaneChangeBehavior(section.laneToLeft, is_oppositeTraffic=True, target_speed=12)
    do FollowLaneBehavior(target_speed=12, laneToFollow=section.laneToLeft.lane, is_oppositeTraffic=True) for 4 seconds
    do LaneChangeBehavior(section, target_speed=12)
    do FollowLaneBehavior(target_speed=7)

road1 = network.elements['road1']
section = road1.forwardLanes.lanes[0].sections[0]
ego = new Car on section.centerline, with speed 7, with behavior Overtake(section)
slow = new Car following roadDirection from ego for Range(36, 40), with behavior FollowLaneBehavior(target_speed=3)

require (distance from ego to intersection) > 95
