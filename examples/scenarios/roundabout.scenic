"""Roundabout: the ego gives way to a car that goes round, then enters and leaves at another arm."""

param map = localPath('../driving/roundabout.xodr')
model scenic.simulators.newtonian.driving_model

arm = network.elements['road1'].forwardLanes.lanes[0]
before = network.elements['road4'].forwardLanes.lanes[0]

ego = new Car following roadDirection from arm.centerline[0] for Range(28, 38), with speed 8,
    with behavior DriveByRulesBehavior(), with color (0.9, 0.75, 0.2)
other = new Car following roadDirection from before.centerline[0] for Range(80, 86), with speed 8,
    with behavior DriveByRulesBehavior(), with color (0.2, 0.4, 0.8)
cyclist = new Bicycle following roadDirection from before.centerline[0] for Range(50, 65), with speed 5,
    with behavior DriveByRulesBehavior(target_speed=5)

record (distance from ego to other) as 'distance'
require always not (ego intersects other) and not (ego intersects cyclist) as 'nobody is hit'
require eventually ego._lane is not None and ego._lane.road is not arm.road and ego._intersection is None as 'the ego enters'
terminate after 20 seconds
