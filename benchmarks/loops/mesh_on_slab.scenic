# A chair on a slab; `folder` holds its mesh.
param folder = None
slab = new Object with width 10, with length 10, with height 0.2
chair = new Object on slab, facing Range(0, 360) deg, with shape MeshShape.fromFile(f"{globalParameters.folder}/dining_chair.obj.bz2", unify=False), with width 0.5, with length 0.5, with height 1
