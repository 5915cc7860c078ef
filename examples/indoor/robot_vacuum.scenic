"""A robot vacuum cleans a room, and turns where it meets furniture or a toy that it pushes (in MuJoCo)."""

from math import atan2
model scenic.simulators.mujoco.model

width, length = 4, 3
room = RectangularRegion((0, 0, 0), 0, width, length)
workspace = Workspace(BoxRegion(position=(0, 0, 0.5), dimensions=(width + 0.3, length + 0.3, 1.2)))

class Wall(Fixture):
    height: 0.3
    color: (0.8, 0.78, 0.74)

class Furniture(Fixture):
    color: (0.62, 0.46, 0.33)
    regionContainedIn: everywhere

class Vacuum(Robot):
    shape: CylinderShape()
    height: 0.1
    color: (0.2, 0.22, 0.26)

for side in (-1, 1):
    new Wall at (side * (width / 2 + 0.05), 0, 0.15), with width 0.1, with length length - 0.01
    new Wall at (0, side * (length / 2 + 0.05), 0.15), with width width + 0.2, with length 0.1

sofa = new Furniture at (Range(-1, 1), length / 2 - 0.42, 0.3), with width 1.6, with length 0.8, with height 0.6, with color (0.35, 0.42, 0.55)
box = new Furniture on room, facing Range(0, 90) deg, with width 0.5, with length 0.4, with height 0.4
ball = new Body on room, with shape SpheroidShape(), with width 0.16, with length 0.16, with height 0.16, with density 60,
    with color (0.85, 0.35, 0.25)

behavior Turn(angle):
    """On the spot, by so much to the left."""
    goal = self.yaw + angle
    off = angle
    while abs(off) > 0.05:
        pace = max(-0.25, min(0.25, 0.5 * off))
        take SetWheelSpeeds(-pace, pace)
        off = atan2(sin(goal - self.yaw), cos(goal - self.yaw))

behavior Ahead(speed):
    """Until it is stopped."""
    take SetWheelSpeeds(speed, speed)
    wait for 10 steps
    while self.speed > 0.6 * speed:
        wait

behavior Clean(speed):
    while True:
        do Ahead(speed)
        take SetWheelSpeeds(-0.2, -0.2)
        wait for 10 steps
        do Turn(Uniform(-1, 1) * Range(60, 150) deg) for 8 seconds

ego = new Vacuum on room, facing Range(0, 360) deg, with behavior Clean(0.6)

require always (ego.position in room) as inside
require always ego.position.z < 0.08 as 'on the floor'
require eventually (distance from ego to (-1.2, -0.8, 0.06)) < 0.6 as 'reaches the corner'
terminate after 40 seconds
