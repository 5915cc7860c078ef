"""Towers of blocks that do not fall: each block has its centre over the one below."""

workspace = Workspace(RectangularRegion((0, 0), 0, 1.2, 1.2))

class Block:
    size: Range(0.06, 0.1)
    width: self.size
    length: self.size
    height: self.size
    color: Uniform((0.85, 0.3, 0.25), (0.25, 0.5, 0.8), (0.95, 0.8, 0.3), (0.35, 0.65, 0.4))

table = new Object with width 1.2, with length 1.2, with height 0.05, with regionContainedIn everywhere,
    with color (0.72, 0.58, 0.42)

def tower(height):
    """Blocks on the table, one over the other; the lowest one."""
    base = new Block on table, facing Range(0, 360) deg
    below = base
    for number in range(height - 1):
        below = new Block above below by (Range(-0.02, 0.02), Range(-0.02, 0.02), 0.0001), with yaw Range(-20, 20) deg
    return base

ego = tower(4)
tower(3)
tower(2)
