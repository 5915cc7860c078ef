"""Parts on a conveyor for a gripper: some lie the wrong way up, and one in ten is damaged."""

workspace = Workspace(RectangularRegion((0, 0), 0, 2.4, 0.8))
belt = new Object with width 2.4, with length 0.6, with height 0.1, with regionContainedIn everywhere, with color (0.3, 0.32, 0.35)

class Part:
    shape: MeshShape.fromFile(localPath("../meshes/toy_rocket.obj"))
    height: 0.15
    width: 0.09
    length: 0.08
    damaged: Discrete({False: 9, True: 1})
    color: Discrete({(0.8, 0.8, 0.85): 3, (0.85, 0.6, 0.3): 1})

lane = RectangularRegion((0, 0, 0.13), 0, 2.2, 0.4)
for number in range(6):
    new Part in lane, facing (Range(0, 360) deg, Uniform(0, 90, 180) deg, 0)
ego = belt
