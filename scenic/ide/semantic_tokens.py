"""Categories of the words of a document, for editors to colour: by the tree and the scopes, not only the spelling."""

import ast
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Final, NamedTuple

from scenic.compiler import tree as scenic
from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS
from scenic.compiler.scopes import BindingKind, Resolution, ScopeKind
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.symbols import SymbolKind, symbol_of_exported
from scenic.compiler.tokens import FSTRING_END, FSTRING_MIDDLE, FSTRING_START, NAME, NUMBER, STRING
from scenic.compiler.traversal import walk
from scenic.ide.name_places import name_span
from scenic.ide.snapshot import Snapshot
from scenic.language.names import NAMES, TRACKED, NameKind
from scenic.project.index import Project

__all__ = ["MODIFIERS", "TYPES", "SemanticToken", "semantic_tokens"]

TYPES: Final = (
    "namespace",
    "type",
    "class",
    "parameter",
    "variable",
    "property",
    "function",
    "method",
    "keyword",
    "comment",
    "string",
    "number",
    "operator",
    "decorator",
    "event",
    "macro",
)
"""The protocol's names for kinds of tokens; behaviors and monitors are ``event``, scenarios ``macro``."""
MODIFIERS: Final = (
    "declaration",
    "definition",
    "readonly",
    "modification",
    "documentation",
    "defaultLibrary",
)
"""The protocol's names for modifiers of tokens."""

_MARKS: Final = frozenset({"(", ")", "[", "]", "{", "}", ",", ":", ";", "."})
_OPERATOR_KINDS: Final = {kind for mark, kind in OPERATORS.items() if mark not in _MARKS}
_STRING_KINDS: Final = frozenset({STRING, FSTRING_START, FSTRING_MIDDLE, FSTRING_END})
_HARD_KINDS: Final = frozenset(HARD_KEYWORDS.values())

_SILENT: Final = (
    ast.Constant,
    ast.BinOp,
    ast.UnaryOp,
    ast.Tuple,
    ast.List,
    ast.Assign,
    ast.Compare,
    ast.Subscript,
)
"""The most frequent of the nodes that say nothing about the words in them."""

_OF_BINDING: Final = {
    BindingKind.PARAMETER: "parameter",
    BindingKind.SELF: "parameter",
    BindingKind.FUNCTION: "function",
    BindingKind.CLASS: "class",
    BindingKind.MODULE: "namespace",
    BindingKind.BEHAVIOR: "event",
    BindingKind.MONITOR: "event",
    BindingKind.SCENARIO: "macro",
    BindingKind.TYPE_PARAMETER: "type",
}
_OF_SYMBOL: Final = {
    SymbolKind.MODULE: "namespace",
    SymbolKind.CLASS: "class",
    SymbolKind.FUNCTION: "function",
    SymbolKind.BEHAVIOR: "event",
    SymbolKind.MONITOR: "event",
    SymbolKind.SCENARIO: "macro",
}
_OF_NAME: Final = {
    NameKind.CLASS: "class",
    NameKind.EXCEPTION: "class",
    NameKind.SHAPE: "class",
    NameKind.DISTRIBUTION: "class",
    NameKind.REGION: "class",
    NameKind.FUNCTION: "function",
    NameKind.VALUE: "variable",
}


class SemanticToken(NamedTuple):
    """A stretch of one line: ``line`` from 1, columns in characters, with its type and modifiers."""

    line: int
    column: int
    end_column: int
    type: str
    modifiers: frozenset[str]


_What = tuple[str, frozenset[str]]


def semantic_tokens(
    snapshot: Snapshot, project: Project | None = None, *, stamp: object = None
) -> tuple[SemanticToken, ...]:
    """Return all tokens of a document that can be coloured, in order; none goes over a line end, and none overlap.

    ``project`` knows what imported names are; ``stamp`` stands for its state.
    """
    return snapshot.derived("semantic tokens", lambda: tuple(_find(snapshot, project)), stamp=stamp)


