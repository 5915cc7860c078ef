"""The properties and members of the classes that a program uses, as far as its text shows them."""

import ast
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.names import Names
from scenic.compiler.surroundings import Property
from scenic.compiler.traversal import walk
from scenic.language.properties import CLASSES, attributes_of, properties_of

__all__ = ["BUILT_IN", "Classes", "find_cycle", "own_property"]


BUILT_IN: Mapping[str, Mapping[str, Property]] = MappingProxyType(
    {
        cls: MappingProxyType(
            {name: Property(entry.needs, entry.final) for name, entry in properties_of(cls).items()}
        )
        for cls in CLASSES
    }
)


_DEEPEST: Final = 20
"""Length to which a chain of base classes is followed."""


_DEFINED: Final[Mapping[type[Any], str]] = MappingProxyType(
    {
        ast.FunctionDef: "function",
        scenic.BehaviorDef: "behavior",
        scenic.MonitorDef: "monitor",
        scenic.ScenarioDef: "scenario",
    }
)


class Classes:
    """The properties and members of built-in classes and of those that the module defines."""

    def __init__(self, names: Names) -> None:
        self._names = names
        self._known: dict[ast.AST, Mapping[str, Property] | None] = {}
        self._circular: dict[int, bool] = {}

    def properties(self, name: ast.expr) -> Mapping[str, Property] | None:
        """All properties of the class that an expression names; ``None`` if they cannot be known."""
        provided = self._names.provided(name)
        if provided is not None:
            return BUILT_IN.get(provided)
        foreign = self._names.foreign(name)
        if foreign is not None:
            return foreign.properties
        definition = self._names.definition(name)
        return None if definition is None else self.of(definition)

    def of(self, definition: ast.AST) -> Mapping[str, Property] | None:
        """All properties of a class that the program defines; ``None`` if they cannot be known."""
        return self._defined(definition) if isinstance(definition, ast.ClassDef) else None

    def inherited(self, definition: ast.ClassDef) -> Mapping[str, Property] | None:
        """The properties that a class has from its bases; ``None`` if they cannot be known."""
        found: dict[str, Property] = {}
        for properties in reversed(
            [self.properties(base) for base in definition.bases] or [BUILT_IN["Object"]]
        ):
            if properties is None or definition.keywords:
                return None
            found.update(properties)
        return found

    def is_circular(self, properties: Mapping[str, Property]) -> bool:
        """Return whether the defaults of a class need one another in a circle."""
        known = self._circular.get(id(properties))
        if known is None:
            known = self._circular[id(properties)] = _is_circular(properties)
        return known

    def base(self, cls: ast.expr, depth: int = 0) -> str | None:
        """The built-in class from which a class derives."""
        name = self._names.provided(cls)
        if name is not None:
            return name if name in CLASSES else None
        foreign = self._names.foreign(cls)
        if foreign is not None:
            return foreign.base
        definition = self._names.definition(cls)
        if depth > _DEEPEST or not isinstance(definition, ast.ClassDef):
            return None
        return self.base(definition.bases[0], depth + 1) if definition.bases else "Object"

    def members(self, cls: ast.expr, depth: int = 0) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class of objects."""
        name = self._names.provided(cls)
        if name is not None:
            return frozenset(properties_of(name)).union(attributes_of(name)) if name in CLASSES else None
        foreign = self._names.foreign(cls)
        if foreign is not None:
            return foreign.members
        definition = self._names.definition(cls)
        if depth > _DEEPEST or not isinstance(definition, ast.ClassDef):
            return None
        return self.members_of(definition, depth)

    def members_of(self, definition: ast.ClassDef, depth: int = 0) -> frozenset[str] | None:
        """All attributes and methods of the instances of a class that the program defines."""
        properties = self.of(definition)
        scope = self._names.resolution.scopes.get(definition)
        if properties is None or scope is None or definition.decorator_list:
            return None
        found = frozenset(properties).union(scope.bindings, attributes_of("Object"))
        for base in definition.bases:
            inherited = self.members(base, depth + 1)
            if inherited is None:
                return None
            found |= inherited
        return found

    def defined(self, name: ast.expr) -> str | None:
        """The kind of what the program or a module that it imports defines under a name, in a word: function, behavior, ..."""
        if not isinstance(name, ast.Name | ast.Attribute) or self._names.provided(name) is not None:
            return None
        foreign = self._names.foreign(name)
        definition = self._names.definition(name) if foreign is None else foreign.definition
        if foreign is None and getattr(definition, "name", None) != getattr(name, "id", None):
            return None  # `self` in a behavior.
        if isinstance(definition, ast.ClassDef):
            return "class" if self.properties(name) is not None else None
        return _DEFINED.get(type(definition))

    def ego_members(self) -> frozenset[str] | None:
        """All attributes and methods of the ego, if the program sets it just once and makes it there."""
        value = self._names.ego_value
        return self.members(value.cls) if isinstance(value, scenic.New) else None

    def _defined(self, node: ast.ClassDef) -> Mapping[str, Property] | None:
        if node not in self._known:
            self._known[node] = None  # A class among its own bases: nothing is known.
            inherited = self.inherited(node)
            if inherited is not None:
                own = (item for item in node.body if isinstance(item, scenic.PropertyDef))
                self._known[node] = MappingProxyType(
                    {**inherited, **{item.name: own_property(item) for item in own}}
                )
        return self._known[node]


def own_property(item: scenic.PropertyDef) -> Property:
    """A property as a class defines it."""
    needs = [
        part.attr
        for part in walk(item.value)
        if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name) and part.value.id == "self"
    ]
    return Property(tuple(dict.fromkeys(needs)), "final" in item.attributes)


def _is_circular(properties: Mapping[str, Property]) -> bool:
    built_in = BUILT_IN["Object"]
    if not any(item.needs and item != built_in.get(name) for name, item in properties.items()):
        return False  # Those of the language are in no circle.
    return (
        find_cycle(list(properties), lambda name: properties[name].needs if name in properties else ())
        is not None
    )


def find_cycle(names: list[str], needed: Callable[[str], tuple[str, ...]]) -> list[str] | None:
    """The properties of one cycle, in order; ``None`` if there is none."""
    done: set[str] = set()
    for start in names:
        path: list[str] = []
        stack: list[tuple[str, Iterator[str]]] = []
        if start not in done:
            path.append(start)
            stack.append((start, iter(needed(start))))
        while stack:
            name, rest = stack[-1]
            following = next(rest, None)
            if following is None:
                stack.pop()
                path.pop()
                done.add(name)
            elif following in path:
                return path[path.index(following) :]
            elif following not in done:
                path.append(following)
                stack.append((following, iter(needed(following))))
    return None
