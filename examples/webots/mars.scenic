"""A rover has to reach a goal on hilly ground, past rocks and pipes; its world is written for Webots.

scenic sample examples/webots/mars.scenic --seed 1 -o mars.wbt
"""

model scenic.simulators.webots.model

workspace = Workspace(BoxRegion(dimensions=(10, 10, 3)))

class Rise(Hill):
    """A low hill anywhere on the ground."""
    position: new Point in RectangularRegion((0, 0, 0), 0, 8, 8)
    width: Range(1.5, 3)
    length: Range(1.5, 3)
    height: Range(0.05, 0.25)

hills = [new Rise for _ in range(8)]
ground = new Ground with color (0.75, 0.42, 0.27), with terrain hills
surface = ground.topSurface

class Rover(WebotsObject):
    """Its nodes in the world are called ROVER, ROVER_0 and so on; its front there is its x axis."""
    webotsType: 'ROVER'
    width: 0.5
    length: 0.7
    height: 0.4
    rotationOffset: (90 deg, 0, 0)
    color: (0.85, 0.85, 0.9)

class Goal(WebotsObject):
    webotsType: 'GOAL'
    width: 0.1
    length: 0.1
    height: 0.3
    color: (0.9, 0.7, 0.1)

class Rock(WebotsObject):
    webotsType: 'ROCK'
    shape: SpheroidShape()
    width: Range(0.15, 0.4)
    length: self.width
    height: 0.7 * self.width
    density: 1500
    color: (0.6, 0.35, 0.25)

class Pipe(WebotsObject):
    webotsType: 'PIPE'
    width: 0.2
    length: Range(0.6, 1.5)
    height: 0.2
    density: 300
    color: (0.5, 0.5, 0.55)

ego = new Rover on surface, at (0, -3.5, 0)
goal = new Goal on surface, at (Range(-2, 2), Range(3, 4), 0)

# A gate on the way, which the rover fits through
gate = new OrientedPoint at (Range(-1, 1), 0, 0), facing Range(-20, 20) deg
new Pipe left of gate by 0.45, on surface
new Pipe right of gate by 0.45, on surface

for _ in range(4):
    new Rock on surface

require (distance from ego to goal) > 5
