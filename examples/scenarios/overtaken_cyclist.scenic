"""Cyclist overtaken: the ego passes a cyclist with a lane's width between them."""

param map = localPath('../driving/crossing.xodr')
model scenic.simulators.newtonian.driving_model

road1 = network.elements['road1']
section = road1.forwardLanes.lanes[0].sections[0]
back = road1.backwardLanes.lanes[0]

behavior Overtake():
    do FollowLaneBehavior(target_speed=9, follow_gap=1.5) until (distance from self to cyclist) < 22
    do LaneChangeBehavior(section.laneToLeft, is_oppositeTraffic=True, target_speed=9, duration=3)
    do FollowLaneBehavior(target_speed=10, laneToFollow=back, is_oppositeTraffic=True) until (
        self.position.x < cyclist.position.x - 9)
    do LaneChangeBehavior(section, target_speed=9, duration=3)
    do FollowLaneBehavior(target_speed=9)

def gap():
    """Metres between the ego and the cyclist across the road, while they are beside each other."""
    beside = abs(ego.position.x - cyclist.position.x) < (ego.length + cyclist.length) / 2
    return abs(ego.position.y - cyclist.position.y) - (ego.width + cyclist.width) / 2 if beside else float('inf')

ego = new Car following roadDirection from section.centerline[0] for 4, with speed 8, with behavior Overtake(),
    with color (0.9, 0.75, 0.2)
cyclist = new Bicycle following roadDirection from ego for Range(22, 28), with speed 3,
    with behavior FollowLaneBehavior(target_speed=3), with color (0.7, 0.2, 0.15)

record gap() as 'gap beside the cyclist'
require always gap() > 1.5 as '1.5 m are kept'
require eventually ego._lane is section.lane and ego.position.x < cyclist.position.x - 6 as 'the ego passes the cyclist'
terminate after 14 seconds
