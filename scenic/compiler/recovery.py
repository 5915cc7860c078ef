"""Parsing on after a mistake.

`Recovery` runs over the statements of a block. One that the fast parser refuses goes to the recording parser, which
calls back here for the blocks inside it: so every mistake is found in the smallest statement around it, and what is
around that survives. If a statement is beyond help, the rest of its line is skipped, its blocks are parsed for
themselves, and an `ErrorStatement` holds what was in them.
"""

import ast
from bisect import bisect_left, bisect_right
from typing import Any, Final

from scenic.compiler import tree
from scenic.compiler.actions import Actions, SyntaxProblem, make
from scenic.compiler.actions.common import place_of
from scenic.compiler.contexts import set_contexts
from scenic.compiler.expectations import Expectations
from scenic.compiler.generated import (
    HARD_KEYWORDS,
    OPERATORS,
    SOFT_KEYWORDS,
    SPECIFIER_KINDS,
    build_parser,
    build_recording_parser,
)
from scenic.compiler.tokens import DEDENT, ENDMARKER, ERROR, INDENT, NEWLINE, Tokens

_IF, _ELIF, _ELSE, _WITH, _WHILE, _TRY, _EXCEPT, _FINALLY, _CLASS = (
    HARD_KEYWORDS[word]
    for word in ("if", "elif", "else", "with", "while", "try", "except", "finally", "class")
)
_INTERRUPT, _WHEN, _CASE, _MATCH, _SETUP, _COMPOSE = (
    SOFT_KEYWORDS[word] for word in ("interrupt", "when", "case", "match", "setup", "compose")
)
_NEW, _OVERRIDE = HARD_KEYWORDS["new"], SOFT_KEYWORDS["override"]
_COLON, _COMMA, _STAR = (OPERATORS[mark] for mark in (":", ",", "*"))

_CLAUSES: Final = frozenset([_ELIF, _ELSE, _EXCEPT, _FINALLY])
"""Words that start nothing but a further clause of a statement with a block."""

_CLAUSE_WORDS: Final = ("elif", "else", "except", "finally", "interrupt")

_SOFT_CLAUSES: Final = frozenset([_CASE, _SETUP, _COMPOSE])
"""Words that start a clause, or a part of a scenario, if a block follows; otherwise they are names."""

_NO_OPERAND: Final = frozenset(OPERATORS[mark] for mark in ("=", ".", ":", ",", ")"))
"""Kinds of tokens after which the preceding word can only be a name."""

_CLOSERS: Final = (")", "]", "}")

_OF_STATEMENTS: Final = ("statement", "class_item")
"""The rules of blocks that hold statements."""

