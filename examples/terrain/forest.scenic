"""A clearing in a forest on a slope: trees stand upright, whatever the ground does, and leave the clearing free."""

class Slope:
    shape: MeshShape.fromFile(localPath("../meshes/hillside.obj"))
    color: (0.42, 0.5, 0.3)
    regionContainedIn: everywhere

class Tree:
    shape: ConeShape()
    width: Range(2, 3.5)
    length: self.width
    height: Range(4, 8)
    baseOffset: (0, 0, 0.4 - self.height / 2)
    allowCollisions: True
    color: (0.15, Range(0.32, 0.48), 0.2)
    regionContainedIn: everywhere

clearing = CircularRegion((0, 0, 20), 8)
woods = RectangularRegion((0, 0, 20), 0, 38, 38).difference(clearing)
workspace = Workspace(BoxRegion(position=(0, 0, 8), dimensions=(40, 40, 30)))
ground = new Slope at (0, 0, 0)
for number in range(30):
    new Tree in woods, on ground.topSurface, with parentOrientation 0, facing 0 deg, with onDirection (0, 0, 1)
ego = new Object in clearing, on ground, with onDirection (0, 0, 1), with width 2, with length 2, with height 1.5, with color (0.9, 0.5, 0.2)
