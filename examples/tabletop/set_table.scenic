"""A table laid for two: plates near the edge, cups to the right of the plates, no two things closer than they may be."""

workspace = Workspace(RectangularRegion((0, 0), 0, 3, 3))
floor = new Object at (0, 0, -0.051), with width 3, with length 3, with height 0.1, with regionContainedIn everywhere
table = new Object at (0, 0), on floor, with shape MeshShape.fromFile(localPath("../meshes/dining_table.obj")),
    with color (0.6, 0.42, 0.28)

class Plate:
    shape: CylinderShape()
    width: 0.25
    length: 0.25
    height: 0.02
    color: (0.92, 0.92, 0.9)

class Cup:
    shape: CylinderShape()
    width: 0.08
    length: 0.08
    height: 0.1
    color: Uniform((0.75, 0.3, 0.25), (0.3, 0.45, 0.7))

for side in (1, -1):
    place = new OrientedPoint at (0, -0.25 * side, 0.77), facing 0 deg if side == 1 else 180 deg
    plate = new Plate at place offset by (Range(-0.15, 0.15), Range(-0.03, 0.03), 0), on table
    new Cup right of plate by (Range(0.03, 0.1), Range(0, 0.1), 0), on table
bowl = new Object on table, with shape SpheroidShape(), with width 0.25, with length 0.25, with height 0.12, with color (0.4, 0.6, 0.5)
ego = bowl
require (distance from bowl to (0, 0, 0.8)) < 0.3
