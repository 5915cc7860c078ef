"""Facts about the modules that a program imports, for the checks of that program.

The compiler looks into no other file. Who knows the project (`scenic.project`) hands a `Surroundings` to the checks; a
program that is compiled to be run has none, and whatever an import brings is unknown then.
"""

import ast
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import field
from typing import Any, Protocol

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import Resolution
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["Foreign", "Property", "Surroundings", "SurroundingsOf"]


@dataclass(frozen=True, slots=True)
class Property:
    """A property of a class: the properties that its default reads, and whether it is final."""

    needs: tuple[str, ...] = ()
    final: bool = False


@dataclass(frozen=True, slots=True)
class Foreign:
    """The definition of a name in another module.

    ``definition`` is the one definition that it can only mean, without decorators; ``None`` if there may be others.
    ``parameters`` are those of a class that is called like a function. ``properties`` are those of a class of objects,
    ``None`` if they cannot be known; ``members`` are all of their attributes and methods, and ``base`` is the built-in class from
    which they derive. ``filename`` and ``span`` tell where the name is defined.
    ``is_plain_class`` tells whether it is a class that certainly makes no objects of the scene.
    """

    name: str
    definition: Any = field(default=None, repr=False)
    parameters: ast.arguments | None = field(default=None, repr=False)
    properties: Mapping[str, Property] | None = field(default=None, repr=False)
    filename: str | None = None
    span: Span | None = None
    is_plain_class: bool = False
    members: frozenset[str] | None = field(default=None, repr=False)
    base: str | None = None


class Surroundings(Protocol):
    """Facts about the imports of a program."""

    @property
    def state(self) -> object:
        """A value that stands for all other modules: equal as long as nothing of them has changed."""

    @property
    def complete(self) -> bool:
        """Return whether ``names`` are all names that star imports and the model bring."""

    @property
    def names(self) -> Collection[str]:
        """The names that star imports and the model bring."""

    def brought(self, name: str) -> Foreign | None:
        """The meaning of one of ``names``; ``None`` if it is not known."""

    def kind_of(self, name: str) -> str | None:
        """The kind of the value of one of ``names``, in the word of the declared type; ``None`` if it is not known."""

    def imported(self, alias: ast.alias) -> Foreign | None:
        """The definition that ``from m import name`` brings; ``None`` if it is not known."""

    def attribute(self, node: ast.Attribute) -> Foreign | None:
        """The meaning of ``m.name``, where ``m`` is an imported module; ``None`` if it is not known."""

    def is_missing(self, alias: ast.alias) -> bool:
        """Return whether nothing is known that an import of a name could mean."""

    def is_begun(self, alias: ast.alias) -> bool:
        """Return whether what an import names is missing, and the beginning of something that is there."""

    def sets_ego(self, statement: ast.Import | ast.ImportFrom | scenic.Model) -> bool:
        """Return whether an import may bring an ego along."""

    def findings(self) -> Iterator[Diagnostic]:
        """The faults of the imports themselves, and of road maps that the program names."""


SurroundingsOf = Callable[[ast.Module, Source, Resolution], Surroundings]
"""Finds out about the imports of a program, whose names are bound already."""
