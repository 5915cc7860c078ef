"""Actions of functions, classes, type parameters and `try`."""

import ast
from collections.abc import Sequence
from typing import Any, TypeAlias

from scenic.compiler import tree
from scenic.compiler.actions.common import Node, Place, make, place_of
from scenic.compiler.actions.targets import TargetActions

Parameter: TypeAlias = tuple[Any, Any]


def _disorder(earlier: ast.arguments, key: object, value: object, *, starred: bool) -> tuple[str, str] | None:
    """The message and the help for an item of a signature that cannot follow the earlier ones."""
    if earlier.kwarg is not None:
        return "nothing can follow a parameter with `**`", "move it to the front"
    if key == "/" and (starred or earlier.posonlyargs or not earlier.args):
        return (
            "`/` has to stand once, after the first parameters and before `*`",
            "the order is `positional, /, any, *, keyword`",
        )
    if key == "*" and starred:
        return "there can be only one `*`", "remove one of them"
    if isinstance(key, ast.arg) and not starred and value is None and earlier.defaults:
        return (
            "a parameter without a default follows one with a default",
            "give it a default, or move it to the front",
        )
    return None


class DefinitionActions(TargetActions):
    """Definitions in Python."""

    def no_parameters(self) -> ast.arguments:
        return make(
            ast.arguments,
            None,
            posonlyargs=[],
            args=[],
            vararg=None,
            kwonlyargs=[],
            kw_defaults=[],
            kwarg=None,
            defaults=[],
        )

    def parameters(self, items: Sequence[Parameter]) -> ast.arguments | None:
        """Sort the items of a signature, and check their order.

        An item is a pair of a parameter and its default, or of ``*``, ``**`` or ``/`` and its parameter; those that
        have none come with the index of their token.
        """
        result = self.no_parameters()
        bare: int | None = None
        for key, value in items:
            place = self.place_of_token(value) if isinstance(value, int) else place_of(value or key)
            if isinstance(key, ast.arg):
                place = place_of(key)
            has_star = bare is not None or result.vararg is not None
            disorder = _disorder(result, key, value, starred=has_star)
            if disorder is not None:
                self._misordered(place, *disorder)
                return None
            if key == "/":
                result.posonlyargs, result.args = result.args, []
            elif key == "*":
                if isinstance(value, int):
                    bare = value
                else:
                    result.vararg = value
            elif key == "**":
                result.kwarg = value
            elif has_star:
                result.kwonlyargs.append(key)
                result.kw_defaults.append(value)
            else:
                if value is not None:
                    result.defaults.append(value)
                result.args.append(key)
        if bare is not None and not result.kwonlyargs:
            advice = "remove `*`, or add a parameter"
            self._misordered(self.place_of_token(bare), "a parameter has to follow the bare `*`", advice)
            return None
        return result

    def _misordered(self, place: Place, message: str, help: str) -> None:
        self.fail(place, message, help=help, code="SC126")

    def type_parameter(self, kind: str, name: int, bound: ast.expr | None, place: Place) -> Any:
        node_class = getattr(ast, kind, None)
        if node_class is None:
            return place
        fields: dict[str, Any] = {"name": self._texts[name]}
        if kind == "TypeVar":
            fields["bound"] = bound
        if "default_value" in node_class._fields:
            fields["default_value"] = None
        return make(node_class, place, **fields)

    def _type_parameters(self, parameters: list[Any] | None) -> list[Any]:
        if parameters and isinstance(parameters[0], tuple):
            self._newer(parameters[0], "type parameters")
            return []
        return parameters or []

    def _newer(self, place: Place, what: str) -> None:
        self._report(
            place, f"{what} need Python 3.12 or newer", code="SC120", help="run Scenic with a newer Python"
        )

    def type_alias(self, name: int, parameters: list[Any] | None, value: ast.expr, place: Place) -> ast.stmt:
        node_class: type[ast.stmt] | None = getattr(ast, "TypeAlias", None)
        if node_class is None:
            self._newer(place, "`type` statements")
            return make(tree.ErrorStatement, place, body=[])
        target = self.stored_name(name)
        return make(node_class, place, name=target, type_params=parameters or [], value=value)

    def function(
        self, node_class: type[Node], signature: tuple[Any, ...], body: list[ast.stmt], place: Place
    ) -> Node:
        name, type_parameters, parameters, returns = signature
        return make(
            node_class,
            place,
            name=self._texts[name],
            args=parameters or self.no_parameters(),
            body=body,
            decorator_list=[],
            returns=returns,
            type_comment=None,
            type_params=self._type_parameters(type_parameters),
        )

    def class_definition(
        self,
        name: int,
        type_parameters: list[Any] | None,
        bases: list[Any] | None,
        body: list[ast.stmt],
        place: Place,
    ) -> ast.ClassDef | None:
        arguments, keywords, generator = (bases[0] if bases else None) or ([], [], None)
        if generator is not None:
            self.fail(place_of(generator), "a class cannot have a generator as its base")
            return None
        return make(
            ast.ClassDef,
            place,
            name=self._texts[name],
            bases=arguments,
            keywords=keywords,
            body=body,
            decorator_list=[],
            type_params=self._type_parameters(type_parameters),
        )

    def decorate(self, decorators: list[ast.expr], definition: Any) -> Any:
        definition.decorator_list = decorators
        return definition

    def try_statement(self, body: list[ast.stmt], rest: tuple[Any, ...], place: Place) -> Any:
        interrupts, handlers, orelse, final, node_class = rest
        for handler in handlers[:-1]:
            if handler.type is None:
                self.fail(
                    place_of(handler),
                    "an `except` without an expression has to be the last one",
                    help="it would take all exceptions before the others could",
                    code="SC116",
                )
                return None
        fields = {"body": body, "handlers": handlers, "orelse": orelse or [], "finalbody": final or []}
        if interrupts is not None:
            fields["interrupts"] = interrupts
        return make(node_class, place, **fields)
