# Glasses in a row along the table.
top = RectangularRegion((0, 0), 0, 2, 1)
glasses = [new Object in top, with width 0.07, with length 0.07, with height 0.15 for i in range(3)]
for one, other in zip(glasses, glasses[1:]):
    require abs(one.y - other.y) < 0.05
    require 0.1 < other.x - one.x < 0.2
