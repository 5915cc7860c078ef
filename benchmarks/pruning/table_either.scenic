# A cup left or right of the plate, within reach.
plate = new Object at (Range(-1, 1), Range(-0.5, 0.5)), with width 0.25, with length 0.25, with height 0.02
cup = new Object at (Range(-1, 1), Range(-0.5, 0.5)), with width 0.08, with length 0.08, with height 0.1
require 0.19 < cup.x - plate.x < 0.21 or -0.21 < cup.x - plate.x < -0.19
require abs(cup.y - plate.y) < 0.05
