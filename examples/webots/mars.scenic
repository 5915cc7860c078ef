"""A rover has to reach a goal on hilly ground, past rocks and pipes; its world is written for Webots.

scenic sample examples/webots/mars.scenic --seed 1 -o mars.wbt
"""

model scenic.simulators.webots.model

ground = new Ground with color (0.75, 0.42, 0.27), with terrain (
    new Hill at (-1.5, 1, 0), with width 3, with length 3, with height 0.25,
    new Hill at (2, -1.5, 0), with width 2.5, with length 3, with height 0.15,
)
workspace = Workspace(BoxRegion(dimensions=(10, 10, 3)))
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
