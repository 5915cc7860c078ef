"""One version of a document, and the facts derived from it: computed once, for all features and threads."""

import ast
import re
import threading
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator
from typing import Any, Final, TypeVar

from scenic.compiler.check import check_tree
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import ParseResult, deep_recursion, parse_lexed
from scenic.compiler.resolver import bind
from scenic.compiler.scopes import Binding, BindingKind, Resolution, Scope, ScopeKind
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Modules
from scenic.compiler.surroundings import SurroundingsOf
from scenic.compiler.tokens import NAME, Tokens
from scenic.compiler.traversal import parts
from scenic.language.diagnostics import Diagnostic
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.project.modules import read_module

__all__ = ["Cancelled", "PythonSnapshot", "Snapshot"]

_T = TypeVar("_T")

_PROPERTY: Final = re.compile(r"\s*\w+\s*(?:\[[^\]]*\])?\s*:")
"""The beginning of a line that gives a property its default."""


class Cancelled(Exception):
    """Raised by work that nobody waits for any more."""


class Snapshot:
    """A document as it stood at one moment. Nothing of it changes; what is derived from its text is derived once.

    Lines count from 1. Columns of places count characters from 0, as in `Span`; those of nodes and tokens count bytes,
    as in `ast`. Tokens are known by their index in `tokens`.
    """

    def __init__(self, text: str, filename: str) -> None:
        self.source = Source(text, filename)
        self._lock = threading.Lock()
        self._making: dict[str, threading.RLock] = {}
        self._known: dict[str, Any] = {}

    @property
    def text(self) -> str:
        """The text, as `Source` has it."""
        return self.source.text

    @property
    def filename(self) -> str:
        """The name of the file, or what stands for it in messages."""
        return self.source.filename

    @property
    def tokens(self) -> Tokens:
        """The tokens of the text."""
        return self._once("tokens", lambda: lex(self.text, WORDS))

    @property
    def parsed(self) -> ParseResult:
        """The tree and what is wrong with the syntax."""
        return self._once("parsed", lambda: parse_lexed(self.tokens, filename=self.filename))

    @property
    def tree(self) -> ast.Module:
        """The tree, as complete as it could be made."""
        return self.parsed.tree

    @property
    def resolution(self) -> Resolution:
        """The scopes and what each name in them means."""
        return self._once("resolution", self._resolve)

    def model(self, modules: Modules) -> Model:
        """Return the semantic model of this version, which knows other modules by ``modules``."""
        return Model(read_module(self.source, tree=self.tree, resolution=self.resolution), modules)

    def derived(self, key: str, make: Callable[[], _T], *, stamp: object = None) -> _T:
        """Return a value that a feature derives from this version, computed on first use and kept.

        It is made anew when ``stamp``, which stands for whatever else it depends on, is another one than last time.
        """
        known, value = self._once(f"derived {key}", lambda: (stamp, make()))
        if known != stamp:
            value = make()
            self._known[f"derived {key}"] = (stamp, value)
        return value

    # Places

    def token_at(self, line: int, column: int) -> int | None:
        """The word, number, string or mark at a place; between two of them the word, or else the one on the right."""
        tokens, source = self.tokens, self.source
        if not 1 <= line <= len(source.lines) or column > len(source.line(line)):
            return None
        byte = source.byte(line, column)
        token = None
        for index in self.tokens_of_line(line):
            if tokens.columns[index] <= byte <= tokens.end_columns[index] and tokens.texts[index]:
                touching = index
                if byte < tokens.end_columns[index] or self.is_word(index):
                    if token is None or not self.is_word(token):
                        token = touching
                elif token is None:
                    token = touching
        return token

    def tokens_of_line(self, line: int) -> range:
        """Return the tokens that begin on a line."""
        lines = self.tokens.lines
        return range(bisect_left(lines, line), bisect_right(lines, line))

    def is_word(self, token: int) -> bool:
        """Return whether a token is a name or a keyword."""
        return self.tokens.kinds[token] >= NAME or (
            self.tokens.texts[token][:1].isidentifier() and self._is_key(token)
        )

    def _is_key(self, token: int) -> bool:
        return WORDS.get(self.tokens.texts[token]) == self.tokens.kinds[token]

    def span_of_token(self, token: int) -> Span:
        """The place of a token."""
        tokens, source = self.tokens, self.source
        line, end_line = tokens.lines[token], tokens.end_lines[token]
        return Span(
            line,
            source.character(line, tokens.columns[token]),
            end_line,
            source.character(end_line, tokens.end_columns[token]),
        )

    def path_to(self, line: int, column: int) -> list[ast.AST]:
        """The nodes around a place, the innermost last; the place between two nodes belongs to the one on the right."""
        place = (line, self.source.byte(line, column))
        path: list[ast.AST] = [self.tree]
        while True:
            inner = touching = None
            for child in _placed(path[-1]):
                start = (getattr(child, "lineno", 0), getattr(child, "col_offset", 0))
                end = (getattr(child, "end_lineno", 0), getattr(child, "end_col_offset", 0))
                if start <= place < end:
                    inner = child
                    break
                if place == end:
                    touching = child
            inner = inner or touching
            if inner is None:
                return path
            path.append(inner)

    def scope_at(self, line: int, column: int) -> Scope:
        """The innermost scope at a place; after the last statement of a block, the scope that the indentation selects."""
        resolution = self.resolution
        scope = resolution.module
        path = self.path_to(line, column)
        for node in [*path, *self._blocks_after(path[-1], line, column)]:
            scope = resolution.scopes.get(node) or scope
        if scope.kind is ScopeKind.CLASS and _PROPERTY.match(self.source.line(line)[:column]):
            # A property whose default is still to be written is not in the tree yet.
            return _scope_of_default(scope)
        return scope

    def _blocks_after(self, node: ast.AST, line: int, column: int) -> Iterator[ast.AST]:
        """Yield the blocks within a node that end before a place, though its line is indented as one of theirs."""
        content = self.source.line(line)[:column]
        indentation = len(content) - len(content.lstrip())
        while True:
            before = [
                each
                for each in _placed(node)
                if isinstance(each, ast.stmt) and each.lineno < line and each.col_offset < indentation
            ]
            if not before:
                return
            node = before[-1]
            yield node

    # How things are made

    def _once(self, key: str, make: Callable[[], _T]) -> _T:
        if key not in self._known:
            with self._lock:
                making = self._making.setdefault(key, threading.RLock())
            # One lock for each thing: a feature that needs the tree does not wait for a check.
            with making:
                if key not in self._known:
                    self._known[key] = make()
        value: _T = self._known[key]
        return value

    def check(
        self, surroundings_of: SurroundingsOf | None, go_on: Callable[[], None] = lambda: None
    ) -> tuple[Diagnostic, ...]:
        """The findings of the static check; ``go_on`` is called now and then, and may raise to stop."""
        return check_tree(
            self.parsed,
            self.source,
            resolution=self.resolution,
            surroundings_of=surroundings_of,
            go_on=go_on,
            typing=True,
        )

    def _resolve(self) -> Resolution:
        with deep_recursion():
            return bind(self.tree)


class PythonSnapshot(Snapshot):
    """A module of Python, of which there are only the tokens and the tree, which Python's own parser has made."""

    def __init__(self, source: Source, tree: ast.Module) -> None:
        super().__init__(source.text, source.filename)
        self._tree = tree

    @property
    def tree(self) -> ast.Module:
        """The tree; empty if the text is not Python."""
        return self._tree


def _scope_of_default(cls: Scope) -> Scope:
    """Return the scope of the default of a property of a class."""
    scope = Scope(ScopeKind.PROPERTY, cls.name, cls.node, cls)
    scope.bindings["self"] = binding = Binding("self", scope)
    binding.sites.append(cls.node)
    binding.kinds.add(BindingKind.SELF)
    return scope


def _placed(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the children of a node that have places; for those that have none, their children."""
    stack = parts(node)[::-1]
    while stack:
        child = stack.pop()
        if getattr(child, "end_lineno", None) is None:
            stack.extend(parts(child)[::-1])
        else:
            yield child
