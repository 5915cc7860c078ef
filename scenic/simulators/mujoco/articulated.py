"""Objects with joints: a base that a program makes, and its links, which are objects whose poses follow from the joints."""

import os
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from scenic.graph.kinds import Column, Kind
from scenic.graph.operation import Call, Operation, always
from scenic.language.errors import ScenicTypeError
from scenic.runtime.ground.context import current, here
from scenic.runtime.instances.objects import OrientedPoint
from scenic.runtime.program.veneer import At, With, new
from scenic.runtime.shapes.shapes import BoxShape, MeshShape, Shape
from scenic.runtime.values.generic import support_of
from scenic.runtime.values.values import Vector, apply, operate, to_scalar
from scenic.simulators.mujoco.kinematics import Floats, Segment, forward
from scenic.simulators.mujoco.robot_descriptions import (
    BASE,
    Description,
    DescriptionError,
    Link,
    read_description,
)

__all__ = [
    "assemble",
    "base_shape",
    "description_of",
    "frame_of",
    "joint_values",
    "link_of",
    "middle_of",
    "origin_of",
]

_MARK: Final = 0.02
"""Size of the box that stands for a base without geoms, metres."""


def _place(call: Call, position: Column, turn: Column, *values: Column) -> Column:
    return forward(call.payload, _lanes(values), position, turn)[0]


def _turn(call: Call, turn: Column, *values: Column) -> Column:
    return forward(call.payload, _lanes(values), turn=turn)[1]


def _lanes(values: tuple[Column, ...]) -> list[Floats]:
    return [np.atleast_1d(value) for value in values]


_PLACE: Final = Operation(
    "place in a chain",
    always(Kind.VECTOR),
    _place,
    "The middle of a link, from a frame before and the joints between.",
)
_TURN: Final = Operation(
    "orientation in a chain",
    always(Kind.ORIENTATION),
    _turn,
    "The orientation of a link, from that of a frame before and the joints between.",
)


def description_of(path: Any) -> Description:
    """Return the description at a path, which starts from the folder of the program; raises `DescriptionError`."""
    if not isinstance(path, str | os.PathLike):
        raise ScenicTypeError(
            f"`description` needs the path of an MJCF or URDF file, not {path!r}",
            help="for example: with description 'arm.xml'",
        )
    context = current.get()
    name = None if context is None else context.file()
    # While a program runs, its folder is the first on Python's path.
    folders = [Path(sys.path[0]), *([] if name is None else [Path(name).parent]), Path()]
    file = next((folder / path for folder in folders if (folder / path).is_file()), folders[0] / path)
    return read_description(file, str(path))


def base_shape(path: Any) -> Shape:
    """Return the shape of the part of a description that does not move; any for one that `assemble` refuses at its own place."""
    try:
        return _formed(description_of(path).links[0])[0]
    except (DescriptionError, ScenicTypeError):
        return BoxShape()


def origin_of(description: Description) -> Floats:
    """Return the middle of the base in the description's frame ``(3,)``, metres: where the object is."""
    return _formed(description.links[0])[1]


def middle_of(description: Description, name: str) -> Floats:
    """Return the middle of a link's box in the link's frame ``(3,)``, metres: where its object is."""
    return _formed(next(link for link in description.links if link.name == name))[1]


@lru_cache(maxsize=1024)
def _formed(link: Link) -> tuple[Shape, Floats]:
    """Return the shape of a link, and the middle of its box in its frame ``(3,)``, metres; of the base without geoms a small box."""
    if link.mesh is None:
        return BoxShape((_MARK, _MARK, _MARK)), np.zeros(3)
    vertices = link.mesh.vertices
    return MeshShape(link.mesh), (vertices.min(axis=0) + vertices.max(axis=0)) / 2


