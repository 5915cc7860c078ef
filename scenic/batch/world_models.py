"""World models that simulators need to drive cars."""

import re
from pathlib import Path
from types import MappingProxyType
from typing import Final

__all__ = ["model_for"]

_FOR_NO_SIMULATOR: Final = re.compile(
    rb"^model[ \t]+scenic\.domains\.driving\.model[ \t\r]*(#|$)", re.MULTILINE
)
_MODELS: Final = MappingProxyType({"newtonian": "scenic.simulators.newtonian.driving_model"})


def model_for(simulator: str, program: Path) -> str | None:
    """Return the world model by which a simulator can drive the cars of a program whose own model is for no simulator.

    Args:
        simulator: its name, as for `choose_simulator`.
        program: the file of the program.

    Returns:
        the name of a module; ``None`` if the program's own model does, or the simulator drives no cars.

    """
    model = _MODELS.get(simulator)
    if model is None:
        return None
    try:
        text = program.read_bytes()
    except OSError:
        return None  # what loads the program says so
    return model if _FOR_NO_SIMULATOR.search(text) else None
