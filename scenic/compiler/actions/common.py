"""Needs of all actions: the tokens, a way to report mistakes, a way to make nodes."""

import ast
from collections.abc import Iterable
from typing import Any, Final, TypeAlias, TypeVar

from scenic.compiler.tokens import Tokens
from scenic.dataclass import dataclass

Place: TypeAlias = tuple[int, int, int, int]
"""Start and end: line from 1 and column in UTF-8 bytes, each."""

LOAD: Final = ast.Load()


@dataclass(frozen=True, slots=True)
class SyntaxProblem:
    """A problem at a place, before it is a diagnostic."""

    code: str
    place: Place
    message: str
    help: str | None = None
    labels: tuple[tuple[Place, str], ...] = ()
    fix: tuple[str, tuple[tuple[Place, str], ...]] | None = None
    """The title of the repair, and what replaces what."""


Node = TypeVar("Node", bound=ast.AST)


def make(node_class: type[Node], place: Place | None, **fields: Any) -> Node:
    """A node, made without the checks of its constructor, which take longer than all the rest."""
    node = node_class.__new__(node_class)
    if place is not None:
        fields["lineno"], fields["col_offset"], fields["end_lineno"], fields["end_col_offset"] = place
    node.__dict__ = fields
    return node


def place_of(node: ast.AST) -> Place:
    """The place of a node."""
    located: Any = node
    return (located.lineno, located.col_offset, located.end_lineno, located.end_col_offset)


class CommonActions:
    """The state of the actions on one text, and actions on lists of anything."""

    def __init__(self, tokens: Tokens) -> None:
        self._tokens = tokens
        self._texts = tokens.texts
        self._numbers: dict[str, int | float | complex] = {}
        """The values of the numbers read so far: most are written again and again."""
        self.problems: dict[tuple[str, Place], SyntaxProblem] = {}
        self.failure: SyntaxProblem | None = None

    def fail(self, place: Place, message: str, *, help: str | None = None, code: str = "SC110") -> None:
        """Note why the alternative being parsed fails; the first reason counts."""
        if self.failure is None:
            self.failure = SyntaxProblem(code, place, message, help)

    def _report(
        self,
        place: Place,
        message: str,
        *,
        help: str | None = None,
        code: str = "SC110",
        labels: tuple[tuple[Place, str], ...] = (),
    ) -> None:
        self.problems.setdefault((code, place), SyntaxProblem(code, place, message, help, labels))

    def place_of_token(self, index: int) -> Place:
        """The place of a token."""
        tokens = self._tokens
        return (
            tokens.lines[index],
            tokens.columns[index],
            tokens.end_lines[index],
            tokens.end_columns[index],
        )

    def module(self, statements: list[Any]) -> ast.Module:
        return make(ast.Module, None, body=self.flat(statements), type_ignores=[])

    def flat(self, statements: list[Any]) -> list[ast.stmt]:
        """Flatten a list of statements in which those of one line form a list."""
        for statement in statements:
            if type(statement) is list:
                break
        else:
            return statements
        flat: list[ast.stmt] = []
        for statement in statements:
            if type(statement) is list:
                flat += statement
            else:
                flat.append(statement)
        return flat

    def joined(self, lists: Iterable[list[Any]]) -> list[Any]:
        return [element for each in lists for element in each]

    def words(self, indices: Iterable[int]) -> list[str]:
        texts = self._texts
        return [texts[index] for index in indices]

    def count_dots(self, indices: Iterable[int]) -> int:
        return sum(len(self._texts[index]) for index in indices)
