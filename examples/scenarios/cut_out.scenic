"""Cut-out: the car ahead leaves the lane and reveals a truck that stands there; the ego stops behind it."""

param map = localPath('../driving/motorway.xodr')
model scenic.simulators.newtonian.driving_model
from scenic.domains.driving.measures import required_deceleration

lane = network.elements['road1'].forwardLanes.lanes[1]
faster = lane.sections[0].fasterLane
speed = Range(14, 17)

behavior CutOut():
    do FollowLaneBehavior(target_speed=speed) until (distance from self to truck) < 45
    do LaneChangeBehavior(faster, target_speed=speed, duration=2.5)
    do FollowLaneBehavior(target_speed=speed)

truck = new Truck following roadDirection from lane.centerline[0] for 400, with color (0.7, 0.2, 0.15)
ego = new Car following roadDirection from truck for Range(-140, -120), with speed speed,
    with behavior FollowLaneBehavior(target_speed=speed, follow_gap=1.3), with color (0.9, 0.75, 0.2)
lead = new Car following roadDirection from ego for Range(24, 28), with speed speed, with behavior CutOut(),
    with color (0.2, 0.4, 0.8)

record required_deceleration(ego, truck) as 'required deceleration'
require always required_deceleration(ego, truck) < 6 as 'less than 6 m/s2 is required'
require always (distance from ego to truck) > 6.2 as 'the ego does not run into the truck'
terminate after 14 seconds
