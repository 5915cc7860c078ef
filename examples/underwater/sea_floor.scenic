"""A diving robot above a sea floor with rocks and weed; the floor is a mesh."""

class SeaFloor:
    shape: MeshShape.fromFile(localPath("../meshes/sea_floor.obj"))
    color: (0.62, 0.58, 0.42)
    regionContainedIn: everywhere

class Rock:
    shape: SpheroidShape()
    width: Range(0.8, 2.5)
    length: Range(0.8, 2.5)
    height: Range(0.6, 1.2)
    color: (0.42, 0.43, 0.42)
    regionContainedIn: everywhere

class Weed:
    shape: ConeShape()
    width: 0.3
    length: 0.3
    height: Range(1, 3)
    color: (0.2, Range(0.4, 0.6), 0.3)
    regionContainedIn: everywhere
    allowCollisions: True

workspace = Workspace(BoxRegion(position=(0, 0, 6), dimensions=(30, 30, 16)))
ground = new SeaFloor at (0, 0, 0)
for number in range(10):
    new Rock on ground
for number in range(25):
    new Weed on ground.topSurface, with parentOrientation 0, facing 0 deg
ego = new Object in BoxRegion(position=(0, 0, 7), dimensions=(20, 20, 4)), facing (Range(0, 360) deg, Range(-20, 0) deg, 0),
    with shape CylinderShape(initial_rotation=(0, 90 deg, 0)), with width 0.8, with length 2.5, with height 0.8, with color (0.95, 0.75, 0.15)
