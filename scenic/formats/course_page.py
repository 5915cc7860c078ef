"""A page that plays simulations in three dimensions: the page of scenes, with a line for the time."""

import json
from array import array
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from scenic.formats.html import Page, packed, page_text
from scenic.formats.json_lines import number
from scenic.formats.lamps import NO_COLORS
from scenic.formats.trajectories import EndedSimulation

__all__ = ["PoseTape", "ShownCourse", "course_data", "course_page"]


class PoseTape:
    """Collects the poses of a running simulation, state by state.

    Attributes:
        colors: of lights in each state, by their keys; see `light_colors`.

    """

    def __init__(self) -> None:
        self._numbers = array("f")
        self._counts = array("l")
        self.colors: list[Mapping[str, str]] = []

    def add(self, poses: Sequence[tuple[Any, Any]], colors: Mapping[str, str] = NO_COLORS) -> None:
        """The next state: position and orientation of each object, and the colours of lights by their keys."""
        # Lights change seldom.
        last = self.colors[-1] if self.colors else NO_COLORS
        self.colors.append(last if colors == last else colors)
        for position, turn in poses:
            self._numbers.extend((*position, turn.x, turn.y, turn.z, turn.w))
        self._counts.append(len(poses))

    def poses(self) -> npt.NDArray[np.float32]:
        """Return position (metres) and quaternion x, y, z, w, ``(states, objects, 7)``; NaN before an object was created."""
        counts = np.array(self._counts)
        present = np.arange(counts.max(initial=0)) < counts[:, np.newaxis]
        poses = np.full((*present.shape, 7), np.nan, dtype="<f4")
        poses[present] = np.frombuffer(self._numbers, dtype=np.float32).reshape(-1, 7)
        return poses


class ShownCourse:
    """The objects of a simulation, also those that came later, as a scene to be drawn."""

    def __init__(self, course: EndedSimulation) -> None:
        scene = course.scene
        self.objects = tuple(course.objects)
        self.egoObject = scene.egoObject
        self.names: Mapping[Any, str] = scene.names
        self.workspace, self.regions, self.params = scene.workspace, scene.regions, scene.params
        self.seed, self.k, self.attempts = scene.seed, scene.k, scene.attempts
        self.origin = scene.origin


def course_data(course: EndedSimulation, tape: PoseTape) -> dict[str, Any]:
    """Return the data that the page needs of a simulation, all of whose states are on the tape, as plain data."""
    page = Page("")
    poses = tape.poses()
    places = poses[..., :3].reshape(-1, 3).astype(np.float64)
    # A few metres make no difference to the ground that is drawn.
    near = np.unique(np.round(places[np.isfinite(places).all(axis=1)] / 5.0), axis=0) * 5.0
    instances = page.add(ShownCourse(course), near, tape.colors)
    data = page.data()
    (scene,) = data["scenes"]
    indices = {id(thing): index for index, thing in enumerate(course.objects)}
    columns = [indices[id(instance.thing)] for instance in instances]
    result = course.result
    scene["course"] = {
        "timestep": number(course.timestep),
        "steps": len(poses) - 1,
        "poses": packed(poses[:, columns]),
        "reason": result.terminationReason,
        "requirements": [
            {
                "label": item.label,
                "verdict": "not evaluated"
                if item.verdict is None
                else item.verdict.name.lower().replace("_", " "),
                "robustness": None if item.robustness is None else number(item.robustness),
            }
            for item in result.requirements
        ],
    }
    return data


def course_page(title: str, courses: Sequence[Mapping[str, Any]]) -> str:
    """Return the page of simulations, each as `course_data` gives it; at least one."""
    together: dict[str, Any] = {
        "meshes": [],
        "outlines": [],
        "grounds": [],
        "scenes": [],
        "lights": courses[0]["lights"],
    }
    numbers: dict[str, dict[str, int]] = {"meshes": {}, "outlines": {}, "grounds": {}}
    for data in courses:
        # Most meshes and regions are the same in all simulations: they are on the page once.
        place: dict[str, list[int]] = {}
        for kind, number_of in numbers.items():
            place[kind] = []
            for item in data.get(kind, ()):
                if kind == "grounds":
                    item = {**item, "mesh": place["meshes"][item["mesh"]]}
                text = json.dumps(item)
                if text not in number_of:
                    number_of[text] = len(number_of)
                    together[kind].append(item)
                place[kind].append(number_of[text])
        for scene in data["scenes"]:
            workspace = scene["workspace"]
            together["scenes"].append(
                {
                    **scene,
                    **{
                        kind: [{**thing, "mesh": place["meshes"][thing["mesh"]]} for thing in scene[kind]]
                        for kind in ("objects", "lamps")
                        if kind in scene
                    },
                    "workspace": None if workspace is None else place["outlines"][workspace],
                    "regions": {name: place["outlines"][k] for name, k in scene["regions"].items()},
                    **(
                        {"ground": [place["grounds"][k] for k in scene["ground"]]}
                        if "ground" in scene
                        else {}
                    ),
                }
            )
    if not together["grounds"]:
        del together["grounds"]
    return page_text(title, together)
