"""Values in words, for messages about those that cannot be used."""

from types import MappingProxyType
from typing import Any

from scenic.graph.kinds import Kind
from scenic.language.errors import ScenicTypeError
from scenic.runtime.program.context import here
from scenic.runtime.values.random_values import Random


def describe(value: Any) -> str:
    """A value in words for a message."""
    if isinstance(value, Random):
        known = value.node.kind
        return "a random value" if known is Kind.OTHER else f"a random {known.value}"
    if value is None:
        return "None"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value)
    kind = type(value).__name__
    return f"{text} ({kind})" if len(text) < 40 else f"a value of type {kind}"


_ADVICE = MappingProxyType(
    {
        "a number": "numbers are written plainly, drawn as by `Range(1, 2)`, or measured as by `distance to x`",
        "a vector": "write `(x, y, z)` or `x @ y`, or name a point or an object",
        "a heading": "write an angle, as `30 deg`, or name an oriented point or an object",
        "an orientation (a heading, Euler angles or an oriented point)": "write three Euler angles `(yaw, pitch, roll)`, or name an oriented point or an object",
        "a region": "make one, as `CircularRegion((0, 0), 5)`, or take one of an object, as `x.topSurface`",
        "a shape": "make one, as `BoxShape()` or `MeshShape.fromFile(path)`",
        "an object": "make one with `new Object`",
        "a point or an object": "make one with `new Point` or `new Object`",
        "an oriented point": "make one with `new OrientedPoint`, or give an object",
        "a region, an object or a vector": "name an object, or make a region, as `CircularRegion((0, 0), 5)`",
        "an object or a region": "name an object, or make a region, as `CircularRegion((0, 0), 5)`",
        "a pair of angles": "write two angles, as `(90 deg, 45 deg)`",
    }
)
"""What to write where something of a type is wanted."""


def wrong_type(wanted: str, value: Any, what: str = "") -> ScenicTypeError:
    """The error for a value that cannot be read as ``wanted``."""
    hint = _ADVICE.get(wanted)
    if isinstance(value, type):
        is_scenic = hasattr(value, "scenic_properties")
        hint = f"to create an instance write `{'new ' * is_scenic}{value.__name__}{'()' * (not is_scenic)}`"
    prefix = f"{what}: " if what else ""
    return ScenicTypeError(f"{prefix}expected {wanted}, not {describe(value)}", span=here(), help=hint)
