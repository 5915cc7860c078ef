"""Actions in Webots, for any object of its world model."""

import json
from pathlib import Path
from typing import Any

from scenic.runtime.values.values import to_vector
from scenic.simulators.actions import Action

__all__ = ["ApplyForceAction", "OffsetAction", "WriteFileAction"]


class OffsetAction(Action):
    """Put the object elsewhere at once: ``offset`` metres to its right, ahead of it and above it."""

    def __init__(self, offset: object) -> None:
        self.offset = to_vector(offset, "OffsetAction")

    def applyTo(self, agent: Any, simulation: Any) -> None:
        """Move the object."""
        simulation.move(agent, agent.position.offsetLocally(agent.orientation, self.offset))

    def __repr__(self) -> str:
        return f"OffsetAction({self.offset})"


class ApplyForceAction(Action):
    """Push the object for one step at its centre of mass.

    Args:
        force: newtons, along the axes of the world, or of the object.
        relative: whether the axes are those of the object.

    """

    def __init__(self, force: object, relative: bool = False) -> None:
        self.force = to_vector(force, "ApplyForceAction")
        self.relative = bool(relative)

    def applyTo(self, agent: object, simulation: Any) -> None:
        """Push."""
        simulation.push(agent, self.force, self.relative)

    def __repr__(self) -> str:
        return f"ApplyForceAction({self.force}, {self.relative})"


class WriteFileAction(Action):
    """Write data as JSON to a file, which the controller of a robot can read.

    Args:
        path: the file.
        data: anything that JSON has: numbers, text, lists, mappings.

    """

    def __init__(self, path: Any, data: object) -> None:
        self.path = Path(path)
        self.text = json.dumps(data)

    def applyTo(self, agent: object, simulation: object) -> None:
        """Write the file whole."""
        from scenic.formats.files import write

        write(self.path, self.text.encode())

    def __repr__(self) -> str:
        return f"WriteFileAction({str(self.path)!r})"
