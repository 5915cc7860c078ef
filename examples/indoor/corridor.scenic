"""People in a corridor, some of them behind open doors: what does a delivery robot see?"""

workspace = Workspace(BoxRegion(position=(0, 10, 1.5), dimensions=(2.4, 20, 3.2)))

class Wall:
    height: 2.6
    regionContainedIn: everywhere
    color: (0.88, 0.86, 0.82)

class Person:
    shape: CylinderShape()
    width: 0.5
    length: 0.5
    height: TruncatedNormal(1.7, 0.1, 1.5, 1.95)
    color: Uniform((0.7, 0.3, 0.25), (0.25, 0.4, 0.65), (0.3, 0.55, 0.35))

floor = new Wall at (0, 10, -0.051), with width 2.4, with length 20, with height 0.1, with color (0.6, 0.62, 0.64)
left = new Wall at (-1.25, 10, 1.3), with width 0.1, with length 20
doors = []
for number in range(4):
    place = 3 + 4.5 * number
    doors.append(new Object at (-0.72, place, 1), facing Range(-30, 30) deg,
        with width 0.9, with length 0.05, with height 2, with color (0.6, 0.42, 0.28))

ego = new Object at (Range(-0.3, 0.3), 0.6, 0.4), with width 0.5, with length 0.6, with height 0.8,
    with viewAngles (70 deg, 50 deg), with visibleDistance 25, with color (0.2, 0.5, 0.8)
first = new Person on floor
second = new Person on floor
require ego can see first
require not (ego can see second)