def _find(snapshot: Snapshot, project: Project | None) -> Iterator[SemanticToken]:
    tokens, source = snapshot.tokens, snapshot.source
    names = _names(snapshot, _imported(snapshot, project))
    plain: frozenset[str] = frozenset()
    meaning_of_kind: dict[int, _What] = dict.fromkeys(_OPERATOR_KINDS, ("operator", plain))
    meaning_of_kind |= dict.fromkeys(_HARD_KINDS, ("keyword", plain))
    meaning_of_kind |= dict.fromkeys(_STRING_KINDS, ("string", plain))
    meaning_of_kind[NUMBER] = ("number", plain)
    meaning_of_kind[NAME] = ("variable", plain)
    soft: _What = ("keyword", plain)
    ascii_lines = [line.isascii() for line in source.lines]
    semantic_tokens: list[SemanticToken] = []
    for kind, line, start, end_line, end in zip(
        tokens.kinds, tokens.lines, tokens.columns, tokens.end_lines, tokens.end_columns, strict=True
    ):
        what = names.get((line, start)) if kind >= NAME or kind in _STRING_KINDS else None
        if what is None:
            what = soft if kind > NAME else meaning_of_kind.get(kind)
            if what is None:
                continue
        if line == end_line and ascii_lines[line - 1]:
            if end > start:
                semantic_tokens.append(SemanticToken(line, start, end, *what))
            continue
        first_column, last_column = source.character(line, start), source.character(end_line, end)
        for at in range(line, end_line + 1):
            first = first_column if at == line else 0
            last = last_column if at == end_line else len(source.line(at))
            if last > first:
                semantic_tokens.append(SemanticToken(at, first, last, *what))
    for line, column, text in tokens.comments:
        semantic_tokens.append(SemanticToken(line, column, column + len(text), "comment", plain))
    semantic_tokens.sort()
    end_of_last = (0, 0)
    for token in semantic_tokens:
        if (token.line, token.column) >= end_of_last:
            yield token
            end_of_last = (token.line, token.end_column)


def _imported(snapshot: Snapshot, project: Project | None) -> Callable[[str], str | None]:
    """Tells what an imported name of the module is."""
    module = None if project is None else project.module(snapshot.filename)
    if project is None or module is None:
        return lambda _name: None
    model = Model(module, project)

    @cache
    def kind_of(name: str) -> str | None:
        exported = model.at_top(name)
        return None if exported is None else _OF_SYMBOL.get(symbol_of_exported(project, exported).kind)

    return kind_of


_DEFINITIONS: Final[Mapping[type[ast.AST], str]] = MappingProxyType(
    {
        ast.ClassDef: "class",
        scenic.BehaviorDef: "event",
        scenic.MonitorDef: "event",
        scenic.ScenarioDef: "macro",
    }
)
"""Definitions whose kind does not depend on where they stand."""


def _names(snapshot: Snapshot, imported: Callable[[str], str | None]) -> dict[tuple[int, int], _What]:
    """Return by line and column in bytes the meanings of names and strings that are more than their spelling says."""
    resolution = snapshot.resolution
    meaning_at: dict[tuple[int, int], _What] = {}
    none: frozenset[str] = frozenset()

    def put(node: object, what: str, *modifiers: str, name: str | None = None) -> None:
        span = name_span(snapshot, node, name)
        place = (span.line, snapshot.source.byte(span.line, span.column))
        meaning_at[place] = (what, frozenset(modifiers))

    # What a name is because of the node around it, which is visited first.
    outer: dict[ast.AST, str] = {}
    for node in walk(snapshot.tree):
        if isinstance(node, _SILENT):
            continue
        outer.update((decorator, "decorator") for decorator in getattr(node, "decorator_list", ()))
        if isinstance(node, ast.Name):
            what = outer.get(node)
            place = (node.lineno, node.col_offset)
            meaning_at[place] = _of_name(node, resolution, imported) if what is None else (what, none)
        elif isinstance(node, ast.Attribute):
            meaning_at[_end_of(node, node.attr)] = (outer.get(node, "property"), none)
        elif isinstance(node, ast.Call):
            if isinstance(node.func, ast.Attribute):
                outer[node.func] = "method"
        elif type(node) in _DEFINITIONS:
            put(node, _DEFINITIONS[type(node)], "definition")
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            scope = resolution.scopes.get(node)
            in_class = scope is not None and scope.parent is not None and scope.parent.kind is ScopeKind.CLASS
            put(node, "method" if in_class else "function", "definition")
        elif isinstance(node, ast.arg):
            meaning_at[node.lineno, node.col_offset] = ("parameter", frozenset({"declaration"}))
        elif isinstance(node, ast.keyword) and node.arg is not None:
            meaning_at[node.lineno, node.col_offset] = ("parameter", none)
        elif isinstance(node, scenic.PropertyDef | scenic.ParamItem):
            meaning_at[node.lineno, node.col_offset] = ("property", frozenset({"definition"}))
        elif isinstance(node, scenic.SpecifierPhrase) and node.property is not None:
            put(node, "property", name=node.property)
        elif isinstance(node, ast.Import | ast.ImportFrom | scenic.Model):
            _of_import(snapshot, node, meaning_at)
        elif isinstance(node, ast.ExceptHandler | ast.MatchAs | ast.MatchStar) and node.name:
            put(node, "variable", "declaration", name=node.name)
        elif isinstance(node, ast.MatchMapping) and node.rest:
            put(node, "variable", "declaration", name=node.rest)
        elif isinstance(node, ast.Expr) and scenic.is_documentation(node):
            meaning_at[node.lineno, node.col_offset] = ("string", frozenset({"documentation"}))
    return meaning_at


