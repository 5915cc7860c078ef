"""Parsing on after a mistake.

`Recovery` runs over the statements of a block. One that the fast parser refuses goes to the recording parser, which
calls back here for the blocks inside it: so every mistake is found in the smallest statement around it, and what is
around that survives. If a statement is beyond help, the rest of its line is skipped, its blocks are parsed for
themselves, and an `ErrorStatement` holds what was in them.
"""

import ast
from typing import Any, Final

from scenic.compiler import tree
from scenic.compiler.actions import Actions, Problem, make
from scenic.compiler.expectations import Expectations
from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS, build_parser, build_recording_parser
from scenic.compiler.lexer import DEDENT, ENDMARKER, ERROR, INDENT, NEWLINE, Tokens

_CONTINUATIONS: Final = frozenset(
    [HARD_KEYWORDS[word] for word in ("elif", "else", "except", "finally")]
    + [SOFT_KEYWORDS[word] for word in ("interrupt", "case", "compose")]
)
"""Words that start a further clause of a statement with a block."""

MOST_PROBLEMS: Final = 200
"""So many mistakes are explained; the statements after them are kept or skipped all the same."""


DEEPEST_RETRY: Final = 12
"""In blocks nested deeper than this, the fast parser is not tried first: what is wrong deep inside would be parsed again
for every block around it."""


