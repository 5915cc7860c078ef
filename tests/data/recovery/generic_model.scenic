model scenic.domains.driving.model

param map = localPath("maps/town.xodr")
param render = 0

EGO_SPEED = 10
BRAKE = 1.0
THRESHOLD = 15

behavior EgoBehavior(speed=10):
    try:
        do FollowLaneBehavior(speed)
    interrupt when withinDistanceToAnyObjs(self, THRESHOLD):
        take SetBrakeAction(BRAKE)

behavior LeadingCarBehavior(speed=10):
    laneSec = self.lane
    do FollowLaneBehavior(target_speed=speed) for 6 seconds
    while laneSec is not None:
        do LaneChangeBehavior(laneSection=laneSec, target_speed=speed)
        laneSec = network.laneAt(self)
    terminate

initLane = Uniform(*network.lanes)
spot = new OrientedPoint on initLane.centerline
side = new OrientedPoint right of spot by 3

ego = new Car at spot,
    with blueprint "vehicle.one",
    with rolename "hero",
    with behavior EgoBehavior(EGO_SPEED)

lead = new Car following roadDirection for Range(10, 15),
    with behavior LeadingCarBehavior(8)

debris = [
    new Trash offset by Range(-1, 1) @ Range(20, 30)
    for each in range(3)
]

walker = new Pedestrian ahead of side by 4 @ 2,
    facing 90 deg relative to side.heading,
    with regionContainedIn None,
    with behavior CrossingBehavior(ego, 1.5, THRESHOLD)

ego.tag = "hero"
lead.tags = ["lead", "car"]
if EGO_SPEED > 8:
    extra = new Car behind ego by 10
    require extra in road
else:
    extra = None

require (distance to intersection) > 60
require ego in initLane and lead in road
require 3 < (distance from ego to lead) < 20
require (ego.laneSection.group is not lead.laneSection.group)
terminate when (distance from lead to spot) > 150
