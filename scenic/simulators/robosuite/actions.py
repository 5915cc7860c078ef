"""Actions of robots in robosuite: inputs of their controllers for one step."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from scenic.language.errors import ScenicTypeError
from scenic.runtime.values.values import to_vector
from scenic.simulators.actions import Action

__all__ = ["JointPositionAction", "OSCPositionAction", "RobotAction", "hand_step"]

_STEP: Final = 0.05
"""The largest step of the hand, metres."""


class RobotAction(Action):
    """Inputs of the controllers of a robot's parts for one step.

    Args:
        parts: numbers from -1 to 1 by part, such as ``{'right': (0, 0, 1, 0, 0, 0), 'right_gripper': (1,)}``.

    """

    def __init__(self, parts: Mapping[str, Sequence[float]]) -> None:
        if not isinstance(parts, Mapping):
            raise ScenicTypeError(
                f"RobotAction needs the inputs of controllers by the parts of the robot, not {parts!r}",
                help="for example: RobotAction({'right': (0, 0, 1, 0, 0, 0), 'right_gripper': (1,)})",
            )
        self.parts = {str(part): tuple(map(float, values)) for part, values in parts.items()}

    def canBeTakenBy(self, agent: object) -> bool:
        """Return whether the agent is a robot."""
        return getattr(agent, "robot_type", None) is not None

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Set the inputs of the controllers."""
        simulation.control(agent, self.parts)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.parts})"


def hand_step(robot: Any, place: object) -> tuple[float, float, float]:
    """Return the input of `OSCPositionAction` that moves a robot's hand towards a place."""
    away = to_vector(place, "hand_step") - robot.hand_position
    # The base looks along +Y here, and along +X in robosuite.
    x, y, z = away.rotatedBy(robot.orientation.inverse)
    return tuple(min(max(float(part) / _STEP, -1.0), 1.0) for part in (y, -x, z))  # type: ignore[return-value] # three


class OSCPositionAction(RobotAction):
    """Move the hand with an operational space controller, the default of all robots.

    Args:
        position: step of the hand along each axis of the base, in parts of the controller's largest step (5 cm), from -1 to 1.
        orientation: turn of the hand about each axis, in parts of the largest turn (0.5 radians).
        gripper: -1 opens, 1 closes; as before if ``None``.
        arm: ``'right'`` or ``'left'``.

    """

    def __init__(
        self,
        position: Sequence[float] = (0, 0, 0),
        orientation: Sequence[float] = (0, 0, 0),
        gripper: float | None = None,
        arm: str = "right",
    ) -> None:
        fingers = {} if gripper is None else {f"{arm}_gripper": (gripper,)}
        super().__init__({arm: (*position, *orientation), **fingers})


class JointPositionAction(RobotAction):
    """Move joints, with the controller ``'JOINT_POSITION'``.

    Args:
        positions: step of each joint of the arm, in parts of the controller's largest step (0.05 radians), from -1 to 1.
        gripper: -1 opens, 1 closes; as before if ``None``.
        arm: ``'right'`` or ``'left'``.

    """

    def __init__(self, positions: Sequence[float], gripper: float | None = None, arm: str = "right") -> None:
        fingers = {} if gripper is None else {f"{arm}_gripper": (gripper,)}
        super().__init__({arm: tuple(positions), **fingers})
