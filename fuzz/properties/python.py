"""Agreement with Python on the Python in a program: trees, and scopes of names."""

import ast
import dis
import random
import sys
import warnings
from collections.abc import Iterator
from types import CodeType
from typing import Any, Final

from fuzz.properties.case import FILENAME, Case, Property, Violation, place
from fuzz.properties.differences import difference
from scenic.compiler import tree as scenic
from scenic.compiler.resolver import resolve
from scenic.compiler.scopes import Reference, Scope, ScopeKind
from scenic.language.names import RESERVED, TRACKED

__all__ = ["OF_TEXTS", "plain_statements"]

_OURS: Final = (scenic.ScenicStatement, scenic.ScenicExpression, scenic.ScenicPart)


def plain_statements(tree: ast.Module) -> Iterator[tuple[ast.stmt, int]]:
    """Yield the statements of a module that contain nothing of Scenic's, and the line after that of the statement before."""
    line = 1
    for node in tree.body:
        if not any(isinstance(part, _OURS) for part in ast.walk(node)):
            yield node, min(line, node.lineno)
        line = (node.end_lineno or node.lineno) + 1


def python_reads_the_same(case: Case) -> None:
    """A statement of Python's syntax has the tree that Python gives it, at the same places, if Python accepts it."""
    if case.has_error:
        return
    lines = case.lines
    for node, first in plain_statements(case.result.tree):
        text = "\n" * (first - 1) + "\n".join(lines[first - 1 : node.end_lineno]) + "\n"
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                body = ast.parse(text).body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            # Other statements on the line may be Scenic's, and Python may be older than what it is to read.
            continue
        theirs = next((each for each in body if place(each) == place(node)), None)
        if theirs is None:
            raise Violation(f"Python has no statement where this {type(node).__name__} is, {place(node)}")
        # Before 3.12 Python did not know the places of what is in f-strings.
        is_formatted = any(isinstance(part, ast.JoinedStr) for part in ast.walk(node))
        where = difference(node, theirs, places=sys.version_info >= (3, 12) or not is_formatted)
        # Nor whether the prefix `u` reaches into format specifications.
        if where is not None and not (is_formatted and ".format_spec." in where and ".kind: " in where):
            raise Violation(f"not as in Python: {where}")


_LOCAL: Final = frozenset({ScopeKind.FUNCTION, ScopeKind.LAMBDA, ScopeKind.COMPREHENSION})
_INSTRUCTIONS: Final = (
    (("FAST", "DEREF", "CLASSDEREF"), "local"),
    (("GLOBAL",), "global"),
    (("NAME",), "by name"),
)


def names_mean_what_python_says(case: Case) -> None:
    """The names of a program are local, or not, as they are in the code that Python makes of it without what is Scenic's.

    Its statements are put into functions and classes, and names that are read are exchanged for others that are bound nearby, in
    reach or not.
    """
    if case.has_error:
        return
    draw = random.Random(case.number)
    for node in case.fresh_tree().body:
        if any(isinstance(part, _SCOPED) for part in ast.walk(node)):
            try:
                tree = _within(_Plain().visit(node), draw.choice(_AROUND))
                _exchange_names(tree, draw)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    code = compile(tree, FILENAME, "exec", dont_inherit=True)
            except (SyntaxError, ValueError, RecursionError):
                # It may be no program of Python's, or none any more.
                continue
            references = resolve(tree, case.source).references
            _check_names(
                code,
                {
                    (place(part), part.id): each
                    for part, each in references.items()
                    if isinstance(part, ast.Name)
                },
            )


