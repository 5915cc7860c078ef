"""Values of a kind that cannot be used where they stand, and attributes that values of a kind do not have."""

import ast
import sys
from collections.abc import Collection, Iterator
from functools import partial
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext, NodeRule
from scenic.compiler.checks.randomness import is_random
from scenic.compiler.checks.wanted import may_be_meant, wrong_kinds
from scenic.compiler.scopes import Scope, ScopeKind
from scenic.compiler.semantics.kinds import ValueKind
from scenic.compiler.traversal import walk
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.members import MEMBERS, members_of
from scenic.language.operators import OPERATORS
from scenic.language.properties import attributes_of, properties_of
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS
from scenic.language.spelling import distance, nearest, related
from scenic.language.types import INSTANCES

__all__ = ["RULES"]

_COMPLETE: Final = frozenset({"vector", "orientation"})
"""Kinds all of whose attributes and methods are declared."""

_COORDINATES: Final = frozenset({"x", "y", "z", "yaw", "pitch", "roll", "heading", "position", "orientation"})

_ELSEWHERE: Final = {
    **dict.fromkeys(("coordinates", "location", "pos", "translation", "xyz"), "position"),
    **dict.fromkeys(("quaternion", "rotation"), "orientation"),
    **dict.fromkeys(("angle", "direction", "theta"), "heading"),
    "bounding_box": "boundingBox",
}
"""Attributes of objects in other libraries, and those of the language that mean the same."""

_ORDERED: Final = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)

_PROPERTIES: Final = properties_of("Object")
_MEMBERS_OF_OBJECTS: Final = frozenset(_PROPERTIES) | frozenset(attributes_of("Object"))


