"""A car cuts in a little ahead, and brakes; the ego brakes after its reaction. Do they keep apart?"""

param map = localPath('motorway.xodr')
model scenic.simulators.newtonian.driving_model

gap = Normal(26, 4)
reaction = TruncatedNormal(0.8, 0.15, 0.2, 2)
strength = TruncatedNormal(0.5, 0.08, 0.2, 1)

faster_sections = []
for lane in network.lanes:
    for section in lane.sections:
        if section._slowerLane is not None:
            faster_sections.append(section)

behavior CutIn(section):
    do LaneChangeBehavior(section, target_speed=15)
    while True:
        take SetThrottleAction(0), SetBrakeAction(strength)

behavior Drive():
    try:
        do FollowLaneBehavior(target_speed=15)
    interrupt when other._lane is self._lane and other.speed < 14:
        do FollowLaneBehavior(target_speed=15) for reaction seconds
        while True:
            take SetThrottleAction(0), SetBrakeAction(0.6)

section = Uniform(*faster_sections)
ego = new Car on section.centerline, with speed 15, with behavior Drive()
other = new Car at ego offset by (3.5, gap), facing roadDirection, with speed 15, with behavior CutIn(section)

require (distance from ego to section.lane.centerline[-1]) > 250
require always (distance from ego to other) > 5 as keeps_apart
terminate after 7 seconds
