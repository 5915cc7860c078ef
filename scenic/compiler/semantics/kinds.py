"""Kinds of values, as far as the text of a program shows them: number, vector, region, object of a class, ...

What an expression gives is inferred from literals, from calls of what the language provides, from its operators, and
through names that are bound just once. `None` stands for all that is not certain, of which nothing may be said.
"""

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.names import Names
from scenic.dataclass import dataclass
from scenic.language.members import INSTANCE_METHODS, MEMBERS, Member, members_of
from scenic.language.names import NAMES, NameKind
from scenic.language.operators import OPERATORS
from scenic.language.properties import attributes_of, properties_of
from scenic.language.types import INSTANCES, Type

__all__ = ["NUMBERS", "KindOf", "ValueKind", "accepts", "joint", "kind_of_type"]


@dataclass(frozen=True, slots=True)
class ValueKind:
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
    """The kind of the direct instances of a built-in class."""
    return ValueKind(name, members=frozenset(properties_of(cls)).union(attributes_of(cls)))


ORIENTED_POINT: Final = _built_in("oriented point", "OrientedPoint")
VECTORS: Final = ValueKind("tuple", items=VECTOR)

_MADE_BY_CALLS: Final = (NameKind.SHAPE, NameKind.REGION, NameKind.DISTRIBUTION)
"""Names that stand for a value only when they are called."""

_SEQUENCES: Final = frozenset({"tuple", "list"})
NUMBERS: Final = frozenset({"number", "boolean"})
"""Kinds of values that can be used as numbers."""
_RUN: Final = frozenset({"behavior", "monitor", "scenario"})
"""Kinds of values that calls of their definitions make."""
_MOST_PARTS: Final = 64
"""Number of elements of a tuple or list that are examined."""

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

_DEEPEST: Final = 20
"""Depth to which values are examined."""


def kind_of_type(declared: str) -> ValueKind | None:
    """The kind of values of a declared type, if it is one word."""
    return _OF_TYPE.get(declared)


def joint(kinds: Sequence[ValueKind | None]) -> ValueKind | None:
    """The kind of a value that has one of some kinds; ``None`` if they differ."""
    first = kinds[0] if kinds else None
    if first is None or any(each is None or each.name != first.name for each in kinds):
        return None
    known = [each for each in kinds if each is not None]
    if all(each == first for each in known):
        return first
    members: frozenset[str] | None = frozenset()
    for each in known:
        members = None if members is None or each.members is None else members | each.members
    sizes = {each.size for each in known}
    return ValueKind(
        first.name, sizes.pop() if len(sizes) == 1 else None, members, joint([each.items for each in known])
    )


def accepts(types: Sequence[Type], kind: ValueKind) -> bool:
    """Return whether values of a kind may be given where any of some types will do; true if that is not certain."""
    if any(each.kinds is None for each in types):
        return True
    if kind.name in _SEQUENCES:
        return any(_accepts_sequence(each, kind) for each in types)
    return any(kind.name in (each.kinds or ()) for each in types)


def _accepts_sequence(wanted: Type, kind: ValueKind) -> bool:
    """Return whether a tuple or list may be given where a type is wanted."""
    if kind.name in (wanted.kinds or ()):
        return True
    if wanted.items is not None:
        return kind.items is None or accepts((wanted.items,), kind.items)
    fits = bool(wanted.lengths) and (kind.size is None or kind.size in wanted.lengths)
    return fits and kind.odd is None and (kind.items is None or kind.items.name in NUMBERS)


