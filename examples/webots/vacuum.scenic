"""The room of `examples/vacuum` as a world of Webots, where a controller of Webots drives the robot.

scenic sample examples/webots/vacuum.scenic -p numToys=8 --seed 1 -o room.wbt
"""

model scenic.simulators.webots.model

param numToys = 0

SIDE = 5
GAP = 0.0001

floor = RectangularRegion((0, 0, 0), 0, SIDE, SIDE)
workspace = Workspace(BoxRegion(position=(0, 0, 1), dimensions=(SIDE + 0.2, SIDE + 0.2, 2.2)))

def mesh(name):
    return MeshShape.fromFile(localPath("../meshes/" + name + ".obj"))

class Vacuum(WebotsObject):
    """Its PROTO and its controller are to be in the project's folders; the controller finds its seed in `customData`."""
    webotsProto: 'IRobotCreate'
    webotsName: 'VACUUM'
    rotationOffset: (90 deg, 0, 0)
    positionOffset: (0, 0, -self.height / 2)
    shape: CylinderShape()
    width: 0.335
    length: 0.335
    height: 0.07
    controller: 'vacuum'
    controllerSeed: DiscreteRange(0, 2 ** 31 - 1)
    customData: str(self.controllerSeed)

class Wall(WebotsObject):
    webotsAdhoc: {'physics': False}
    width: SIDE
    length: 0.04
    height: 0.5

class Furniture(WebotsObject):
    webotsAdhoc: {'physics': True}
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
    positionStdDev: (0.05, 0.05, 0)
    orientationStdDev: (10 deg, 0, 0)

class Couch(Furniture):
    shape: mesh("couch")
    width: 2
    length: 0.75
    height: 0.75
    positionStdDev: (0.05, 0.5, 0)
    orientationStdDev: (5 deg, 0, 0)

class CoffeeTable(Furniture):
    shape: mesh("trestle_table")
    width: 1.2
    length: 0.5
    height: 0.4
    positionStdDev: (0.05, 0.05, 0)
    orientationStdDev: (5 deg, 0, 0)

class Toy(WebotsObject):
    webotsAdhoc: {'physics': True}
    shape: Uniform(BoxShape(), CylinderShape(), ConeShape(), SpheroidShape())
    width: 0.1
    length: 0.1
    height: 0.1
    density: 100
    color: (0.85, 0.3, 0.25)

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

block = new Toy on floor, with shape BoxShape()
second = new Toy on block, with shape BoxShape()
new Toy on second, with shape BoxShape()
for _ in range(globalParameters.numToys):
    new Toy on floor

record final ego.position as place
terminate after 300 seconds
