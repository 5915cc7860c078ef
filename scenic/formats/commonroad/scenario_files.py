"""CommonRoad files of scenes and simulations."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree

from scenic.formats.commonroad.elements import Numbers, add_location, add_roads, decimal
from scenic.formats.commonroad.obstacles import (
    ObstacleCourse,
    State,
    add_obstacle,
    add_problem,
    state_of,
)
from scenic.formats.commonroad.records import RoadRecords, RoadSource
from scenic.formats.files import write
from scenic.formats.scene_protocols import Scene
from scenic.language.errors import UnsupportedError

__all__ = ["CommonRoadFile", "commonroad_about", "commonroad_document", "document_text", "write_scene"]

_MARK: Final = "scenic-simulation "
"""Beginning of the comment that contains the first line of a trajectory file."""

_COMMENT: Final = 1 << 24
"""The longest comment that is read."""

_TIMESTEP: Final = 0.1
"""Seconds in a step of scenes, which have no time."""


def commonroad_document(
    scene: Scene,
    courses: Sequence[ObstacleCourse],
    timestep: float,
    *,
    colors: Sequence[Mapping[str, str]] = (),
    ego_moves: bool = False,
) -> ElementTree.Element:
    """Return the document of a scene whose objects move along courses.

    The ego becomes the planning problem. Every other object is an obstacle.

    Args:
        scene: with a road network as its workspace.
        courses: of all objects, in the order of the scene.
        timestep: seconds between states.
        colors: of traffic lights at each step, by key; those of the scene's parameters without them.
        ego_moves: make the ego an obstacle, too.

    Raises:
        UnsupportedError: the scene has no road network, or no ego.

    """
    source = _source(scene)
    ego = next((course for course in courses if course.thing is scene.egoObject), None)
    if ego is None:
        raise UnsupportedError(
            "CommonRoad needs an ego, whose drive is the planning problem",
            help="name one of the objects `ego`",
        )
    unlit = source.commonroad_records(scene.params)
    records = _lit(unlit, colors, timestep) if colors else unlit
    root = ElementTree.Element("commonRoad", _attributes(records, scene.k, timestep))
    numbers = Numbers()
    add_location(root, records)
    add_roads(root, records, numbers, timestep)
    obstacles = [
        (course, f"object {index}")
        for index, course in enumerate(courses)
        if ego_moves or course.thing is not scene.egoObject
    ]
    # Numbers follow the order of the scene; the schema wants obstacles that never move first.
    for _, key in obstacles:
        numbers.reserve(key)
    for course, key in sorted(obstacles, key=lambda item: not item[0].is_still):
        add_obstacle(root, course, key, numbers, timestep)
    here = source.lanelets_at((ego.states[0].x, ego.states[0].y))
    add_problem(root, ego, numbers, _onward(records, here) or here, timestep)
    return root


def _onward(records: RoadRecords, here: Sequence[str]) -> list[str]:
    """Return the lanelets that follow some lanelets, each once."""
    successors = {lanelet.key: lanelet.successors for lanelet in records.lanelets}
    return list(dict.fromkeys(key for lanelet in here for key in successors[lanelet]))


def _source(scene: Scene) -> RoadSource:
    workspace = scene.workspace
    if not isinstance(workspace, RoadSource):
        raise UnsupportedError(
            "CommonRoad needs a road network, and this program has none",
            help="use a driving model, or another format",
        )
    return workspace


def _attributes(records: RoadRecords, k: int, timestep: float) -> dict[str, str]:
    name = re.sub("[^A-Za-z0-9]", "", records.name) or "Map"
    return {
        "commonRoadVersion": "2020a",
        # Of Zamunda, CommonRoad's country without a place; its signs are those of Germany.
        "benchmarkID": f"ZAM_{name[:1].upper()}{name[1:]}-1_{k + 1}_T-1",
        "date": datetime.now(UTC).date().isoformat(),
        "author": "Scenic",
        "affiliation": "Scenic",
        "source": records.name,
        "timeStepSize": decimal(timestep),
    }


def _lit(records: RoadRecords, colors: Sequence[Mapping[str, str]], timestep: float) -> RoadRecords:
    """The records with the colours that the traffic lights have had."""
    lights = tuple(
        replace(
            light,
            cycle=tuple(
                (timestep * len(list(steps)), color)
                for color, steps in groupby(row.get(light.key, "off") for row in colors)
            ),
        )
        for light in records.lights
    )
    return replace(records, lights=lights)


def document_text(root: ElementTree.Element, comment: str | None = None) -> bytes:
    """Return the content of a file: a document, perhaps with a comment before it."""
    ElementTree.indent(root)
    head = b'<?xml version="1.0" encoding="UTF-8"?>\n'
    if comment is not None:
        # A comment may not contain two hyphens.
        head += b"<!-- " + comment.replace("--", "-\\u002d").encode() + b" -->\n"
    return head + ElementTree.tostring(root, encoding="unicode").encode() + b"\n"


def write_scene(scene: Scene, path: Path) -> None:
    """Write a scene; objects that have a speed keep it for a step.

    Raises:
        UnsupportedError: the scene has no road network, or no ego.
        OutputError: the file cannot be written.

    """
    courses = [
        ObstacleCourse(thing, (state_of(thing.position, thing, getattr(thing, "velocity", (0.0, 0.0))),))
        for thing in scene.objects
    ]
    write(path, document_text(commonroad_document(scene, courses, _TIMESTEP)))


class CommonRoadFile:
    """A file of a simulation at ``path``, made when the simulation has ended."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._states: list[list[State]] = []
        self._colors: list[Mapping[str, str]] = []

    def add(self, simulation: Any, poses: Sequence[tuple[Any, Any]]) -> None:
        """Take the next state: position and orientation of each object."""
        things = zip(simulation.objects, poses, strict=True)
        self._states.append([state_of(*pose, thing.velocity) for thing, pose in things])
        source = _source(simulation.scene)
        self._colors.append(source.light_colors(simulation))

    def finish(self, simulation: Any, about: Mapping[str, object]) -> None:
        """Write the file.

        Raises:
            UnsupportedError: the program has no map or no ego, or made objects while it ran.
            OutputError: the file cannot be written.

        """
        scene = simulation.scene
        if any(len(states) != len(scene.objects) for states in self._states):
            raise UnsupportedError(
                "CommonRoad has no objects that are made during the simulation", help="write JSON Lines"
            )
        courses = [
            ObstacleCourse(thing, tuple(states[index] for states in self._states))
            for index, thing in enumerate(scene.objects)
        ]
        root = commonroad_document(scene, courses, float(simulation.timestep), colors=self._colors)
        text = json.dumps(about, allow_nan=False, separators=(",", ":"))
        write(self._path, document_text(root, _MARK + text))

    def close(self) -> None:
        """Give up what is not finished."""
        self._states.clear()


def commonroad_about(path: Path) -> Any:
    """Read the data about the whole simulation from a file of this package; ``None`` for other files.

    Raises ``OSError`` or ``ValueError`` where it cannot be read.
    """
    with path.open(encoding="utf-8") as stream:
        stream.readline()
        comment = stream.readline(_COMMENT).strip()
    start, end = f"<!-- {_MARK}", " -->"
    if not (comment.startswith(start) and comment.endswith(end)):
        return None
    return json.loads(comment[len(start) : -len(end)])
