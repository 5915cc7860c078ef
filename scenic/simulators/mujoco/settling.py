"""Scenes in which things stay: a condition that simulates the objects of a candidate and looks how far they move."""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.language.errors import ScenicValueError
from scenic.simulators.commands import GRAVITY
from scenic.simulators.mujoco.articulated import description_of
from scenic.simulators.mujoco.jointed import Jointed
from scenic.simulators.mujoco.library import library, quietly
from scenic.simulators.mujoco.model import Builder, Part

__all__ = ["Settling", "Tally"]

_STEP: Final = 0.002
_FALLEN: Final = 0.05
"""Metres that an object sinks which has fallen."""


@dataclass(slots=True)
class Tally:
    """Numbers of the tries and objects that were looked at in this process."""

    scenes: int = 0
    stable: int = 0
    objects: int = 0
    fell: int = 0
    tipped: int = 0
    slid: int = 0

    def __str__(self) -> str:
        return (
            f"{self.stable:,} of {self.scenes:,} candidates stayed; of {self.objects:,} objects {self.fell:,} fell, "
            f"{self.tipped:,} tipped, {self.slid:,} slid"
        )


class Settling:
    """The condition that no object moves.

    Args:
        seconds: length of the simulation.
        distance: by which an object may move, metres.
        angle: by which it may turn, radians.

    """

    def __init__(self, seconds: float, distance: float = 0.01, angle: float = math.radians(5)) -> None:
        for name, value in (("seconds", seconds), ("distance", distance), ("angle", angle)):
            if not 0 < value < math.inf:
                raise ScenicValueError(f"{name} of settling must be a positive number, not {value!r}")
        library()
        self.seconds = seconds
        self.distance = distance
        self.angle = angle
        self.tally = Tally()

    def __call__(self, things: Sequence[Any]) -> bool:
        """Return whether none of the objects of a scene moves."""
        model, data, parts = _model(things)
        mujoco = library()
        before = {
            part.name: (data.body(part.name).xpos.copy(), data.body(part.name).xquat.copy()) for part in parts
        }
        with quietly():
            mujoco.mj_step(model, data, max(1, round(self.seconds / _STEP)))
            mujoco.mj_kinematics(model, data)
        tally, steady = self.tally, True
        tally.scenes += 1
        tally.objects += len(parts)
        for part in parts:
            place, turn = before[part.name]
            body = data.body(part.name)
            shift = body.xpos - place
            tilt = 2 * math.acos(min(1.0, abs(float(turn @ body.xquat))))
            distance = float(np.linalg.norm(shift))
            if math.isfinite(distance) and distance <= self.distance and tilt <= self.angle:
                continue
            steady = False
            if not math.isfinite(distance) or shift[2] < -_FALLEN:
                tally.fell += 1
            elif tilt > self.angle:
                tally.tipped += 1
            else:
                tally.slid += 1
        tally.stable += steady
        return steady


@dataclass(frozen=True, slots=True)
class _State:
    """A model and its state, as `Jointed` reads them."""

    model: Any
    data: Any


def _model(things: Sequence[Any]) -> tuple[Any, Any, list[Part]]:
    """The compiled model of objects, its state, and the parts that move."""
    builder = Builder(_STEP, GRAVITY)
    parts = [builder.add(thing) for thing in things]
    # Just below the lowest point: what stands on nothing falls on it.
    builder.add_ground(min(0.0, min((_bottom(thing) for thing in things), default=0.0)))
    mujoco = library()
    with quietly():
        model = builder.spec.compile()
    data = mujoco.MjData(model)
    state = _State(model, data)
    for part in parts:
        if part.model == "articulated":
            Jointed(state, description_of(part.thing.description), part.thing, f"{part.name} ").start()
    mujoco.mj_forward(model, data)
    return model, data, [part for part in parts if part.moves]


def _bottom(thing: Any) -> float:
    turn = thing.orientation
    row = np.array(
        [
            2 * (turn.x * turn.z - turn.y * turn.w),
            2 * (turn.y * turn.z + turn.x * turn.w),
            1 - 2 * (turn.x**2 + turn.y**2),
        ]
    )
    size = np.array([thing.width, thing.length, thing.height], np.float64)
    return float(thing.position.z + (thing.shape.mesh.vertices * size @ row).min())
