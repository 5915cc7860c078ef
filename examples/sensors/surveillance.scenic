"""Two cameras watch a yard from opposite corners: everything of value is seen by at least one of them."""

workspace = Workspace(RectangularRegion((0, 0), 0, 20, 20))
yard = new Object at (0, 0, -0.051), with width 20, with length 20, with height 0.1, with regionContainedIn everywhere,
    with color (0.68, 0.7, 0.66)

class Camera:
    width: 0.2
    length: 0.3
    height: 0.2
    viewAngles: (80 deg, 60 deg)
    visibleDistance: 30
    color: (0.15, 0.15, 0.18)

class Container:
    width: 2.4
    length: 6
    height: 2.6
    color: Uniform((0.6, 0.3, 0.25), (0.3, 0.45, 0.6), (0.4, 0.55, 0.4))

ego = new Camera at (-9.5, -9.5, 5), facing directly toward (0, 0, 0)
other = new Camera at (9.5, 9.5, 5), facing directly toward (0, 0, 0)
for number in range(4):
    new Container on yard, facing Uniform(0, 90) deg
safe = new Object on yard, with color (0.95, 0.8, 0.25)
require (ego can see safe) or (other can see safe)
