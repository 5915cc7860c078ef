"""A mast to be inspected from a circle of places around it, each looking at the mast."""

workspace = Workspace(BoxRegion(position=(0, 0, 10), dimensions=(24, 24, 20)))
mast = new Object at (0, 0, 8), with shape CylinderShape(), with width 0.6, with length 0.6, with height 16, with color (0.6, 0.62, 0.65)
dish = new Object left of mast by (0.02, 0, Range(2, 5)), with shape ConeShape(initial_rotation=(0, 0, 90 deg)),
    with width 0.6, with length 1.2, with height 1.2, with color (0.85, 0.85, 0.88)

class Drone:
    width: 0.6
    length: 0.6
    height: 0.2
    color: (0.25, 0.3, 0.35)

height = Range(9, 13)
radius = Range(4, 7)
for number in range(5):
    around = number * 72 deg
    new Drone at (radius * cos(around), radius * sin(around), height), facing directly toward dish
ego = new Drone at (0, -radius - 2, height), facing directly toward dish, with color (0.2, 0.5, 0.8)
