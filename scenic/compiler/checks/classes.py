"""The properties of the classes that a program uses, as far as its text shows them."""

import ast
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Protocol

from scenic.compiler import tree as scenic
from scenic.compiler.surroundings import Foreign, Property
from scenic.compiler.traversal import walk
from scenic.language.properties import CLASSES, properties_of

__all__ = ["BUILT_IN", "Classes", "find_cycle", "own_property"]


BUILT_IN: Mapping[str, Mapping[str, Property]] = MappingProxyType(
    {
        cls: MappingProxyType(
            {name: Property(entry.needs, entry.final) for name, entry in properties_of(cls).items()}
        )
        for cls in CLASSES
    }
)


class Meanings(Protocol):
    """The meanings of expressions that name something."""

    def definition(self, name: ast.expr) -> ast.AST | None:
        """The one definition that an expression can mean."""

    def provided(self, name: ast.expr) -> str | None:
        """The name of what the language provides."""

    def foreign(self, name: ast.expr) -> Foreign | None:
        """The definition in another module that a name means."""


class Classes:
    """The properties of built-in classes and of those that the module defines."""

    def __init__(self, meanings: Meanings) -> None:
        self._meanings = meanings
        self._known: dict[ast.AST, Mapping[str, Property] | None] = {}
        self._circular: dict[int, bool] = {}

    def properties(self, name: ast.expr) -> Mapping[str, Property] | None:
        """All properties of the class that an expression names; ``None`` if they cannot be known."""
        provided = self._meanings.provided(name)
        if provided is not None:
            return BUILT_IN.get(provided)
        foreign = self._meanings.foreign(name)
        if foreign is not None:
            return foreign.properties
        definition = self._meanings.definition(name)
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
