"""A race course for drones: gates that stand in a winding line, each turned a little."""

workspace = Workspace(BoxRegion(position=(0, 18, 5), dimensions=(30, 44, 10)))

class Beam:
    width: 2.4
    length: 0.2
    height: 0.2
    color: (0.9, 0.35, 0.2)
    allowCollisions: True

def gate(x, y, z):
    """Two beams and two posts around a hole of 2 m; the lower beam."""
    low = new Beam at (x, y, z - 1.1), facing Range(-25, 25) deg
    new Beam above low by 2
    new Beam above low by (-1.1, 0, 0), with width 0.2, with height 2
    new Beam above low by (1.1, 0, 0), with width 0.2, with height 2
    return low

first = gate(Range(-3, 3), 6, Range(2, 4))
second = gate(Range(-6, 6), 14, Range(2, 6))
third = gate(Range(-6, 6), 22, Range(2, 6))
fourth = gate(Range(-6, 6), 30, Range(2, 4))
ego = new Object at (0, 0, 1), facing toward first, with width 0.5, with length 0.5, with height 0.2, with color (0.2, 0.5, 0.8)
require abs(relative heading of first from second) < 30 deg
