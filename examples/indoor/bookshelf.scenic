"""Books on the boards of a shelf: `on` a mesh means all of its faces that look up."""

workspace = Workspace(RectangularRegion((0, 0), 0, 2, 2))

class Book:
    width: Range(0.02, 0.05)
    length: Range(0.12, 0.2)
    height: Range(0.15, 0.24)
    color: Uniform((0.6, 0.2, 0.2), (0.2, 0.3, 0.55), (0.25, 0.45, 0.3), (0.8, 0.7, 0.4))

floor = new Object with width 2, with length 2, with height 0.1, with regionContainedIn everywhere
shelf = new Object on floor, with shape MeshShape.fromFile(localPath("../meshes/shelf.obj")),
    with color (0.72, 0.56, 0.4)
ego = shelf
for number in range(10):
    new Book on shelf
