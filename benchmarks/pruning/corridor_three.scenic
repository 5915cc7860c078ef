# Three robots side by side in a wide corridor.
workspace = Workspace(RectangularRegion((0, 0), 0, 6, 100))
robots = [new Object in workspace, with width 0.8, with length 0.8 for i in range(3)]
require abs(robots[0].y - robots[1].y) < 1
require abs(robots[1].y - robots[2].y) < 1
