"""Scenes in which things stay: the objects of a candidate are simulated, to reject it where one moves, or to keep the poses they end in."""

import math
import multiprocessing
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.node import Graph
from scenic.language.errors import ScenicValueError
from scenic.runtime.description.outcome import Program, Requirement
from scenic.runtime.instances.properties import update
from scenic.runtime.python.samples import dependencies
from scenic.runtime.sampling.check_planning import Outline
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import Orientation, Vector, as_node, operate, to_vector
from scenic.simulators.commands import GRAVITY
from scenic.simulators.mujoco.articulated import description_of
from scenic.simulators.mujoco.jointed import Jointed
from scenic.simulators.mujoco.library import library, quietly
from scenic.simulators.mujoco.model import Builder

__all__ = ["Settling", "SettlingTally", "keep_poses", "require_rest"]

Floats = NDArray[np.float64]

_STEP: Final = 0.002
_FALLEN: Final = 0.05
"""Metres that an object sinks which has fallen."""
_ANGLE: Final = math.radians(5)
_LULL: Final = 0.5
"""Seconds after settling in which objects of kept poses stay within the tolerance."""
_STILL: Final = ("static", "articulated", "link")
"""The `dynamics` of objects whose poses are kept as they are."""
_KINDS: Final = ("scenes", "stable", "objects", "fell", "tipped", "slid", "restless")


