"""Simulations as JSON Lines: a line about the simulation, then one for each step."""

import json
from collections.abc import Iterator
from typing import Any, Final, Protocol

from scenic.formats.json_lines import number, plain

__all__ = ["FORMAT", "VERSION", "Course", "course_document", "step_documents", "trajectory_lines"]

FORMAT: Final = "scenic-simulation"
VERSION: Final = 1


class Course(Protocol):
    """A simulation that has run (`scenic.simulators.simulation.Simulation`, with its poses kept)."""

    objects: Any
    scene: Any
    result: Any
    poses: Any
    timestep: float


def course_document(course: Course, *, k: int, tries: int) -> dict[str, Any]:
    """What is to say about the whole simulation."""
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
        "steps": len(result.actions),
        "ended": result.terminationType.name,
        "reason": result.terminationReason,
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
        "records": {name: plain(value, numbers) for name, value in result.records.items()},
    }


def step_documents(course: Course) -> Iterator[dict[str, Any]]:
    """Each state: positions in metres, orientations as quaternions x, y, z, w, and the actions then taken."""
    numbers = {id(thing): index for index, thing in enumerate(course.objects)}
    actions = course.result.actions
    for step, poses in enumerate(course.poses):
        taken = actions[step] if step < len(actions) else {}
        yield {
            "step": step,
            "time": number(step * course.timestep),
            "positions": [[number(part) for part in position] for position, _ in poses],
            "orientations": [[number(value) for value in (o.x, o.y, o.z, o.w)] for _, o in poses],
            "actions": {
                str(numbers[id(agent)]): [plain(action, numbers) for action in some]
                for agent, some in taken.items()
                if some
            },
        }


def trajectory_lines(course: Course, *, k: int, tries: int) -> Iterator[str]:
    """The lines of the file of a simulation, without their ends; equal simulations give equal text."""
    for document in (course_document(course, k=k, tries=tries), *step_documents(course)):
        yield json.dumps(document, allow_nan=False, separators=(",", ":"))
