"""Kinds of values, as far as the text of a program shows them: number, vector, region, object of a class, ...

`None` stands for all that is not certain, of which nothing may be said. `values` infers the kinds of expressions.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final, NamedTuple

from scenic.language.properties import attributes_of, properties_of
from scenic.language.types import Type

__all__ = [
    "BOOLEAN",
    "CLASS",
    "FIELD",
    "FUNCTION",
    "NOTHING",
    "NUMBER",
    "NUMBERS",
    "ORIENTATION",
    "RANGE",
    "REGION",
    "SEQUENCES",
    "SHAPE",
    "TEXT",
    "VECTOR",
    "WORKSPACE",
    "ValueKind",
    "accepts",
    "joint",
    "kind_of_type",
]


class ValueKind(NamedTuple):
    """A kind of values.

    ``name`` is the noun for messages. ``size`` is the number of elements of a tuple or list that stands in the text.
    ``members`` are the attributes and methods of an object, ``None`` if they are not all known. ``items`` is the kind of all
    elements of a sequence, and of all values of a dictionary, ``None`` if that is not certain; ``odd`` is the kind of an element that
    is certainly not a number.
    """

    name: str
    size: int | None = None
    members: frozenset[str] | None = None
    items: "ValueKind | None" = None
    odd: "ValueKind | None" = None

    @property
    def phrase(self) -> str:
        """The noun with its article."""
        if self.name in ("text", "nothing"):
            return "`None`" if self.name == "nothing" else "text"
        noun = self.name if self.size is None else f"{self.name} of {self.size}"
        return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


NUMBER: Final = ValueKind("number")
BOOLEAN: Final = ValueKind("boolean")
TEXT: Final = ValueKind("text")
NOTHING: Final = ValueKind("nothing")
VECTOR: Final = ValueKind("vector")
ORIENTATION: Final = ValueKind("orientation")
REGION: Final = ValueKind("region")
WORKSPACE: Final = ValueKind("workspace")
SHAPE: Final = ValueKind("shape")
FIELD: Final = ValueKind("vector field")
FUNCTION: Final = ValueKind("function")
CLASS: Final = ValueKind("class")
RANGE: Final = ValueKind("range")


def _built_in(name: str, cls: str) -> ValueKind:
    """Return the kind of the direct instances of a built-in class."""
    return ValueKind(name, members=frozenset(properties_of(cls)).union(attributes_of(cls)))


ORIENTED_POINT: Final = _built_in("oriented point", "OrientedPoint")
VECTORS: Final = ValueKind("tuple", items=VECTOR)

SEQUENCES: Final = frozenset({"tuple", "list"})
"""Kinds of values with elements in an order."""
NUMBERS: Final = frozenset({"number", "boolean"})
"""Kinds of values that can be used as numbers."""
_OF_TYPE: Final[Mapping[str, ValueKind]] = MappingProxyType(
    {
        "scalar": NUMBER,
        "vector": VECTOR,
        "orientation": ORIENTATION,
        "region": REGION,
        "shape": SHAPE,
        "vector field": FIELD,
        "boolean": BOOLEAN,
        "oriented point": ORIENTED_POINT,
        "tuple of vectors": VECTORS,
        "list of points": ValueKind("list", items=VECTOR),
        "text": TEXT,
    }
)
"""The kinds of declared types; of others nothing is known."""


def kind_of_type(declared: str) -> ValueKind | None:
    """Return the kind of values of a declared type, if it is one word."""
    return _OF_TYPE.get(declared)


def joint(kinds: Sequence[ValueKind | None]) -> ValueKind | None:
    """Return the kind of a value that has one of some kinds; ``None`` if they differ."""
    first = kinds[0] if kinds else None
    if first is None or any(each is None or each.name != first.name for each in kinds):
        return None
    definite_kinds = [each for each in kinds if each is not None]
    if all(each == first for each in definite_kinds):
        return first
    members: frozenset[str] | None = frozenset()
    for each in definite_kinds:
        members = None if members is None or each.members is None else members | each.members
    sizes = {each.size for each in definite_kinds}
    return ValueKind(
        first.name,
        sizes.pop() if len(sizes) == 1 else None,
        members,
        joint([each.items for each in definite_kinds]),
    )


def accepts(types: Sequence[Type], kind: ValueKind) -> bool:
    """Return whether values of a kind may be given where any of some types will do; true if that is not certain."""
    name = kind.name
    for each in types:
        if each.kinds is None or name in each.kinds:
            return True
    return name in SEQUENCES and any(_accepts_sequence(each, kind) for each in types)


def _accepts_sequence(wanted: Type, kind: ValueKind) -> bool:
    """Return whether a tuple or list may be given where a type is wanted, for its elements."""
    if wanted.items is not None:
        return kind.items is None or accepts((wanted.items,), kind.items)
    fits = bool(wanted.lengths) and (kind.size is None or kind.size in wanted.lengths)
    return fits and kind.odd is None and (kind.items is None or kind.items.name in NUMBERS)
