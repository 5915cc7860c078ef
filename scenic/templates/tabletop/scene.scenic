"""A mug and some blocks on a table; a camera looks at them and must see the mug."""

from scenic import RGBSensor

workspace = Workspace(RectangularRegion((0, 0), 0, 3, 3))
floor = new Object with width 3, with length 3, with height 0.1,
    with regionContainedIn everywhere, with color (0.75, 0.7, 0.62)

class Block:
    size: Range(0.04, 0.08)
    width: self.size
    length: self.size
    height: self.size
    color: Uniform((0.85, 0.3, 0.25), (0.25, 0.5, 0.8), (0.95, 0.8, 0.3))

table = new Object on floor, with width 1.2, with length 0.8, with height 0.72, with color (0.65, 0.48, 0.32)
mug = new Object on table, with shape CylinderShape((0.08, 0.08, 0.1)), with color (0.9, 0.9, 0.86)
for number in range(5):
    new Block on table, facing Range(0, 360) deg

# The camera is on a post in front of the table.
ego = new Object behind table by Range(0.2, 0.5), on floor, with width 0.1, with length 0.1, with height 1.3,
    with sensors {"front": RGBSensor(offset=(0, 0.06, 0.6), rotation=(0, -40 deg, 0), width=320, height=240)}

require ego can see mug
require (distance from ego to mug) < 1.2