_SEMICOLON: Final = OPERATORS[";"]
_CLAUSED: Final = _CLAUSES | {HARD_KEYWORDS["for"], HARD_KEYWORDS["async"], _IF, _WHILE, _TRY, _INTERRUPT}
"""First words of statements that may have further clauses, and of those."""

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
        self.problems: list[SyntaxProblem] = []
        self.expectations = Expectations(tokens)
        lists = (*tokens.lists(), actions)
        self._kinds = lists[0]
        self._fast = build_parser(*lists)
        self._recording = build_recording_parser(*lists, self.statements)
        self._done: dict[tuple[str, int], tuple[list[Any], int]] = {}
        # The token at which each mistake was reported, so that none is reported twice.
        self._reported: set[int] = set()
        self._last_reported = -1
        # The first and last lines of scenarios whose parts stand among statements because something else is wrong.
        self._spoilt: list[tuple[int, int]] = []
        self._depth = 0
        self._lexical_lines = sorted({each.span.line for each in tokens.diagnostics if each.span is not None})

    def file(self) -> ast.Module:
        """Return the whole tree."""
        body: list[Any] = []
        position = 0
        while True:
            statements, position = self.statements("statement", position)
            body += statements
            if self._kinds[position] == ENDMARKER:
                self._forget_guards()
                module = self.actions.module(body)
                set_contexts(module)
                return module
            position += 1  # the end of a block that never began

    def statements(self, rule: str, position: int) -> tuple[list[Any], int]:
        """Return the statements (as ``rule`` has them) from ``position`` to the end of the block, and where that is."""
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
        first = position
        previous: int | None = None
        parts: list[int] = []
        while kinds[position] not in (DEDENT, ENDMARKER):
            if kinds[position] == INDENT:
                inner, end, is_header = self._unexpected_block(rule, position)
                if is_header and previous is not None and body:
                    # What stands in the block belongs to a header that is not complete.
                    body[-1] = self._error(previous, end, inner)
                else:
                    body += inner
                position = end
                continue
            start = position
            if kinds[start] in (_SETUP, _COMPOSE) and rule in _OF_STATEMENTS and self._is_clause(start):
                parts.append(start)
                nodes, position, _ = self._clause(start)
                node = self._error(start, position, nodes)
            elif rule in _OF_STATEMENTS and self._is_clause(start):
                open_statement = self._unfinished_clause(start, previous)
                node, position = self._stray_clause(start, previous, unfinished=open_statement is not None)
                if (
                    open_statement is not None
                    and open_statement == previous
                    and isinstance(body[-1], ast.Expr)
                ):
                    body[-1] = self._error(previous, start, [])
                if open_statement is not None and self._reported.isdisjoint(range(open_statement, start)):
                    self._add(self.expectations.unfinished_clause(open_statement), open_statement)
            else:
                node, position = self._statement(rule, start)
            if isinstance(node, list) and rule != "specifier_line":
                body += node
            else:
                body.append(node)
            if previous is not None and kinds[start] == ERROR and isinstance(body[-1], tree.ErrorStatement):
                self._forget_closer(start, previous)
            previous = start
        if parts:
            self._stray_part(first, parts, position)
        return body, position

    def _stray_part(self, first: int, parts: list[int], end: int) -> None:
        """Parts of a scenario stand among other statements, in a block from ``first`` to ``end``.

        If something else is wrong with the block or its header, that is why.
        """
        kinds = self._kinds
        part = parts[0]
        for index, again in enumerate(parts):
            earlier = next((each for each in parts[:index] if kinds[each] == kinds[again]), None)
            if earlier is not None and earlier + 1 not in self._reported:
                word = self.tokens.texts[again]
                place = self.actions.place_of_token
                problem = SyntaxProblem(
                    "SC210",
                    place(again),
                    f"a scenario has only one `{word}` block",
                    "move its statements into the first, or write a second scenario",
                    ((place(earlier), f"the first `{word}` is here"),),
                )
                self._add(problem, again)
                self._spoilt.append((self.tokens.lines[first], self.tokens.lines[end]))
                return
        header = max(0, first - 3)
        while header > 0 and kinds[header - 1] not in (NEWLINE, INDENT, DEDENT):
            header -= 1
        if (
            header <= self._last_reported < end
            # A header without a colon will be told of.
            or (first > 2 and kinds[first - 1] == INDENT and kinds[first - 3] != _COLON)
            or self._lexical_between(header, end)
        ):
            self._spoilt.append((self.tokens.lines[first], self.tokens.lines[end]))
        else:
            _, _, farthest, alternatives = self._recording("statement", part)
            self._explain(part, farthest, alternatives, None)

    def _statement(self, rule: str, start: int) -> tuple[Any, int]:
        """Parse one statement with the fast parser, or else with the recording one, or else skip it."""
        actions = self.actions
        outer_failure = actions.failure
        try:
            if self._depth <= DEEPEST_RETRY:
                node, end = self._fast(rule, start)
                # If what follows belongs to it, its end may not be where it seemed.
                cut_short = self._kinds[end] == INDENT or (
                    self._kinds[start] in _CLAUSED and self._is_clause(end)
                )
                if node is not None and not cut_short:
                    return node, end
            actions.failure = None
            node, end, farthest, alternatives = self._recording(rule, start)
            if node is not None:
                return node, end
            failure = actions.failure
            node, end, is_explained = self._skip(rule, start, farthest)
            if not is_explained:
                self._explain(start, farthest, alternatives, failure)
            return node, end
        except RecursionError:
            place = actions.place_of_token(start)
            self.problems.append(
                SyntaxProblem(
                    "SC112", place, "this statement is nested too deeply", "split it into several statements"
                )
            )
            return self._skip(rule, start, start)[:2]
        finally:
            actions.failure = outer_failure

    # Clauses without the statement that they belong to, because that was wrong, or is missing.

    def _is_clause(self, position: int) -> bool:
        kinds = self._kinds
        kind = kinds[position]
        if kind in _CLAUSES:
            return True
        if kind == _INTERRUPT:
            return kinds[position + 1] == _WHEN or self._has_block(position)
        if kind in (_SETUP, _COMPOSE):
            return kinds[position + 1 : position + 4] == [_COLON, NEWLINE, INDENT]
        return kind == _CASE and self._has_block(position)

    def _has_block(self, position: int) -> bool:
        """Return whether the line at ``position`` has a block."""
        kinds = self._kinds
        while kinds[position] not in (NEWLINE, ENDMARKER):
            position += 1
        return kinds[position] == NEWLINE and kinds[position + 1] == INDENT

    def _unfinished_clause(self, position: int, previous: int | None) -> int | None:
        """Return the line before the one at ``position``, if it is the beginning of a clause that is being typed.

        If a block stands between them, that line is the one of the statement at ``previous``.
        """
        kinds = self._kinds
        if position < 2:
            return None
        if kinds[position - 1] == NEWLINE:
            start, end = position - 1, position - 1
            while start > 0 and kinds[start - 1] not in (NEWLINE, INDENT, DEDENT) and position - start < 4:
                start -= 1
        elif previous is not None and self._has_block(previous):
            start, end = previous, self._line_end(previous)
        else:
            return None
        words = self.tokens.texts[start:end]
        if not words or len(words) > 2 or (words[1:] and not "when".startswith(words[1])):
            return None
        return start if any(word.startswith(words[0]) for word in _CLAUSE_WORDS) else None

    def _stray_clause(self, start: int, previous: int | None, *, unfinished: bool) -> tuple[Any, int]:
        """Return a clause that stands for itself; the statement before it starts at ``previous``.

        If that one is an ``unfinished`` clause, this one is right where it stands.
        """
        body, end, right = self._clause(start)
        if right and not unfinished:
            # Then it must be the place that is wrong.
            actions = self.actions
            outer_failure = actions.failure
            actions.failure = None
            _, _, farthest, alternatives = self._recording("statement", start)
            if previous is not None and self._kinds[previous] in _CLAUSED:
                # The clause belongs to the statement before: what was wrong with it there?
                _, _, stop, alternatives_before = self._recording("statement", previous)
                if stop == start:
                    farthest, alternatives = stop, alternatives_before
            actions.failure = outer_failure
            self._explain(start, farthest, alternatives, None)
        body, end = self._clauses(end, body)
        return self._error(start, end, body), end

    def _forget_guards(self) -> None:
        """Drop the reports of guards of a scenario whose parts are spoilt: the guards stand where they should."""
        problems = self.actions.problems
        self._spoilt.sort()
        for key, problem in list(problems.items()):
            if problem.code != "SC132":
                continue
            index = bisect_right(self._spoilt, (problem.place[0], len(self.tokens.text))) - 1
            if index >= 0 and problem.place[0] <= self._spoilt[index][1]:
                del problems[key]

    def _clauses(self, position: int, body: list[Any]) -> tuple[list[Any], int]:
        """Return the clauses that follow, each for itself, added to ``body``."""
        while self._is_clause(position):
            found, position, _ = self._clause(position)
            body += found
        return body, position

    def _clause(self, start: int) -> tuple[list[Any], int, bool]:
        """The statements of a clause, its end, and whether its first line is right.

        A clause is read as the statement that looks most like it.
        """
        kinds = self._kinds
        kind = kinds[start]
        if kind == _CASE:
            return self._clause_as("case_block", start, start, _CASE)
        if kind == _INTERRUPT and kinds[start + 1] != _WHEN:
            self._explain(start, start + 1, {_WHEN}, None)
            body, end = self._skip_lines("statement", start, start + 1)
            return body, end, False
        if kind == _INTERRUPT:
            return self._clause_as("statement", start, start + 1, _WHILE)
        if kind == _ELIF:
            return self._clause_as("statement", start, start, _IF)
        if kind == _EXCEPT and kinds[start + 1] != _COLON:
            return self._clause_as("statement", start, start + (kinds[start + 1] == _STAR), _WITH)
        if kinds[start + 1] != _COLON:
            self._explain(start, start + 1, {_COLON}, None)
            body, end = self._skip_lines("statement", start, start + 1)
            return body, end, False
        if kinds[start + 2 : start + 4] == [NEWLINE, INDENT]:
            body, end = self.statements("statement", start + 4)
            return [*body], end + (kinds[end] == DEDENT), True
        if kinds[start + 2] == NEWLINE:
            self._explain(start, start + 3, {"an indented block"}, None)
            return [], start + 3, False
        node, end = self._statement("statement", start + 2)
        return node if isinstance(node, list) else [node], end, True

    def _clause_as(self, rule: str, start: int, position: int, kind: int) -> tuple[list[Any], int, bool]:
        """Read the clause at ``start`` with its token at ``position`` taken for another keyword."""
        kinds, actions = self._kinds, self.actions
        original, kinds[position] = kinds[position], kind
        outer_failure = actions.failure
        actions.failure = None
        try:
            node, end, farthest, alternatives = self._recording(rule, position)
            failure = actions.failure
        finally:
            kinds[position] = original
            actions.failure = outer_failure
        if node is not None:
            return list(node.body) if rule == "case_block" else [node], end, True
        body, end = self._skip_lines("statement", start, farthest)
        self._explain(start, farthest, alternatives, failure)
        return body, end, False

    def _forget_closer(self, start: int, previous: int) -> None:
        """Suppress the report of a line that starts with a bracket that closes nothing, after a wrong statement."""
        tokens = self.tokens
        place = (tokens.lines[start], tokens.columns[start])
        lines = (tokens.lines[previous], tokens.lines[start])
        wrong = previous <= self._last_reported < start or any(
            lines[0] <= problem.place[0] < lines[1] for problem in self.actions.problems.values()
        )
        if tokens.texts[start] in _CLOSERS and wrong:
            tokens.diagnostics[:] = [
                each
                for each in tokens.diagnostics
                if each.code != "SC103" or each.span is None or (each.span.line, each.span.column) != place
            ]

    def _explain(self, start: int, farthest: int, expected: set[Any], failure: SyntaxProblem | None) -> None:
        farthest = max(start, farthest)
        if (
            start in self._reported  # and what follows a wrong beginning is not worth a second message
            or farthest in self._reported
            or len(self.problems) >= MOST_PROBLEMS
            # Where the lexer found something wrong, the parser has nothing to add.
            or self._kinds[farthest] == ERROR
            or self._lexical_between(start, min(farthest, self._line_end(start)))
            or (failure is None and self._lexical_between(start, farthest))
        ):
            self._note(farthest)
        elif failure is not None:
            self._add(self.expectations.failed(start, failure), farthest)
        else:
            self._add(self.expectations.problem(start, farthest, expected), farthest)

    def _add(self, problem: SyntaxProblem, token: int) -> None:
        if len(self.problems) < MOST_PROBLEMS:
            self.problems.append(problem)
        self._note(token)

    def _note(self, token: int) -> None:
        self._reported.add(token)
        self._last_reported = max(self._last_reported, token)

    def _lexical_between(self, start: int, end: int) -> bool:
        """Return whether the lexer found something wrong on the lines from one token to another."""
        lines, wrong = self.tokens.lines, self._lexical_lines
        index = bisect_left(wrong, lines[start])
        return index < len(wrong) and wrong[index] <= lines[end]

    def _skip(self, rule: str, start: int, farthest: int) -> tuple[Any, int, bool]:
        """Skip the statement at ``start``, of which ``farthest`` is the token that cannot be right.

        Gives what stands for it, its end, and whether a later clause is wrong that has explained all. A clause of ``match``
        becomes one that matches anything, so that the tree has the nodes that it should; specifiers are left out.
        """
        kinds = self._kinds
        body, first_end = self._skip_lines(rule, start, min(farthest, self._line_end(start)))
        position, is_explained = first_end, False
        if rule != "case_block" and (kinds[start] in _CLAUSED or kinds[first_end - 1] == DEDENT):
            while self._is_clause(position):
                nodes, position, right = self._clause(position)
                body += nodes
                is_explained = is_explained or not right
            is_explained = is_explained and farthest >= first_end
        while position < farthest and kinds[position] not in (DEDENT, ENDMARKER):
            position, nodes = self._skip_line(position)
            body += nodes
        if rule == "specifier_line":
            return [], position, False
        node = self._error(start, position, body)
        if rule == "case_block":
            pattern = make(ast.MatchAs, place_of(node), pattern=None, name=None)
            return (
                make(ast.match_case, None, pattern=pattern, guard=None, body=[node]),
                position,
                is_explained,
            )
        return node, position, is_explained

    def _error(self, start: int, end: int, body: list[Any]) -> ast.AST:
        """Make the node for the tokens from ``start`` up to ``end`` that form no statement; ``body`` contains
        the nodes found in them.
        """
        kinds = self._kinds
        last = end - 1
        while last > start and (kinds[last] in (NEWLINE, INDENT, DEDENT) or self._is_gap(last)):
            last -= 1
        place = (*self.actions.place_of_token(start)[:2], *self.actions.place_of_token(last)[2:])
        return make(tree.ErrorStatement, place, body=body)

    def _is_gap(self, position: int) -> bool:
        """Return whether a token only marks a gap; it may be after the end of the source."""
        return self._kinds[position] == ERROR and not self.tokens.texts[position]

    def _line_end(self, position: int) -> int:
        """Return the token that ends the line."""
        while self._kinds[position] not in (NEWLINE, ENDMARKER):
            position += 1
        return position

    def _line_start(self, position: int) -> int:
        """Return the token that begins the line."""
        kinds = self._kinds
        while position > 0 and kinds[position - 1] not in (NEWLINE, INDENT, DEDENT):
            position -= 1
        return position

    def _skip_lines(self, rule: str, start: int, farthest: int) -> tuple[list[Any], int]:
        """Skip lines with their blocks until ``farthest`` is behind; what is in the blocks is returned."""
        position, body = self._skip_line(start, in_specifiers=rule == "specifier_line")
        while position < farthest and self._kinds[position] not in (DEDENT, ENDMARKER):
            position, found = self._skip_line(position)
            body += found
        return body, position

    def _skip_line(self, start: int, *, in_specifiers: bool = False) -> tuple[int, list[Any]]:
        """Skip to the end of the line, and over its block, whose statements are returned."""
        kinds = self._kinds
        position = self._line_end(start)
        if kinds[position] == NEWLINE:
            position += 1
        if kinds[position] != INDENT:
            return position, []
        rule = "statement"
        if in_specifiers or (kinds[position - 2] == _COMMA and self._is_specifier(position + 1)):
            rule = "specifier_line"
        elif kinds[start] == _CLASS:
            rule = "class_item"
        elif kinds[start] == _MATCH and kinds[position + 1] == _CASE:
            rule = "case_block"
        body, position = self.statements(rule, position + 1)
        if rule == "case_block":
            body = [statement for clause in body for statement in clause.body]
        return position + (kinds[position] == DEDENT), [] if rule == "specifier_line" else [*body]

    def _is_specifier(self, position: int) -> bool:
        """Return whether the line at ``position`` looks like one of specifiers."""
        kinds = self._kinds
        if kinds[position] not in SPECIFIER_KINDS or kinds[position + 1] in _NO_OPERAND:
            return False
        return kinds[self._line_end(position) - 1] != _COLON

    def _unexpected_block(self, rule: str, position: int) -> tuple[list[Any], int, bool]:
        """Return a block that nothing begins; its statements count as those of the block around it.

        Also tells whether the line before is a header that is not complete.
        """
        first = position + 1
        before = self._line_start(max(0, position - 2))
        if before in self._reported and self._unfinished_clause(position, before) is not None:
            # The block of a clause of which it has been said already that it is not complete.
            body, end = self.statements(rule, first)
            return body, end + (self._kinds[end] == DEDENT), True
        header = None
        specifiers = rule == "specifier_line" or self._is_specifier(first)
        if not self._lexical_between(first, first) and first not in self._reported:
            if specifiers and rule != "specifier_line" and self._may_take_specifiers(position - 2):
                self._add(self._no_specifiers(position), first)
            else:
                header = self.expectations.unfinished_header(first)
                self._add(header or self.expectations.unexpected_block(first), first)
        body, end = self.statements("specifier_line" if specifiers else rule, first)
        if specifiers and rule != "specifier_line":
            body = []
        return body, end + (self._kinds[end] == DEDENT), header is not None

    def _may_take_specifiers(self, last: int) -> bool:
        """Return whether the line that ends with the token ``last`` may be one that makes an instance."""
        kinds = self._kinds
        if kinds[last] == _COMMA:
            return True
        if kinds[last] == _SEMICOLON:
            return False
        while last >= 0 and kinds[last] not in (NEWLINE, INDENT, DEDENT):
            if kinds[last] in (_NEW, _OVERRIDE):
                return True
            last -= 1
        return False

    def _no_specifiers(self, position: int) -> SyntaxProblem:
        """Specifiers stand on lines of their own, and the line before does not allow that."""
        last = position - 2
        line, column = self.tokens.end_lines[last], self.tokens.end_columns[last]
        if self._kinds[last] == _COMMA:
            return SyntaxProblem(
                "SC111",
                self.actions.place_of_token(last),
                "specifiers follow, but this line makes no instance",
                "write `new` before the class",
            )
        place = (line, column, line, column)
        return SyntaxProblem(
            "SC113",
            place,
            "a comma is missing here, since the next line goes on with specifiers",
            "end the line with `,`",
            fix=("Insert a comma", ((place, ","),)),
        )


__all__ = ["MOST_PROBLEMS", "Recovery"]
