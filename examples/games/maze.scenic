"""A maze with a way through: walls stand at random between cells, and the runner can see the exit from a corner."""

workspace = Workspace(RectangularRegion((0, 0), 0, 10, 10))
floor = new Object at (0, 0, -0.051), with width 10, with length 10, with height 0.1, with regionContainedIn everywhere, with color (0.8, 0.8, 0.76)

class Wall:
    width: 2
    length: 0.2
    height: 1
    color: (0.35, 0.45, 0.4)
    allowCollisions: True
    regionContainedIn: everywhere

for x in range(4):
    for y in range(5):
        if (x + y) % 2 == 0:
            new Wall at (-4 + 2 * x + 1, -4 + 2 * y, 0.501), facing Uniform(0, 90) deg

goal = new Object at (4.5, 4.5, 0.501), with width 0.6, with length 0.6, with color (0.95, 0.8, 0.25)
ego = new Object on floor, facing toward goal, with width 0.5, with length 0.5, with height 0.6, with color (0.2, 0.5, 0.8)
require ego can see goal
require (distance from ego to goal) > 6
