"""Default values that all calls share and that the body changes."""

import ast
import re
from collections.abc import Iterator
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.context import CheckContext
from scenic.language.diagnostics import Diagnostic
from scenic.language.word_sets import word_set

__all__ = ["check_defaults"]

_MUTATING: Final = word_set(
    "add append clear discard extend insert pop popitem remove reverse setdefault sort update"
)
"""Methods of lists, dictionaries and sets that change them."""


_KEPT: Final = re.compile(r"^_|cache|memo", re.IGNORECASE)
"""Names of parameters whose defaults are meant to last from call to call."""


def check_defaults(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC309 for a list, dictionary or set that is the default of a parameter and changed in the body."""
    changes: dict[ast.AST, ast.AST] | None = None
    for cls in (
        ast.FunctionDef,
        ast.AsyncFunctionDef,
        scenic.BehaviorDef,
        scenic.MonitorDef,
        scenic.ScenarioDef,
    ):
        for node, _ in context.nodes(cls):
            args = node.args
            if args is None or not (args.defaults or args.kw_defaults):
                continue
            positional = [*args.posonlyargs, *args.args]
            pairs = [
                *zip(positional[len(positional) - len(args.defaults) :], args.defaults, strict=False),
                *zip(args.kwonlyargs, args.kw_defaults, strict=False),
            ]
            for arg, default in pairs:
                if not _mutable(default, context):
                    continue
                changes = _changed(context) if changes is None else changes
                if arg not in changes or _KEPT.search(arg.arg):
                    continue
                yield context.warning(
                    "SC309",
                    f"the default of `{arg.arg}` is made once, and changed by every call that uses it",
                    default,
                    f"use `None` as the default, and make the value in the body when `{arg.arg}` is `None`",
                    labels=(context.label(changes[arg], "changed here"),),
                )


def _mutable(default: ast.expr | None, context: CheckContext) -> bool:
    if isinstance(default, ast.Call):
        return context.provided(default.func) in ("dict", "list", "set")
    return isinstance(default, ast.Dict | ast.List | ast.Set)


def _changed(context: CheckContext) -> dict[ast.AST, ast.AST]:
    """Return the parameters, bound just once, whose values are changed, and where."""
    places: dict[ast.AST, ast.AST] = {}

    def note(target: object, place: ast.AST) -> None:
        binding = context.binding(target) if isinstance(target, ast.Name) else None
        if binding is not None and len(binding.sites) == 1:
            places.setdefault(binding.sites[0], place)

    for node, _ in context.nodes(ast.Call):
        if isinstance(node.func, ast.Attribute) and node.func.attr in _MUTATING:
            note(node.func.value, node)
    for node, _ in context.nodes(ast.Subscript):
        if not isinstance(node.ctx, ast.Load):
            note(node.value, node)
    return places
