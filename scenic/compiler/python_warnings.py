"""Python's own errors and warnings about a program that passes all other checks.

Nearly every program has nothing of the kind, and lowering and compiling it takes longer than all other checks together: a
check compiles only what is suspected here. What CPython (3.11 to 3.14) says while it compiles a tree depends on few things,
most of which programs do not have: those are not looked at more closely.
"""

import ast
import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.scopes import BindingKind, Resolution, Scope
from scenic.compiler.traversal import first_position
from scenic.language.source import Source

__all__ = ["suspects"]

_WORDS: Final = re.compile("async|\f|__(?:class|debug|instance|scenic|value)")
"""Comprehensions that wait, indentation that is hidden, and beginnings of names that cannot be bound, or that lowered code binds."""

_LONGEST: Final = 500
"""So many tokens of a logical line cannot be nested too deeply for any compiler: few nodes have less than one token."""

_DEEPEST: Final = 12
"""So many blocks in one another are allowed, whatever they become: CPython takes twenty loops."""

_HARMLESS: Final = frozenset(
    {
        bool, float, int, str,  # plain values in fields
        ast.Assign, ast.Attribute, ast.AugAssign, ast.BinOp, ast.BoolOp, ast.Break, ast.Call, ast.ClassDef,
        ast.Compare, ast.Constant, ast.Continue, ast.Dict, ast.DictComp, ast.Expr, ast.For, ast.FormattedValue,
        ast.FunctionDef, ast.GeneratorExp, ast.If, ast.IfExp, ast.Import, ast.ImportFrom, ast.JoinedStr,
        ast.Lambda, ast.List, ast.ListComp, ast.Name, ast.Pass, ast.Raise, ast.Return, ast.Set, ast.SetComp,
        ast.Slice, ast.Subscript, ast.Tuple, ast.UnaryOp, ast.While, ast.With, ast.alias, ast.arg,
        ast.arguments, ast.comprehension, ast.keyword, ast.withitem,
        *(
            cls
            for cls in vars(scenic).values()
            if isinstance(cls, type)
            and issubclass(cls, scenic.ScenicStatement | scenic.ScenicExpression | scenic.ScenicPart)
            and cls not in (scenic.ErrorStatement, scenic.Interrupt, scenic.TryInterrupt)
        ),
    }
)  # fmt: skip
"""Nodes about which Python complains only in the cases handled here; the project's own check finds mistakes of placement."""

_VARIABLE: Final = (ast.Attribute, ast.Call, ast.Name, ast.Subscript)
"""Expressions whose value may be anything; Python warns of literals that are called, indexed or compared by
identity instead."""


def suspects(
    tree: ast.Module, resolution: Resolution, source: Source, *, longest_line: int
) -> list[ast.stmt]:
    """Return the statements of the top level that have to be compiled to get Python's complaints, in order.

    ``resolution`` are the names of a program without errors, ``longest_line`` is the number of tokens of its longest
    logical line. If Python's complaints about one statement depend on others, the result is all of them.
    """
    if longest_line > _LONGEST or any(map(_joins, tree.body)):
        return tree.body
    lines = {
        line
        for line, text in enumerate(source.lines, 1)
        if not text.isascii() or _WORDS.search(text) is not None
    }
    nodes = [node for cls in resolution.by_class.keys() - _HARMLESS for node, _ in resolution.by_class[cls]]
    nodes += [
        node for cls, test in _TESTS.items() for node, _ in resolution.by_class.get(cls, ()) if test(node)
    ]
    nodes += [scope.node for scope in resolution.scopes.values() if _repeats_parameters(scope)]
    lines.update(node.lineno for node in nodes if hasattr(node, "lineno"))
    line_numbers = sorted(lines)

    def is_suspect(statement: ast.stmt) -> bool:
        index = bisect_left(line_numbers, first_position(statement)[0])
        return (index < len(line_numbers) and line_numbers[index] <= (statement.end_lineno or 0)) or _is_deep(
            [statement]
        )

    return [statement for statement in tree.body if is_suspect(statement)]


def _joins(statement: ast.stmt) -> bool:
    """Return whether Python's complaints about other statements depend on a statement of the top level."""
    return isinstance(statement, ast.Global) or (
        isinstance(statement, ast.ImportFrom) and statement.module == "__future__"
    )


def _repeats_parameters(scope: Scope) -> bool:
    """Return whether two parameters have a name; behaviors and monitors bind theirs, by their own node, to ``self``."""
    return any(
        sum(isinstance(site, ast.arg | scenic.BehaviorDef | scenic.MonitorDef) for site in binding.sites) > 1
        for binding in scope.bindings.values()
        if BindingKind.PARAMETER in binding.kinds and len(binding.sites) > 1
    )


def _call(node: ast.Call) -> bool:
    return not isinstance(node.func, _VARIABLE) or _repeats(node.keywords)


def _class(node: Any) -> bool:
    return bool(getattr(node, "type_params", None)) or _repeats(node.keywords)


def _repeats(keywords: Sequence[ast.keyword]) -> bool:
    """Return whether a keyword is given twice."""
    return len(keywords) > 1 and len({each.arg for each in keywords if each.arg is not None}) < sum(
        each.arg is not None for each in keywords
    )


def _comparison(node: ast.Compare) -> bool:
    return any(op.__class__ in (ast.Is, ast.IsNot) for op in node.ops) and not all(
        isinstance(side, _VARIABLE)
        or (isinstance(side, ast.Constant) and (side.value is None or isinstance(side.value, bool)))
        for side in (node.left, *node.comparators)
    )


_TESTS: Final[Mapping[type[ast.AST], Callable[[Any], bool]]] = {
    ast.Call: _call,
    ast.ClassDef: _class,
    ast.Compare: _comparison,
    ast.FunctionDef: lambda node: bool(getattr(node, "type_params", None)),
    ast.ImportFrom: lambda node: node.module == "__future__",
    ast.Subscript: lambda node: not isinstance(node.value, _VARIABLE),
    ast.UnaryOp: lambda node: isinstance(node.op, ast.Invert),
}


def _is_deep(statements: Iterable[ast.stmt]) -> bool:
    """Return whether blocks are nested deeply, those of ``elif`` included."""
    level: list[Any] = list(statements)
    for _ in range(_DEEPEST):
        level = [
            inner
            for statement in level
            if statement.__class__ not in _SIMPLE
            for field in _BLOCKS
            for inner in getattr(statement, field, None) or ()
        ]
        if not level:
            return False
    return True


_BLOCKS: Final = ("body", "orelse", "guards", "setup", "compose")
_SIMPLE: Final = frozenset(
    {
        ast.Assign,
        ast.AugAssign,
        ast.Expr,
        ast.Pass,
        ast.Raise,
        ast.Return,
        scenic.PropertyDef,
        scenic.Require,
        scenic.Take,
    }
)
"""The most frequent statements that hold no others."""
