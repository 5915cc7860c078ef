"""A bowling lane after the first ball: some pins are gone, and at least one split is left."""

workspace = Workspace(RectangularRegion((0, 1.5), 0, 2, 5))
lane = new Object at (0, 1.5, -0.051), with width 1.2, with length 5, with height 0.1, with regionContainedIn everywhere, with color (0.85, 0.7, 0.45)

class Pin:
    shape: CylinderShape()
    width: 0.12
    length: 0.12
    height: 0.38
    color: (0.95, 0.95, 0.92)

gap = 0.3
pins = []
for row in range(4):
    for column in range(row + 1):
        # A pin that is gone lies in the pit behind the lane.
        pins.append(new Pin at ((column - row / 2) * gap, 3 + row * gap * 0.87, Discrete({0.19: 2, -2: 3})),
            with regionContainedIn everywhere)
ego = new Object at (Range(-0.4, 0.4), 0, 0.11), with shape SpheroidShape(), with width 0.22, with length 0.22, with height 0.22,
    with color (0.2, 0.3, 0.6)
require pins[0].position.z < 0
require pins[6].position.z > 0 and pins[9].position.z > 0
