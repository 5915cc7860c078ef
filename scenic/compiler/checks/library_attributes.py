"""Attributes that the values of world models do not have: ``network.lane``.

The class of such a value follows from annotations of the library.
"""

import ast
import os
import re
from collections.abc import Collection, Iterator, Mapping
from types import MappingProxyType
from typing import Final

from scenic.compiler.checks.context import CheckContext
from scenic.compiler.checks.wanted import is_attempt
from scenic.compiler.scopes import Resolution
from scenic.compiler.semantics.classes import Class, is_of_library
from scenic.compiler.semantics.modules import Exported
from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.members import MEMBERS
from scenic.language.properties import attributes_of, properties_of
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.language.spelling import distance, nearest, related

__all__ = ["check_library_attributes"]

_OF_SEQUENCES: Final = frozenset({*dir(tuple), *dir(list), *dir(set)})
_COMMON: Final = frozenset(properties_of("Object")).union(attributes_of("Object"), *MEMBERS.values())


def check_library_attributes(context: CheckContext) -> Iterator[Diagnostic]:
    """Reports slips in attributes of what star imports and the model bring."""
    imports, resolution = context.brought, context.resolution
    if not any(each.module is not None and is_of_library(each.module.filename) for each in imports.values()):
        return
    if context.writes_any_attribute:
        return
    members = context.stored_attributes | context.given | context.asked_attributes
    callee_identities = {id(node.func) for node, _ in resolution.nodes(ast.Call)}
    slips: dict[tuple[str, str], tuple[str, str | None, str, bool] | None] = {}
    for node, _ in resolution.nodes(ast.Attribute):
        if node.attr in members or node.attr.startswith("_") or is_attempt(node, context):
            continue
        if node.attr in _COMMON and not _is_near(node, imports):
            continue
        chain = _chain(node.value, resolution, imports)
        if chain is None:
            continue
        key = (chain, node.attr)
        if key not in slips:
            slips[key] = _slip(context, node)
        slip = slips[key]
        if slip is not None:
            kind, similar_name, advice, is_method = slip
            whole = context.source.span(node)
            place = Span(
                whole.end_line, max(0, whole.end_column - len(node.attr)), whole.end_line, whole.end_column
            )
            yield context.warning(
                "SC214",
                f"{'an' if kind[0] in 'AEIOU' else 'a'} `{kind}` has no attribute `{node.attr}`",
                place,
                advice,
                fix=_renamed(
                    place,
                    similar_name,
                    context.source,
                    is_called=id(node) in callee_identities and not is_method,
                )
                if similar_name
                else None,
            )


def _renamed(place: Span, meant: str, source: Source, *, is_called: bool) -> Fix | None:
    """The repair of an attribute's name; what is called without arguments, as methods of others are, loses the parentheses."""
    rest = source.line(place.end_line)[place.end_column :]
    if is_called and not rest.startswith("()"):
        return None
    whole = Span(place.line, place.column, place.end_line, place.end_column + 2) if is_called else place
    return Fix(f"Change to `{meant}`", (Edit(whole, meant),))


def _is_near(node: ast.Attribute, brought: Mapping[str, Exported]) -> bool:
    """Return whether an attribute is one of what is brought itself, or of a sequence in it: ``network.lane``, ``network.lanes.road``."""
    match node.value:
        case ast.Name(id=name):
            return name in brought and node.attr not in _COMMON
        case ast.Attribute(value=ast.Name(id=name)):
            return name in brought and node.attr not in _OF_SEQUENCES
    return False


def _chain(node: ast.expr, resolution: Resolution, brought: Collection[str]) -> str | None:
    """Return a text that stands for the value of an expression, which begins with a name of one meaning; ``None`` for other expressions."""
    words: list[str] = []
    while not isinstance(node, ast.Name):
        match node:
            case ast.Attribute(value=value, attr=name):
                words.append(f".{name}")
            case ast.Call(func=value):
                words.append("()")
            case ast.Subscript(value=value):
                words.append("[]")
            case _:
                return None
        node = value
    if node.id not in brought and node.id != "ego":
        # A name of the program means the same everywhere if the module binds it just once, and no function does.
        reference = resolution.references.get(node)
        binding = None if reference is None else reference.binding
        if binding is None or len(binding.sites) != 1:
            return None
        return f"{id(binding)} {words}"
    return None if node.id in resolution.names else f"{node.id} {words}"