def _of_name(node: ast.Name, resolution: Resolution, imported: Callable[[str], str | None]) -> _What:
    reference = resolution.references.get(node)
    binding = None if reference is None else reference.binding
    modifiers = set() if isinstance(node.ctx, ast.Load) else {"modification"}
    if node.id in TRACKED:
        return "variable", frozenset({*modifiers, "defaultLibrary"})
    if binding is None or BindingKind.IMPORTED in binding.kinds:
        imported_kind = imported(node.id)
        if imported_kind is not None:
            return imported_kind, frozenset(modifiers)
    if binding is None:
        declaration = NAMES.get(node.id)
        if declaration is not None:
            return _OF_NAME.get(declaration.kind, "variable"), frozenset({*modifiers, "defaultLibrary"})
        if node.id in PYTHON_NAMES:
            value = PYTHON_NAMES[node.id]
            return value, frozenset({*modifiers, "defaultLibrary"})
        return "variable", frozenset(modifiers)
    for kind, what in _OF_BINDING.items():
        if kind in binding.kinds:
            return what, frozenset(modifiers)
    if node.id.isupper() and len(node.id) > 1:
        modifiers.add("readonly")
    return "variable", frozenset(modifiers)


def _of_import(
    snapshot: Snapshot, node: ast.Import | ast.ImportFrom | scenic.Model, found: dict[tuple[int, int], _What]
) -> None:
    """Names of modules are namespaces; what is imported from them keeps what is known of it."""
    tokens = snapshot.tokens
    resolution = snapshot.resolution
    place = (node.lineno, node.col_offset)
    in_module = not isinstance(node, ast.ImportFrom)
    for index in range(snapshot.tokens_of_line(node.lineno).start, len(tokens.kinds)):
        at = (tokens.lines[index], tokens.columns[index])
        if at >= (node.end_lineno or 0, node.end_col_offset or 0):
            break
        text = tokens.texts[index]
        if at <= place or not text.isidentifier():
            in_module = in_module or (at == place and text == "from")
            continue
        if text == "import" and isinstance(node, ast.ImportFrom):
            in_module = False
        elif tokens.kinds[index] >= NAME:
            binding = resolution.names.get(text)
            kind = (
                None
                if binding is None
                else next((_OF_BINDING[k] for k in _OF_BINDING if k in binding.kinds), None)
            )
            found[at] = ("namespace" if in_module else kind or "variable", frozenset({"declaration"}))


def _end_of(node: ast.Attribute, name: str) -> tuple[int, int]:
    return node.end_lineno or node.lineno, (node.end_col_offset or 0) - len(name.encode())


def _python_names() -> dict[str, str]:
    import builtins

    return {
        name: "class" if isinstance(value, type) else "function" if callable(value) else "variable"
        for name, value in vars(builtins).items()
    }


PYTHON_NAMES: Final = _python_names()
"""Categories of Python's builtins."""
