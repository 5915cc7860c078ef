# A target that a wall hides wholly: no ray gets through, and every one has to be cast or proved superfluous.

ego = new Object with viewAngles (120 deg, 60 deg), with visibleDistance 40
wall = new Object at (0, Range(4, 6), 0), with width 8, with length 0.2, with height 4
target = new Object at (Range(-1, 1), Range(10, 14), Range(-0.5, 0.5)), facing Range(0, 360) deg
require not (ego can see target)
