"""The ego passes a car that stands in its lane, and comes back."""

param map = localPath('motorway.xodr')
model scenic.simulators.newtonian.driving_model

slower_sections = []
for lane in network.lanes:
    for section in lane.sections:
        if section._fasterLane is not None:
            slower_sections.append(section)

behavior Bypass(section):
    try:
        do FollowLaneBehavior(target_speed=12)
    interrupt when withinDistanceToObjsInLane(self, 42) and self._lane is section.lane:
        do LaneChangeBehavior(section.fasterLane, target_speed=12)
        do FollowLaneBehavior(target_speed=12, laneToFollow=section.fasterLane.lane) for 5 seconds
        do LaneChangeBehavior(section, target_speed=12)
        do FollowLaneBehavior(target_speed=12)

section = Uniform(*slower_sections)
ego = new Car on section.centerline, with speed 10, with behavior Bypass(section)
standing = new Car following roadDirection from ego for Range(45, 60)

require (distance from ego to section.lane.centerline[-1]) > 250
require ego can see standing
