"""A toy under a table: it is hidden from a standing robot, and visible to one that bends down."""

workspace = Workspace(RectangularRegion((0, 0), 0, 5, 5))
floor = new Object with width 5, with length 5, with height 0.1, with regionContainedIn everywhere, with color (0.8, 0.7, 0.55)
table = new Object on floor, facing Range(0, 360) deg, with shape MeshShape.fromFile(localPath("../meshes/coffee_table.obj")),
    with width 1.4, with length 1.4, with height 0.45, with color (0.5, 0.35, 0.22)
toy = new Object on floor, with shape MeshShape.fromFile(localPath("../meshes/toy_car.obj")),
    with width 0.12, with length 0.2, with height 0.1, with color (0.8, 0.25, 0.2)

class Robot:
    width: 0.3
    length: 0.3
    height: 1.2

ego = new Robot on floor, facing toward toy, with cameraOffset (0, 0.2, 0.5), with color (0.2, 0.5, 0.8)
low = new Robot on floor, facing toward toy, with height 0.3, with color (0.4, 0.65, 0.45)
require 1 < (distance from ego to toy) < 2.5
require not (ego can see toy)
require low can see toy
