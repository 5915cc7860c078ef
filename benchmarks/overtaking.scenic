"""Four cars on a two-lane road, held together by arithmetic requirements that most candidates fail."""

road = RectangularRegion((0, 50, 0), 0, 8, 120)
left_lane = RectangularRegion((-2, 50, 0), 0, 4, 120)
right_lane = RectangularRegion((2, 50, 0), 0, 4, 120)
workspace = Workspace(road)

class Car:
    width: 1.8
    length: 4.5
    height: 1.5
    target_speed: Normal(12, 4)

ego = new Car in right_lane, facing Normal(0, 0.05)
slow = new Car in right_lane, facing Normal(0, 0.05)
oncoming = new Car in left_lane, facing 180 deg + Normal(0, 0.05)
parked = new Car in left_lane, facing Uniform(0, 180) deg

closing = ego.target_speed - slow.target_speed
gap = slow.position.y - ego.position.y

require ego.position.y < 30
require abs(ego.position.x - slow.position.x) < 1
require 10 < gap < 40
require closing > 1
require (distance from ego to oncoming) > 60
require gap / closing < 8
require abs(parked.position.x + 2) > 0.5
