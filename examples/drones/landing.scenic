"""A drone above a landing pad on a roof, at an angle from which it sees the pad past the chimneys."""

workspace = Workspace(BoxRegion(position=(0, 0, 12), dimensions=(30, 30, 24)))
house = new Object at (0, 0, 3), with width 12, with length 9, with height 6, with color (0.75, 0.68, 0.6)

class Chimney:
    width: Range(0.6, 1.2)
    length: 0.8
    height: Range(1, 2.5)
    color: (0.55, 0.3, 0.25)

pad = new Object on house, with shape CylinderShape(), with width 2, with length 2, with height 0.05, with color (0.9, 0.8, 0.2)
new Chimney on house
new Chimney on house
ego = new Object in BoxRegion(position=(0, 0, 14), dimensions=(16, 16, 8)), facing directly toward pad,
    with width 0.6, with length 0.6, with height 0.2, with viewAngles (60 deg, 45 deg), with color (0.2, 0.5, 0.8)
require ego can see pad
require (altitude from pad to ego) > 40 deg
require (distance from ego to pad) > 6
