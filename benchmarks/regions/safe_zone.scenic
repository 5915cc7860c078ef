"""A robot vacuum in a furnished room: the furniture keeps clear of a safe zone about the robot; `toys` lie on the floor."""

param toys = 0
count = globalParameters.toys

def mesh(name):
    return MeshShape.fromFile(localPath("../../examples/meshes/" + name + ".obj"))

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 5.2, 5.2))

class Fixed:
    regionContainedIn: everywhere
    allowCollisions: True

class Toy:
    shape: Uniform(BoxShape(), CylinderShape(), ConeShape(), SpheroidShape())
    width: 0.1
    length: 0.1
    height: 0.1

floor = new Fixed at (0, 0, -0.005), with width 5, with length 5, with height 0.01
new Fixed at (0, 2.5201, 0.25), with width 5, with length 0.04, with height 0.5
left = new Fixed at (-2.5201, 0, 0.25), with width 0.04, with length 5, with height 0.5
new Fixed at (0, -2.5201, 0.25), with width 5, with length 0.04, with height 0.5
new Fixed at (2.5201, 0, 0.25), with width 0.04, with length 5, with height 0.5

ego = new Object on floor, with shape CylinderShape(), with width 0.335, with length 0.335, with height 0.07
safe = CircularRegion(ego.position, 1)

dining = RectangularRegion((1.25, 0, 0), 0, 2.5, 5).difference(safe)
table = new Object contained in dining, facing Range(0, 360) deg, with shape mesh("dining_table"),
    with width Range(0.7, 1.5), with length Range(0.7, 1.5), with height 0.75
for side in (0, 1, 2):
    place = (table.position offset along table.heading + side * 90 deg by (0, 0.35, 0))
    new Object at place, on floor, facing table.heading + side * 90 deg + Range(-10, 10) deg, with shape mesh("chair"),
        with regionContainedIn dining, with allowCollisions True, with width 0.4, with length 0.4, with height 1

couch = new Object at (-2.1, Range(-1.5, 1.5), 0), on floor, facing -90 deg + Range(-5, 5) deg, with shape mesh("sofa"),
    with width 1.7, with length 0.7, with height 0.7
new Object ahead of couch by 0.336, on floor, facing -90 deg + Range(-5, 5) deg, with shape mesh("coffee_table"),
    with width 1, with length 0.5, with height 0.4

for number in range(count):
    new Toy on floor, facing Range(0, 360) deg
