"""A wall hides one box from the ego and not another."""

ego = new Object at (0, 0, 0.5), with viewAngles (70 deg, 30 deg), with visibleDistance 14, with showVisibleRegion True,
    with color (0.85, 0.3, 0.2)
wall = new Object at (0, 5, 1), with width 4, with height 2, with length 0.2, with color (0.75, 0.72, 0.66)
hidden = new Object at (Range(-1, 1), Range(8, 11), 0.5), with color (0.35, 0.45, 0.75)
seen = new Object at (Range(2, 4), Range(8, 10), 0.5), with color (0.3, 0.65, 0.35)
require not (ego can see hidden)
require ego can see seen
