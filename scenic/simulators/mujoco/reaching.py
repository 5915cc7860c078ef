"""Places that a thing with joints can reach: a condition by inverse kinematics."""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.language.types import OBJECT
from scenic.runtime.geometry.meshes.convex_parts import convex_parts
from scenic.runtime.regions.stacked import is_body
from scenic.runtime.values.describing import wrong_type
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import is_random, to_vector
from scenic.simulators.mujoco.articulated import description_of, origin_of
from scenic.simulators.mujoco.jointed import Jointed
from scenic.simulators.mujoco.library import library

__all__ = ["reaches"]

Floats = NDArray[np.float64]

Form: TypeAlias = tuple[Any, tuple[float, float, float]]
"""A mesh in the unit box, and its size in metres."""

_STARTS: Final = 12
"""Configurations from which solutions are looked for: the file's own, and random ones, always the same."""
_MORE_STARTS: Final = 60
"""The same where there are solutions, but with contacts."""

_DEEP: Final = 1e-3
"""Metres that links may enter each other: geoms of neighbours often do."""


_EACH: Final = 6
"""Values that describe an obstacle: position, orientation, width, length, height and shape."""


def reaches(
    thing: Any, target: object, frame: str, down: bool, tolerance: float, avoiding: Iterable[object] = ()
) -> Any:
    """Return whether a frame of a thing with joints can be within a tolerance (metres) of a place.

    Links may touch neither each other nor the obstacles there.

    Args:
        thing: the object with joints.
        target: an object or a position.
        frame: name of a body or a site.
        down: whether the frame's Z axis is to point downwards.
        tolerance: metres.
        avoiding: objects that are obstacles; of a thing with joints all links.

    Raises:
        DescriptionError: there is no such frame.
        ScenicTypeError: an obstacle is no object.

    """
    description = description_of(thing.description)
    description.frame(frame)
    place = to_vector(getattr(target, "position", target), "`reaches`")
    question = _Question(str(description.path), frame, bool(down), float(tolerance))
    values = (thing.position, thing.orientation, place, *_values(avoiding))
    return call_later(question, *values) if any(map(is_random, values)) else question(*values)


def _values(obstacles: Iterable[object]) -> Iterator[Any]:
    """Yield the values that describe obstacles, one after the other."""
    for item in obstacles:
        if not is_body(item):
            raise wrong_type(OBJECT, item, "`avoiding`")
        parts: Any = getattr(item, "links", None) or {"": item}
        for part in parts.values():
            yield from (part.position, part.orientation, part.width, part.length, part.height, part.shape)


@dataclass(frozen=True, slots=True)
class _Question:
    path: str
    frame: str
    down: bool
    tolerance: float

    def __call__(self, base: Any, turn: Any, place: Any, *values: Any) -> bool:
        """Return whether there is a solution, given the pose of the base, the place in the world, and obstacles."""
        obstacles = [values[start : start + _EACH] for start in range(0, len(values), _EACH)]
        forms = tuple(
            (shape.mesh, (float(width), float(length), float(height)))
            for *_, width, length, height, shape in obstacles
        )
        arm = _arm(self.path, forms)
        back = quaternions.conjugate(np.array([turn.x, turn.y, turn.z, turn.w]))

        def local(point: Any) -> Floats:
            return quaternions.rotate(back, np.array(tuple(point)) - np.array(tuple(base))) + arm.origin

        arm.put(
            [
                (local(position), quaternions.multiply(back, np.array(orientation.q)))
                for position, orientation, *_ in obstacles
            ]
        )
        axis = quaternions.rotate(back, np.array([0.0, 0.0, -1.0])) if self.down else None
        return arm.solves(self.frame, local(place), down=axis, tolerance=self.tolerance)


class _Arm:
    """A description alone, its frame that of the world."""

    def __init__(self, path: str, obstacles: Sequence[Form] = ()) -> None:
        mujoco = library()
        self.description = description_of(path)
        self.origin = origin_of(self.description)
        spec = mujoco.MjSpec.from_file(path)
        for item in [item for item in spec.joints if item.type == mujoco.mjtJoint.mjJNT_FREE]:
            spec.delete(item)
        for number, (mesh, size) in enumerate(obstacles):
            body = spec.worldbody.add_body(name=f"obstacle {number}", mocap=True)
            for index, points in enumerate(mesh.derived(convex_parts) or (np.asarray(mesh.vertices),)):
                name = f"obstacle {number} {index}"
                spec.add_mesh(
                    name=name,
                    uservert=(points * size).ravel().tolist(),
                    inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
                )
                # Links touch it, other obstacles do not.
                body.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, contype=~0 & 0x7FFFFFFF, conaffinity=0
                )
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._jointed = Jointed(self, self.description, None, "")
        joints = self.description.joints.values()
        low = np.array([max(joint.low, -np.pi) for joint in joints])
        high = np.array([min(joint.high, np.pi) for joint in joints])
        draws = np.random.default_rng(0).uniform(low, high, (_MORE_STARTS - 1, len(low)))
        home = np.clip([joint.home for joint in joints], low, high)
        self._starts = np.concatenate([home[None], draws])

    def put(self, poses: Sequence[tuple[Floats, Floats]]) -> None:
        """Move the obstacles to places with orientations ``(x, y, z, w)``, in its own frame."""
        for number, (place, (x, y, z, w)) in enumerate(poses):
            slot = int(self.model.body(f"obstacle {number}").mocapid[0])
            self.data.mocap_pos[slot] = place
            self.data.mocap_quat[slot] = [w, x, y, z]

    def solves(self, frame: str, place: Floats, *, down: Floats | None, tolerance: float) -> bool:
        """Return whether some start leads to a solution without contacts."""
        mujoco = library()
        in_contact = False
        for number, start in enumerate(self._starts):
            if number >= _STARTS and not in_contact:
                return False
            self._set(dict(zip(self.description.joints, start.tolist(), strict=True)))
            values, left = self._jointed.solve(frame, place, down)
            if left > tolerance:
                continue
            self._set(values)
            mujoco.mj_forward(self.model, self.data)
            if not self.data.ncon or self.data.contact.dist.min() > -_DEEP:
                return True
            in_contact = True
        return False

    def _set(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            self.data.joint(name).qpos[0] = value


@lru_cache(maxsize=16)
def _arm(path: str, obstacles: tuple[Form, ...] = ()) -> _Arm:
    return _Arm(path, obstacles)
