"""Simulations as JSON Lines: a line about the simulation, then one for each step."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, Protocol

from scenic.formats.files import Waiting, writing
from scenic.formats.json_lines import number, plain
from scenic.runtime.dynamics.recorders import Filed

__all__ = [
    "FORMAT",
    "VERSION",
    "EndedSimulation",
    "LinesFile",
    "RunningSimulation",
    "TrajectoryFile",
    "course_document",
    "step_document",
]

FORMAT: Final = "scenic-simulation"
VERSION: Final = 1


class RunningSimulation(Protocol):
    """A simulation (`scenic.simulators.simulation.Simulation`)."""

    objects: Any
    currentTime: int
    timestep: float


class EndedSimulation(RunningSimulation, Protocol):
    """A simulation that has run."""

    scene: Any
    result: Any


def course_document(course: EndedSimulation, *, k: int, tries: int) -> dict[str, Any]:
    """Return the facts about the whole simulation."""
    numbers = {id(thing): index for index, thing in enumerate(course.objects)}
    names = course.scene.names
    result = course.result
    return {
        "format": FORMAT,
        "version": VERSION,
        "seed": course.scene.seed,
        "k": k,
        "tries": tries,
        "timestep": number(course.timestep),
        "steps": course.currentTime,
        "ended": result.terminationType.name,
        "reason": result.terminationReason,
        "params": {str(name): plain(value, numbers) for name, value in course.scene.params.items()},
        "objects": [
            {
                "class": type(thing).__name__,
                "name": names.get(thing),
                "size": [number(value) for value in (thing.width, thing.length, thing.height)],
                "color": plain(thing.color, numbers),
            }
            for thing in course.objects
        ],
        "requirements": [
            {
                "label": item.label,
                "line": item.line,
                "verdict": None if item.verdict is None else item.verdict.name,
                "robustness": None if item.robustness is None else number(item.robustness),
            }
            for item in result.requirements
        ],
        "records": {name: _record(value, numbers) for name, value in result.records.items()},
        **_notes(course),
    }


def _notes(course: EndedSimulation) -> dict[str, Any]:
    """Return what the simulation noted of its objects, if anything."""
    notes = getattr(course, "notes", ())
    rows = [{"step": step, "object": thing, "text": text} for step, thing, text in notes]
    return {"notes": rows} if rows else {}


def _record(value: object, numbers: Mapping[int, int]) -> Any:
    """Return a recorded value as plain data; a value in a file of its own becomes the name of the file."""
    return {"$file": value.name} if isinstance(value, Filed) else plain(value, numbers)


def step_document(
    course: RunningSimulation, poses: Sequence[tuple[Any, Any]], actions: Mapping[Any, Any]
) -> dict[str, Any]:
    """The present state: positions in metres, orientations as quaternions x, y, z, w, and the actions then taken."""
    numbers = {id(thing): index for index, thing in enumerate(course.objects)}
    step = course.currentTime
    return {
        "step": step,
        "time": number(step * course.timestep),
        "positions": [[number(part) for part in position] for position, _ in poses],
        "orientations": [[number(value) for value in (o.x, o.y, o.z, o.w)] for _, o in poses],
        "actions": {
            str(numbers[id(agent)]): [plain(action, numbers) for action in some]
            for agent, some in actions.items()
            if some
        },
    }


class TrajectoryFile(Protocol):
    """A file of a simulation, into which states are put while it runs; there is no file before it is finished."""

    def add(self, state: Mapping[str, object]) -> None:
        """The next state, as `step_document` gives it."""

    def finish(self, about: Mapping[str, object]) -> None:
        """Complete the file with the data of `course_document` about the whole simulation."""

    def close(self) -> None:
        """Give up what is not finished."""


class LinesFile:
    """A file of JSON Lines at ``path``: a line about the simulation, then one for each state.

    What is in the first line is known last. So states wait in a file without a name, of which nothing remains however the
    process ends. Raises ``OutputError`` where files cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._waiting = Waiting(path)

    def add(self, state: Mapping[str, object]) -> None:
        """The next state."""
        self._waiting.write(_line(state))

    def finish(self, about: Mapping[str, object]) -> None:
        """Complete the file."""
        with writing(self._path) as stream:
            stream.write(_line(about))
            self._waiting.copy(stream)

    def close(self) -> None:
        """Give up what is not finished."""
        self._waiting.close()


def _line(document: Mapping[str, object]) -> bytes:
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode() + b"\n"