class KindOf:
    """Infers kinds of the expressions of one program; keeps what it has inferred."""

    def __init__(self, names: Names, classes: Classes) -> None:
        self._names = names
        self._classes = classes
        self._known: dict[ast.expr, ValueKind | None] = {}

    def __call__(self, node: ast.expr | None, depth: int = 0) -> ValueKind | None:
        """The kind of what an expression gives; ``None`` if it is not certain."""
        if node is None or depth > _DEEPEST:
            return None
        if node not in self._known:
            self._known[node] = None  # A name that is bound to itself.
            self._known[node] = self._infer(node, depth + 1)
        return self._known[node]

    def _infer(self, node: ast.expr, depth: int) -> ValueKind | None:
        match node:
            case ast.Constant(value=value):
                return _of_constant(value)
            case ast.JoinedStr():
                return TEXT
            case ast.Lambda():
                return FUNCTION
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                return self._display("tuple" if isinstance(node, ast.Tuple) else "list", parts, depth)
            case ast.ListComp(elt=element):
                return ValueKind("list", items=self(element, depth))
            case ast.Dict(values=values):
                return ValueKind("dictionary", items=self._joint(values, depth))
            case ast.DictComp(value=value):
                return ValueKind("dictionary", items=self(value, depth))
            case ast.Subscript(value=value, slice=index):
                return self._item(value, index, depth)
            case ast.Set() | ast.SetComp():
                return ValueKind("set")
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

    def _instance(self, cls: ast.expr) -> ValueKind | None:
        base = self._classes.base(cls)
        name = {"Point": "point", "OrientedPoint": "oriented point"}.get(base or "", "object")
        return ValueKind(name if base is not None else "object", members=self._classes.members(cls))

    def _joint(self, options: Iterable[ast.expr], depth: int) -> ValueKind | None:
        return joint([self(option, depth) for option in options])

    def _display(self, name: str, parts: Sequence[ast.expr], depth: int) -> ValueKind:
        """The kind of a tuple or list in the text."""
        if any(isinstance(part, ast.Starred) for part in parts):
            return ValueKind(name)
        kinds = [self(part, depth) for part in parts[:_MOST_PARTS]]
        odd = next((each for each in kinds if each is not None and each.name not in NUMBERS), None)
        return ValueKind(name, len(parts), items=joint(kinds) if len(parts) <= _MOST_PARTS else None, odd=odd)

    def _item(self, value: ast.expr, index: ast.expr, depth: int) -> ValueKind | None:
        """The kind of ``value[index]``."""
        owner = self(value, depth)
        if owner is None or isinstance(index, ast.Slice):
            return None
        if owner == VECTOR:
            return NUMBER
        return owner.items if owner.name in (*_SEQUENCES, "dictionary") else None

    @staticmethod
    def _binary(left: ValueKind | None, right: ValueKind | None, operator: ast.operator) -> ValueKind | None:
        if left == NUMBER == right:
            return NUMBER
        if left == VECTOR and right == NUMBER and isinstance(operator, ast.Mult | ast.Div):
            return VECTOR
        if left == NUMBER and right == VECTOR and isinstance(operator, ast.Mult):
            return VECTOR
        if VECTOR in (left, right) and isinstance(operator, ast.Add | ast.Sub) and left == right:
            return VECTOR
        return None

    def _call(self, node: ast.Call, depth: int) -> ValueKind | None:
        function = node.func
        if isinstance(function, ast.Attribute):
            found = self.method(function, depth)
            return None if found is None or found.result is None else kind_of_type(found.result.name)
        name = self._names.provided(function)
        if name is None:
            defined = self._classes.defined(function)
            if defined in _RUN:
                return ValueKind(defined)
            returned = self._names.returned(function) if defined == "function" else ()
            return self._joint(returned, depth) if returned else None
        if name not in NAMES:
            return None
        result = NAMES[name].result
        if result is not None:
            return kind_of_type(result.name)
        if name in ("abs", "round", "min", "max"):
            numbers = len(node.args) and all(self(each, depth) == NUMBER for each in node.args)
            return NUMBER if numbers else None
        if name in ("Uniform", "Options", "Discrete") and not node.keywords:
            return joint([self._option(option, node, depth) for option in _options(node)])
        return {"Workspace": WORKSPACE, "str": TEXT, "localPath": TEXT, "range": RANGE}.get(name)

    def _option(self, option: ast.expr, choice: ast.Call, depth: int) -> ValueKind | None:
        """The kind of an option of a choice; of ``*values`` that of the elements."""
        if option is choice:
            return None
        if not isinstance(option, ast.Starred):
            return self(option, depth)
        kind = self(option.value, depth)
        return kind.items if kind is not None and kind.name in _SEQUENCES else None

    def method(self, function: ast.Attribute, depth: int = 0) -> Member | None:
        """The declared method that a call of an attribute calls."""
        owner = self(function.value, depth)
        if owner is None:
            if self._names.provided(function.value) == "Orientation":
                return MEMBERS["orientation"].get(function.attr) if function.attr.startswith("from") else None
            return None
        if owner.name in INSTANCES:
            return None if function.attr in self._names.owners else INSTANCE_METHODS.get(function.attr)
        found = members_of(owner.name).get(function.attr)
        return found if found is not None and found.is_method else None

    def _attribute(self, node: ast.Attribute, depth: int) -> ValueKind | None:
        owner = self(node.value, depth)
        if owner is None:
            return None
        if owner.name not in INSTANCES:
            member = members_of(owner.name).get(node.attr)
            if member is None or member.is_method or member.result is None:
                return None
            return kind_of_type(member.result.name)
        cls = {"point": "Point", "oriented point": "OrientedPoint"}.get(owner.name, "Object")
        declared = properties_of(cls).get(node.attr)
        if declared is not None:
            return kind_of_type(declared.type)
        attribute = attributes_of(cls).get(node.attr)
        return None if attribute is None or attribute.is_method else kind_of_type(attribute.type)

    def _name(self, node: ast.Name, depth: int) -> ValueKind | None:
        name = self._names.provided(node)
        if name == "ego":
            return ValueKind("object", members=self._classes.ego_members())
        if name in ("everywhere", "nowhere"):
            return REGION
        if name is not None:
            declared = NAMES[name].kind if name in NAMES else None
            return (
                FUNCTION if declared is NameKind.FUNCTION else CLASS if declared in _MADE_BY_CALLS else None
            )
        annotation = self._names.annotation(node)
        if annotation is not None:
            return self._annotated(annotation)
        defined = self._classes.defined(node)
        if defined is not None:
            return ValueKind(defined)
        found = self._names.only_value(node)
        if found is None:
            brought = self._names.kind_of_brought(node)
            return None if brought is None else kind_of_type(brought)
        value, in_turn = found
        if in_turn:
            is_range = isinstance(value, ast.Call) and self._names.provided(value.func) == "range"
            of = None if is_range else self(value, depth)
            return NUMBER if is_range else of.items if of is not None and of.name in _SEQUENCES else None
        kind = self(value, depth)
        if kind is not None and kind.name in ("list", "dictionary"):
            # Lists grow.
            return ValueKind(kind.name, items=None if node.id in self._names.grown else kind.items)
        return kind

    def _annotated(self, annotation: ast.expr) -> ValueKind | None:
        name = self._names.provided(annotation)
        if name in ("int", "float", "str", "Vector", "Orientation", "VectorField"):
            kinds = {"str": TEXT, "Vector": VECTOR, "Orientation": ORIENTATION, "VectorField": FIELD}
            return kinds.get(name, NUMBER)
        return self._instance(annotation) if self._classes.members(annotation) is not None else None


def _options(node: ast.Call) -> Iterator[ast.expr]:
    """Yield the options of a choice that the text shows; the call itself stands for unknown options."""
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if name == "Discrete" and not any(isinstance(each, ast.Dict) for each in node.args):
        yield node
        return
    of_sequence = name == "Options" and len(node.args) == 1
    for argument in node.args:
        if of_sequence and isinstance(argument, ast.List | ast.Tuple):
            yield from (node if isinstance(each, ast.Starred) else each for each in argument.elts)
        elif of_sequence and not isinstance(argument, ast.Dict):
            yield node
        elif isinstance(argument, ast.Dict):
            yield from (node if key is None else key for key in argument.keys)
        else:
            yield argument
    if not node.args:
        yield node


def _of_constant(value: object) -> ValueKind | None:
    if value is None:
        return NOTHING
    if isinstance(value, bool):
        return BOOLEAN
    if isinstance(value, int | float):
        return NUMBER
    return TEXT if isinstance(value, str) else None
