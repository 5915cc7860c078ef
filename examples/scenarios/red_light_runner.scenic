"""Red-light runner: a car does not halt at a red light; the ego, which has the right of way, gives way."""

param map = localPath('../driving/crossing.xodr')
param traffic_lights = {'states': {'5': 'red'}}
model scenic.simulators.newtonian.driving_model
from scenic.domains.driving.measures import is_running_red

crossing = network.intersections[0]
straight = [maneuver for maneuver in crossing.maneuvers if maneuver.type is ManeuverType.STRAIGHT]
wrong = [maneuver for maneuver in straight if maneuver.startLane.road.id == 1][0]
ways = [maneuver for maneuver in wrong.conflictingManeuvers if maneuver.type is ManeuverType.STRAIGHT]
way = Uniform(*ways)

ego = new Car on way.startLane.centerline, with speed 9,
    with behavior DriveByRulesBehavior(target_speed=10), with color (0.9, 0.75, 0.2)
runner = new Car on wrong.startLane.centerline, with speed 11, with color (0.7, 0.2, 0.15),
    with behavior DriveByRulesBehavior(target_speed=11, ignore={'signals', 'priority'})

require 35 < (distance from ego to crossing) < 45
require 40 < (distance from runner to crossing) < 50
record is_running_red(runner) as 'runs a red light'
require eventually is_running_red(runner) as 'the light is run'
require always not is_running_red(ego) as 'the ego runs none'
require always not (ego intersects runner) as 'nobody is hit'
terminate after 14 seconds
