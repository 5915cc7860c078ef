# Two robots meet in the middle of a corridor.
corridor = RectangularRegion((0, 0), 0, 2.5, 80)
workspace = Workspace(corridor)
ego = new Object in workspace, with width 0.6, with length 0.8
other = new Object in workspace, with width 0.6, with length 0.8
require (distance from ego to other) < 2
require ego.y < -25
