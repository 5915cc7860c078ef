"""Actions for bodies in MuJoCo, beside those of `scenic.simulators.commands`."""

from collections.abc import Mapping
from typing import Any

from scenic.language.types import OBJECT
from scenic.runtime.instances.objects import Object
from scenic.runtime.values.describing import wrong_type
from scenic.runtime.values.values import to_vector
from scenic.simulators.actions import Action
from scenic.simulators.commands import Command, model_of

__all__ = ["ApplyForce", "Grasp", "Release"]


class ApplyForce(Command):
    """Push a free body at its centre of mass until the next such action.

    Args:
        force: newtons, global frame.
        torque: newton metres, global frame.

    """

    models = ("point", "free")

    def __init__(self, force: Any, torque: Any = (0, 0, 0)) -> None:
        self.force = to_vector(force, "ApplyForce")
        self.torque = to_vector(torque, "ApplyForce")

    def commands(self) -> Mapping[str, float]:
        """The force and the torque."""
        return dict(zip(("fx", "fy", "fz", "tx", "ty", "tz"), (*self.force, *self.torque), strict=True))

    def __repr__(self) -> str:
        return f"ApplyForce({self.force}, {self.torque})"


class _Grip(Action):
    """An action for grippers."""

    def canBeTakenBy(self, agent: Any) -> bool:
        """Return whether the agent is a guided body."""
        return model_of(agent) == "guided"


class Grasp(_Grip):
    """Hold an object as it is, until `Release`; nothing is held that is further away than the gripper's ``reach``."""

    def __init__(self, target: Any) -> None:
        if not isinstance(target, Object):
            raise wrong_type(OBJECT, target, "Grasp")
        self.target = target

    def applyTo(self, agent: Any, simulation: Any) -> None:
        """Close the gripper."""
        simulation.grasp(agent, self.target)

    def __repr__(self) -> str:
        return f"Grasp({self.target!r})"


class Release(_Grip):
    """Let go of what is held."""

    def applyTo(self, agent: Any, simulation: Any) -> None:
        """Open the gripper."""
        simulation.release(agent)

    def __repr__(self) -> str:
        return "Release()"
