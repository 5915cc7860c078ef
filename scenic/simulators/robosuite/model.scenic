"""World model of robosuite: tables, things and arms. Sampling does not need the package."""

from scenic.simulators.robosuite import *
from scenic.simulators.robosuite.actions import hand_step
from scenic.simulators.robosuite.custom import check_mjcf, shape_of_mjcf

param use_environment = None
param camera_view = None
param render = False
param real_time = False
param timestep = 0.05

simulator RobosuiteSimulator(
    use_environment=globalParameters.use_environment,
    camera_view=globalParameters.camera_view,
    render=bool(globalParameters.render),
    real_time=bool(globalParameters.real_time),
    timestep=float(globalParameters.timestep),
)

class RoboSuiteObject:
    """A thing with the contact properties of MuJoCo: kilograms per cubic metre, friction, `solref`, `solimp`."""
    dynamics: 'free'
    density: 1000
    friction: (1, 0.005, 0.0001)
    solref: (0.02, 1)
    solimp: (0.9, 0.95, 0.001)
    robosuite_class: None
    mjcf: None

class CustomObject(RoboSuiteObject):
    """A thing that `mjcf` describes: text of MJCF, or the path of a file."""
    shape: shape_of_mjcf(self.mjcf)

    def _assembled(self):
        check_mjcf(self.mjcf)

class Box(RoboSuiteObject):
    """A box."""
    width: 0.05
    length: 0.05
    height: 0.05

class Cube(Box):
    """A cube of 4 cm."""
    width: 0.04
    length: 0.04
    height: 0.04

class Ball(RoboSuiteObject):
    """A ball."""
    shape: SpheroidShape((0.05, 0.05, 0.05))

class Cylinder(RoboSuiteObject):
    """An upright cylinder."""
    shape: CylinderShape((0.05, 0.05, 0.1))

class Capsule(RoboSuiteObject):
    """An upright cylinder with round ends, which here is the cylinder around it."""
    shape: CylinderShape((0.05, 0.05, 0.12))
    capsule: True

class Bottle(RoboSuiteObject):
    robosuite_class: 'BottleObject'
    width: 0.056
    length: 0.059
    height: 0.16

class Can(RoboSuiteObject):
    robosuite_class: 'CanObject'
    width: 0.05
    length: 0.05
    height: 0.08

class Milk(RoboSuiteObject):
    robosuite_class: 'MilkObject'
    width: 0.04
    length: 0.04
    height: 0.144

class Cereal(RoboSuiteObject):
    robosuite_class: 'CerealObject'
    width: 0.1
    length: 0.03
    height: 0.15

class Bread(RoboSuiteObject):
    robosuite_class: 'BreadObject'
    width: 0.048
    length: 0.04
    height: 0.048

class Lemon(RoboSuiteObject):
    robosuite_class: 'LemonObject'
    width: 0.068
    length: 0.04
    height: 0.04

class Hammer(RoboSuiteObject):
    robosuite_class: 'HammerObject'
    width: 0.115
    length: 0.037
    height: 0.251

class Table:
    """The top of a table of an arena of robosuite, at the height of 0.8 m."""
    dynamics: 'static'
    arena: 'table'
    has_legs: True
    friction: (1, 0.005, 0.0001)
    width: 0.8
    length: 0.8
    height: 0.05
    position: (0, 0, 0.775)

class TableArena(Table):
    """The same."""

class PegsArena(Table):
    """A table with two pegs, which are not part of its shape here."""
    arena: 'pegs'
    width: 0.45
    length: 0.69

class BinsArena(Table):
    """Two bins, here the box below them."""
    arena: 'bins'
    width: 0.39
    length: 0.98
    position: (0.1, 0, 0.775)

class Robot:
    """An arm on its base, which here is the box of the base; it stands before a table of the usual size and faces it."""
    dynamics: 'static'
    robot_type: 'Panda'
    gripper_type: 'default'
    base_type: 'default'
    controller_config: None
    initial_qpos: None
    joint_positions[dynamic]: ()
    gripper_positions[dynamic]: ()
    hand_position[dynamic]: 0 @ 0
    width: 0.3
    length: 0.3
    height: 0.9
    position: (-0.56, 0, self.height / 2)
    yaw: -90 deg

class Panda(Robot):
    robot_type: 'Panda'

class Sawyer(Robot):
    robot_type: 'Sawyer'

class UR5e(Robot):
    robot_type: 'UR5e'

class Jaco(Robot):
    robot_type: 'Jaco'

class IIWA(Robot):
    robot_type: 'IIWA'

class Kinova3(Robot):
    robot_type: 'Kinova3'

class Baxter(Robot):
    robot_type: 'Baxter'
    position: (-0.66, 0, self.height / 2)

class PandaRobot(Panda):
    """The same as `Panda`."""

class SawyerRobot(Sawyer):
    """The same as `Sawyer`."""

behavior MoveHandTo(place, gripper=None, tolerance=0.01, patience=100):
    """Move the hand to a place with an operational space controller; ends when it is there, or after `patience` steps."""
    steps = 0
    while (distance from self.hand_position to place) > tolerance and steps < patience:
        away = hand_step(self, place)
        take OSCPositionAction(away, gripper=gripper)
        steps += 1

behavior MoveGripper(closing, steps=15):
    """Close (1) or open (-1) the gripper."""
    for _ in range(steps):
        take OSCPositionAction(gripper=closing)

behavior PickAndLift(thing, height=0.15):
    """Take a thing from above and lift it."""
    do MoveHandTo(thing.position + (0, 0, 0.1), -1, 0.015)
    do MoveHandTo(thing.position, -1)
    do MoveGripper(1)
    do MoveHandTo(thing.position + (0, 0, height), 1, 0.015)
