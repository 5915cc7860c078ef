"""A robot vacuum cleans a furnished room with toys on the floor. Does it cover a third of the floor in five minutes?

scenic simulate examples/vacuum/vacuum.scenic -n 25 -p numToys=0,1,2,4,8,16 --keep all --time 1200 --plot robustness.png
"""

import random
from math import atan2, ceil
from sweeping import Sweep

model scenic.simulators.mujoco.model
simulator MujocoSimulator(timestep=0.25, physics_step=0.005, sleep=True)

param numToys = 0
param duration = 300
param bumper = 60  # so far to each side of straight ahead the bumper feels, degrees
toys = globalParameters.numToys
duration = globalParameters.duration
bumper = globalParameters.bumper * 1 deg

SIDE = 5
GAP = 0.0001
SPEED = 16 * 0.031
AXLE = 0.272

floor = RectangularRegion((0, 0, 0), 0, SIDE, SIDE)
workspace = Workspace(BoxRegion(position=(0, 0, 1), dimensions=(SIDE + 0.2, SIDE + 0.2, 2.2)))

# Things

def mesh(name):
    return MeshShape.fromFile(localPath("../meshes/" + name + ".obj"))

class Wall(Fixture):
    width: SIDE
    length: 0.04
    height: 0.5
    color: (0.82, 0.8, 0.75)

class Furniture(Body):
    density: 670
    color: (0.62, 0.46, 0.33)

class DiningTable(Furniture):
    shape: mesh("dining_table")
    width: Range(0.7, 1.5)
    length: Range(0.7, 1.5)
    height: 0.75

class Chair(Furniture):
    shape: mesh("chair")
    width: 0.4
    length: 0.4
    height: 0.9
    color: (0.7, 0.55, 0.4)
    positionStdDev: (0.05, 0.05, 0)
    orientationStdDev: (10 deg, 0, 0)

class Couch(Furniture):
    shape: mesh("couch")
    width: 2
    length: 0.75
    height: 0.75
    color: (0.35, 0.42, 0.55)
    positionStdDev: (0.05, 0.5, 0)
    orientationStdDev: (5 deg, 0, 0)

class CoffeeTable(Furniture):
    shape: mesh("trestle_table")
    width: 1.2
    length: 0.5
    height: 0.4
    positionStdDev: (0.05, 0.05, 0)
    orientationStdDev: (5 deg, 0, 0)

class Toy(Body):
    shape: Uniform(BoxShape(), CylinderShape(), ConeShape(), SpheroidShape())
    width: 0.1
    length: 0.1
    height: 0.1
    density: 100
    color: Uniform((0.85, 0.3, 0.25), (0.25, 0.6, 0.35), (0.95, 0.75, 0.2))

class Block(Toy):
    shape: BoxShape()

# The robot: a round body on two wheels, and how it is driven

behavior Drive(left, right, steps):
    """Set the speeds of the wheels (m/s) for some steps; the simulator takes those of the sides, which are further out."""
    mean, half = (left + right) / 2, (right - left) / 2 * self.width / AXLE
    for _ in range(steps):
        take SetWheelSpeeds(mean - half, mean + half)

behavior Turn(angle):
    """Turn on the spot to the left, at half speed or a little slower, so that it takes a whole number of steps."""
    step = simulation().timestep
    steps = max(1, ceil(abs(angle) * AXLE / (SPEED * step)))
    pace = angle / (steps * step) * AXLE / 2
    do Drive(-pace, pace, steps)

behavior Clean():
    """Ahead until the bumper feels something; then back, and away from that side by a random angle."""
    draws = random.Random(self.controllerSeed)
    half_second = ceil(0.5 / simulation().timestep)
    do Drive(0, 0, half_second)
    while True:
        front = [place for place in self.touches if abs(atan2(place.x, place.y)) <= bumper]
        if not front:
            do Drive(SPEED, SPEED, 1)
            continue
        side = -1 if any(place.x < 0 for place in front) else 1
        do Drive(-SPEED / 2, -SPEED / 2, half_second)
        do Turn(side * draws.uniform(0, 180) * 1 deg)

monitor Covering(robot, every=20):
    """Keep the area that the robot has passed over, brought up to date every few steps."""
    sweep = Sweep(robot.width / 2)
    while True:
        sweep.pass_over(robot.position)
        if len(sweep.path) % every == 0:
            robot.covered = sweep.area() / SIDE ** 2
        wait

class Vacuum(Robot):
    shape: CylinderShape()
    width: 0.335
    length: 0.335
    height: 0.07
    wheelRadius: 0.031
    mass: 3
    color: (0.2, 0.22, 0.26)
    controllerSeed: DiscreteRange(0, 2 ** 31 - 1)
    covered: 0
    behavior: Clean()

# The room

right = new Wall at (SIDE / 2 + 0.02 + GAP, 0, 0.25), facing 90 deg
left = new Wall at (-SIDE / 2 - 0.02 - GAP, 0, 0.25), facing -90 deg
new Wall at (0, SIDE / 2 + 0.02 + GAP, 0.25)
new Wall at (0, -SIDE / 2 - 0.02 - GAP, 0.25)

ego = new Vacuum on floor, facing Range(0, 360) deg
free = CircularRegion(ego.position, 1)

dining = RectangularRegion((1.25, 0, 0), 0, 2.5, 5).difference(free)
living = RectangularRegion((-1.25, 0, 0), 0, 2.5, 5).difference(free)

table = new DiningTable contained in dining, on floor, facing Range(0, 360) deg
behind_it = new Chair behind table by -0.1, on floor, facing toward table, with regionContainedIn dining
ahead_of_it = new Chair ahead of table by -0.1, on floor, facing toward table, with regionContainedIn dining
beside_it = new Chair left of table by -0.1, on floor, facing toward table, with regionContainedIn dining
mutate behind_it, ahead_of_it, beside_it
lean = Uniform((90 deg, 0), (-90 deg, 0), (0, 90 deg), (0, -90 deg))
fallen = new Chair contained in dining, on floor, facing (Range(0, 360) deg, lean[0], lean[1]), with baseOffset (0, 0, -0.2)

couch = new Couch ahead of left by 0.335, on floor, facing away from left, with regionContainedIn living
coffee = new CoffeeTable ahead of couch by 0.336, on floor, facing away from couch, with regionContainedIn living
mutate couch, coffee

block = new Block on floor
second = new Block on block
new Block on second
for _ in range(toys):
    new Toy on floor

# What it must do

require monitor Covering(ego)
require eventually ego.covered > 1 / 3 as coverage
record final ego.covered as covered
record ego.position as path
terminate after duration seconds
