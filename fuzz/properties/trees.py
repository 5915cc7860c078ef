"""Validity of trees: types of fields, contexts, and places."""

import ast
from collections.abc import Iterator
from typing import Any, Final

from fuzz.properties.case import Case, Property, Violation
from fuzz.properties.signatures import SIGNATURES
from scenic.compiler import tree as scenic

__all__ = ["OF_TEXTS", "TARGETS"]

TARGETS: Final[dict[tuple[type[ast.AST], str], type[ast.expr_context]]] = {
    (ast.Assign, "targets"): ast.Store,
    (ast.AugAssign, "target"): ast.Store,
    (ast.AnnAssign, "target"): ast.Store,
    (ast.For, "target"): ast.Store,
    (ast.AsyncFor, "target"): ast.Store,
    (ast.comprehension, "target"): ast.Store,
    (ast.withitem, "optional_vars"): ast.Store,
    (ast.NamedExpr, "target"): ast.Store,
    (ast.Delete, "targets"): ast.Del,
}
"""The fields that hold what is assigned or deleted."""
if hasattr(ast, "TypeAlias"):
    TARGETS[ast.TypeAlias, "name"] = ast.Store

_PASSED_ON: Final = frozenset({(ast.Tuple, "elts"), (ast.List, "elts"), (ast.Starred, "value")})
"""Fields that have the context of the node that they are in."""

_ANY_ORDER: Final = frozenset({"Operation.operands", "SpecifierPhrase.operands"})
"""Lists whose elements are in the order of their meaning, not of the text."""

_INTERLEAVED: Final = frozenset(
    {
        ast.IfExp,  # the test stands between the others
        ast.Dict,
        ast.arguments,
        ast.Call,
        ast.ClassDef,
        ast.FunctionDef,
        ast.AsyncFunctionDef,
        ast.MatchMapping,
        ast.Compare,
        scenic.BehaviorDef,  # a docstring stands before the guards
        scenic.Record,
    }
)
"""Nodes whose fields do not follow each other in the text."""


def fields_have_their_types(case: Case) -> None:
    """Every field has a value of its declared type, and every expression the context of its place."""
    stack: list[tuple[ast.AST, type[ast.expr_context]]] = [(case.result.tree, ast.Load)]
    while stack:
        node, context = stack.pop()
        cls = node.__class__
        signature = SIGNATURES.get(cls)
        if signature is None:
            raise Violation(f"{cls.__name__} is no class of the tree")
        for field in signature:
            if not hasattr(node, field.name):
                raise Violation(f"{_where(node)} has no {field.name}")
            value = getattr(node, field.name)
            fault = field.fault(value)
            if fault is not None:
                raise Violation(f"{_where(node)}: {fault}")
            if field.name == "ctx" and value.__class__ is not context:
                raise Violation(
                    f"{_where(node)} has the context {type(value).__name__}, not {context.__name__}"
                )
            key = (cls, field.name)
            inner = context if key in _PASSED_ON else TARGETS.get(key, ast.Load)
            stack.extend(
                (part, inner)
                for part in (value if isinstance(value, list) else (value,))
                if isinstance(part, ast.AST) and part._fields
            )
        _check_lengths(node)


_SAME_LENGTH: Final = {
    ast.Dict: ("keys", "values"),
    ast.Compare: ("ops", "comparators"),
    ast.MatchMapping: ("keys", "patterns"),
    ast.MatchClass: ("kwd_attrs", "kwd_patterns"),
}
_NOT_EMPTY: Final[dict[type[ast.AST], tuple[str, ...]]] = {
    ast.Assign: ("targets",),
    ast.Delete: ("targets",),
    ast.BoolOp: ("values",),
    ast.Compare: ("ops",),
    ast.Import: ("names",),
    ast.ImportFrom: ("names",),
    ast.Global: ("names",),
    ast.Nonlocal: ("names",),
    ast.With: ("items", "body"),
    ast.AsyncWith: ("items", "body"),
    ast.For: ("body",),
    ast.AsyncFor: ("body",),
    ast.While: ("body",),
    ast.If: ("body",),
    ast.Try: ("body",),
    ast.TryStar: ("body", "handlers"),
    ast.FunctionDef: ("body",),
    ast.AsyncFunctionDef: ("body",),
    ast.ClassDef: ("body",),
    ast.ExceptHandler: ("body",),
    ast.Match: ("cases",),
    ast.match_case: ("body",),
    ast.ListComp: ("generators",),
    ast.SetComp: ("generators",),
    ast.DictComp: ("generators",),
    ast.GeneratorExp: ("generators",),
    ast.Set: ("elts",),
    ast.MatchOr: ("patterns",),
    scenic.Param: ("items",),
    scenic.TryInterrupt: ("body", "interrupts"),
    scenic.Interrupt: ("body",),
    scenic.Take: ("actions",),
    scenic.Do: ("targets",),
    scenic.DoChoose: ("targets",),
    scenic.DoShuffle: ("targets",),
    scenic.Temporal: ("operands",),
    scenic.Override: ("specifiers",),
}
"""Lists that no text leaves empty."""


def _check_lengths(node: Any) -> None:
    same = _SAME_LENGTH.get(type(node))
    if same is not None and len(getattr(node, same[0])) != len(getattr(node, same[1])):
        raise Violation(f"{_where(node)}: {same[0]} and {same[1]} differ in length")
    if isinstance(node, ast.arguments):
        positional = len(node.posonlyargs) + len(node.args)
        if len(node.defaults) > positional or len(node.kw_defaults) != len(node.kwonlyargs):
            raise Violation("more defaults than parameters")


