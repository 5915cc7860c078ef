"""Pedestrian behind a parked car: somebody steps into the lane where the ego sees them late."""

param map = localPath('../driving/crossing.xodr')
model scenic.simulators.newtonian.driving_model

lane = network.elements['road1'].forwardLanes.lanes[0]

behavior Attentive():
    try:
        do FollowLaneBehavior(target_speed=7)
    interrupt when withinDistanceToAnyPedestrians(self, 12):
        take SetThrottleAction(0), SetBrakeAction(1)

behavior StepOut():
    while (distance from self to ego) > 17:
        wait
    do WalkTo(far, speed=Range(1.2, 1.6))

ego = new Car following roadDirection from lane.centerline[0] for 20, with speed 7, with behavior Attentive(),
    with viewAngle 160 deg, with color (0.9, 0.75, 0.2)
spot = new OrientedPoint following roadDirection from ego for Range(38, 45)
parked = new Car right of spot by 1.75, with regionContainedIn None, with color (0.2, 0.4, 0.8)
walker = new Pedestrian ahead of parked by 0.4, facing 90 deg relative to spot.heading,
    with regionContainedIn None, with behavior StepOut()
far = new Point left of (front of parked) by 9

record (distance from ego to walker) as 'distance'
require always not (ego intersects walker) as 'the pedestrian is not hit'
require eventually walker in lane as 'the pedestrian steps into the lane'
terminate after 10 seconds
