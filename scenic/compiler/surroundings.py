"""Facts about the modules that a program imports, for the checks of that program.

The compiler looks into no other file. Who knows the project (`scenic.project`) hands a `Surroundings` to the checks; a
program that is compiled to be run has none, and whatever an import brings is unknown then.
"""

import ast
from collections.abc import Callable, Iterator
from typing import Protocol

from scenic.compiler import tree as scenic
from scenic.compiler.semantics.modules import Module, Modules
from scenic.language.diagnostics import Diagnostic

__all__ = ["Surroundings", "SurroundingsOf"]


class Surroundings(Protocol):
    """Facts about the imports of a program."""

    @property
    def modules(self) -> Modules:
        """The modules that the program can reach."""

    def is_missing(self, alias: ast.alias) -> bool:
        """Return whether nothing is known that an import of a name could mean."""

    def is_begun(self, alias: ast.alias) -> bool:
        """Return whether what an import names is missing, and the beginning of something that is there."""

    def sets_ego(self, statement: ast.Import | ast.ImportFrom | scenic.Model) -> bool:
        """Return whether an import may bring an ego along."""

    def findings(self) -> Iterator[Diagnostic]:
        """The faults of the imports themselves, and of road maps that the program names."""


SurroundingsOf = Callable[[Module], Surroundings]
"""Finds out about the imports of a program, whose names are bound already."""
