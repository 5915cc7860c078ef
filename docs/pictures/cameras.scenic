"""A robot that looks into a furnished room, with a camera of each type."""

from scenic import DepthSensor, RGBSensor, SSSensor

def mesh(name):
    return MeshShape.fromFile(localPath("../../examples/meshes/" + name + ".obj"))

class Fixed:
    regionContainedIn: everywhere

class Chair:
    shape: mesh("chair")
    width: 0.45
    length: 0.5
    height: 0.95
    color: (0.62, 0.38, 0.2)

class Toy:
    width: Range(0.2, 0.3)
    length: self.width
    height: self.width

class Duck(Toy):
    shape: mesh("toy_duck")
    color: (0.95, 0.8, 0.15)

class Car(Toy):
    shape: mesh("toy_car")
    length: 1.8 * self.width
    color: (0.8, 0.15, 0.12)

place = {"offset": (0, 0.2, 0.55), "rotation": (0, -14 deg, 0), "width": 480, "height": 360, "attributes": {"fov": 75}}
workspace = Workspace(RectangularRegion((0, 0, 0), 0, 6, 6))
floor = new Fixed at (0, 0, -0.051), with width 6, with length 6, with height 0.1, with color (0.78, 0.62, 0.42)
north = new Fixed at (0, 3.06, 1.3), with width 6.2, with length 0.1, with height 2.6, with color (0.86, 0.85, 0.8)
west = new Fixed at (-3.06, 0, 1.3), with width 0.1, with length 6, with height 2.6, with color (0.86, 0.85, 0.8)
ego = new Object at (1.2, -2.4, 0.6), facing 15 deg, with width 0.4, with length 0.4, with height 1.2,
    with sensors {"rgb": RGBSensor(**place), "depth": DepthSensor(**place), "classes": SSSensor(**place)}
sofa = new Object at (Range(-1, 0.5), 2.4, 0), on floor, facing 180 deg, with shape mesh("sofa"),
    with width 2, with length 0.85, with height 0.8, with color (0.2, 0.42, 0.6)
table = new Object at (-0.8, 0.4, 0), on floor, facing Range(-20, 20) deg, with shape mesh("dining_table"),
    with width 1.5, with length 0.9, with height 0.75, with color (0.68, 0.42, 0.22)
new Chair left of table by Range(0, 0.1), on floor, facing toward table
new Chair right of table by Range(0, 0.1), on floor, facing toward table
new Object at (2.3, 2.2, 0), on floor, with shape mesh("plant"), with width 0.7, with length 0.7, with height 1.4,
    with color (0.2, 0.5, 0.25)
zone = RectangularRegion((0.6, -0.6, 0), 0, 2.6, 1.6)
for _ in range(3):
    new Duck in zone, on floor, facing Range(0, 360) deg
    new Car in zone, on floor, facing Range(0, 360) deg
