"""What random values, vectors and orientations can do, in terms of a few hooks.

The methods are written once for definite and random values alike. How an operation is applied, at once or as a node of
the graph, is the business of `scenic.runtime.values.values`, which fills the hooks in.
"""

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

from scenic.runtime.values.lazy import Lazy, defer


class Operand:
    """What the methods below are made of: hooks that `scenic.runtime.values.values` fills in."""

    __slots__ = ()

    _operate: ClassVar["staticmethod[..., Any]"]
    """Apply an operation of the table, by name, to operands; ``payload`` is its data."""
    _vector: ClassVar["staticmethod[..., Any]"]
    """The vector of three numbers."""
    _to_scalar: ClassVar["staticmethod[[Any], Any]"]
    """A value as a number (section 4.3 of the specification)."""
    _to_vector: ClassVar["staticmethod[[Any], Any]"]
    """A value as a vector."""
    _to_orientation: ClassVar["staticmethod[[Any], Any]"]
    """A value as an orientation."""
    _as_drawn: ClassVar["staticmethod[[Callable[[Any, Any], Any], Any, Any], Any]"]
    """A function of two values, of which the second may be a choice among several kinds, or of a kind that only the draw shows."""
    _is_vector: ClassVar["staticmethod[[Any], bool]"]
    """Whether a value is a vector, or a pair or triple that stands for one."""
    _is_orientation: ClassVar["staticmethod[[Any], bool]"]
    """Whether a value is an orientation."""
    _with_vector: ClassVar["staticmethod[[str, Any, Any], Any]"]
    """Apply an operation to two values read as vectors; ``NotImplemented`` where one is none."""
    _with_number: ClassVar["staticmethod[[str, Any, Any], Any]"]
    """Apply an operation to a vector and a number; ``NotImplemented`` where it is none."""


