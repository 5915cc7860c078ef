# Points in, on and over meshes.
import trimesh
stone = MeshVolumeRegion(trimesh.creation.icosphere(2), dimensions=(8, 6, 4), position=(0, 0, 2))
ego = new Object on stone.getSurfaceRegion(), with width 0.3, with length 0.3, with height 0.3
bird = new Object at (Range(-3, 3), Range(-2, 2), Range(8, 10)), with width 0.5
gem = new Object in stone, with width 0.2, with length 0.2, with height 0.2, with regionContainedIn stone, with allowCollisions True
