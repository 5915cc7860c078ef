"""Arguments of behaviors that cannot be used: errors that are marked at the argument, and speeds that are no speeds."""

from typing import Any

from scenic.language.errors import InvalidScenarioError, ScenicTypeError
from scenic.runtime.values.describing import wrong_type

__all__ = ["impossible_argument", "speed_to_reach", "wrong_argument"]


def wrong_argument(parameter: str, wanted: str, value: object, what: str = "") -> ScenicTypeError:
    """Return the error for an argument of a wrong type.

    Args:
        parameter: of the behavior.
        wanted: a noun.
        value: the argument.
        what: it is, for the message; by default the name of the parameter.

    """
    error = wrong_type(wanted, value, what or f"`{parameter}`")
    error.argument = parameter
    return error


def impossible_argument(parameter: str, message: str, help: str) -> InvalidScenarioError:
    """Return the error for an argument that cannot be meant."""
    error = InvalidScenarioError(message, help=help)
    error.argument = parameter
    return error


def speed_to_reach(agent: Any, simulation: Any, speed: float) -> float:
    """Return the speed in m/s that a behavior is to reach: at least 0, as a car that drives backward needs another gear."""
    if speed >= 0:
        return speed
    simulation.note(agent, f"is to reach {speed:g} m/s, which is taken as 0: behaviors drive forward")
    return 0.0
