"""A rover among boulders on a Mars-like plain; its target is in sight, and not beyond a steep climb."""

class Plain:
    shape: MeshShape.fromFile(localPath("../meshes/crater.obj"))
    color: (0.72, 0.42, 0.26)
    regionContainedIn: everywhere

class Boulder:
    shape: SpheroidShape()
    width: Range(0.5, 3)
    length: self.width * Range(0.8, 1.3)
    height: self.width * Range(0.5, 0.9)
    color: (Range(0.45, 0.6), 0.32, 0.22)
    regionContainedIn: everywhere

workspace = Workspace(BoxRegion(position=(0, 0, 10), dimensions=(60, 60, 30)))
plain = new Plain at (0, 0, 0)
for number in range(12):
    new Boulder on plain
ego = new Object on plain, with width 2, with length 2.6, with height 1.6, with viewAngles (120 deg, 80 deg), with color (0.85, 0.85, 0.88)
goal = new Object on plain, with width 0.6, with length 0.6, with height 1, with color (0.3, 0.5, 0.8)
require 10 < (distance from ego to goal) < 30
require abs(altitude from ego to goal) < 10 deg
