"""The semantic model of a program: its names, classes and kinds of values, for checks and editors."""

import ast
from functools import cached_property
from weakref import proxy

from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.kinds import KindOf, ValueKind
from scenic.compiler.semantics.names import Names
from scenic.language.members import Member

__all__ = ["Model"]


class Model(Names):
    """The meaning of the names and expressions of a program. Each fact is computed once, on first use."""

    @cached_property
    def classes(self) -> Classes:
        """The properties and members of the classes that the program uses."""
        # Without a reference back all of this is gone as soon as nobody asks any more.
        return Classes(proxy(self))

    @cached_property
    def _kinds(self) -> KindOf:
        return KindOf(proxy(self), self.classes)

    def kind_of(self, value: ast.expr | None) -> ValueKind | None:
        """The kind of what an expression gives; ``None`` if it is not certain."""
        return self._kinds(value)

    def method(self, function: ast.Attribute) -> Member | None:
        """The declared method of a value that a call of an attribute calls."""
        return self._kinds.method(function)
