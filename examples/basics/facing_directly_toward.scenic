"""A plane aimed at a ball in the air: `facing directly toward` sets yaw and pitch, so the nose points at it."""

ball = new Object at (Range(-12, 12), Range(12, 20), Range(8, 14)),
    with shape SpheroidShape(),
    with width 3, with length 3, with height 3,
    with color (0.85, 0.25, 0.2)

ego = new Object at (0, 0, 2),
    facing directly toward ball,
    with shape MeshShape.fromFile(localPath("../meshes/plane.obj")),
    with color (0.75, 0.8, 0.88)
