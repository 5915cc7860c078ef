"""A chair at a table with a cup on it: the example of the README."""

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 4, 3))
floor = new Object with width 4, with length 3, with height 0.1, with regionContainedIn everywhere
table = new Object on floor, facing Range(-30, 30) deg,
    with width Range(1, 1.4), with length 0.7, with height 0.72, with color (0.7, 0.5, 0.3)
ego = new Object behind table by Range(0.05, 0.3), on floor, facing toward table,
    with width 0.5, with length 0.5, with height 0.9
cup = new Object on table, with shape CylinderShape((0.08, 0.08, 0.1))
require (distance from cup to ego) < 0.9
