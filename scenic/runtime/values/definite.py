"""Definite vectors and orientations: plain rows of floats, with the methods that random ones have, too."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, Self

import numpy as np

from scenic.graph import quaternions
from scenic.language.errors import ScenicTypeError
from scenic.runtime.ground.context import here
from scenic.runtime.values.applying import operate, scalar_of
from scenic.runtime.values.coercions import from_euler, to_orientation, vector
from scenic.runtime.values.describing import describe
from scenic.runtime.values.lazy import defer, is_lazy
from scenic.runtime.values.methods import OrientationMethods, VectorMethods
from scenic.runtime.values.random_base import is_random
from scenic.runtime.values.rows import OrientationRow, VectorRow
from scenic.runtime.values.source_text import plain_number

_ADD, _SUBTRACT, _MULTIPLY, _ROTATE = map(scalar_of, ("add", "subtract", "multiply", "rotate"))


class Vector(VectorRow, VectorMethods, length=3):
    """A definite vector: three floats, in metres. ``Vector(x, y, z)`` with a random coordinate is a random vector."""

    __slots__ = ()

    def __new__(cls, x: Any, y: Any, z: Any = 0) -> Any:
        if is_random(x) or is_random(y) or is_random(z):
            return vector(x, y, z)
        try:
            return cls.of((float(x), float(y), float(z)))
        except (TypeError, ValueError):
            if is_lazy((x, y, z)):
                return defer(cls, x, y, z)
            raise ScenicTypeError(
                f"`Vector` needs three numbers, not {describe((x, y, z))}",
                span=here(),
                help="coordinates are in metres",
            ) from None

    @property
    def x(self) -> float:
        return self._row[0]

    @property
    def y(self) -> float:
        return self._row[1]

    @property
    def z(self) -> float:
        return self._row[2]

    # The operations that running simulations do most, without a detour.

    def __add__(self, other: object) -> Any:
        if type(other) is Vector:
            return Vector.of(_ADD(None, self._row, other._row))
        return super().__add__(other)

    def __sub__(self, other: object) -> Any:
        if type(other) is Vector:
            return Vector.of(_SUBTRACT(None, self._row, other._row))
        return super().__sub__(other)

    def __mul__(self, other: object) -> Any:
        if type(other) is float or type(other) is int:
            return Vector.of(_MULTIPLY(None, self._row, float(other)))
        return super().__mul__(other)

    __rmul__ = __mul__

    def rotatedBy(self, rotation: object) -> Any:
        """Return the rotated vector as `VectorMethods` does, but without its general dispatch."""
        turn = to_orientation(rotation)
        if type(turn) is Orientation:
            return Vector.of(_ROTATE(None, turn._row, self._row))
        return operate("rotate", turn, self)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Vector):
            return self._row == other._row
        if isinstance(other, tuple | list):
            return len(other) in (2, 3) and self._row == tuple(other) + (0,) * (3 - len(other))
        return NotImplemented

    def __hash__(self) -> int:
        return hash(self._row)

    def index(self, value: object) -> int:
        """Return the axis of the first coordinate that is equal to a number; raises ``ValueError`` where none is."""
        return self._row.index(value)

    def count(self, value: object) -> int:
        """Number of coordinates that are equal to a number."""
        return self._row.count(value)

    def __repr__(self) -> str:
        return "Vector({}, {}, {})".format(*map(plain_number, self._row))

    def __array__(self, dtype: Any = None, copy: object = None) -> Any:
        return np.array(self._row, dtype=dtype)

    def __reduce__(self) -> tuple[Any, ...]:
        return Vector, self._row

    def __deepcopy__(self, _memo: object) -> Self:
        return self  # nothing of it can change

    def __copy__(self) -> Self:
        return self


class OrientedVector(Vector):
    """A vector with the heading, in radians, that a region prefers there."""

    __slots__ = ("heading",)
    heading: float

    def __new__(cls, x: Any, y: Any, z: Any, heading: float) -> Self:
        return cls.make((x, y, z), heading)

    @classmethod
    def make(cls, position: Iterable[float], heading: float) -> Self:
        """The vector of three numbers, with a heading."""
        self = cls.of(float(part) for part in position)
        self.heading = heading
        return self

    def toHeading(self) -> float:
        """Return the heading."""
        return self.heading

    def __reduce__(self) -> tuple[Any, ...]:
        return OrientedVector, (*self._row, self.heading)


# So that ``case (x, y, z)`` fits a vector.
Sequence.register(Vector)


class Orientation(OrientationRow, OrientationMethods, length=4):
    """A definite orientation: a unit quaternion. Made by `fromEuler` or `fromQuaternion`, or from SciPy's ``Rotation``."""

    __slots__ = ()

    def __init__(self, rotation: object = None) -> None:
        if rotation is not None and not hasattr(rotation, "as_quat"):
            raise ScenicTypeError(
                f"`Orientation` takes a rotation of SciPy, not {describe(rotation)}",
                span=here(),
                help="use `Orientation.fromEuler(yaw, pitch, roll)` or `Orientation.fromQuaternion((x, y, z, w))`",
            )
        self._row = (0.0, 0.0, 0.0, 1.0) if rotation is None else tuple(rotation.as_quat().tolist())

    @staticmethod
    def fromEuler(yaw: object, pitch: object, roll: object) -> Any:
        """Return the intrinsic rotations about Z, the new X and the new Y (radians)."""
        return from_euler(yaw, pitch, roll)

    @classmethod
    def fromQuaternion(cls, quaternion: Sequence[float]) -> "Orientation":
        """Return the orientation of (x, y, z, w), normalised; raises ``ValueError`` for the zero quaternion."""
        x, y, z, w = (float(part) for part in quaternion)
        length = math.sqrt(x * x + y * y + z * z + w * w)
        if not (length > 0 and math.isfinite(length)):
            raise ValueError(f"not a rotation: quaternion {tuple(quaternion)}")
        return cls.of((x / length, y / length, z / length, w / length))

    @property
    def x(self) -> float:
        """First imaginary part of the quaternion."""
        return self._row[0]

    @property
    def y(self) -> float:
        """Second imaginary part of the quaternion."""
        return self._row[1]

    @property
    def z(self) -> float:
        """Third imaginary part of the quaternion."""
        return self._row[2]

    @property
    def w(self) -> float:
        """Real part of the quaternion."""
        return self._row[3]

    @property
    def q(self) -> tuple[float, float, float, float]:
        """The quaternion (x, y, z, w)."""
        return self._row

    @property
    def r(self) -> Any:
        """The rotation as SciPy's ``Rotation``."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(self._row)

    def getRotation(self) -> Any:
        """Return the rotation as SciPy's ``Rotation``."""
        return self.r

    def approxEq(self, other: "Orientation", tol: float = 1e-10) -> bool:
        """Return whether the two differ by a rotation of at most about ``tol`` (up to the sign of the quaternion)."""
        product = sum(a * b for a, b in zip(self._row, other._row, strict=True))
        return bool(abs(product) >= 1 - tol)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Orientation):
            return NotImplemented
        return self._row == other._row or self._row == tuple(-part for part in other._row)

    def __hash__(self) -> int:
        sign = next((part for part in reversed(self._row) if part != 0), 1.0)
        return hash(tuple(part if sign > 0 else -part for part in self._row))

    @property
    def yaw(self) -> float:
        """Rotation about Z, the first of the intrinsic Euler angles (radians)."""
        return quaternions.euler_angle(self._row, 0)

    @property
    def eulerAngles(self) -> tuple[float, float, float]:
        """Yaw, pitch and roll."""
        return quaternions.euler_angles(self._row)

    def __repr__(self) -> str:
        return "Orientation.fromEuler({}, {}, {})".format(*map(plain_number, self.eulerAngles))
