# A row of boxes, each moved and turned by noise.
boxes = [new Object at (3 * i, 0), with width 1.5, with length 1.5 for i in range(12)]
ego = boxes[0]
mutate
require (distance from boxes[3] to boxes[4]) > 2
