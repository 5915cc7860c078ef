"""Two chairs below a tilted cube in the air.

The blue one is placed in the cube's own frame and so is tilted with it. The green one is then also put on the
floor: its position is dropped straight down, and it stands upright as the floor does.
"""

chair = MeshShape.fromFile(localPath("../meshes/chair.obj"))

floor = new Object with width 4, with length 4, with height 0.1,
    with color (0.8, 0.72, 0.6)

cube = new Object at (Range(-1, 1), Range(-1, 1), 2.6),
    facing (Range(0, 360) deg, Range(10, 25) deg, Range(10, 25) deg),
    with color (0.75, 0.75, 0.78)

blue = new Object below cube,
    with shape chair,
    with color (0.2, 0.4, 0.85)

green = new Object below cube, on floor,
    with shape chair,
    with color (0.25, 0.65, 0.3)
