"""The properties of the classes that a program uses, as far as its text tells."""

import ast
from collections.abc import Callable, Mapping
from types import MappingProxyType

from scenic.compiler import tree as scenic
from scenic.compiler.surroundings import Foreign, Property
from scenic.compiler.traversal import walk
from scenic.language.properties import CLASSES, properties_of

__all__ = ["BUILT_IN", "Classes", "own_property"]


BUILT_IN: Mapping[str, Mapping[str, Property]] = MappingProxyType(
    {
        cls: MappingProxyType(
            {name: Property(entry.needs, entry.final) for name, entry in properties_of(cls).items()}
        )
        for cls in CLASSES
    }
)


class Classes:
    """The properties of built-in classes and of those that the module defines.

    ``definition`` gives the one definition that an expression can mean, ``provided`` the name of what the language
    provides, ``foreign`` what another module defines.
    """

    def __init__(
        self,
        definition: Callable[[ast.expr], ast.AST | None],
        provided: Callable[[ast.expr], str | None],
        foreign: Callable[[ast.expr], Foreign | None],
    ) -> None:
        self._definition = definition
        self._provided = provided
        self._foreign = foreign
        self._known: dict[ast.AST, Mapping[str, Property] | None] = {}

    def properties(self, name: ast.expr) -> Mapping[str, Property] | None:
        """All properties of the class that an expression names; ``None`` if they cannot be known."""
        provided = self._provided(name)
        if provided is not None:
            return BUILT_IN.get(provided)
        foreign = self._foreign(name)
        if foreign is not None:
            return foreign.properties
        definition = self._definition(name)
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

    def is_built_in(self, properties: Mapping[str, Property]) -> bool:
        """Whether these are the properties of a class of the language, whose defaults need no checking."""
        return any(properties is built_in for built_in in BUILT_IN.values())

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
