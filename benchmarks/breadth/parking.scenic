# A curb, a badly parked car and an observer, with containment and visibility.
curb = PolylineRegion([(4, 0), (4, 60)])
road = PolygonalRegion([(-4, 0), (4, 0), (4, 60), (-4, 60)])
ego = new Object at (Range(-3, 3), Range(3, 20)), with width 1.8, with length 4.5, with viewAngle 90 deg,
    with visibleDistance 60, with regionContainedIn road
spot = new OrientedPoint on curb
badly = Uniform(1, -1) * Range(5, 15) deg
parked = new Object left of spot by 0.5, facing badly relative to spot, with width 1.8, with length 4.5
require (angle to parked) > -45 deg
require 5 < (distance to parked) < 40
