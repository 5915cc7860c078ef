"""The vacuum room of the paper: furniture keeps clear of a safe zone about the robot; `toys` lie on the floor."""

param toys = 0
toys = globalParameters.toys

SIDE = 5
GAP = 0.0001

workspace = Workspace(BoxRegion(position=(0, 0, 1), dimensions=(SIDE + 0.2, SIDE + 0.2, 2.2)))

def mesh(name):
    return MeshShape.fromFile(localPath("../../examples/meshes/" + name + ".obj"))

class Floor:
    width: SIDE
    length: SIDE
    height: 0.01

class Wall:
    width: SIDE
    length: 0.04
    height: 0.5

class DiningTable:
    shape: mesh("dining_table")
    width: Range(0.7, 1.5)
    length: Range(0.7, 1.5)
    height: 0.75

class Chair:
    shape: mesh("chair")
    width: 0.42
    length: 0.45
    height: 0.9
    positionStdDev: (0.05, 0.05, 0)
    orientationStdDev: (10 deg, 0, 0)

class Couch:
    shape: mesh("sofa")
    width: 2
    length: 0.75
    height: 0.75
    positionStdDev: (0.05, 0.5, 0)
    orientationStdDev: (5 deg, 0, 0)

class CoffeeTable:
    shape: mesh("coffee_table")
    width: 1.2
    length: 0.5
    height: 0.4
    positionStdDev: (0.05, 0.05, 0)
    orientationStdDev: (5 deg, 0, 0)

class Toy:
    shape: Uniform(BoxShape(), CylinderShape(), ConeShape(), SpheroidShape())
    width: 0.1
    length: 0.1
    height: 0.1

class Block(Toy):
    shape: BoxShape()

class Vacuum:
    shape: CylinderShape()
    width: 0.335
    length: 0.335
    height: 0.07

floor = new Floor at (0, 0, -0.005)
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
fallen = new Chair contained in dining, on floor, facing (Range(0, 360) deg, Uniform(90, -90) deg, 0)

couch = new Couch ahead of left by 0.335, on floor, facing away from left, with regionContainedIn living
coffee = new CoffeeTable ahead of couch by 0.336, on floor, facing away from couch, with regionContainedIn living
mutate couch, coffee

block = new Block on floor
second = new Block on block
new Block on second
for _ in range(toys):
    new Toy on floor