def right_trees_are_whole(case: Case) -> None:
    """In the tree of a text without errors, no list is empty that no text leaves empty."""
    if case.has_error:
        return
    for node in ast.walk(case.result.tree):
        for name in _NOT_EMPTY.get(type(node), ()):
            if not getattr(node, name):
                raise Violation(f"{_where(node)}: {name} is empty")


def nodes_lie_in_the_text(case: Case) -> None:
    """Every node has a place if its class has; it starts and ends at tokens, holds its parts, and these are in order."""
    widths = case.widths
    tokens = case.tokens
    starts = set(zip(tokens.lines, tokens.columns, strict=True))
    ends = set(zip(tokens.end_lines, tokens.end_columns, strict=True))
    loose: set[ast.AST] = set()
    stack: list[tuple[ast.AST, Any, Any]] = [(case.result.tree, (1, 0), (len(widths), widths[-1] + 1))]
    while stack:
        node, outer_start, outer_end = stack.pop()
        cls = node.__class__
        start, end = outer_start, outer_end
        if "lineno" in node._attributes:
            placed_node: Any = node
            try:
                start = (placed_node.lineno, placed_node.col_offset)
                end = (placed_node.end_lineno, placed_node.end_col_offset)
            except AttributeError as problem:
                raise Violation(f"{cls.__name__} has no place: {problem}") from None
            if end < start:
                raise Violation(f"{_where(node)} ends before it starts, at {end}")
            for line, column in (start, end):
                # The column after the last one is that of the line end.
                if not (1 <= line <= len(widths) and 0 <= column <= widths[line - 1] + 1):
                    raise Violation(f"{_where(node)} lies outside the text")
            if start not in starts and node not in loose:
                raise Violation(f"{_where(node)} does not start at a token")
            if end not in ends and node not in loose:
                raise Violation(f"{_where(node)} does not end at the end of a token, but at {end}")
            if start < outer_start or end > outer_end:
                raise Violation(
                    f"{_where(node)} is not inside what it is part of, {outer_start} to {outer_end}"
                )
            if getattr(node, "decorator_list", None):
                # Decorators stand before what they decorate.
                start = _start(placed_node.decorator_list[0], start)
        if isinstance(node, ast.JoinedStr):
            # The text of a field with `=` starts with the blanks after the brace, and ends with those after the sign.
            loose.update(node.values)
        rows = list(_rows(node))
        for row in rows:
            _check_order(node, row)
            stack.extend((part, outer_start if _decorates(node, part) else start, end) for part in row)


def _decorates(node: Any, part: ast.AST) -> bool:
    return part in getattr(node, "decorator_list", ())


def _rows(node: ast.AST) -> Iterator[list[ast.AST]]:
    """The parts of a node, in rows that are in the order of the text."""
    rows: list[list[ast.AST]] = []
    for name in node._fields:
        value = getattr(node, name, None)
        if isinstance(value, list):
            parts = [part for part in value if isinstance(part, ast.AST) and part._fields]
            if f"{type(node).__name__}.{name}" in _ANY_ORDER:
                parts.sort(key=lambda part: _start(part, (0, 0)))
        elif isinstance(value, ast.AST) and value._fields:
            parts = [value]
        else:
            continue
        if parts:
            rows.append(parts)
    if node.__class__ in _INTERLEAVED:
        yield from rows
        yield sorted(
            (part for row in rows for part in row if "lineno" in part._attributes),
            key=lambda p: _start(p, (0, 0)),
        )
    elif rows:
        yield [part for row in rows for part in row]


def _check_order(node: ast.AST, row: list[ast.AST]) -> None:
    """No part begins before the one before it has ended."""
    last: Any = (0, 0)
    for part in row:
        if "lineno" not in part._attributes:
            continue
        placed_node: Any = part
        start = _start(part, last)
        if getattr(part, "decorator_list", None):
            start = min(start, _start(placed_node.decorator_list[0], start))
        if start < last and not (_stands_for_both(node) or _is_of_field(node, last, part)):
            raise Violation(
                f"{_where(part)} in {_where(node)} begins before the part before it ends, at {last}"
            )
        last = (placed_node.end_lineno, placed_node.end_col_offset)


def _stands_for_both(node: ast.AST) -> bool:
    """Return whether a node is a clause of ``match`` that could not be parsed: its pattern and its block are the same text."""
    return isinstance(node, ast.match_case) and any(
        isinstance(part, scenic.ErrorStatement) for part in node.body
    )


def _is_of_field(node: ast.AST, last: Any, part: Any) -> bool:
    """Return whether the node before ``part`` is the text of ``{part=}``, which lies in the replacement field
    as in Python's trees.
    """
    return (
        isinstance(node, ast.JoinedStr)
        and isinstance(part, ast.FormattedValue)
        and last <= (part.end_lineno, part.end_col_offset)
    )


def _start(node: Any, default: Any) -> Any:
    return (node.lineno, node.col_offset) if hasattr(node, "lineno") else default


def _where(node: Any) -> str:
    name = type(node).__name__
    return f"{name} at {node.lineno}:{node.col_offset}" if hasattr(node, "lineno") else name


OF_TEXTS: Final = (
    Property.of(fields_have_their_types),
    Property.of(right_trees_are_whole),
    Property.of(nodes_lie_in_the_text),
)
