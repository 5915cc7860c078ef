# Four large meshes on a plane; `folder` holds them.
param folder = None
shape = MeshShape.fromFile(f"{globalParameters.folder}/chair.obj.bz2", unify=False)
plane = RectangularRegion((0, 0, 0), 0, 20, 20)
for _ in range(4):
    new Object in plane, facing Range(0, 360) deg, with shape shape, with width 3, with length 3, with height 4
