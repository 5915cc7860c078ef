"""Actions for bodies in MuJoCo, beside those of `scenic.simulators.commands`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenic.language.errors import ScenicTypeError
from scenic.language.types import OBJECT
from scenic.runtime.instances.objects import Object
from scenic.runtime.values.describing import wrong_type
from scenic.runtime.values.values import to_vector
from scenic.simulators.actions import Action
from scenic.simulators.commands import Command, model_of
from scenic.simulators.mujoco.articulated import description_of

__all__ = [
    "ApplyForce",
    "Grasp",
    "MoveTo",
    "Release",
    "SetGripper",
    "SetJointPositions",
    "SetJointTorques",
    "SetJointVelocities",
]


class ApplyForce(Command):
    """Push a free body at its centre of mass until the next such action.

    Args:
        force: newtons, global frame.
        torque: newton metres, global frame.

    """

    models = ("point", "free")

    def __init__(self, force: object, torque: object = (0, 0, 0)) -> None:
        self.force = to_vector(force, "ApplyForce")
        self.torque = to_vector(torque, "ApplyForce")

    def commands(self) -> Mapping[str, float]:
        """Return the force and the torque."""
        return dict(zip(("fx", "fy", "fz", "tx", "ty", "tz"), (*self.force, *self.torque), strict=True))

    def __repr__(self) -> str:
        return f"ApplyForce({self.force}, {self.torque})"


class _Grip(Action):
    """An action for grippers."""

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent is a guided body."""
        return model_of(agent) == "guided"


class Grasp(_Grip):
    """Hold an object as it is, until `Release`; nothing is held that is further away than the gripper's ``reach``."""

    def __init__(self, target: object) -> None:
        if not isinstance(target, Object):
            raise wrong_type(OBJECT, target, "Grasp")
        self.target = target

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Close the gripper."""
        simulation.grasp(agent, self.target)

    def __repr__(self) -> str:
        return f"Grasp({self.target!r})"


class Release(_Grip):
    """Let go of what is held."""

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Open the gripper."""
        simulation.release(agent)

    def __repr__(self) -> str:
        return "Release()"


class _JointAction(Action):
    """An action for things with joints.

    Args:
        values: numbers by the names of joints.

    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        if not isinstance(values, Mapping):
            raise ScenicTypeError(
                f"{type(self).__name__} needs numbers by the names of joints, not {values!r}",
                help=f"for example: {type(self).__name__}({{'elbow': 0.5}})",
            )
        self.values = {str(name): float(value) for name, value in values.items()}

    def canBeTakenBy(self, agent: Any) -> bool:
        """Return whether the agent has joints; raises `DescriptionError` for a name that none of them has."""
        if model_of(agent) != "articulated":
            return False
        description = description_of(agent.description)
        for name in self.values:
            description.joint(name)
        return True

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.values})"


class SetJointPositions(_JointAction):
    """Move joints to values (radians or metres) at the agent's ``jointSpeed``."""

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set the targets of the servos."""
        simulation.jointed(agent).aim(self.values)


class SetJointVelocities(_JointAction):
    """Move joints at speeds (radians or metres per second) until the next action on them."""

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Let the targets of the servos move."""
        simulation.jointed(agent).run(self.values)


class SetJointTorques(_JointAction):
    """Let torques (newton metres) or forces (newtons) act on joints until the next action on them."""

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Apply the torques."""
        simulation.jointed(agent).push(self.values)


class SetGripper(Action):
    """Open or close a gripper: move all joints of the agent's ``gripper`` to a share of their range, 0 closed, 1 open."""

    def __init__(self, opening: float) -> None:
        self.opening = min(max(float(opening), 0.0), 1.0)

    def canBeTakenBy(self, agent: Any) -> bool:
        """Return whether the agent has joints that are its gripper."""
        return model_of(agent) == "articulated" and bool(agent.gripper)

    def applyTo(self, agent: Any, simulation: Any) -> None:
        """Set the targets of the gripper's servos."""
        jointed = simulation.jointed(agent)
        joints = [jointed.description.joint(name) for name in agent.gripper]
        jointed.aim({joint.name: joint.low + self.opening * (joint.high - joint.low) for joint in joints})

    def __repr__(self) -> str:
        return f"SetGripper({self.opening:g})"


class MoveTo(Action):
    """Move a frame of the agent to a place, by inverse kinematics.

    Args:
        frame: name of a body or site.
        position: the place, metres.
        down: whether the frame's Z axis is to point downwards.

    """

    def __init__(self, frame: str, position: object, down: bool = False) -> None:
        self.frame = frame
        self.position = to_vector(position, "MoveTo")
        self.down = bool(down)

    def canBeTakenBy(self, agent: Any) -> bool:
        """Return whether the agent has joints; raises `DescriptionError` if it has no such frame."""
        if model_of(agent) != "articulated":
            return False
        description_of(agent.description).frame(self.frame)
        return True

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set the targets of the servos to the nearest solution."""
        jointed = simulation.jointed(agent)
        place = np.array([float(part) for part in self.position])
        down = np.array([0.0, 0.0, -1.0]) if self.down else None
        jointed.aim(jointed.solve(self.frame, place, down)[0])

    def __repr__(self) -> str:
        return f"MoveTo({self.frame!r}, {self.position})"
