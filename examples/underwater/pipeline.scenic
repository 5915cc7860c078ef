"""A robot follows a pipeline at a steady height above it, as a search for leaks needs it."""

workspace = Workspace(BoxRegion(position=(0, 10, 3), dimensions=(20, 30, 8)))

class Pipe:
    shape: CylinderShape(initial_rotation=(0, 90 deg, 0))
    width: 0.6
    length: 3
    height: 0.6
    color: (0.55, 0.5, 0.35)

bend = Range(-12, 12) deg
piece = new Pipe at (0, 0, 0.3), with allowCollisions True
pieces = [piece]
for number in range(6):
    piece = new Pipe at front of piece offset by (0, 1.4, 0), facing (bend * number, 0, 0), with allowCollisions True
    pieces.append(piece)
leak = new Object above Uniform(*pieces) by 0.02, with shape SpheroidShape(), with width 0.25, with length 0.25, with height 0.25,
    with color (0.8, 0.25, 0.2)
ego = new Object above pieces[1] by Range(1.5, 2.5), with width 0.7, with length 1.6, with height 0.6,
    with viewAngles (90 deg, 90 deg), with color (0.95, 0.75, 0.15)
require (distance from ego to leak) > 3
