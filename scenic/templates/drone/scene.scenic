"""A drone flies to a pad and keeps away from a mast."""

from scenic.simulators.kinematic import *
simulator KinematicSimulator(timestep=0.1)

workspace = Workspace(BoxRegion(position=(0, 0, 5), dimensions=(24, 24, 12)))

mast = new Object at (Range(-3, 3), Range(-3, 3), 3), with width 0.4, with length 0.4, with height 6, with color (0.6, 0.6, 0.62)
pad = new Object at (Range(4, 9), Range(-6, 6), 0.05), with width 1.5, with length 1.5, with height 0.1, with color (0.9, 0.8, 0.2)

behavior FlyTo(goal, speed):
    while True:
        ahead = goal - self.position
        wanted = ahead * (speed / max(1, ahead.norm()))
        gap = self.position - mast.position
        aside = Vector(gap.x, gap.y, 0)
        if aside.norm() < 3:
            # Away from the mast, and past it.
            wanted = wanted + aside * (2 / aside.norm()) + Vector(-aside.y, aside.x, 0) * (1 / aside.norm())
        take SetVelocity(wanted)

ego = new Object at (-8, Range(-6, 6), Range(2, 4)), with width 0.6, with length 0.6, with height 0.2,
    with color (0.2, 0.5, 0.8), with behavior FlyTo(pad.position + (0, 0, 0.5), 2)

require always (minimum distance from ego to mast) > 0.3 as 'keeps away'
require eventually (distance from ego to pad) < 1 as 'arrives'
terminate when (distance from ego to pad) < 0.8
