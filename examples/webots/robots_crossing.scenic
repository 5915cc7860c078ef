"""The crossing of `examples/intersection_labels` in Webots: two cars that are there already, and buildings that are made.

scenic sample examples/webots/robots_crossing.scenic --seed 1 -o crossing.wbt
"""

from scenic.simulators.webots.road.car_models import modelWithName

model scenic.simulators.webots.model

X5 = modelWithName['BmwX5']

crossing_road = RectangularRegion((0, 0, 0), 0, 160, 5)
own_road = RectangularRegion((0, -55, 0), 0, 5, 80)
far_side = RectangularRegion((45, 0, 0), 0, 70, 2.5)
beyond = RectangularRegion((-56, 56, 0), 0, 100, 100).union(RectangularRegion((56, 56, 0), 0, 100, 100))

class Car(WebotsObject):
    """Its nodes are called CAR_0 and CAR_1; their front is their x axis."""
    webotsType: 'CAR'
    rotationOffset: (90 deg, 0, 0)
    width: X5.width
    length: X5.length
    height: 1.75
    viewAngles: (1.5, 60 deg)
    visibleDistance: 100
    viewRayDensity: 10
    cameraOffset: (0, 1, 0.9)

class Building(WebotsObject):
    webotsAdhoc: {'physics': False}
    width: 22
    length: 22
    height: 100

class Residential(Building):
    width: 14.275
    length: 57.4
    height: 40

class Glass(Building):
    width: 14.1
    length: 8.1
    height: 112

behavior Drive(speed):
    """Move on at one speed (m/s)."""
    while True:
        step = speed * simulation().timestep
        take OffsetAction((-sin(self.heading) * step, cos(self.heading) * step, 0))

ego = new Car on own_road, facing 0 deg, with behavior Drive(14)
car = new Car on far_side, facing 90 deg, with behavior Drive(14)

for _ in range(2):
    new Building on beyond, facing Range(0, 360) deg
    new Glass on beyond, facing Range(0, 360) deg
new Residential on beyond, facing Range(0, 360) deg
new Residential at (-36, -21, 20)
new Building at (18 + Range(-1, 1), -20 + Range(-1, 1), 50), facing Range(-5, 5) deg
new Building at (50 + Range(-1, 1), -22 + Range(-1, 1), 50), facing Range(-5, 5) deg

require eventually ego can see car
require (not ego can see car) until (distance from ego to car) < 75
require always (distance from ego to car) > 2
terminate when ego.position.y > 0
terminate after 60 seconds