class Arithmetic(Operand):
    """Python's arithmetic."""

    __slots__ = ()

    def __add__(self, other: Any) -> Any:
        return self._operate("add", self, other)

    def __radd__(self, other: Any) -> Any:
        return self._operate("add", other, self)

    def __sub__(self, other: Any) -> Any:
        return self._operate("subtract", self, other)

    def __rsub__(self, other: Any) -> Any:
        return self._operate("subtract", other, self)

    def __mul__(self, other: Any) -> Any:
        return self._operate("multiply", self, other)

    def __rmul__(self, other: Any) -> Any:
        return self._operate("multiply", other, self)

    def __truediv__(self, other: Any) -> Any:
        return self._operate("divide", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._operate("divide", other, self)

    def __floordiv__(self, other: Any) -> Any:
        return self._operate("floor divide", self, other)

    def __rfloordiv__(self, other: Any) -> Any:
        return self._operate("floor divide", other, self)

    def __mod__(self, other: Any) -> Any:
        return self._operate("modulo", self, other)

    def __rmod__(self, other: Any) -> Any:
        return self._operate("modulo", other, self)

    def __divmod__(self, other: Any) -> Any:
        return self._operate("divmod", self, other)

    def __rdivmod__(self, other: Any) -> Any:
        return self._operate("divmod", other, self)

    def __pow__(self, other: Any) -> Any:
        return self._operate("power", self, other)

    def __rpow__(self, other: Any) -> Any:
        return self._operate("power", other, self)

    def __neg__(self) -> Any:
        return self._operate("negative", self)

    def __pos__(self) -> Any:
        return self._operate("positive", self)

    def __abs__(self) -> Any:
        return self._operate("absolute", self)

    def __round__(self, digits: Any = None) -> Any:
        return self._operate("round", self) if digits is None else self._operate("round", self, digits)


class VectorMethods(Operand):
    """What a vector can do, definite or random."""

    __slots__ = ()

    @property
    def x(self) -> Any:
        """East, in metres."""
        return self._operate("component", self, payload=0)

    @property
    def y(self) -> Any:
        """North, in metres."""
        return self._operate("component", self, payload=1)

    @property
    def z(self) -> Any:
        """Up, in metres."""
        return self._operate("component", self, payload=2)

    def norm(self) -> Any:
        """Euclidean length."""
        return self._operate("norm", self)

    def dot(self, other: Any) -> Any:
        """Scalar product."""
        return self._operate("dot", self, self._to_vector(other))

    def cross(self, other: Any) -> Any:
        """Vector product."""
        return self._operate("cross", self, self._to_vector(other))

    def normalized(self) -> Any:
        """The unit vector of the same direction; the zero vector stays as it is."""
        return self._operate("normalized", self)

    def rotatedBy(self, rotation: Any) -> Any:
        """Rotated by an orientation, or by an angle about the vertical axis (radians, anticlockwise)."""
        return self._operate("rotate", self._to_orientation(rotation), self)

    def distanceTo(self, other: Any) -> Any:
        """Distance to another point, or to the nearest point of a region."""
        if isinstance(other, Lazy):
            return defer(self.distanceTo, other)
        return self._as_drawn(VectorMethods._distance_to, self, other)

    def _distance_to(self, other: Any) -> Any:
        space = getattr(other, "occupiedSpace", other)
        measure = getattr(space, "distance_from", None)
        return self._operate("distance", self, self._to_vector(other)) if measure is None else measure(self)

    def angleTo(self, other: Any) -> Any:
        """Azimuth of the direction to ``other`` (radians, from North, anticlockwise)."""
        return self._operate("azimuth", self._operate("subtract", self._to_vector(other), self))

    azimuthTo = angleTo

    def altitudeTo(self, other: Any) -> Any:
        """Altitude of the direction to ``other`` (radians above the horizon)."""
        return self._operate("altitude", self._operate("subtract", self._to_vector(other), self))

    def angleWith(self, other: Any) -> Any:
        """Signed angle in the plane from this vector to ``other`` (radians, within [-pi, pi])."""
        return self._operate(
            "normalize angle",
            self._operate(
                "subtract", self._operate("azimuth", self._to_vector(other)), self._operate("azimuth", self)
            ),
        )

    def offsetRotated(self, rotation: Any, offset: Any) -> Any:
        """This point displaced by ``offset`` read in the frame ``rotation``."""
        return self._operate(
            "add", self, self._operate("rotate", self._to_orientation(rotation), self._to_vector(offset))
        )

    def offsetLocally(self, orientation: Any, offset: Any) -> Any:
        """This point displaced by ``offset`` read in the frame ``orientation``."""
        return self.offsetRotated(orientation, offset)

    def offsetRadially(self, radius: Any, heading: Any) -> Any:
        """This point displaced by ``radius`` metres in the direction ``heading``."""
        return self.offsetRotated(heading, self._vector(0, radius, 0))

    def sphericalCoordinates(self) -> Any:
        """Length, azimuth (not normalised) and altitude, as a vector."""
        azimuth = self._operate("azimuth", self)
        return self._vector(self.norm(), azimuth, self._operate("altitude", self))

    def toVector(self) -> Any:
        """The vector itself; points and objects have the same method."""
        return self

    @property
    def coordinates(self) -> tuple[Any, Any, Any]:
        """The three coordinates, as a tuple."""
        return (self.x, self.y, self.z)

    def applyRotation(self, rotation: Any) -> Any:
        """The vector turned by an orientation."""
        return self.rotatedBy(rotation)

    def __add__(self, other: Any) -> Any:
        return self._with_vector("add", self, other)

    def __radd__(self, other: Any) -> Any:
        return self._with_vector("add", self, other)

    def __sub__(self, other: Any) -> Any:
        return self._with_vector("subtract", self, other)

    def __rsub__(self, other: Any) -> Any:
        return self._with_vector("subtract", other, self)

    def __mul__(self, other: Any) -> Any:
        return self._with_number("multiply", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self._with_number("divide", self, other)

    def __neg__(self) -> Any:
        return self._operate("negative", self)

    def __pos__(self) -> Any:
        return self

    def __len__(self) -> int:
        return 3

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, int) and -3 <= index < 3:
            return self._operate("component", self, payload=index % 3)
        if isinstance(index, slice):
            return (self.x, self.y, self.z)[index]
        if isinstance(index, int):
            raise IndexError("a vector has three components")
        if isinstance(index, Arithmetic):  # random
            return self._operate("getitem", self, index)
        raise TypeError(f"a vector is indexed by 0, 1 or 2, not by {index!r}")

    def __iter__(self) -> Iterator[Any]:
        return iter((self.x, self.y, self.z))


class OrientationMethods(Operand):
    """What an orientation can do, definite or random."""

    __slots__ = ()

    @property
    def yaw(self) -> Any:
        """Rotation about Z, the first of the intrinsic Euler angles (radians)."""
        return self._operate("euler", self, payload=0)

    @property
    def pitch(self) -> Any:
        """Rotation about the new X (radians)."""
        return self._operate("euler", self, payload=1)

    @property
    def roll(self) -> Any:
        """Rotation about the new Y (radians)."""
        return self._operate("euler", self, payload=2)

    @property
    def eulerAngles(self) -> Any:
        """Yaw, pitch and roll."""
        return (self.yaw, self.pitch, self.roll)

    @property
    def x(self) -> Any:
        """First imaginary part of the quaternion."""
        return self._operate("quaternion", self, payload=0)

    @property
    def y(self) -> Any:
        """Second imaginary part of the quaternion."""
        return self._operate("quaternion", self, payload=1)

    @property
    def z(self) -> Any:
        """Third imaginary part of the quaternion."""
        return self._operate("quaternion", self, payload=2)

    @property
    def w(self) -> Any:
        """Real part of the quaternion."""
        return self._operate("quaternion", self, payload=3)

    @property
    def q(self) -> tuple[Any, Any, Any, Any]:
        """The quaternion (x, y, z, w)."""
        return (self.x, self.y, self.z, self.w)

    @property
    def inverse(self) -> Any:
        """The opposite rotation."""
        return self._operate("inverse", self)

    def localAnglesFor(self, other: Any) -> Any:
        """Euler angles of ``other`` in this frame."""
        return self._operate("compose", self.inverse, self._to_orientation(other)).eulerAngles

    def globalToLocalAngles(self, yaw: Any, pitch: Any, roll: Any) -> Any:
        """Euler angles in this frame of the orientation that has these ones globally."""
        return self.localAnglesFor((yaw, pitch, roll))

    def toOrientation(self) -> Any:
        """The orientation itself."""
        return self

    def toHeading(self) -> Any:
        """Global yaw."""
        return self.yaw

    def __mul__(self, other: Any) -> Any:
        if self._is_orientation(other):
            return self._operate("compose", self, other)
        if self._is_vector(other):
            return self._operate("rotate", self, self._to_vector(other))
        return NotImplemented

    def __add__(self, other: Any) -> Any:
        return self._operate("compose", self, self._to_orientation(other))

    def __radd__(self, other: Any) -> Any:
        return self._operate("compose", self._to_orientation(other), self)
