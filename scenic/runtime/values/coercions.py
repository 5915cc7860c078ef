"""Readings of values as numbers, vectors, headings and orientations for operators and specifiers (section 4.3 of the specification)."""

import math
from collections.abc import Callable
from typing import Any

from scenic.graph import quaternions
from scenic.graph.kinds import Kind
from scenic.graph.operation import Operation, always, by_lane
from scenic.graph.operations import TABLE
from scenic.language.errors import ScenicTypeError
from scenic.language.types import HEADING, ORIENTATION, SCALAR, VECTOR
from scenic.runtime.ground.context import here
from scenic.runtime.values.applying import apply, operate
from scenic.runtime.values.choices import drawn_option, select
from scenic.runtime.values.describing import wrong_type
from scenic.runtime.values.generic import as_orientation, as_vector
from scenic.runtime.values.lazy import Lazy, defer
from scenic.runtime.values.nodes import ROWS, as_node, is_number, is_orientation, is_vector
from scenic.runtime.values.random_base import RandomBase
from scenic.runtime.values.rows import OrientationRow, VectorRow, orientation_of, vector_of


def to_scalar(value: object, what: str = "") -> Any:
    """A real number, as a float."""
    if type(value) is float:
        return value
    if isinstance(value, Lazy):
        return defer(to_scalar, value, what)
    if isinstance(value, RandomBase):
        if value.node.kind is Kind.SCALAR:
            return value
        if value.node.kind.is_number:
            return operate("float", value)
        if value.node.kind.is_boxed:
            if all(option.kind.is_number for option in value.node.operands[1:]):
                # A choice among integers and floats: as floats its options have one kind, which analysis understands.
                return _coerce_boxed(value, Kind.SCALAR, to_scalar, what)
            return _coerce_later(value, Kind.SCALAR, to_scalar, what)
    elif is_number(value):
        return float(value)
    raise wrong_type(SCALAR, value, what)


def to_vector(value: Any, what: str = "") -> Any:
    """Return a vector: also a pair (z = 0), a triple, and anything with a position."""
    if isinstance(value, VectorRow):
        return value
    if isinstance(value, Lazy):
        return defer(to_vector, value, what)
    if isinstance(value, RandomBase):
        if value.node.kind is Kind.VECTOR:
            return value
        if value.node.kind.is_boxed:
            return _coerce_boxed(value, Kind.VECTOR, to_vector, what)
        raise wrong_type(VECTOR, value, what)
    if isinstance(value, ROWS):
        if len(value) not in (2, 3):
            raise ScenicTypeError(
                f"{what + ': ' if what else ''}a vector has 2 or 3 coordinates, not {len(value)}",
                span=here(),
            )
        return vector(*value)
    if hasattr(value, "toVector") and not isinstance(value, type):
        return value.toVector()
    if getattr(value, "geom_type", None) == "Point":  # shapely's
        return vector(*next(iter(value.coords)))
    raise wrong_type(VECTOR, value, what)


def to_heading(value: object, what: str = "") -> Any:
    """Return a heading in radians: a number, the global yaw of an orientation, the heading of an oriented point."""
    if type(value) is float:
        return value
    if isinstance(value, Lazy):
        return defer(to_heading, value, what)
    if isinstance(value, RandomBase):
        if value.node.kind.is_number:
            return to_scalar(value)
        if value.node.kind is Kind.ORIENTATION:
            return operate("euler", value, payload=0)
        if value.node.kind.is_boxed:
            return _coerce_boxed(value, Kind.SCALAR, to_heading, what)
    elif is_number(value):
        return float(value)
    elif hasattr(value, "toHeading") and not isinstance(value, type):
        return value.toHeading()
    raise wrong_type(HEADING, value, what)


def to_orientation(value: object, what: str = "") -> Any:
    """Return an orientation: also a heading, a triple of Euler angles, and anything that has an orientation."""
    if isinstance(value, OrientationRow):
        return value
    if type(value) is float:
        return from_euler(value, 0.0, 0.0)
    if isinstance(value, Lazy):
        return defer(to_orientation, value, what)
    if isinstance(value, RandomBase):
        if value.node.kind is Kind.ORIENTATION:
            return value
        if value.node.kind.is_number:
            return from_euler(value, 0, 0)
        if value.node.kind is Kind.VECTOR:
            return from_euler(*(operate("component", value, payload=axis) for axis in range(3)))
        if value.node.kind.is_boxed:
            return _coerce_boxed(value, Kind.ORIENTATION, to_orientation, what)
    elif is_number(value):
        return from_euler(value, 0, 0)
    elif isinstance(value, VectorRow) or (isinstance(value, ROWS) and len(value) == 3):
        return from_euler(*value)
    elif hasattr(value, "toOrientation") and not isinstance(value, type):
        return value.toOrientation()
    raise wrong_type(ORIENTATION, value, what)


def from_euler(yaw: object, pitch: object, roll: object) -> Any:
    """Return the orientation of intrinsic rotations about Z, the new X and the new Y (radians)."""
    if (
        type(yaw) is float
        and type(pitch) is float
        and type(roll) is float
        and math.isfinite(yaw + pitch + roll)
    ):
        return orientation_of(quaternions.of_euler(yaw, pitch, roll))
    return operate("from euler", *map(to_scalar, (yaw, pitch, roll)))


def vector(x: object, y: object, z: object = 0) -> Any:
    """The vector of three numbers."""
    if type(x) is float and type(y) is float and type(z) is float:
        return vector_of((x, y, z))
    if is_number(x) and is_number(y) and is_number(z):
        return vector_of((float(x), float(y), float(z)))
    return operate("vector", to_scalar(x), to_scalar(y), to_scalar(z))


def _coerce_boxed(value: RandomBase, kind: Kind, function: Callable[..., Any], what: str) -> Any:
    """Coerce option by option where ``value`` is a choice, else when it is sampled."""
    if value.node.operation is TABLE["select"]:
        index, *options = value.node.operands
        return select(index, [as_node(function(drawn_option(option), what)) for option in options])
    return _coerce_later(value, kind, function, what)


def _coerce_later(value: RandomBase, kind: Kind, function: Callable[..., Any], what: str) -> Any:
    return when_drawn(value, kind, lambda sampled: function(sampled, what))


def when_drawn(
    value: RandomBase,
    kind: Kind,
    function: Callable[[Any], Any],
    together: Callable[[list[Any]], list[Any] | None] | None = None,
) -> Any:
    """The result of a function of the value that is drawn; ``together`` is the function over a list (see `Operation`)."""
    operation = Operation(
        f"to {kind.value}",
        always(kind),
        by_lane,
        "A coercion that has to wait for the sampled value.",
        python=function,
        together=together,
    )
    return apply(operation, value)


def with_vector(name: str, left: object, right: object) -> Any:
    """An operation on two values read as vectors; ``NotImplemented`` where one is none."""
    try:
        return operate(name, to_vector(left), to_vector(right))
    except ScenicTypeError:
        return NotImplemented


def with_number(name: str, left: object, right: object) -> Any:
    """An operation on a vector and a number; ``NotImplemented`` where it is none."""
    is_scalar = is_number(right) or isinstance(right, RandomBase)
    if is_scalar and not is_vector(right) and not is_orientation(right):
        return operate(name, left, to_scalar(right))
    return NotImplemented


as_vector.register(object, to_vector)
as_orientation.register(object, to_orientation)
