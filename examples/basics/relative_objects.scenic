"""Three blocks, each placed in the frame of another: B beside A, and C above B.

A is turned and tilted, and the directions right and above turn and tilt with it.
"""

class Block:
    width: 1
    length: 1
    height: 1

A = new Block at (0, 0, 2),
    facing (Range(0, 360) deg, Range(-30, 30) deg, Range(-30, 30) deg),
    with length 2,
    with color (0.85, 0.3, 0.25)

B = new Block right of A by Range(0.5, 2),
    with height 1.6,
    with color (0.95, 0.75, 0.25)

C = new Block above B by Range(0.1, 0.5),
    with yaw Range(-45, 45) deg,
    with color (0.25, 0.55, 0.85)

ego = A
