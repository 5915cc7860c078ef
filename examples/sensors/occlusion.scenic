"""A pedestrian that steps out from behind a van: hidden from the car now, and near its path."""

workspace = Workspace(RectangularRegion((0, 20), 0, 14, 60))
lane = 3.5
ego = new Object at (lane / 2, 0, 0.75), with width 1.9, with length 4.5, with height 1.5,
    with viewAngles (100 deg, 40 deg), with visibleDistance 60, with cameraOffset (0, 0.5, 0.5), with color (0.2, 0.5, 0.8)
van = new Object at (lane + 1.2, Range(14, 24), 1.2), with width 2.1, with length 5.5, with height 2.4, with color (0.85, 0.85, 0.82)
walker = new Object ahead of van by (Range(-0.6, 0.4), Range(0.5, 2), 0), with shape CylinderShape(),
    with width 0.5, with length 0.5, with height 1.75, with color (0.8, 0.3, 0.2)
require not (ego can see walker)
require (distance from ego to walker) > 12
