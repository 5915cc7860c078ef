"""A living room: furniture of random size along the walls, chairs round a table, and things left lying about.

Everything is a real mesh. Chairs may stand partly under the table, as long as they do not touch it.
"""

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 6, 5))

def mesh(name):
    return MeshShape.fromFile(localPath("../meshes/" + name + ".obj"))

chair_shape = mesh("chair")

class Fixed:
    regionContainedIn: everywhere
    color: (0.93, 0.91, 0.87)

class Chair:
    shape: chair_shape
    color: (0.72, 0.5, 0.32)

class Toy:
    size: Range(0.12, 0.22)
    width: self.size
    length: self.size
    height: self.size

class Car(Toy):
    shape: mesh("toy_car")
    length: 1.8 * self.size
    color: (0.8, 0.25, 0.2)

class Rocket(Toy):
    shape: mesh("toy_rocket")
    height: 2 * self.size
    color: (0.85, 0.85, 0.9)

# The room itself: a floor and two of its walls, which look into it.
floor = new Fixed with width 6, with length 5, with height 0.1, at (0, 0, -0.05),
    with color (0.82, 0.7, 0.55)
north = new Fixed at (0, 2.57, 1.2), facing 180 deg, with width 6.24, with length 0.1, with height 2.4
west = new Fixed at (-3.07, 0, 1.2), facing -90 deg, with width 5, with length 0.1, with height 2.4

# Along the walls.
sofa = new Object ahead of north by (Range(-1.6, 1.6), Range(0.02, 0.2), 0), on floor,
    facing Range(175, 185) deg,
    with shape mesh("sofa"), with width Range(1.7, 2.3),
    with color (0.3, 0.45, 0.55)
shelf = new Object ahead of west by (Range(-1.8, 1.8), 0.02, 0), on floor,
    facing -90 deg,
    with shape mesh("shelf"), with width Range(0.8, 1.2), with height Range(1.5, 2),
    with color (0.6, 0.42, 0.28)
lamp = new Object left of sofa by Range(0.05, 0.2), on floor,
    with shape mesh("floor_lamp"),
    with color (0.95, 0.85, 0.55)

# In the room.
coffee_table = new Object ahead of sofa by Range(0.3, 0.6), on floor,
    with shape mesh("coffee_table"), with width Range(0.7, 1), with length Range(0.7, 1),
    with color (0.55, 0.36, 0.24)
cabinet = new Object at (Range(-1.8, 1.8), Range(-2.25, -2.1)), on floor,
    facing Range(-5, 5) deg,
    with shape mesh("cabinet"),
    with color (0.35, 0.33, 0.36)
table = new Object on floor,
    facing Range(-30, 30) deg,
    with shape mesh("dining_table"), with width Range(1.3, 1.8), with length Range(0.8, 1),
    with color (0.66, 0.46, 0.3)
plant = new Object on floor,
    with shape mesh("plant"), with height Range(0.8, 1.3),
    with color (0.3, 0.55, 0.3)

# Round the table; a negative distance moves a chair under it.
ego = new Chair left of table by Range(-0.3, 0.05), on floor, facing toward table
new Chair right of table by Range(-0.3, 0.05), on floor, facing toward table
new Chair ahead of table by (Range(-0.3, 0.3), 0.1, 0), on floor, facing toward table

# Things.
vase = new Object on table,
    with shape CylinderShape(), with width 0.12, with length 0.12, with height Range(0.18, 0.3),
    with color (0.3, 0.55, 0.7)
new Toy on coffee_table, facing Range(0, 360) deg,
    with shape mesh("toy_duck"),
    with color (0.95, 0.8, 0.2)
new Car on floor, facing Range(0, 360) deg
new Rocket on floor, facing Range(0, 360) deg
new Toy on floor, with shape SpheroidShape(), with color (0.9, 0.45, 0.2)
new Toy on floor, with shape ConeShape(), with color (0.55, 0.4, 0.7)
new Toy on floor, facing Range(0, 90) deg, with color (0.35, 0.6, 0.4)

require distance from table to sofa > 1.6
require distance from plant to table > 1.2
require (distance from cabinet to sofa) > 3