def _specifiers(
    node: scenic.New | scenic.Override, scope: Scope, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report mistakes such as ``at 3``, ``with width "3"``."""
    if may_be_meant(node, scope, context) or context.is_cut(node):
        return
    for specifier in node.specifiers:
        if specifier.property is not None:
            declaration = _PROPERTIES.get(specifier.property)
            if declaration is not None and specifier.operands:
                title = f"`with {specifier.property}`"
                yield from wrong_kinds(title, declaration.types, specifier.operands[0], context)
        elif specifier.specifier in SPECIFIERS:
            element = SPECIFIERS[specifier.specifier]
            for operand, value in zip(element.operands, specifier.operands, strict=False):
                left_out = operand.default is not None and _is_none(value)
                # `in front of x` has a message of its own.
                if not left_out and not isinstance(value, scenic.Operation):
                    yield from wrong_kinds(partial(element.label, operand), operand.types, value, context)


def _operation(node: scenic.Operation, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``distance to 3``, ``position @ 3``."""
    if node.operator == "@" and not may_be_meant(node, scope, context):
        yield from _coordinates(node, context)
    if (
        node.operator == "at"
        and (kind := context.kind_of(node.operands[0])) is not None
        and kind.name in INSTANCES
    ):
        text = context.text(node.operands[1]) if node.operands[1] is not None else None
        yield context.error(
            "SC404",
            f"`at` after {kind.phrase}: only a vector field has a value at a place",
            node,
            f"a distance is given by `by`: `by {text or 'distance'}`; a further specifier begins after a comma",
        )
        return
    if node.operator in OPERATORS and node.operator != "@" and not may_be_meant(node, scope, context):
        operator = OPERATORS[node.operator]
        for operand, value in zip(operator.operands, node.operands, strict=False):
            if not _is_none(value):  # Mostly as if it were left out.
                yield from wrong_kinds(partial(operator.label, operand), operand.types, value, context)


_BETWEEN_TWO: Final = frozenset({"altitude", "angle", "distance", "minimum distance"})
"""Operators between two things, of which one may be left out."""


def _conjunction(node: ast.BoolOp, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC114 for ``distance from a and b``."""
    match node:
        case ast.BoolOp(op=ast.And(), values=[scenic.Operation(operator=name, operands=operands), other]):
            pass
        case _:
            return
    kind = context.kind_of(other)
    if name not in _BETWEEN_TWO or len(operands) != 2 or None not in operands:
        return
    if kind is None or not (kind.name in INSTANCES or kind.name == "vector"):
        return
    first, second = ("from", "to") if operands[1] is None else ("to", "from")
    operand = operands[0] or operands[1]
    if operand is None:
        return
    left, right = context.source.span(operand), context.source.span(other)
    between = Span(left.end_line, left.end_column, right.line, right.column)
    yield context.error(
        "SC114",
        f"`{name} {first} ... and ...` has no second end: `and` joins conditions",
        between if left.end_line == right.line else node,
        f"write `{name} {first} {context.text(operand) or '...'} {second} {context.text(other) or '...'}`",
        fix=Fix(f"Write `{second}`", (Edit(between, f" {second} "),)),
    )


def _coordinates(node: scenic.Operation, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC404 for ``place @ 3``, where ``place`` is a vector already."""
    for operand in node.operands:
        kind = context.kind_of(operand)
        if operand is not None and kind is not None and kind.name in _NO_COORDINATES:
            yield context.error(
                "SC404",
                f"`@` makes a vector of two numbers, and this is {kind.phrase}",
                operand,
                "write `x @ y` with numbers; a vector is used as it is, or moved by `offset by`",
            )


_NO_COORDINATES: Final = frozenset(
    {"dictionary", "list", "object", "oriented point", "point", "region", "tuple", "vector"}
)


def _is_none(value: ast.expr | None) -> bool:
    return isinstance(value, ast.Constant) and value.value is None


def _property(node: scenic.PropertyDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``width: "3"``, ``size: self.lenth``."""
    declared = _PROPERTIES.get(node.name)
    if declared is not None and "additive" not in node.attributes:
        yield from wrong_kinds(f"`{node.name}`", declared.types, node.value, context)


def _assign(node: ast.Assign, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``workspace = room``, ``ego = 3``."""
    kind = context.kind_of(node.value)
    if isinstance(node.value, ast.Tuple) and (
        len(node.value.elts) < 2 or any(isinstance(part, scenic.New) for part in node.value.elts)
    ):
        kind = None  # The comma is reported, or the line goes on after it.
    for target in node.targets if kind is not None else ():
        name = context.provided(target)
        if kind is not None and kind.name == "workspace" and isinstance(target, ast.Name):
            yield from _workspace(target, context)
        if kind is None or name not in ("ego", "workspace"):
            continue
        if name == "workspace" and kind.name != "workspace":
            yield context.error(
                "SC404",
                f"the workspace must be a `Workspace`, not {kind.phrase}",
                node.value,
                f"write `workspace = Workspace({context.text(node.value) or 'region'})`"
                if kind.name == "region"
                else "write `workspace = Workspace(region)`",
                fix=context.replacement(
                    "Make a workspace", node.value, f"Workspace({context.text(node.value)})"
                )
                if kind.name == "region" and context.text(node.value)
                else None,
            )
        elif name == "ego" and kind.name not in ("object", "class"):
            yield context.error(
                "SC404",
                f"the ego must be an object, not {kind.phrase}",
                node.value,
                "make one with `new Object`",
            )


_NOT_CALLED: Final = frozenset(
    {*INSTANCES, "number", "boolean", "text", "vector", "list", "tuple", "dictionary"}
)
"""Kinds of values that cannot be called."""


def _call(node: ast.Call, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC404 for ``angle from ego (3, 4)``, where ``to`` is missing, ``3 (x)``."""
    kind = context.kind_of(node.func)
    if kind is None or kind.name not in _NOT_CALLED or may_be_meant(node, scope, context):
        return
    if kind.name in INSTANCES and kind.members is None:
        return  # A class in another file may define `__call__`.
    word = "to" if any(_ends_with(each, node) for each, _ in context.nodes(scenic.Operation)) else None
    yield context.error(
        "SC404",
        f"{kind.phrase} cannot be called",
        node,
        f"a word is missing before the parentheses, such as `{word}`"
        if word
        else "a comma, an operator or a word is missing before the parentheses",
    )


def _ends_with(operation: scenic.Operation, node: ast.Call) -> bool:
    """Return whether a call is the last operand of an operator with ``from``."""
    return operation.operator in _MEASURES and any(operand is node for operand in operation.operands)


_MEASURES: Final = frozenset({"distance", "angle", "altitude", "relative heading", "apparent heading"})


def _workspace(target: ast.Name, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``workspce = Workspace(region)``."""
    if distance(target.id, "workspace", limit=2) in (1, 2):
        yield context.warning(
            "SC307",
            f"a workspace counts only under the name `workspace`, not `{target.id}`",
            target,
            "did you mean `workspace`?",
            fix=context.renaming(target, target.id, "workspace"),
        )


def _mutate(node: scenic.Mutate, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``mutate room``."""
    for target in node.targets:
        kind = context.kind_of(target)
        if kind is not None and kind.name not in INSTANCES:
            yield context.error(
                "SC404",
                f"`mutate` needs points or objects, not {kind.phrase}",
                target,
                "name an object, or leave the name out to mutate all",
            )


_DEFINED: Final = frozenset({"behavior", "class", "function", "monitor", "scenario"})
"""Kinds of definitions, of which SC203 says more."""


def _new(node: scenic.New, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``new table`` where ``table`` is an object."""
    yield from _specifiers(node, scope, context)
    kind = context.kind_of(node.cls)
    if kind is not None and (kind.name not in _DEFINED or context.provided(node.cls) is not None):
        yield context.error(
            "SC404",
            f"`new` needs a class of objects, and `{node.cls.id}` is {kind.phrase}",
            node.cls,
            "name a class, such as `Object`, or define one with `class`",
        )


def _compare(node: ast.Compare, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``ego.position > 3``."""
    if may_be_meant(node, scope, context):
        return
    sides = [node.left, *node.comparators]
    for operator, left, right in zip(node.ops, sides, sides[1:], strict=False):
        kinds = context.kind_of(left), context.kind_of(right)
        if isinstance(operator, ast.In | ast.NotIn):
            yield from _contained(node, *kinds, context)
        if not isinstance(operator, _ORDERED):
            continue
        if None not in kinds and {kind.name for kind in kinds if kind is not None} == {"text", "number"}:
            yield context.error(
                "SC404",
                "text is neither smaller nor larger than a number",
                node,
                "write numbers without quotes",
            )
            return
        wrong = next((kind for kind in kinds if kind is not None and _is_unordered(kind)), None)
        if wrong is not None:
            yield context.error(
                "SC404",
                f"{wrong.phrase} is neither smaller nor larger than anything",
                node,
                "compare numbers: a coordinate such as `x.position.y`, or `distance from x to y`",
            )
            return


def _contained(
    node: ast.Compare, item: ValueKind | None, container: ValueKind | None, context: CheckContext
) -> Iterator[Diagnostic]:
    """Report mistakes such as ``ego in 3``, ``3 in room``."""
    if container is not None and container.name in _WITHOUT_ITEMS:
        yield context.error(
            "SC404",
            f"`in` needs a region or a collection, not {container.phrase}",
            node,
            "name a region, or write a list or tuple of what it can be",
        )
    elif (
        container is not None
        and item is not None
        and container.name in ("region", "workspace")
        and item.name in ("number", "text", "boolean", "nothing")
    ):
        yield context.error(
            "SC404",
            f"a region contains points and objects, not {item.phrase}",
            node,
            "write a point, as `(x, y)`, or name an object",
        )


def _arithmetic(node: ast.BinOp, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``ego.width + "3"``, ``ego.position + 3``."""
    yield from _counted(node, scope, context)
    if not isinstance(node.op, ast.Add | ast.Sub | ast.Div):
        return
    kinds = context.kind_of(node.left), context.kind_of(node.right)
    if None in kinds or may_be_meant(node, scope, context):
        return
    left, right = (kind.name for kind in kinds if kind is not None)
    sign = _SIGNS[type(node.op)]
    if "text" in (left, right) and left != right and {left, right} <= _APART:
        other = next(kind.phrase for kind in kinds if kind is not None and kind.name != "text")
        yield context.error(
            "SC404",
            f"`{sign}`: text and {other} cannot be combined",
            node,
            'write numbers without quotes, and make text of a value by `str(value)` or `f"{value}"`',
        )
    elif not isinstance(node.op, ast.Div) and {left, right} in _UNLIKE:
        phrases = sorted(kind.phrase for kind in kinds if kind is not None)
        yield context.error(
            "SC404",
            f"`{sign}`: {phrases[0]} and {phrases[1]} cannot be combined",
            node,
            "a vector is moved by a vector: write `position + (x, y)`, or `position offset by (x, y)`",
        )


def _counted(node: ast.BinOp, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC404 for ``2 * range(0, 3)``."""
    for side in (node.left, node.right):
        if not isinstance(side, ast.Call) or context.provided(side.func) != "range":
            continue
        text = context.text(side)
        if text is not None and not may_be_meant(node, scope, context):
            yield context.error(
                "SC404",
                "`range` counts: its result is no number",
                side,
                f"a random number between two bounds is `Range{text[len('range') :]}`",
                fix=context.renaming(side.func, "range", "Range"),
            )


_UNLIKE: Final = (
    {"vector", "number"}, {"tuple", "number"}, {"list", "number"}, {"region", "number"}, {"region", "vector"}, {"tuple", "list"},
)  # fmt: skip
"""Pairs of kinds that can be neither added nor subtracted."""
_APART: Final = frozenset({"text", "number", "vector", "tuple", "list", "nothing", "boolean"})
_SIGNS: Final = {ast.Add: "+", ast.Sub: "-", ast.Div: "/"}


def _subscript(node: ast.Subscript, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``Uniform[1, 2]``, ``ego.width[0]``."""
    key = node.slice.value if isinstance(node.slice, ast.Constant) else None
    if (
        isinstance(key, str)
        and isinstance(node.ctx, ast.Load)
        and context.provided(node.value) == "globalParameters"
    ):
        yield from _parameter(key, context.source.span(node.slice), context)
        return
    kind = context.kind_of(node.value)
    if kind is None or kind.name not in _WITHOUT_ITEMS or may_be_meant(node, scope, context):
        return
    name = context.provided(node.value)
    yield context.error(
        "SC404",
        f"{kind.phrase} has no items" if name is None else f"`{name}` has no items",
        node,
        "take items of lists, tuples and dictionaries"
        if name is None
        else f"call it with parentheses: `{name}(...)`",
    )


def _loop(node: ast.For, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report mistakes such as ``for i in 3``."""
    kind = context.kind_of(node.iter)
    if kind is None or kind.name not in _WITHOUT_ITEMS or may_be_meant(node, scope, context):
        return
    if is_random(node.iter, context):
        return  # `randomness` reports that.
    text = context.text(node.iter)
    is_number = kind.name == "number" and text
    yield context.error(
        "SC404",
        f"`for` goes through the items of a value, and {kind.phrase} has none",
        node.iter,
        f"write `range({text})` to count" if is_number else "name a list, or count with `range(n)`",
    )


_WITHOUT_ITEMS: Final = frozenset({"number", "boolean", "nothing", "class", "function"})


def _is_unordered(kind: ValueKind) -> bool:
    return kind.name in INSTANCES or kind.name in ("vector", "orientation", "region", "workspace", "nothing")


def _attribute(node: ast.Attribute, scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC214 for ``ego.positon``, ``Vector(1, 2).lenght()``."""
    name = node.attr
    if isinstance(node.ctx, ast.Store) and context.provided(node.value) == "globalParameters":
        yield context.error(
            "SC123",
            "global parameters are set by `param`, not by assignment",
            node,
            f"write `param {name} = value` at the top level",
        )
    if not isinstance(node.ctx, ast.Load) or name.startswith("_"):
        return
    if context.provided(node.value) == "globalParameters":
        yield from _parameter(node.attr, _end(node, context), context)
        return
    if context.writes_any_attribute:
        return
    kind = context.kind_of(node.value)
    if kind is None and isinstance(node.value, ast.Name) and node.value.id == "self":
        yield from _of_agent(node, context)
    if kind is None or name in context.asked_attributes or may_be_meant(node, scope, context):
        return
    if kind.name == "number" and name in _COORDINATES:
        yield context.error(
            "SC214",
            f"a number has no attribute `{name}`",
            _end(node, context),
            f"take `{name}` of a vector, an orientation or an object",
        )
        return
    if kind.name in INSTANCES:
        members = kind.members
        if members is None or name in members or name in context.given or name in context.stored_attributes:
            return
        if name in MEMBERS["vector"]:
            return  # Points have the attributes of their positions.
    else:
        members = frozenset(members_of(kind.name))
        if not members or name in members:
            return
    yield from _unknown_attribute(node, kind, members, context)


def _unknown_attribute(
    node: ast.Attribute, kind: ValueKind, known: Collection[str], context: CheckContext
) -> Iterator[Diagnostic]:
    """Report an attribute that is not among the known ones."""
    name = node.attr
    similar_name = nearest(name, known)
    if similar_name is None and kind.name in INSTANCES:
        similar_name = _ELSEWHERE.get(name) or related(
            name, {each for each in known if not each.startswith("_")}
        )
    place = _end(node, context)
    if similar_name is None and kind.name not in _COMPLETE:
        # Python code may give it to some of them.
        # Some regions have more, but nothing of the language is written with underscores.
        is_open = kind.name not in INSTANCES and not (kind.name == "region" and "_" in name)
        if not is_open and name not in _MEMBERS_OF_OBJECTS and not _has_python(context):
            declared_names = (each for each in known if each in _PROPERTIES or kind.name == "region")
            ways = f"a class declares more (`{name}: value`), or `with {name} value`"
            yield context.warning(
                "SC214",
                f"{kind.phrase} has no attribute `{name}`, and nothing in this program gives it one",
                place,
                f"its attributes are {', '.join(sorted(declared_names)[:6])}, ..."
                + ("" if kind.name == "region" else f"; {ways}"),
            )
        return
    yield context.error(
        "SC214",
        f"{kind.phrase} has no attribute `{name}`",
        place,
        f"did you mean `{similar_name}`?"
        if similar_name
        else f"its attributes are {', '.join(sorted(known)[:6])}, ...",
        fix=context.renaming(place, name, similar_name) if similar_name else None,
    )


def _has_python(context: CheckContext) -> bool:
    """Return whether code may set or ask attributes in ways that the text does not show, as modules other than the standard library's may."""
    if context.resolution.reflective or any(
        context.mentions(each) for each in ("getattr", "hasattr", "setattr")
    ):
        return True
    names = [alias.name for node, _ in context.nodes(ast.Import) for alias in node.names]
    names += [node.module or "" for node, _ in context.nodes(ast.ImportFrom)]
    return any(each.partition(".")[0] not in (*sys.stdlib_module_names, "scenic") for each in names)


def _of_agent(node: ast.Attribute, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC214 for ``self.spped`` in a behavior or monitor, whose agent may be of any class."""
    binding = context.binding(node.value) if isinstance(node.value, ast.Name) else None
    if binding is None or binding.scope.kind not in (ScopeKind.BEHAVIOR, ScopeKind.MONITOR):
        return
    name = node.attr
    names = context.given | context.stored_attributes | context.owners.keys() | _MEMBERS_OF_OBJECTS
    similar_name = None if name in names else nearest(name, _MEMBERS_OF_OBJECTS)
    if similar_name is None or any(name == item.name for item, _ in context.nodes(scenic.PropertyDef)):
        return
    if name in context.properties_brought:
        return
    place = _end(node, context)
    yield context.warning(
        "SC214",
        f"no class of this program has a property `{name}`",
        place,
        f"did you mean `{similar_name}`?",
        fix=context.renaming(place, name, similar_name),
    )


def _parameter(name: str, place: Span, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC214 for ``globalParameters.sped``, ``globalParameters['sped']``."""
    names = context.parameters
    similar_name = nearest(name, names)
    if name in names or similar_name is None:
        return
    yield context.warning(
        "SC214",
        f"this program sets no parameter `{name}`",
        place,
        f"did you mean `{similar_name}`?",
        fix=context.renaming(place, name, similar_name)
        if place.end_column - place.column == len(name)
        else None,
    )


def _end(node: ast.Attribute, context: CheckContext) -> Span:
    """The place of the name after the dot."""
    whole = context.source.span(node)
    start = max(0, whole.end_column - len(node.attr))
    return Span(whole.end_line, start, whole.end_line, whole.end_column)


def _class(node: ast.ClassDef, _scope: Scope, context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC214 for ``size: self.lenth * 2``, in the defaults of a class."""
    defaults = [item.value for item in node.body if isinstance(item, scenic.PropertyDef)]
    cls = context.class_at(node) if defaults else None
    members = None if cls is None or context.writes_any_attribute else cls.names
    if members is None:
        return
    for default in defaults:
        for part in walk(default):
            if (
                isinstance(part, ast.Attribute)
                and isinstance(part.value, ast.Name)
                and part.value.id == "self"
                and part.attr not in members
                and part.attr not in context.given
            ):
                yield from _of_self(part, node.name, members, context)


def _of_self(
    node: ast.Attribute, name: str, known: frozenset[str], context: CheckContext
) -> Iterator[Diagnostic]:
    similar_name = nearest(node.attr, known)
    if similar_name is None or node.attr in context.stored_attributes:
        return  # A class that derives from it may have the property.
    place = _end(node, context)
    yield context.error(
        "SC214",
        f"`{name}` has no property `{node.attr}`",
        place,
        f"did you mean `{similar_name}`?",
        fix=context.renaming(place, node.attr, similar_name),
    )


RULES: Final[dict[type[ast.AST], NodeRule]] = {
    ast.Assign: _assign,
    ast.Attribute: _attribute,
    ast.BinOp: _arithmetic,
    ast.BoolOp: _conjunction,
    ast.Call: _call,
    ast.ClassDef: _class,
    ast.Compare: _compare,
    ast.For: _loop,
    ast.Subscript: _subscript,
    scenic.Mutate: _mutate,
    scenic.New: _new,
    scenic.Operation: _operation,
    scenic.PropertyDef: _property,
    scenic.Override: _specifiers,
}
