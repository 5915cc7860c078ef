"""Places that a thing with joints can reach: a condition by inverse kinematics."""

from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import is_random, to_vector
from scenic.simulators.mujoco.articulated import description_of, origin_of
from scenic.simulators.mujoco.jointed import Jointed
from scenic.simulators.mujoco.library import library

__all__ = ["reaches"]

Floats = NDArray[np.float64]

_STARTS: Final = 12
"""Configurations from which solutions are looked for: the file's own, and random ones, always the same."""

_DEEP: Final = 1e-3
"""Metres that links may enter each other: geoms of neighbours often do."""


def reaches(thing: Any, target: object, frame: str, down: bool, tolerance: float) -> Any:
    """Return whether a frame of a thing with joints can be within a tolerance (metres) of a place.

    Links may not touch each other there. Other objects are not looked at.

    Args:
        thing: the object with joints.
        target: an object or a position.
        frame: name of a body or a site.
        down: whether the frame's Z axis is to point downwards.
        tolerance: metres.

    Raises:
        DescriptionError: there is no such frame.

    """
    description = description_of(thing.description)
    description.frame(frame)
    place = to_vector(getattr(target, "position", target), "`reaches`")
    question = _Question(str(description.path), frame, bool(down), float(tolerance))
    if is_random(place) or is_random(thing.position) or is_random(thing.orientation):
        return call_later(question, thing.position, thing.orientation, place)
    return question(thing.position, thing.orientation, place)


@dataclass(frozen=True, slots=True)
class _Question:
    path: str
    frame: str
    down: bool
    tolerance: float

    def __call__(self, base: Any, turn: Any, place: Any) -> bool:
        """Return whether there is a solution, given the pose of the base and the place in the world."""
        arm = _arm(self.path)
        back = quaternions.conjugate(np.array([turn.x, turn.y, turn.z, turn.w]))
        local = quaternions.rotate(back, np.array(tuple(place)) - np.array(tuple(base))) + arm.origin
        if not self.down:
            return arm.solves(self.frame, local, down=None, tolerance=self.tolerance)
        axis = quaternions.rotate(back, np.array([0.0, 0.0, -1.0]))
        return arm.solves(self.frame, local, down=axis, tolerance=self.tolerance)


class _Arm:
    """A description alone, its frame that of the world."""

    def __init__(self, path: str) -> None:
        mujoco = library()
        self.description = description_of(path)
        self.origin = origin_of(self.description)
        spec = mujoco.MjSpec.from_file(path)
        for item in [item for item in spec.joints if item.type == mujoco.mjtJoint.mjJNT_FREE]:
            spec.delete(item)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._jointed = Jointed(self, self.description, None, "")
        joints = self.description.joints.values()
        low = np.array([max(joint.low, -np.pi) for joint in joints])
        high = np.array([min(joint.high, np.pi) for joint in joints])
        draws = np.random.default_rng(0).uniform(low, high, (_STARTS - 1, len(low)))
        home = np.clip([joint.home for joint in joints], low, high)
        self._starts = np.concatenate([home[None], draws])

    def solves(self, frame: str, place: Floats, *, down: Floats | None, tolerance: float) -> bool:
        """Return whether some start leads to a solution without contacts."""
        mujoco = library()
        for start in self._starts:
            self._set(dict(zip(self.description.joints, start.tolist(), strict=True)))
            values, left = self._jointed.solve(frame, place, down)
            if left > tolerance:
                continue
            self._set(values)
            mujoco.mj_forward(self.model, self.data)
            if not self.data.ncon or self.data.contact.dist.min() > -_DEEP:
                return True
        return False

    def _set(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            self.data.joint(name).qpos[0] = value


@lru_cache(maxsize=16)
def _arm(path: str) -> _Arm:
    return _Arm(path)