class _Plain(ast.NodeTransformer):
    """Puts plain Python in the places of what is Scenic's: the expressions in it, assignments for properties, otherwise nothing."""

    def visit(self, node: ast.AST) -> Any:
        if isinstance(node, _APART):
            return ast.copy_location(ast.Pass(), node)
        self.generic_visit(node)
        if isinstance(node, scenic.PropertyDef):
            target = ast.copy_location(ast.Name(id=node.name, ctx=ast.Store()), node)
            return ast.copy_location(ast.Assign(targets=[target], value=node.value), node)
        if isinstance(node, scenic.ScenicExpression | scenic.ScenicStatement):
            values = ast.copy_location(ast.Tuple(elts=list(_values(node)), ctx=ast.Load()), node)
            is_statement = isinstance(node, ast.stmt)
            return ast.copy_location(ast.Expr(value=values), node) if is_statement else values
        return node


_APART: Final = (
    scenic.BehaviorDef,
    scenic.MonitorDef,
    scenic.ScenarioDef,
    scenic.Guard,
    scenic.TryInterrupt,
)


def _values(node: ast.AST) -> Iterator[ast.expr]:
    """The expressions in a node of Scenic's, and in its parts."""
    for part in ast.iter_child_nodes(node):
        if isinstance(part, ast.expr):
            yield part
        else:
            yield from _values(part)


_AROUND: Final = ("pass", "class Around: pass", "def around(): pass", "class Around:\n    def around(): pass")


def _within(node: ast.stmt, around: str) -> ast.Module:
    """A module in which a statement replaces `pass` in the text ``around``."""
    tree = ast.parse(around)
    block: list[ast.stmt] = tree.body
    while not isinstance(block[0], ast.Pass):
        holder: Any = ast.copy_location(block[0], node)
        block = holder.body
    block[0] = node
    return tree


def _exchange_names(tree: ast.Module, draw: random.Random) -> None:
    nodes = list(ast.walk(tree))
    read = [node for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)]
    bound = {node.arg for node in nodes if isinstance(node, ast.arg)}
    bound |= {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    bound |= {node.name for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    names = sorted(bound - set(RESERVED) - set(TRACKED))
    if names and draw.random() < 0.7:
        for node in draw.sample(read, len(read) // 2 + len(read) % 2):
            if node.id not in RESERVED and node.id not in TRACKED:
                node.id = draw.choice(names)


_SCOPED: Final = (
    ast.FunctionDef,
    ast.AsyncFunctionDef,
    ast.Lambda,
    ast.ClassDef,
    ast.ListComp,
    ast.SetComp,
    ast.DictComp,
    ast.GeneratorExp,
)


def _check_names(code: CodeType, references: dict[Any, Reference]) -> None:
    for instruction in dis.get_instructions(code):
        at = instruction.positions
        name = instruction.argval
        if (
            at is None
            or not isinstance(name, str)
            or name.startswith("__")
            or name in RESERVED
            or name in TRACKED
        ):
            continue
        reference = references.get((((at.lineno, at.col_offset), (at.end_lineno, at.end_col_offset)), name))
        kind = _kind(instruction.opname)
        if reference is None or kind is None:
            continue
        scope = None if reference.binding is None else reference.binding.scope
        if kind not in _expected(scope):
            what = "nothing" if scope is None else f"a name of the {scope.kind} {scope.name}"
            raise Violation(
                f"`{name}` at {at.lineno}:{at.col_offset} is {what}, but {kind} in {code.co_name}"
            )
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            _check_names(constant, references)


def _kind(instruction: str) -> str | None:
    action, _, rest = instruction.partition("_")
    if action not in ("LOAD", "STORE", "DELETE"):
        return None
    return next((kind for words, kind in _INSTRUCTIONS if rest in words), None)


def _expected(scope: Scope | None) -> tuple[str, ...]:
    if scope is not None and scope.kind in _LOCAL:
        return ("local",)
    if scope is not None and scope.kind is ScopeKind.CLASS:
        return ("by name",)
    return ("global", "by name")


OF_TEXTS: Final = (
    Property.of(python_reads_the_same, one_in=2),
    Property.of(names_mean_what_python_says, one_in=2),
)
