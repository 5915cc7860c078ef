"""Methods of random values, vectors and orientations, written once for definite and random values alike."""

from collections.abc import Iterator
from typing import Any

from scenic.runtime.values.applying import operate
from scenic.runtime.values.choices import as_drawn
from scenic.runtime.values.coercions import to_orientation, to_vector, vector, with_number, with_vector
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.nodes import is_orientation, is_vector
from scenic.runtime.values.random_base import RandomBase


class Arithmetic:
    """Python's arithmetic."""

    __slots__ = ()

    def __add__(self, other: object) -> Any:
        return operate("add", self, other)

    def __radd__(self, other: object) -> Any:
        return operate("add", other, self)

    def __sub__(self, other: object) -> Any:
        return operate("subtract", self, other)

    def __rsub__(self, other: object) -> Any:
        return operate("subtract", other, self)

    def __mul__(self, other: object) -> Any:
        return operate("multiply", self, other)

    def __rmul__(self, other: object) -> Any:
        return operate("multiply", other, self)

    def __truediv__(self, other: object) -> Any:
        return operate("divide", self, other)

    def __rtruediv__(self, other: object) -> Any:
        return operate("divide", other, self)

    def __floordiv__(self, other: object) -> Any:
        return operate("floor divide", self, other)

    def __rfloordiv__(self, other: object) -> Any:
        return operate("floor divide", other, self)

    def __mod__(self, other: object) -> Any:
        return operate("modulo", self, other)

    def __rmod__(self, other: object) -> Any:
        return operate("modulo", other, self)

    def __divmod__(self, other: object) -> Any:
        return operate("divmod", self, other)

    def __rdivmod__(self, other: object) -> Any:
        return operate("divmod", other, self)

    def __pow__(self, other: object) -> Any:
        return operate("power", self, other)

    def __rpow__(self, other: object) -> Any:
        return operate("power", other, self)

    def __neg__(self) -> Any:
        return operate("negative", self)

    def __pos__(self) -> Any:
        return operate("positive", self)

    def __abs__(self) -> Any:
        return operate("absolute", self)

    def __round__(self, digits: object = None) -> Any:
        return operate("round", self) if digits is None else operate("round", self, digits)


