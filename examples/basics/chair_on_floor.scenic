"""A chair somewhere on a floor, standing on it with all four legs and not over its edge."""

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 5, 5))

floor = new Object with width 5, with length 5, with height 0.1,
    with regionContainedIn everywhere,
    with color (0.8, 0.72, 0.6)

ego = new Object on floor,
    facing Range(0, 360) deg,
    with shape MeshShape.fromFile(localPath("../meshes/chair.obj")),
    with color (0.25, 0.5, 0.75)
