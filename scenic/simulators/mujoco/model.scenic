"""World model of the MuJoCo simulator: kinds of bodies, and the actions that they take."""

from scenic.simulators.mujoco import *
from scenic.simulators.mujoco.articulated import assemble, base_shape, frame_of, link_of
from scenic.simulators.mujoco.reaching import reaches

simulator MujocoSimulator()

class Body:
    """A rigid body; kilograms if `mass` is given, else kilograms per cubic metre."""
    dynamics: 'free'
    mass: None
    density: 1000
    friction: 1
    collides: True

class Fixture:
    """A part of the world that cannot be moved: floors, walls, tables."""
    dynamics: 'static'
    friction: 1
    collides: True

class Link(Body):
    """A part of an `Articulated`, which makes it."""
    dynamics: 'link'
    linkName: None
    base: None

class Articulated(Body):
    """A thing with joints, as an MJCF or URDF file describes it: its base, which stands still, and its links.

    `joints` are values by name, radians or metres, which may be random; the others are as in the file. Servos move joints at
    `jointSpeed` (radians per second, a fifth of it in metres per second). `gripper` are the names of the joints that open a gripper.
    """
    dynamics: 'articulated'
    description: None
    joints: {}
    jointValues[dynamic]: {}
    jointVelocities[dynamic]: {}
    jointTorques[dynamic]: {}
    """Torques (newton metres) or forces (newtons) of the drives of joints."""
    gripperContacts[dynamic]: ()
    """The objects that links touch which the joints of the gripper move."""
    jointSpeed: 1.5
    gripper: ()
    links: {}
    shape: base_shape(self.description)

    def _assembled(self):
        if self.dynamics == 'articulated':
            assemble(self, Link)

    def link(self, name):
        """The object that is a link."""
        return link_of(self, name)

    def frame(self, name):
        """The frame of a body or site, which follows from the joints, as an oriented point."""
        return frame_of(self, name)

    def reaches(self, target, frame, down=False, tolerance=0.01, avoiding=()):
        """Whether the frame can be at an object or place without the links touching each other or objects to avoid."""
        return reaches(self, target, frame, down, tolerance, avoiding)

class Robot(Articulated):
    """A robot that an MJCF or URDF file describes, as an `Articulated`; without `description` it drives on two wheels.

    `SetWheelSpeeds` sets the speeds of these.
    """
    dynamics: 'differential' if self.description is None else 'articulated'
    shape: BoxShape() if self.description is None else base_shape(self.description)
    width: 0.35 if self.description is None else self.shape.width
    length: 0.35 if self.description is None else self.shape.length
    height: 0.12 if self.description is None else self.shape.height
    wheelRadius: 0.04
    density: 300 if self.description is None else 1000
    touches[dynamic]: ()
    """Places in its own frame where others have touched its sides during the last step."""

class Car(Body):
    """Drives on four wheels, of which the front ones are steered: `SetThrottle` and `SetSteering`."""
    dynamics: 'bicycle'
    width: 1.8
    length: 4.3
    height: 1.5
    mass: 1200
    wheelRadius: 0.33

class Gripper(Body):
    """A hand that moves as `SetVelocity` says, and holds what it touches from `Grasp` to `Release`."""
    dynamics: 'guided'
    width: 0.08
    length: 0.08
    height: 0.1
    reach: 0.02
    holding[dynamic]: False

class Quadrotor(Body):
    """Flies as `Fly` says."""
    dynamics: 'quadrotor'
    width: 0.4
    length: 0.4
    height: 0.1
    mass: 1

behavior Reach(frame, place, down=False, tolerance=0.01, patience=10):
    """Move a frame of the agent to a place; ends when it is there, or after `patience` seconds."""
    begun = simulation().currentTime
    steps = patience / simulation().timestep
    take MoveTo(frame, place, down)
    while (distance from self.frame(frame) to place) > tolerance and simulation().currentTime - begun < steps:
        wait

behavior OpenGripper(opening=1, seconds=0.5):
    """Open the gripper, 0 closed, 1 open."""
    take SetGripper(opening)
    do Stay() for seconds seconds

behavior Stay():
    """Keep the joints where they are."""
    while True:
        wait

behavior PickAndPlace(thing, place, frame, above=0.12):
    """Take a thing from above and put it at a place: open, reach, close, lift, carry, open."""
    up = (0, 0, above)
    do OpenGripper(1)
    do Reach(frame, thing.position + up, True, 0.02)
    do Reach(frame, thing.position, True, 0.008, 4)
    do OpenGripper(0)
    do Reach(frame, self.frame(frame).position + up, True, 0.02)
    do Reach(frame, place + up, True, 0.02)
    do Reach(frame, place, True, 0.015, 4)
    do OpenGripper(1)
    do Reach(frame, self.frame(frame).position + up, True, 0.02)
