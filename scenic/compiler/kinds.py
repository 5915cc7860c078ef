"""Kinds of values, as far as the text of a program shows them: number, vector, region, object of a class, ...

What an expression gives is inferred from literals, from calls of what the language provides, from its operators, and
through names that are bound just once. `None` stands for all that is not certain, of which nothing may be said.
"""

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final, Protocol

from scenic.compiler import tree as scenic
from scenic.dataclass import dataclass
from scenic.language.names import NAMES, NameKind
from scenic.language.operators import OPERATORS
from scenic.language.properties import attributes_of, properties_of
from scenic.language.types import INSTANCES, Type

__all__ = ["Kind", "KindOf", "accepts", "kind_of_type"]


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of values.

    ``name`` is the noun for messages. ``size`` is the number of elements of a tuple or list that stands in the text.
    ``members`` are the attributes and methods of an object, ``None`` if they are not all known.
    """

    name: str
    size: int | None = None
    members: frozenset[str] | None = None

    @property
    def phrase(self) -> str:
        """The noun with its article."""
        if self.name in ("text", "nothing"):
            return "`None`" if self.name == "nothing" else "text"
        noun = self.name if self.size is None else f"{self.name} of {self.size}"
        return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


NUMBER: Final = Kind("number")
BOOLEAN: Final = Kind("boolean")
TEXT: Final = Kind("text")
NOTHING: Final = Kind("nothing")
VECTOR: Final = Kind("vector")
ORIENTATION: Final = Kind("orientation")
REGION: Final = Kind("region")
WORKSPACE: Final = Kind("workspace")
SHAPE: Final = Kind("shape")
FIELD: Final = Kind("vector field")
FUNCTION: Final = Kind("function")
CLASS: Final = Kind("class")
ORIENTED_POINT: Final = Kind("oriented point")

_MADE_BY_CALLS: Final = (NameKind.SHAPE, NameKind.REGION, NameKind.DISTRIBUTION)
"""Names that stand for a value only when they are called."""

_SEQUENCES: Final = frozenset({"tuple", "list"})

_OF_TYPE: Final[Mapping[str, Kind]] = MappingProxyType(
    {
        "scalar": NUMBER,
        "vector": VECTOR,
        "orientation": ORIENTATION,
        "region": REGION,
        "shape": SHAPE,
        "vector field": FIELD,
        "boolean": BOOLEAN,
        "oriented point": ORIENTED_POINT,
    }
)
"""The kinds of declared types; of others nothing is known."""

_DEEPEST: Final = 20
"""Depth to which values are examined."""


def kind_of_type(declared: str) -> Kind | None:
    """The kind of values of a declared type, if it is one word."""
    return _OF_TYPE.get(declared)


def accepts(types: Sequence[Type], kind: Kind) -> bool:
    """Return whether values of a kind may be given where any of some types will do; true if that is not certain."""
    if any(each.kinds is None for each in types):
        return True
    if kind.name in _SEQUENCES:
        lengths = {length for each in types for length in each.lengths}
        return bool(lengths) and (kind.size is None or kind.size in lengths)
    return any(kind.name in (each.kinds or ()) for each in types)


class Meanings(Protocol):
    """The meanings of the names of a program."""

    def provided(self, name: ast.expr) -> str | None:
        """The name of what the language provides."""

    def only_value(self, name: ast.Name) -> tuple[ast.expr, bool] | None:
        """The expression that is certainly bound to a name; true if it is the parts of that expression in turn."""

    def annotation(self, name: ast.Name) -> ast.expr | None:
        """The annotation of the parameter that a name certainly is."""

    def members(self, cls: ast.expr) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class of objects."""

    def ego_members(self) -> frozenset[str] | None:
        """All attributes and methods of the ego."""

    def base(self, cls: ast.expr) -> str | None:
        """The built-in class from which a class derives."""