def _slip(context: CheckContext, node: ast.Attribute) -> tuple[str, str | None, str, bool] | None:
    """The class of the owner of an attribute, the name that was meant if it is known, advice, and whether a method is meant; if the class has no such attribute."""
    symbol = context.class_of(node.value)
    element = context.class_of_elements(node.value) if symbol is None else None
    if element is not None and node.attr not in _OF_SEQUENCES:
        element_class = context.class_of_symbol(element)
        similar_name = (
            None
            if element_class is None
            else nearest(node.attr, {each.name for each in element_class.members})
        )
        return (
            None
            if similar_name is None
            else (
                f"sequence of {element.name}",
                f"[0].{similar_name}",
                f"did you mean `[0].{similar_name}`?",
                True,
            )
        )
    if symbol is None:
        # An attribute of the class itself, such as a member of an enumeration.
        symbol = context.meaning(node.value) if isinstance(node.value, ast.Name) else None
    if symbol is None or not is_of_library(symbol.filename):
        return None
    cls = context.class_of_symbol(symbol)
    if cls is None or cls.member(node.attr) is not None or cls.member("__getattr__") is not None:
        return None
    names = {each.name for each in cls.members if not each.name.startswith("_")}
    similar_name, is_slip = _meant(node.attr, names)
    if similar_name is None:
        owner = _owner_beside(symbol, node.attr)
        if owner is not None:
            return symbol.name, None, _OTHER_WAYS.get((symbol.name, owner), f"a `{owner}` has it"), False
        if not (cls.complete and names):
            return None
        return symbol.name, None, f"it has {_some(cls, names)}, ...", False
    return (
        symbol.name,
        similar_name if is_slip else None,
        f"did you mean `{similar_name}`?",
        _is_called(cls, similar_name),
    )


def _meant(name: str, names: Collection[str]) -> tuple[str | None, bool]:
    """The name that is probably meant, and whether it can be put in place of the other."""
    near = nearest(name, names)
    meant = near if near is not None and _has_like_words(name, near) else _elsewhere(name, names)
    if meant is not None:
        return meant, True
    akin = related(name, names)
    # A shorter name is another thing: `lanes` are no `numLanes`.
    return (akin, len(akin) > len(name)) if akin is not None else (near, False)


def _is_called(cls: Class, name: str) -> bool:
    """Return whether a member is a method, rather than a property."""
    member = cls.member(name)
    if member is None or member.symbol is None or member.kind is not SymbolKind.METHOD:
        return False
    decorators = getattr(member.symbol.node, "decorator_list", ())
    return not any(ast.unparse(each).endswith("property") for each in decorators)


def _some(cls: Class, names: Collection[str]) -> str:
    """Some names that programs use of a class of the library, which its own code has in other writing."""
    home = os.path.dirname(cls.symbol.filename or "")
    own_names = [
        each.name
        for each in cls.members
        if each.name in names
        and each.symbol is not None
        and os.path.dirname(each.symbol.filename or "") == home
        and "_" not in each.name
    ]
    return ", ".join(f"`{each}`" for each in sorted(own_names or names)[:_SHOWN])


def _has_like_words(name: str, meant: str) -> bool:
    """Return whether no whole word of a name is another one: ``rightEdge`` is no misspelt ``rightLane``."""
    one, other = (re.findall(r"[A-Z]?[a-z]+|[A-Z]+|\d+", each) for each in (name, meant))
    if len(one) != len(other):
        return True
    pairs = zip(map(str.lower, one), map(str.lower, other), strict=True)
    return all(distance(a, b, limit=2) <= max(1, len(a) // 3) for a, b in pairs)


def _owner_beside(symbol: Symbol, name: str) -> str | None:
    """Return a class beside a class of the library that defines a name itself."""
    for node in () if symbol.module is None else symbol.module.tree.body:
        if isinstance(node, ast.ClassDef) and node.name != symbol.name:
            for part in node.body:
                target = part.target if isinstance(part, ast.AnnAssign) else None
                is_own = isinstance(part, ast.FunctionDef) and part.name == name
                if is_own or (isinstance(target, ast.Name) and target.id == name):
                    return node.name
    return None


_OTHER_WAYS: Final[Mapping[tuple[str, str], str]] = MappingProxyType(
    {
        ("Lane", "LaneSection"): "sections of lanes have it: of an object `ego.laneSection`, at a point "
        "`network.laneSectionAt(point)`, of a lane one of `lane.sections`",
        ("Road", "RoadSection"): "sections of roads have it: one of `road.sections`",
    }
)
"""Advice where a class lacks what another one has."""
_NEIGHBOURS: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(("nextLane", "next_lane", "next", "following"), "successor"),
        **dict.fromkeys(("prevLane", "previousLane", "previous_lane", "previous"), "predecessor"),
        **dict.fromkeys(("center", "centerLine", "middle"), "centerline"),
        **dict.fromkeys(("maxSpeed", "max_speed", "speedlimit"), "speedLimit"),
        **dict.fromkeys(("isSignaled", "signalized"), "isSignalized"),
        "junctions": "intersections",
    }
)
"""Names that other libraries have for attributes of roads and lanes."""


def _elsewhere(name: str, names: Collection[str]) -> str | None:
    meant = _NEIGHBOURS.get(name)
    return meant if meant in names else None


_SHOWN: Final = 8
"""Attributes that are listed where none is near."""