def joint_values(description: Description, given: Any) -> dict[str, Any]:
    """Return the values of all joints of a description: those in ``given``, else their home values.

    Raises:
        DescriptionError: there is no joint of a name, or a value is outside its limits.
        ScenicTypeError: ``given`` is not a mapping of names to numbers.

    """
    if not isinstance(given, Mapping):
        raise ScenicTypeError(
            f"`joints` needs the values of joints by their names, not {given!r}",
            help="for example: with joints {'elbow': Range(0, 90) deg}",
        )
    values: dict[str, Any] = {}
    for name, value in given.items():
        joint = description.joint(name)
        number = to_scalar(value, f"the joint {name!r}")
        low, high = (number, number) if isinstance(number, int | float) else support_of(number)
        slack = 1e-9
        for bound, is_outside in (
            (low, low is not None and low < joint.low - slack),
            (high, high is not None and high > joint.high + slack),
        ):
            if is_outside:
                raise DescriptionError(
                    f"the joint {name!r} goes from {joint.low:.6g} to {joint.high:.6g} and cannot be {bound:.6g}",
                    help="angles are in radians (write `30 deg`), lengths in metres",
                )
        values[name] = number
    for name, joint in description.joints.items():
        values.setdefault(name, min(max(joint.home, joint.low), joint.high))
    return values


def assemble(thing: Any, part: type[Any]) -> None:
    """Make the links of an object with joints, which has just been made, as objects of the class ``part``."""
    description = description_of(thing.description)
    thing.__dict__["jointValues"] = joint_values(description, thing.joints)
    for name in thing.gripper:
        description.joint(name)
    thing.__dict__["description"] = str(description.path)
    for name in ("jointVelocities", "jointTorques"):
        thing.__dict__[name] = dict.fromkeys(description.joints, 0.0)
    thing.__dict__["_assembly"] = thing
    frames = _Frames(thing, origin_of(description))
    links: dict[str, Any] = {BASE: thing}
    for link in description.links[1:]:
        if link.mesh is None:
            continue
        shape, middle = _formed(link)
        position, orientation = frames.point(link.chain, middle)
        link_object = new(
            part,
            [
                At(position),
                With("parentOrientation", orientation),
                With("shape", shape),
                With("linkName", link.name),
                With("base", thing),
                With("color", link.color[:3]),
                With("density", thing.density),
            ],
        )
        link_object.__dict__["_assembly"] = thing
        links[link.name] = link_object
    thing.__dict__["links"] = links


class _Frames:
    """Frames of a thing's links in the world, each computed from the nearest frame before it.

    Args:
        thing: the object.
        origin: the place of its middle in the description, ``(3,)``, metres.

    """

    def __init__(self, thing: Any, origin: Floats) -> None:
        self._values = thing.jointValues
        start = operate("subtract", thing.position, operate("rotate", thing.orientation, _vector(origin)))
        self._known: dict[tuple[Segment, ...], tuple[Any, Any]] = {(): (start, thing.orientation)}

    def at(self, chain: tuple[Segment, ...]) -> tuple[Any, Any]:
        """The place and the orientation of the frame at the end of a chain."""
        if chain not in self._known:
            prefix_length = max(end for end in range(len(chain)) if chain[:end] in self._known)
            place, turn = self._known[chain[:prefix_length]]
            rest = chain[prefix_length:]
            joints = [self._values[joint.name] for segment in rest for joint in segment.joints]
            self._known[chain] = (
                apply(_PLACE, place, turn, *joints, payload=rest),
                apply(_TURN, turn, *joints, payload=rest),
            )
        return self._known[chain]

    def point(self, chain: tuple[Segment, ...], point: Floats) -> tuple[Any, Any]:
        """The place of a point of a frame ``(3,)``, metres, and the frame's orientation."""
        place, turn = self.at(chain)
        return operate("add", place, operate("rotate", turn, _vector(point))) if point.any() else place, turn


def _vector(point: Floats) -> Vector:
    return Vector.of(tuple(point.tolist()))


def frame_of(thing: Any, name: str) -> Any:
    """Return the frame of a body or a site of an object with joints, as an oriented point."""
    description = description_of(thing.description)
    position, orientation = _Frames(thing, origin_of(description)).at(description.frame(name))
    return new(OrientedPoint, [At(position), With("parentOrientation", orientation)])


def link_of(thing: Any, name: str) -> Any:
    """Return the object that is a link of an object with joints; raises `DescriptionError` if there is none of the name."""
    if name not in thing.links:
        from scenic.language.spelling import nearest

        similar_name = nearest(name, thing.links)
        raise DescriptionError(
            f"there is no link {name!r}",
            help=f"did you mean {similar_name!r}?"
            if similar_name
            else f"its links are {', '.join(thing.links)}",
        ).at((here(), None))
    return thing.links[name]
