"""Racks in rows with pallets on them, and a forklift in an aisle that fits it."""

workspace = Workspace(RectangularRegion((0, 0), 0, 24, 16))
floor = new Object at (0, 0, -0.051), with width 24, with length 16, with height 0.1, with regionContainedIn everywhere,
    with color (0.7, 0.7, 0.68)

class Board:
    width: 1.1
    length: 10
    height: 0.1
    color: (0.85, 0.45, 0.2)

class Pallet:
    width: 0.8
    length: 1.2
    height: Range(0.6, 1.4)
    color: Uniform((0.7, 0.55, 0.35), (0.5, 0.55, 0.6), (0.35, 0.45, 0.6))

aisle = Range(2.8, 3.4)
boards = []
for row in range(4):
    for level in range(2):
        boards.append(new Board at ((row - 1.5) * (1.1 + aisle), 0, 0.1 + 1.8 * level))
for number in range(14):
    new Pallet on Uniform(*boards), with parentOrientation 0, facing 0 deg
ego = new Object at (Range(-0.4, 0.4), Range(-4, 4), 0), on floor, facing Uniform(0, 180) deg,
    with width 1.2, with length 2.4, with height 2.1, with color (0.95, 0.75, 0.15)