class VectorMethods:
    """Methods of vectors, definite or random."""

    __slots__ = ()

    @property
    def x(self) -> Any:
        """East, in metres."""
        return operate("component", self, payload=0)

    @property
    def y(self) -> Any:
        """North, in metres."""
        return operate("component", self, payload=1)

    @property
    def z(self) -> Any:
        """Up, in metres."""
        return operate("component", self, payload=2)

    def norm(self) -> Any:
        """Return the Euclidean length."""
        return operate("norm", self)

    def dot(self, other: object) -> Any:
        """Return the scalar product."""
        return operate("dot", self, to_vector(other))

    def cross(self, other: object) -> Any:
        """Return the vector product."""
        return operate("cross", self, to_vector(other))

    def normalized(self) -> Any:
        """Return the unit vector of the same direction; the zero vector stays as it is."""
        return operate("normalized", self)

    def rotatedBy(self, rotation: object) -> Any:
        """Return the vector rotated by an orientation, or by an angle about the vertical axis (radians, anticlockwise)."""
        return operate("rotate", to_orientation(rotation), self)

    def distanceTo(self, other: object) -> Any:
        """Distance to another point, or to the nearest point of a region."""
        if isinstance(other, Lazy):
            return defer(self.distanceTo, other)
        return as_drawn(VectorMethods._distance_to, self, other)

    def _distance_to(self, other: object) -> Any:
        space = getattr(other, "occupiedSpace", other)
        measure = getattr(space, "distance_from", None)
        return operate("distance", self, to_vector(other)) if measure is None else measure(self)

    def angleTo(self, other: object) -> Any:
        """Return the azimuth of the direction to ``other`` (radians, from North, anticlockwise)."""
        return operate("azimuth", operate("subtract", to_vector(other), self))

    azimuthTo = angleTo

    def altitudeTo(self, other: object) -> Any:
        """Return the altitude of the direction to ``other`` (radians above the horizon)."""
        return operate("altitude", operate("subtract", to_vector(other), self))

    def angleWith(self, other: object) -> Any:
        """Return the signed angle in the plane from this vector to ``other`` (radians, within [-pi, pi])."""
        return operate(
            "normalize angle",
            operate("subtract", operate("azimuth", to_vector(other)), operate("azimuth", self)),
        )

    def offsetRotated(self, rotation: object, offset: object) -> Any:
        """This point displaced by ``offset`` read in the frame ``rotation``."""
        return operate("add", self, operate("rotate", to_orientation(rotation), to_vector(offset)))

    def offsetLocally(self, orientation: object, offset: object) -> Any:
        """This point displaced by ``offset`` read in the frame ``orientation``."""
        return self.offsetRotated(orientation, offset)

    def offsetRadially(self, radius: object, heading: object) -> Any:
        """This point displaced by ``radius`` metres in the direction ``heading``."""
        return self.offsetRotated(heading, vector(0, radius, 0))

    def sphericalCoordinates(self) -> Any:
        """Return the length, the azimuth (not normalised) and the altitude, as a vector."""
        azimuth = operate("azimuth", self)
        return vector(self.norm(), azimuth, operate("altitude", self))

    def toVector(self) -> Any:
        """Return the vector itself; points and objects have the same method."""
        return self

    @property
    def coordinates(self) -> tuple[Any, Any, Any]:
        """The three coordinates, as a tuple."""
        return (self.x, self.y, self.z)

    def applyRotation(self, rotation: object) -> Any:
        """Return the vector turned by an orientation."""
        return self.rotatedBy(rotation)

    def __add__(self, other: object) -> Any:
        return with_vector("add", self, other)

    def __radd__(self, other: object) -> Any:
        return with_vector("add", self, other)

    def __sub__(self, other: object) -> Any:
        return with_vector("subtract", self, other)

    def __rsub__(self, other: object) -> Any:
        return with_vector("subtract", other, self)

    def __mul__(self, other: object) -> Any:
        return with_number("multiply", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Any:
        return with_number("divide", self, other)

    def __neg__(self) -> Any:
        return operate("negative", self)

    def __pos__(self) -> Any:
        return self

    def __len__(self) -> int:
        return 3

    def __getitem__(self, index: object) -> Any:
        if isinstance(index, int) and -3 <= index < 3:
            return operate("component", self, payload=index % 3)
        if isinstance(index, slice):
            return (self.x, self.y, self.z)[index]
        if isinstance(index, int):
            raise IndexError("a vector has three components")
        if isinstance(index, RandomBase):
            return operate("getitem", self, index)
        raise TypeError(f"a vector is indexed by 0, 1 or 2, not by {index!r}")

    def __iter__(self) -> Iterator[Any]:
        return iter((self.x, self.y, self.z))


class OrientationMethods:
    """Methods of orientations, definite or random."""

    __slots__ = ()

    @property
    def yaw(self) -> Any:
        """Rotation about Z, the first of the intrinsic Euler angles (radians)."""
        return operate("euler", self, payload=0)

    @property
    def pitch(self) -> Any:
        """Rotation about the new X (radians)."""
        return operate("euler", self, payload=1)

    @property
    def roll(self) -> Any:
        """Rotation about the new Y (radians)."""
        return operate("euler", self, payload=2)

    @property
    def eulerAngles(self) -> Any:
        """Yaw, pitch and roll."""
        return (self.yaw, self.pitch, self.roll)

    @property
    def x(self) -> Any:
        """First imaginary part of the quaternion."""
        return operate("quaternion", self, payload=0)

    @property
    def y(self) -> Any:
        """Second imaginary part of the quaternion."""
        return operate("quaternion", self, payload=1)

    @property
    def z(self) -> Any:
        """Third imaginary part of the quaternion."""
        return operate("quaternion", self, payload=2)

    @property
    def w(self) -> Any:
        """Real part of the quaternion."""
        return operate("quaternion", self, payload=3)

    @property
    def q(self) -> tuple[Any, Any, Any, Any]:
        """The quaternion (x, y, z, w)."""
        return (self.x, self.y, self.z, self.w)

    @property
    def inverse(self) -> Any:
        """The opposite rotation."""
        return operate("inverse", self)

    def localAnglesFor(self, other: object) -> Any:
        """Return the Euler angles of ``other`` in this frame."""
        return operate("compose", self.inverse, to_orientation(other)).eulerAngles

    def globalToLocalAngles(self, yaw: object, pitch: object, roll: object) -> Any:
        """Return the Euler angles, in this frame, of the orientation with the given global ones."""
        return self.localAnglesFor((yaw, pitch, roll))

    def toOrientation(self) -> Any:
        """Return the orientation itself."""
        return self

    def toHeading(self) -> Any:
        """Return the global yaw."""
        return self.yaw

    def __mul__(self, other: object) -> Any:
        if is_orientation(other):
            return operate("compose", self, other)
        if is_vector(other):
            return operate("rotate", self, to_vector(other))
        return NotImplemented

    def __add__(self, other: object) -> Any:
        return operate("compose", self, to_orientation(other))

    def __radd__(self, other: object) -> Any:
        return operate("compose", to_orientation(other), self)
