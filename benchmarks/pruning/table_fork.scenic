# Fork and knife on the two sides of a plate.
top = RectangularRegion((0, 0), 0, 2, 1)
plate = new Object in top, with width 0.25, with length 0.25, with height 0.02
fork = new Object in top, with width 0.03, with length 0.2, with height 0.01
knife = new Object in top, with width 0.03, with length 0.2, with height 0.01
require abs(fork.x - plate.x + 0.18) < 0.03 and abs(fork.y - plate.y) < 0.05
require abs(knife.x - plate.x - 0.18) < 0.03 and abs(knife.y - plate.y) < 0.05