class Recovery:
    """Parses the tokens of one text that has a mistake; ``problems`` holds what was found."""

    def __init__(self, tokens: Tokens, actions: Actions) -> None:
        self.tokens = tokens
        self.actions = actions
        self.problems: list[Problem] = []
        self.expectations = Expectations(tokens)
        self._kinds = [*tokens.kinds, 0, 0, 0, 0]
        lists = (
            self._kinds,
            tokens.texts,
            tokens.lines,
            tokens.columns,
            tokens.end_lines,
            tokens.end_columns,
            actions,
        )
        self._fast = build_parser(*lists)
        self._recording = build_recording_parser(*lists, self.statements)
        self._done: dict[tuple[str, int], tuple[list[Any], int]] = {}
        # The token at which each mistake was reported, so that none is reported twice.
        self._reported: set[int] = set()
        self._depth = 0
        self._lexical_lines = {each.span.line for each in tokens.diagnostics if each.span is not None}

    def file(self) -> ast.Module:
        """The whole tree."""
        body: list[Any] = []
        position = 0
        while True:
            statements, position = self.statements("statement", position)
            body += statements
            if self._kinds[position] == ENDMARKER:
                return self.actions.module(body)
            position += 1  # the end of a block that never began

    def statements(self, rule: str, position: int) -> tuple[list[Any], int]:
        """The statements (as ``rule`` has them) from ``position`` to the end of the block, and where that is."""
        known = self._done.get((rule, position))
        if known is None:
            self._depth += 1
            try:
                known = self._done[rule, position] = self._statements(rule, position)
            finally:
                self._depth -= 1
        return known

    def _statements(self, rule: str, position: int) -> tuple[list[Any], int]:
        kinds = self._kinds
        body: list[Any] = []
        previous: int | None = None
        while kinds[position] not in (DEDENT, ENDMARKER):
            if kinds[position] == INDENT:
                inner, position = self._unexpected_block(position)
                body += inner
                continue
            start = position
            node, position = self._statement(rule, start, previous)
            previous = start
            if isinstance(node, list):
                body += node
            else:
                body.append(node)
        return body, position

    def _statement(self, rule: str, start: int, previous: int | None) -> tuple[Any, int]:
        """One statement, by whichever means; the one before it starts at ``previous``."""
        actions = self.actions
        outer_failure = actions.failure
        try:
            if self._depth <= DEEPEST_RETRY:
                node, end = self._fast(rule, start)
                if node is not None:
                    return node, end
            actions.failure = None
            node, end, farthest, expected = self._recording(rule, start)
            if node is not None:
                return node, end
            failure = actions.failure
            if failure is None and previous is not None and self._kinds[start] in _CONTINUATIONS:
                # The clause belongs to the statement before: what was wrong with it there?
                _, _, reached, wanted = self._recording(rule, previous)
                if reached >= farthest:
                    farthest, expected = reached, wanted
            self._explain(start, farthest, expected, failure)
            return self._skip(rule, start, farthest)
        except RecursionError:
            place = actions.place_of_token(start)
            self.problems.append(
                Problem(
                    "SC112", place, "this statement is nested too deeply", "split it into several statements"
                )
            )
            return self._skip(rule, start, start)
        finally:
            actions.failure = outer_failure

    def _explain(self, start: int, farthest: int, expected: set[Any], failure: Problem | None) -> None:
        farthest = max(start, farthest)
        if start in self._reported:
            # The beginning is wrong already, and what follows it is not worth a second message.
            self._reported.add(farthest)
            return
        if failure is not None:
            self._add(failure, farthest)
            return
        # Where the lexer found something wrong, the parser has nothing to add.
        if self._kinds[farthest] == ERROR or self._lexical_between(start, farthest):
            self._reported.add(farthest)
            return
        self._add(self.expectations.problem(start, farthest, expected), farthest)

    def _add(self, problem: Problem, token: int) -> None:
        if token not in self._reported and len(self.problems) < MOST_PROBLEMS:
            self.problems.append(problem)
        self._reported.add(token)

    def _lexical_between(self, start: int, end: int) -> bool:
        lines = self.tokens.lines
        return any(lines[start] <= line <= lines[end] for line in self._lexical_lines)

    def _skip(self, rule: str, start: int, farthest: int) -> tuple[ast.AST, int]:
        """Skip the statement at ``start``, of which ``farthest`` is the token that cannot be right.

        A clause of ``match`` becomes one that matches anything, so that the tree has the nodes that it should.
        """
        kinds = self._kinds
        position = start
        body: list[Any] = []
        while True:
            position, found = self._skip_line(position)
            body += found or []
            if position >= farthest or kinds[position] in (DEDENT, ENDMARKER):
                break
        if found is not None:
            # The clauses after a block whose beginning was wrong mean nothing without it.
            while kinds[position] in _CONTINUATIONS and self._starts_clause(position):
                position, found = self._skip_line(position)
                body += found or []
        last = position - 1
        while last > start and kinds[last] in (NEWLINE, INDENT, DEDENT):
            last -= 1
        place = (*self.actions.place_of_token(start)[:2], *self.actions.place_of_token(last)[2:])
        node: ast.AST = make(tree.ErrorStatement, place, body=body)
        if rule == "case_block":
            pattern = make(ast.MatchAs, place, pattern=None, name=None)
            node = make(ast.match_case, None, pattern=pattern, guard=None, body=[node])
        return node, position

    def _starts_clause(self, position: int) -> bool:
        """Whether the line at ``position`` has a block."""
        kinds = self._kinds
        while kinds[position] not in (NEWLINE, ENDMARKER):
            position += 1
        return kinds[position + 1] == INDENT

    def _skip_line(self, position: int) -> tuple[int, list[Any] | None]:
        """Skip to the end of the line, and over its block, whose statements are returned."""
        kinds = self._kinds
        start = position
        while kinds[position] not in (NEWLINE, ENDMARKER):
            position += 1
        if kinds[position] == NEWLINE:
            position += 1
        if kinds[position] != INDENT:
            return position, None
        rule = "statement"
        if kinds[start] == HARD_KEYWORDS["class"]:
            rule = "class_item"
        elif kinds[start] == SOFT_KEYWORDS["match"] and kinds[position + 1] == SOFT_KEYWORDS["case"]:
            rule = "case_block"
        body, position = self.statements(rule, position + 1)
        return position + (kinds[position] == DEDENT), body

    def _unexpected_block(self, position: int) -> tuple[list[Any], int]:
        """A block that nothing begins; its statements count as those of the block around it."""
        first = position + 1
        if not self._lexical_between(first, first) and first not in self._reported:
            self.problems.append(
                Problem(
                    "SC102",
                    self.actions.place_of_token(first),
                    "this line is indented more than the one before, which begins no block",
                    "align it with the line before",
                )
            )
        body, end = self.statements("statement", first)
        return body, end + (self._kinds[end] == DEDENT)


__all__ = ["MOST_PROBLEMS", "Recovery"]
