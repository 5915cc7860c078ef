"""Trees, rocks and a car on hills: a mesh made here, on whose upper side things stand."""

import numpy as np
import trimesh

SIDE = 60
x, y = np.meshgrid(np.linspace(-1, 1, SIDE), np.linspace(-1, 1, SIDE), indexing="ij")
height = 0.5 * np.sin(2.6 * x + 0.4) * np.cos(2.2 * y) + 0.12 * np.sin(7 * x + 3 * y) + 0.08 * np.cos(5 * y - 4 * x) + 1.2

def solid(height):
    """The solid between a square of heights and the plane below it."""
    above = np.column_stack([x.ravel(), y.ravel(), height.ravel()])
    below = above * [1, 1, 0]
    corner = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]))
    top = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    rim = np.concatenate([corner[:-1, 0], corner[-1, :-1], corner[:0:-1, -1], corner[0, :0:-1]])
    next_ = np.roll(rim, -1)
    under = SIDE * SIDE
    sides = np.concatenate([np.column_stack([rim, rim + under, next_]), np.column_stack([next_, rim + under, next_ + under])])
    return trimesh.Trimesh(np.concatenate([above, below]), np.concatenate([top, top[:, ::-1] + under, sides]), process=False)

class Hills:
    shape: MeshShape(solid(height))
    width: 60
    length: 60
    height: 12
    color: (0.45, 0.6, 0.35)
    regionContainedIn: everywhere

class Trunk:
    shape: CylinderShape()
    width: 0.5
    length: 0.5
    height: 2.5
    color: (0.42, 0.3, 0.2)
    allowCollisions: True
    regionContainedIn: everywhere

class Crown:
    shape: ConeShape()
    width: Range(2.5, 4)
    length: self.width
    height: Range(4, 7)
    color: (0.13, Range(0.32, 0.45), 0.2)
    regionContainedIn: everywhere
    allowCollisions: True

class Rock:
    shape: SpheroidShape()
    width: Range(1, 3)
    length: Range(1, 3)
    height: Range(0.8, 1.6)
    color: (0.55, 0.54, 0.52)
    regionContainedIn: everywhere

hills = new Hills at (0, 0, 6)
for _ in range(26):
    trunk = new Trunk on hills.topSurface, with parentOrientation 0, facing 0 deg
    new Crown above trunk by -0.4
for _ in range(12):
    new Rock on hills
ego = new Object on hills, with width 2.2, with length 4, with height 1.6, with color (0.8, 0.25, 0.15)
