"""A furnished room with sixteen toys on its floor: containment, `on`, and collisions of meshes of random size."""

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 6, 5))

def mesh(name):
    return MeshShape.fromFile(localPath("../examples/meshes/" + name + ".obj"))

chair_shape = mesh("chair")
car_shape = mesh("toy_car")
rocket_shape = mesh("toy_rocket")
duck_shape = mesh("toy_duck")

class Fixed:
    regionContainedIn: everywhere

class Chair:
    shape: chair_shape

class Toy:
    size: Range(0.1, 0.2)
    width: self.size
    length: self.size
    height: self.size

class Ball(Toy):
    shape: SpheroidShape()

class Car(Toy):
    shape: car_shape
    length: 1.8 * self.size

class Rocket(Toy):
    shape: rocket_shape
    height: 2 * self.size

class Duck(Toy):
    shape: duck_shape
    length: 1.6 * self.size

floor = new Fixed with width 6, with length 5, with height 0.1, at (0, 0, -0.05)
north = new Fixed at (0, 2.57, 1.2), facing 180 deg, with width 6.24, with length 0.1, with height 2.4
west = new Fixed at (-3.07, 0, 1.2), facing -90 deg, with width 5, with length 0.1, with height 2.4

sofa = new Object ahead of north by (Range(-1.6, 1.6), Range(0.02, 0.2), 0), on floor,
    facing Range(175, 185) deg,
    with shape mesh("sofa"), with width Range(1.7, 2.3)
coffee_table = new Object ahead of sofa by Range(0.3, 0.6), on floor,
    with shape mesh("coffee_table"), with width Range(0.7, 1), with length Range(0.7, 1)
table = new Object on floor,
    facing Range(-30, 30) deg,
    with shape mesh("dining_table"), with width Range(1.3, 1.8), with length Range(0.8, 1)
ego = new Chair left of table by Range(-0.3, 0.05), on floor, facing toward table
new Chair right of table by Range(-0.3, 0.05), on floor, facing toward table
new Chair ahead of table by (Range(-0.3, 0.3), 0.1, 0), on floor, facing toward table

new Ball on floor
new Ball on floor
new Ball on floor
new Ball on floor
new Toy on floor, facing Range(0, 90) deg
new Toy on floor, facing Range(0, 90) deg
new Toy on floor, facing Range(0, 90) deg
new Toy on floor, facing Range(0, 90) deg
new Car on floor, facing Range(0, 360) deg
new Car on floor, facing Range(0, 360) deg
new Car on floor, facing Range(0, 360) deg
new Rocket on floor, facing Range(0, 360) deg
new Rocket on floor, facing Range(0, 360) deg
new Duck on floor, facing Range(0, 360) deg
new Duck on floor, facing Range(0, 360) deg
new Duck on floor, facing Range(0, 360) deg
