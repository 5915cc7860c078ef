# Four cars in a plane, with three requirements.
class Car:
    width: 2
    length: 4.5
    height: 1.5

plane = RectangularRegion((0, 0, 0), 0, 60, 60)
ego = new Car in plane, facing Range(-30, 30) deg
lead = new Car ahead of ego by Range(5, 15), facing Range(-10, 10) deg relative to ego.heading
other = new Car in plane, facing Range(0, 360) deg
parked = new Car in plane
require (distance from ego to other) < 20
require (relative heading of other from ego) > 90 deg
require (distance from parked to other) > 10