class SettlingTally:
    """Numbers of the candidates and objects that were simulated, in this process and in those that it has forked."""

    def __init__(self) -> None:
        self._numbers = multiprocessing.Array("q", len(_KINDS))

    def __getattr__(self, name: str) -> int:
        if name not in _KINDS:
            raise AttributeError(name)
        return int(self._numbers[_KINDS.index(name)])

    def add(self, *numbers: int) -> None:
        """Add numbers in the order scenes, stable, objects, fell, tipped, slid, restless."""
        with self._numbers.get_lock():
            for place, number in enumerate(numbers):
                self._numbers[place] += number

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the copy in another process an empty tally: a process that is not forked counts on its own."""
        return SettlingTally, ()

    def __str__(self) -> str:
        return (
            f"{self.stable:,} of {self.scenes:,} candidates stayed; of {self.objects:,} objects {self.fell:,} fell, "
            f"{self.tipped:,} tipped, {self.slid:,} slid"
            + (f"; {self.restless:,} candidates were still moving" if self.restless else "")
        )


class Settling:
    """A short simulation of the objects of a scene.

    Args:
        seconds: length of the simulation.
        distance: by which an object may move, metres.
        angle: by which it may turn, radians.

    """

    def __init__(self, seconds: float, distance: float = 0.01, angle: float = _ANGLE) -> None:
        for name, value in (("seconds", seconds), ("distance", distance), ("angle", angle)):
            if not 0 < value < math.inf:
                raise ScenicValueError(f"{name} of settling must be a positive number, not {value!r}")
        library()
        self.seconds = seconds
        self.distance = distance
        self.angle = angle
        self.tally = SettlingTally()

    def stays(self, things: Sequence[object]) -> bool:
        """Return whether none of the objects of a scene moves."""
        world = _World(things)
        before = world.poses()
        world.run(self.seconds)
        return self._compared(before, world.poses())

    def settled(self, things: Sequence[object]) -> tuple[Any, ...]:
        """Return the poses in which objects come to rest, and whether they do.

        Returns:
            Whether all objects are at rest in the end, then for each object its place and its yaw, pitch and roll.

        """
        world = _World(things)
        before = world.poses()
        world.run(self.seconds)
        after = world.poses()
        self._compared(before, after)
        world.run(_LULL)
        at_rest = all(
            math.isfinite(shift) and shift <= self.distance and turn <= self.angle
            for shift, turn, _ in map(_change, after, world.poses())
        )
        self.tally.add(0, 0, 0, 0, 0, 0, not at_rest)
        ends = dict(zip((id(part.thing) for part in world.parts), after, strict=True))
        return at_rest, *(_placed(thing, ends.get(id(thing))) for thing in things)

    def _compared(self, before: "list[_Pose]", after: "list[_Pose]") -> bool:
        """Count the objects that have moved, by the kind of their motion; returns whether none has."""
        fell = tip_count = slid = 0
        for first, last in zip(before, after, strict=True):
            distance, tilt, height = _change(first, last)
            if math.isfinite(distance) and distance <= self.distance and tilt <= self.angle:
                continue
            if not math.isfinite(distance) or height < -_FALLEN:
                fell += 1
            elif tilt > self.angle:
                tip_count += 1
            else:
                slid += 1
        steady = not fell + tip_count + slid
        self.tally.add(1, steady, len(before), fell, tip_count, slid)
        return steady


def require_rest(program: Program, settling: Settling, *, keep: bool) -> Any:
    """Add the requirement that no object of a scene moves in a simulation, or with `keep` that all come to rest.

    Returns the results of `Settling.settled` as a random value, for `keep_poses`; ``None`` without ``keep``.
    """
    program.settling = settling
    if not keep:
        stays = call_later(settling.stays, tuple(program.objects))
        label = f"nothing moves by more than {settling.distance:g} m in {settling.seconds:g} s (--settle)"
        program.requirements.append(Requirement(as_node(stays), 1.0, label, is_simulated=True))
        return None
    # Copies keep the poses before, of which the settled ones are made.
    result = call_later(settling.settled, tuple(type(item)._make(item.__dict__) for item in program.objects))
    label = f"everything is at rest after {settling.seconds:g} s (--settle)"
    at_rest = as_node(operate("getitem", result, 0))
    program.requirements.append(Requirement(at_rest, 1.0, label, is_simulated=True))
    return result


def keep_poses(program: Program, outlined: Outline, settled: object) -> Outline:
    """Let the objects of scenes have settled poses; the requirements, which are outlined already, are about the poses before.

    Args:
        program: it has run.
        outlined: its outline, made after `require_rest`.
        settled: the random value that `require_rest` has returned.

    """
    for number, thing in enumerate(program.objects):
        if thing.__dict__.get("dynamics") in _STILL:
            continue
        pose = operate("getitem", settled, number + 1)
        yaw, pitch, roll = (operate("getitem", pose, place) for place in (1, 2, 3))
        position = to_vector(operate("getitem", pose, 0))
        update(thing, {"position": position, "yaw": yaw, "pitch": pitch, "roll": roll})
    outputs = dependencies([*program.objects, *program.parameters.values()])
    return replace(outlined, graph=Graph([*outlined.graph.nodes, *outputs]), outputs=tuple(outputs))


@dataclass(frozen=True, slots=True)
class _State:
    """A model and its state, as `Jointed` reads them."""

    model: Any
    data: Any


_Pose = tuple[Floats, Floats]
"""Place of a body ``(3,)``, metres, and its orientation ``(w, x, y, z)``."""


class _World:
    """Objects of a scene in MuJoCo, above a ground just below their lowest point: what stands on nothing falls on it."""

    def __init__(self, things: Sequence[object]) -> None:
        builder = Builder(_STEP, GRAVITY)
        present = [thing for thing in things if getattr(thing, "present", True)]
        parts = [builder.add(thing) for thing in present]
        builder.add_ground(min(0.0, min((_bottom(thing) for thing in present), default=0.0)))
        with quietly():
            model = builder.spec.compile()
        data = library().MjData(model)
        self._state = _State(model, data)
        for part in parts:
            if part.model == "articulated":
                description = description_of(part.thing.description)
                Jointed(self._state, description, part.thing, f"{part.name} ").start()
        library().mj_forward(model, data)
        self.parts = [part for part in parts if part.moves]

    def run(self, seconds: float) -> None:
        """Simulate."""
        model, data = self._state.model, self._state.data
        with quietly():
            library().mj_step(model, data, max(1, round(seconds / _STEP)))
            library().mj_kinematics(model, data)

    def poses(self) -> list[_Pose]:
        """Return the present poses of the parts that move."""
        bodies = [self._state.data.body(part.name) for part in self.parts]
        return [(body.xpos.copy(), body.xquat.copy()) for body in bodies]


def _change(first: _Pose, last: _Pose) -> tuple[float, float, float]:
    """Return the distance (metres), angle (radians) and height (metres) between two poses of a body."""
    shift = last[0] - first[0]
    angle = 2 * math.acos(min(1.0, abs(float(first[1] @ last[1]))))
    return float(np.linalg.norm(shift)), angle, float(shift[2])


def _placed(thing: Any, pose: _Pose | None) -> tuple[Any, float, float, float]:
    """Return the position, yaw, pitch and roll of an object in a pose; its own if there is none."""
    if pose is None:
        return thing.position, thing.yaw, thing.pitch, thing.roll
    w, x, y, z = pose[1].tolist()
    local = thing.parentOrientation.inverse * Orientation.of((x, y, z, w))
    return Vector.of(tuple(pose[0].tolist())), *local.eulerAngles


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
