# A robot in a corridor, another close behind it.
corridor = RectangularRegion((0, 0), 0, 3, 60)
workspace = Workspace(corridor)
ego = new Object in workspace, with width 0.6, with length 0.8
follower = new Object in workspace, with width 0.6, with length 0.8
require 1 < ego.y - follower.y < 2
require abs(ego.x - follower.x) < 0.3
