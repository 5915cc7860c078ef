# Four plates near the edge of a table, cups close to them.
top = RectangularRegion((0, 0), 0, 2, 1)
plate = new Object in top, with width 0.25, with length 0.25, with height 0.02
cup = new Object in top, with width 0.08, with length 0.08, with height 0.1
require 0.18 < (distance from plate to cup) < 0.22
require plate.y < -0.3
require cup.x > plate.x + 0.1
