"""A gripper puts blocks from a table into a tray (in MuJoCo)."""

model scenic.simulators.mujoco.model

simulator MujocoSimulator(timestep=0.05)

workspace = Workspace(BoxRegion(position=(0, 0, 1), dimensions=(3, 3, 2)))

class Block(Body):
    width: 0.06
    length: 0.06
    height: 0.06
    density: 400
    requireVisible: False

table = new Fixture at (0, 0, 0.2), with width 1.2, with length 0.8, with height 0.4, with color (0.72, 0.56, 0.4)

# A tray is a plate with four rims.
plate = new Fixture at (0.4, 0, 0.406), with width 0.3, with length 0.4, with height 0.01, with color (0.3, 0.35, 0.4)
tray = RectangularRegion((0.4, 0, 0.411), 0, 0.3, 0.4)
for side in (-1, 1):
    new Fixture at (0.4 + side * 0.156, 0, 0.42), with width 0.01, with length 0.4, with height 0.038, with color (0.3, 0.35, 0.4)
    new Fixture at (0.4, side * 0.206, 0.42), with width 0.3, with length 0.01, with height 0.038, with color (0.3, 0.35, 0.4)

free = RectangularRegion((-0.22, 0, 0.4), 0, 0.6, 0.6)
first = new Block on free, facing Range(0, 90) deg, with color (0.8, 0.25, 0.25)
second = new Block on free, facing Range(0, 90) deg, with color (0.25, 0.6, 0.35)
third = new Block on free, facing Range(0, 90) deg, with color (0.25, 0.4, 0.8)
blocks = [first, second, third]

def reached(hand, place):
    return (distance from hand to place) < 0.006

behavior Move(place, speed=0.5):
    """Go there in a straight line, slower near the end."""
    while not reached(self, place):
        way = place - self.position
        far = way.norm()
        take SetVelocity(way * (min(speed, 3 * far) / far))
    take SetVelocity((0, 0, 0))

behavior Fetch(block, place):
    over = Vector(block.position.x, block.position.y, 0.6)
    do Move(over)
    do Move(Vector(over.x, over.y, block.position.z + 0.085), 0.25)
    take Grasp(block)
    do Move(over, 0.25)
    do Move(place + Vector(0, 0, 0.25))
    do Move(place + Vector(0, 0, 0.13), 0.25)
    take Release()
    do Move(place + Vector(0, 0, 0.25))

behavior Sort():
    for number, block in enumerate(blocks):
        do Fetch(block, Vector(0.4, -0.11 + 0.11 * number, 0.411))
    terminate

ego = new Gripper at (-0.2, 0, 0.8), with behavior Sort, with color (0.85, 0.85, 0.88)

require eventually (first in tray) and (second in tray) and (third in tray) as sorted
require always (first.position.z > 0.42) and (second.position.z > 0.42) and (third.position.z > 0.42) as 'none falls down'
require eventually ego.holding as grasped
record ego.holding as holding
