"""Six chairs pushed under a table: bounding boxes always overlap, so the meshes themselves decide."""

workspace = Workspace(RectangularRegion((0, 0, 0), 0, 5, 4))

chair_shape = MeshShape.fromFile(localPath("../examples/meshes/chair.obj"))
table_shape = MeshShape.fromFile(localPath("../examples/meshes/dining_table.obj"))

class Chair:
    shape: chair_shape
    width: Range(0.4, 0.5)

floor = new Object with width 5, with length 4, with height 0.1, at (0, 0, -0.05),
    with regionContainedIn everywhere

table = new Object at (Range(-0.5, 0.5), Range(-0.5, 0.5)), on floor,
    facing Range(-20, 20) deg,
    with shape table_shape, with width Range(1.8, 2.2), with length Range(0.9, 1.2), with height Range(0.72, 0.78)

ego = new Chair left of table by Range(-0.45, -0.1), on floor, facing toward table
new Chair right of table by Range(-0.45, -0.1), on floor, facing toward table
new Chair ahead of table by (Range(-0.7, -0.2), Range(-0.55, -0.1), 0), on floor, facing Range(160, 200) deg
new Chair ahead of table by (Range(0.2, 0.7), Range(-0.55, -0.1), 0), on floor, facing Range(160, 200) deg
new Chair behind table by (Range(-0.7, -0.2), Range(-0.55, -0.1), 0), on floor, facing Range(-20, 20) deg
new Chair behind table by (Range(0.2, 0.7), Range(-0.55, -0.1), 0), on floor, facing Range(-20, 20) deg
