"""Two cars approach a crossing between buildings; is the other one visible from the ego's camera, and when?

python examples/intersection_labels/label.py -n 20 --seed 1 -o labels
"""

import trimesh
from scenic import RGBSensor
from scenic.simulators.kinematic import KinematicSimulator, SetVelocity

simulator KinematicSimulator(timestep=0.5)

param speed = 14
param recordFolder = '.'
param stop = False
"""Whether the ego stops at the line for two seconds."""
speed = globalParameters.speed
stops = globalParameters.stop

# Roads cross at the origin

crossing_road = RectangularRegion((0, 0, 0), 0, 160, 5)
own_road = RectangularRegion((0, -55, 0), 0, 5, 80)
beyond = RectangularRegion((-56, 56, 0), 0, 100, 100).union(RectangularRegion((56, 56, 0), 0, 100, 100))
far_side = RectangularRegion((45, 0, 0), 0, 70, 2.5)

# Things

def hull():
    """A car's convex hull in the unit box: outlines at three heights and the roof."""
    rings = [(0.18, 0.9, 0.92), (0.55, 1, 1), (0.62, 0.96, 0.98), (1, 0.72, 0.5)]
    points = [
        (x * wide / 2, y * long / 2 - (0.1 if height == 1 else 0), height)
        for height, wide, long in rings for x in (-1, 1) for y in (-1, 1)
    ]
    return trimesh.convex.convex_hull([*points, (-0.35, -0.3, 0), (0.35, -0.3, 0), (-0.35, 0.3, 0), (0.35, 0.3, 0)])

class Car:
    shape: MeshShape(hull())
    width: 2.23
    length: 4.85
    height: 1.83
    color: (0.25, 0.35, 0.6)

class Building:
    regionContainedIn: everywhere

class Commercial(Building):
    width: 22
    length: 22
    height: 100
    color: (0.72, 0.7, 0.66)

class Residential(Building):
    width: 14.275
    length: 57.4
    height: 40
    color: (0.7, 0.5, 0.42)

class Glass(Building):
    width: 14.1
    length: 8.1
    height: 112
    color: (0.5, 0.65, 0.75)

behavior Ahead(pace, line=None):
    """Drive on at one speed, perhaps with a stop of two seconds at the line y = -5."""
    way = Vector(-sin(self.heading), cos(self.heading), 0)
    while line and self.position.y < -5 - pace * simulation().timestep:
        take SetVelocity(way * pace)
    if line:
        take SetVelocity((0, 0, 0))
        wait for 2 seconds
    while True:
        take SetVelocity(way * pace)

# The scene

ego = new Car on own_road, facing 0 deg, with color (0.8, 0.25, 0.2),
    with viewAngles (1.5, 60 deg), with visibleDistance 100, with viewRayDensity 10,
    with cameraOffset (0, 1, 0.9), with behavior Ahead(speed, stops),
    with sensors {'front': RGBSensor(offset=(0, 1, 0.9), width=480, height=298, attributes={'fov': 85.94})}
car = new Car on far_side, facing 90 deg, with behavior Ahead(speed)

for _ in range(2):
    new Commercial on beyond, facing Range(0, 360) deg
    new Glass on beyond, facing Range(0, 360) deg
new Residential on beyond, facing Range(0, 360) deg

new Residential at (-36, -21, 20)
new Commercial at (18 + Range(-1, 1), -20 + Range(-1, 1), 50), facing Range(-5, 5) deg
new Commercial at (50 + Range(-1, 1), -22 + Range(-1, 1), 50), facing Range(-5, 5) deg

# What must hold, and what is kept

require eventually (ego can see car) as 'is seen'
require (not ego can see car) until (distance from ego to car) < 75 as 'is seen late'
require always (distance from ego to car) > 2 as 'no collision'
terminate when ego.position.y > 0
terminate after 60 seconds

record (ego can see car) as visible
record (distance from ego to car) as distance
record ego.observations['front'] to 'film-{simulation}.mp4'
