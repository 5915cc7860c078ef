"""A small arm takes a thing from a table with random clutter and puts it into an open drawer."""

model scenic.simulators.mujoco.model

table = new Fixture at (0, 0, 0.35), with width 1.4, with length 1.2, with height 0.7, with color (0.8, 0.78, 0.74)

class Thing(Body):
    width: 0.04
    length: 0.04
    height: Range(0.03, 0.06)
    density: 400
    friction: 1.5

# What is to be taken stands upright; the clutter lies as things that were thrown do.
cup = new Thing at (Range(-0.3, 0.3), Range(-0.05, 0.25)), on table, with shape BoxShape(),
    facing Range(0, 360) deg, with color (0.85, 0.2, 0.15)
shapes = (CylinderShape((0.04, 0.04, 0.07)), BoxShape((0.03, 0.06, 0.04)), ConeShape((0.05, 0.05, 0.06)))
clutter = [new Body at (Range(-0.5, 0.5), Range(-0.1, 0.45)), resting on table, with shape Uniform(*shapes)
           for i in range(6)]

cabinet = new Articulated at (0.46, -0.1), on table, with description "drawer.xml", facing Range(-100, -80) deg,
    with joints {'drawer': Range(0.12, 0.18)}, with servos False, with weightless False
goal = cabinet.frame('inside')

arm = new Articulated at (0, -0.35), on table, with description "arm.xml", with gripper ('left', 'right'),
    with joints {'turn': Range(-20, 20) deg, 'lift': -20 deg, 'elbow': -60 deg, 'bend': -80 deg},
    with behavior PickAndPlace(cup, goal.position, 'grip')
ego = arm

# For images: `scenic sample tidy.scenic -n 100 --camera front --camera above --image-size 640x480 -o images`.
class Eye(Fixture):
    width: 0.04
    length: 0.04
    height: 0.04
    render: False
    collides: False

front = new Eye at (0.9, 1.1, 1.5), facing directly toward table
above = new Eye at (0, 0.1, 2.2), facing directly toward table

require arm.reaches(cup, 'grip', down=True)
require arm.reaches(goal, 'grip', down=True)
# Fingers need room.
require all((distance from cup to other) > 0.1 for other in clutter)

record (distance from cup to goal) as gap
record final (distance from cup to goal) < 0.1 as tidy
terminate after 40 seconds
