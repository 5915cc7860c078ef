"""Values in words, for messages about those that cannot be used."""

from collections.abc import Sequence

from scenic.graph.kinds import Kind
from scenic.language.errors import ScenicTypeError
from scenic.language.types import Type, wanted
from scenic.runtime.ground.context import here
from scenic.runtime.values.random_base import RandomBase


def describe(value: object) -> str:
    """Return a value in words for a message."""
    if isinstance(value, RandomBase):
        kind_of_value = value.node.kind
        return "a random value" if kind_of_value is Kind.OTHER else f"a random {kind_of_value.value}"
    if value is None:
        return "None"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value)
    kind = type(value).__name__
    return f"{text} ({kind})" if len(text) < 40 else f"a value of type {kind}"


def wrong_type(types: Type | Sequence[Type] | str, value: object, what: str = "") -> ScenicTypeError:
    """Return the error for a value that has none of the types, or does not match a noun."""
    noun, hint = (
        (types, None) if isinstance(types, str) else wanted((types,) if isinstance(types, Type) else types)
    )
    if isinstance(value, type):
        is_scenic = hasattr(value, "scenic_properties")
        hint = f"to create an instance write `{'new ' * is_scenic}{value.__name__}{'()' * (not is_scenic)}`"
    prefix = f"{what}: " if what else ""
    return ScenicTypeError(f"{prefix}expected {noun}, not {describe(value)}", span=here(), help=hint)
