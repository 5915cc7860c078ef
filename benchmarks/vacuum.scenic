"""A robot vacuum in a furnished room; `toys` lie on its floor, of four shapes and of random size."""

param toys = 0
count = globalParameters.toys

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 5, 5))

def mesh(name):
    return MeshShape.fromFile(localPath("../examples/meshes/" + name + ".obj"))

class Fixed:
    regionContainedIn: everywhere

class Vacuum:
    shape: CylinderShape()
    width: 0.34
    length: 0.34
    height: 0.09

class Toy:
    size: Range(0.08, 0.18)
    width: self.size
    length: self.size
    height: self.size

floor = new Fixed at (0, 0, -0.06), with width 5, with length 5, with height 0.1
new Fixed at (0, 2.57, 1.2), with width 5.24, with length 0.1, with height 2.4
new Fixed at (0, -2.57, 1.2), with width 5.24, with length 0.1, with height 2.4
new Fixed at (2.57, 0, 1.2), with width 0.1, with length 5, with height 2.4
new Fixed at (-2.57, 0, 1.2), with width 0.1, with length 5, with height 2.4

ego = new Vacuum on floor, facing Range(0, 360) deg
table = new Object on floor, facing Range(0, 360) deg, with shape mesh("dining_table"),
    with width 1.5, with length 0.9, with height 0.75
for side in (-0.4, 0, 0.4):
    new Object ahead of table by (side, Range(0, 0.2), 0), on floor, facing Range(150, 210) deg,
        with shape mesh("chair"), with width 0.38, with length 0.42, with height 0.9
sofa = new Object at (Range(-1.5, 1.5), 1.95, 0), on floor, facing 180 deg, with shape mesh("sofa"),
    with width 1.9, with length 0.8, with height 0.8
new Object ahead of sofa by Range(0.3, 0.6), on floor, with shape mesh("coffee_table"),
    with width 0.8, with length 0.8, with height 0.4

shapes = (SpheroidShape(), mesh("toy_car"), mesh("toy_duck"), mesh("toy_rocket"))
for number in range(count):
    new Toy on floor, facing Range(0, 360) deg, with shape shapes[number % 4]
