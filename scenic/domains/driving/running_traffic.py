"""The running simulation, as behaviors of cars and functions about traffic lights need it."""

from typing import Any, Final

from scenic.language.errors import InvalidScenarioError
from scenic.runtime.program.builtins import running_simulation

__all__ = ["ADVICE", "running_traffic"]

ADVICE: Final = (
    "take a simulator of traffic, such as the built-in one: "
    "`model scenic.simulators.newtonian.driving_model` (from the command line: `--simulator newtonian`)"
)
"""Help where a simulator or its objects know nothing of traffic."""


def running_traffic() -> Any:
    """Return the simulation that is running.

    Raises:
        InvalidScenarioError: none is, or it is not one of traffic.

    """
    simulation = running_simulation()
    if "traffic_lights" not in dir(simulation):  # which does not make them
        raise InvalidScenarioError(
            f"{type(simulation).__name__} cannot drive cars and knows no traffic lights", help=ADVICE
        )
    return simulation