class KindOf:
    """Infers kinds of the expressions of one program; keeps what it has inferred."""

    def __init__(self, meanings: Meanings) -> None:
        self._meanings = meanings
        self._known: dict[ast.expr, Kind | None] = {}

    def __call__(self, node: ast.expr | None, depth: int = 0) -> Kind | None:
        """The kind of what an expression gives; ``None`` if it is not certain."""
        if node is None or depth > _DEEPEST:
            return None
        if node not in self._known:
            self._known[node] = None  # A name that is bound to itself.
            self._known[node] = self._infer(node, depth + 1)
        return self._known[node]

    def _infer(self, node: ast.expr, depth: int) -> Kind | None:
        match node:
            case ast.Constant(value=value):
                return _of_constant(value)
            case ast.JoinedStr():
                return TEXT
            case ast.Lambda():
                return FUNCTION
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                spread = any(isinstance(part, ast.Starred) for part in parts)
                return Kind(
                    "tuple" if isinstance(node, ast.Tuple) else "list", None if spread else len(parts)
                )
            case ast.Dict() | ast.DictComp():
                return Kind("dictionary")
            case ast.Set() | ast.SetComp():
                return Kind("set")
            case scenic.New(cls=cls):
                return self._instance(cls)
            case ast.IfExp(body=body, orelse=orelse):
                return self._joint((body, orelse), depth)
            case ast.UnaryOp(op=ast.Not()):
                return BOOLEAN
            case ast.UnaryOp(operand=operand):
                return NUMBER if self(operand, depth) == NUMBER else None
            case ast.BinOp(left=left, right=right):
                return self._binary(self(left, depth), self(right, depth), node.op)
            case scenic.Operation(operator="deg", operands=[operand]):
                return self(operand, depth)
            case scenic.Operation(operator=name):
                return kind_of_type(OPERATORS[name].result) if name in OPERATORS else None
            case ast.Call():
                return self._call(node, depth)
            case ast.Attribute():
                return self._attribute(node, depth)
            case ast.Name():
                return self._name(node, depth)
        return None

    def _instance(self, cls: ast.expr) -> Kind | None:
        base = self._meanings.base(cls)
        name = {"Point": "point", "OrientedPoint": "oriented point"}.get(base or "", "object")
        return Kind(name if base is not None else "object", members=self._meanings.members(cls))

    def _joint(self, options: Iterable[ast.expr], depth: int) -> Kind | None:
        kinds = {self(option, depth) for option in options}
        return kinds.pop() if len(kinds) == 1 else None

    @staticmethod
    def _binary(left: Kind | None, right: Kind | None, operator: ast.operator) -> Kind | None:
        if left == NUMBER == right:
            return NUMBER
        if VECTOR in (left, right) and isinstance(operator, ast.Add | ast.Sub) and left == right:
            return VECTOR
        return None

    def _call(self, node: ast.Call, depth: int) -> Kind | None:
        function = node.func
        if isinstance(function, ast.Attribute):
            owner = self(function.value, depth)
            if owner in (REGION, WORKSPACE) and function.attr in ("intersect", "union", "difference"):
                return REGION
            if owner in (REGION, WORKSPACE) and function.attr in (
                "intersects",
                "containsPoint",
                "containsObject",
            ):
                return BOOLEAN
            if owner == VECTOR and function.attr in ("norm", "distanceTo", "angleTo", "azimuthTo", "dot"):
                return NUMBER
            named = self._meanings.provided(function.value)
            return ORIENTATION if named == "Orientation" and function.attr.startswith("from") else None
        name = self._meanings.provided(function)
        if name is None or name not in NAMES:
            return None
        result = NAMES[name].result
        if result is not None:
            return kind_of_type(result.name)
        if name in ("abs", "round", "min", "max"):
            numbers = len(node.args) and all(self(each, depth) == NUMBER for each in node.args)
            return NUMBER if numbers else None
        if name in ("Uniform", "Options", "Discrete") and not node.keywords:
            return self._joint(_options(node), depth)
        return {"Workspace": WORKSPACE, "str": TEXT, "localPath": TEXT}.get(name)

    def _attribute(self, node: ast.Attribute, depth: int) -> Kind | None:
        owner = self(node.value, depth)
        if owner in (VECTOR, ORIENTATION) and node.attr in ("x", "y", "z", "yaw", "pitch", "roll"):
            return NUMBER
        if owner is None or owner.name not in INSTANCES:
            return None
        cls = {"point": "Point", "oriented point": "OrientedPoint"}.get(owner.name, "Object")
        declared = properties_of(cls).get(node.attr)
        if declared is not None:
            return kind_of_type(declared.type)
        attribute = attributes_of(cls).get(node.attr)
        return None if attribute is None or attribute.is_method else kind_of_type(attribute.type)

    def _name(self, node: ast.Name, depth: int) -> Kind | None:
        name = self._meanings.provided(node)
        if name == "ego":
            return Kind("object", members=self._meanings.ego_members())
        if name in ("everywhere", "nowhere"):
            return REGION
        if name is not None:
            declared = NAMES[name].kind if name in NAMES else None
            return (
                FUNCTION if declared is NameKind.FUNCTION else CLASS if declared in _MADE_BY_CALLS else None
            )
        annotation = self._meanings.annotation(node)
        if annotation is not None:
            return self._annotated(annotation)
        found = self._meanings.only_value(node)
        if found is None:
            return None
        value, in_turn = found
        if not in_turn:
            kind = self(value, depth)
            # Lists grow.
            return Kind("list") if kind is not None and kind.name == "list" else kind
        if isinstance(value, ast.List | ast.Tuple) and value.elts:
            return self._joint(value.elts, depth)
        is_range = isinstance(value, ast.Call) and self._meanings.provided(value.func) == "range"
        return NUMBER if is_range else None

    def _annotated(self, annotation: ast.expr) -> Kind | None:
        name = self._meanings.provided(annotation)
        if name in ("int", "float", "str", "Vector", "Orientation", "VectorField"):
            kinds = {"str": TEXT, "Vector": VECTOR, "Orientation": ORIENTATION, "VectorField": FIELD}
            return kinds.get(name, NUMBER)
        return self._instance(annotation) if self._meanings.members(annotation) is not None else None


def _options(node: ast.Call) -> Iterator[ast.expr]:
    """Yield the options of a choice that the text shows; the call itself stands for unknown options."""
    of_sequence = isinstance(node.func, ast.Name) and node.func.id == "Options" and len(node.args) == 1
    for argument in node.args:
        if of_sequence and isinstance(argument, ast.List | ast.Tuple):
            yield from (node if isinstance(each, ast.Starred) else each for each in argument.elts)
        elif of_sequence and not isinstance(argument, ast.Dict):
            yield node
        elif isinstance(argument, ast.Dict):
            yield from (node if key is None else key for key in argument.keys)
        elif isinstance(argument, ast.Starred):
            yield node
        else:
            yield argument
    if not node.args:
        yield node


def _of_constant(value: object) -> Kind | None:
    if value is None:
        return NOTHING
    if isinstance(value, bool):
        return BOOLEAN
    if isinstance(value, int | float):
        return NUMBER
    return TEXT if isinstance(value, str) else None
