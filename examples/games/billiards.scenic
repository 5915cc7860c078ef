"""Fifteen balls in a triangle and a cue ball with a free line to the first of them."""

workspace = Workspace(RectangularRegion((0, 0), 0, 1.6, 2.8))
cloth = new Object at (0, 0, -0.051), with width 1.27, with length 2.54, with height 0.1, with regionContainedIn everywhere, with color (0.15, 0.45, 0.3)
inside = RectangularRegion((0, 0, 0), 0, 1.2, 2.45)

class Ball:
    shape: SpheroidShape()
    width: 0.057
    length: 0.057
    height: 0.057
    color: Uniform((0.85, 0.25, 0.2), (0.95, 0.8, 0.2), (0.2, 0.35, 0.7), (0.45, 0.2, 0.5), (0.9, 0.5, 0.2))

spacing = 0.058
balls = []
for row in range(5):
    for column in range(row + 1):
        balls.append(new Ball at ((column - row / 2) * spacing, 0.6 + row * 0.0503, 0.0286))
ego = new Ball at (Range(-0.55, 0.55), Range(-1.15, -0.3), 0.0286), facing toward balls[0], with viewAngles (90 deg, 60 deg),
    with color (0.97, 0.97, 0.95)
require ego can see balls[0]
require abs(angle from ego to balls[0]) < 25 deg
