"""A robot with a stereo pair and a depth camera: `scenic sample --camera left -o images` makes labelled images."""

from scenic import DepthSensor, RGBSensor, SSSensor

workspace = Workspace(RectangularRegion((0, 0), 0, 6, 6))
floor = new Object at (0, 0, -0.051), with width 6, with length 6, with height 0.1, with regionContainedIn everywhere,
    with color (0.75, 0.65, 0.5)

class Chair:
    shape: MeshShape.fromFile(localPath("../meshes/chair.obj"))
    color: Uniform((0.7, 0.45, 0.28), (0.3, 0.4, 0.55))

class Plant:
    shape: MeshShape.fromFile(localPath("../meshes/plant.obj"))
    color: (0.25, 0.5, 0.28)

def eye(x):
    return {"offset": (x, 0.2, 0.4), "rotation": (0, -15 deg, 0), "width": 320, "height": 240, "attributes": {"fov": 80}}

ego = new Object at (0, -2.4), on floor, facing Range(-10, 10) deg, with width 0.4, with length 0.4, with height 1,
    with color (0.2, 0.5, 0.8),
    with sensors {"left": RGBSensor(**eye(-0.06)), "right": RGBSensor(**eye(0.06)), "depth": DepthSensor(**eye(0)), "classes": SSSensor(**eye(0))}
target = new Chair in RectangularRegion((0, 0.5), 0, 3, 3), on floor, facing Range(0, 360) deg
new Plant on floor
new Plant on floor
require ego can see target
