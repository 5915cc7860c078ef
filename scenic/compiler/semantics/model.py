"""The semantic model of a program: what its names mean, and what its expressions and classes are, for checks and editors."""

import ast
from collections.abc import Mapping
from functools import cached_property
from weakref import proxy

from scenic.compiler.semantics.classes import Class, Classes, ClassMember
from scenic.compiler.semantics.kinds import ValueKind
from scenic.compiler.semantics.modules import Exported, Module
from scenic.compiler.semantics.names import Names
from scenic.compiler.semantics.symbols import Symbol
from scenic.compiler.semantics.values import Values
from scenic.language.members import Member

__all__ = ["Model"]


class Model(Names):
    """The meaning of the names and expressions of a module. Each fact is computed once, on first use.

    ``definition``, ``kind_of``, ``class_named`` and ``method`` say what is certain; ``meaning``, ``class_of`` and
    ``class_of_elements`` what is likely.
    """

    @cached_property
    def _classes(self) -> Classes:
        # Without a reference back all of this is gone as soon as nobody asks any more.
        return Classes(self.modules, proxy(self))

    def beside(self, module: Module) -> "Model":
        """Return the model of another module."""
        return self if module is self.module else Model(module, self.modules)

    @cached_property
    def _values(self) -> Values:
        return Values(self._classes)

    def meaning(self, node: ast.expr) -> Symbol | None:
        """The meaning of a name or an attribute; ``None`` if it is unknown."""
        return self._values.meaning(self.module, node)

    def kind_of(self, value: ast.expr | None) -> ValueKind | None:
        """Return the kind of what an expression gives; ``None`` if it is not certain."""
        return None if value is None else self._values.value(self.module, value).kind

    def class_of(self, node: ast.expr) -> Symbol | None:
        """Return the class of the value of an expression; ``None`` if it is unknown."""
        return self._values.value(self.module, node).cls

    def class_of_elements(self, node: ast.expr) -> Symbol | None:
        """Return the class of the elements of the sequence that an expression is; ``None`` if it is unknown."""
        return self._values.value(self.module, node).elements

    def class_of_exported(self, exported: Exported) -> Symbol | None:
        """Return the class of a value that a module defines; ``None`` if it is unknown."""
        return self._values.of_exported(exported).cls

    def class_of_symbol(self, symbol: Symbol | None) -> Class | None:
        """Return the class that a symbol is; ``None`` if it is none."""
        return self._classes.of_symbol(symbol)

    def class_named(self, name: ast.expr) -> Class | None:
        """Return the class of objects that an expression certainly names; ``None`` if it is none, or may be another."""
        return self._values.class_of_objects(self.module, name)

    def class_at(self, definition: ast.AST) -> Class | None:
        """Return the class of objects that a statement defines, if all of its members are known."""
        known = self._classes.of_node(self.module, definition)
        return known if known is not None and known.complete and known.is_scenic else None

    def properties(self, name: ast.expr) -> Mapping[str, ClassMember] | None:
        """Return all properties of the class of objects that an expression names; ``None`` if they cannot be known."""
        known = self.class_named(name)
        return known.properties if known is not None and known.complete else None

    def built_in(self, name: ast.expr) -> str | None:
        """Return the class of the language from which the class that an expression names certainly derives."""
        known = self.class_named(name)
        return None if known is None else known.built_in

    @cached_property
    def properties_brought(self) -> frozenset[str]:
        """The properties of the classes that star imports and the model bring."""
        classes = map(self.class_of_symbol, self.definitions_brought())
        return frozenset(
            name
            for each in classes
            if each is not None and each.names is not None
            for name in each.properties
        )

    def method(self, function: ast.Attribute) -> Member | None:
        """Return the declared method of a value that a call of an attribute calls."""
        return self._values.method(self.module, function)
