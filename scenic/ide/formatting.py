"""Writing a document in the usual style.

The tokens of a statement on one line get the blanks and quotes of the style (`spacing`), and lose parentheses without which the
statement is read as before. Comments, blank lines (up to two), and the layout of statements that are written over several
lines stay; the latter are only moved with their block. Statements that share a line are put on lines of their own.

The result means the same and formats to itself; a text with mistakes is left alone. The style is described in
``docs/reference/format.md``.
"""

import ast
import difflib
import re
from bisect import bisect_left, bisect_right
from collections import Counter, deque
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import field
from itertools import pairwise
from typing import Any, Final

from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse, parse_lexed
from scenic.compiler.scopes import ScopeKind
from scenic.compiler.text_lines import measure
from scenic.compiler.tokens import DEDENT, ENDMARKER, FSTRING_MIDDLE, INDENT, NEWLINE, STRING, Tokens
from scenic.compiler.traversal import first_position, position
from scenic.compiler.tree import GUARDS
from scenic.dataclass import dataclass
from scenic.ide.snapshot import Snapshot
from scenic.ide.spacing import Lexeme, lexemes, needless_pairs, spaced
from scenic.language.diagnostics import Edit
from scenic.language.spans import Span

__all__ = ["format_text", "formatting"]

_INDENTATION: Final = "    "
_DEFINITION: Final = re.compile(r"@|async +def\b|(?:class|def|behavior|monitor|scenario) +\w+ *[\[(:]")


@dataclass(slots=True)
class _Line:
    """One logical line: its first and last line (from 1), its depth, and its comments.

    ``begin`` is its first token.
    """

    first: int
    last: int
    depth: int
    begin: int
    is_definition: bool = False
    is_decorator: bool = False
    trailing: str = ""
    above: list[tuple[int, int, str]] = field(default_factory=list)
    """Comments on lines of their own before it: line, column, text."""


def formatting(snapshot: Snapshot, *ranges: tuple[int, int]) -> tuple[Edit, ...]:
    """The changes that put a document into the usual style, one for each run of lines that change.

    With ``ranges``, each the first and the last of some lines, only changes that touch these; where a document would mean
    something else after them alone (a part of a block indented otherwise), those of the whole statements of the top
    level. None for a text with mistakes.
    """
    before = snapshot.text
    after = snapshot.derived("formatted", lambda: _formatted(snapshot))
    if after is None or after == before:
        return ()
    edits = tuple(_edits(before.split("\n"), after.split("\n")))
    if not ranges:
        return edits
    for lines in (ranges, [_statements_around(snapshot.tree, *each) for each in ranges]):
        chosen_edits = tuple(
            each
            for each in edits
            if any(each.span.line <= last and _last_line(each) >= first for first, last in lines)
        )
        if _same(snapshot.tree, snapshot.tokens, _edited(before, chosen_edits)):
            return chosen_edits
    return edits


def _edits(old: Sequence[str], new: Sequence[str]) -> Iterator[Edit]:
    for start, end, new_start, new_end in _changes(old, new):
        text = "\n".join(new[new_start:new_end])
        if end < len(old):
            span = Span(start + 1, 0, end + 1, 0)
            text += "\n" if new_end > new_start else ""
        elif start:
            # At the end of the text the line end before goes with what is replaced.
            span = Span(start, len(old[start - 1]), len(old), len(old[-1]))
            text = "\n" + text if new_end > new_start else ""
        else:
            span = Span(1, 0, len(old), len(old[-1]))
        yield Edit(span, text)


def _last_line(edit: Edit) -> int:
    """The last line that an edit touches; one that only inserts touches the line before which it does."""
    span = edit.span
    return span.end_line - 1 if span.end_column == 0 and span.end_line > span.line else span.end_line


def _statements_around(tree: ast.Module, first: int, last: int) -> tuple[int, int]:
    """The first and the last line of the statements of the top level on some lines, with what stands before these."""
    end = 0
    begin, stop = first, last
    for node in tree.body:
        start, end = end + 1, max(end, node.end_lineno or node.lineno)
        if start <= last and end >= first:
            begin, stop = min(begin, start), max(stop, end)
    return begin, stop


def _edited(text: str, edits: Sequence[Edit]) -> str:
    """Return a text after edits that are in order and do not overlap."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    parts, last_place = [], 0
    for each in edits:
        parts += [text[last_place : starts[each.span.line - 1] + each.span.column], each.text]
        last_place = starts[each.span.end_line - 1] + each.span.end_column
    return "".join([*parts, text[last_place:]])


def _changes(old: Sequence[str], new: Sequence[str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the differences of two texts: a range of lines of the old text and the range that replaces it, as
    few lines as possible.
    """
    # Lines that say the same are changed one by one; those that say nothing are like all others of their kind.
    matches = _matches([_said(line) for line in old], [_said(line) for line in new])
    old_place, new_done = 0, 0
    for index, other, size in matches:
        for at, new_at in zip(range(index, index + size), range(other, other + size), strict=True):
            stays = old[at] == new[new_at]
            if at > old_place or (new_at > new_done and stays):
                yield old_place, at, new_done, new_at
                old_place, new_done = at, new_at
            if not stays:
                # With what is inserted before it, if anything is: no two changes begin at one place.
                yield at, at + 1, new_done, new_at + 1
            old_place, new_done = at + 1, new_at + 1
    if old_place < len(old) or new_done < len(new):
        yield old_place, len(old), new_done, len(new)


def _matches(old: Sequence[str], new: Sequence[str]) -> Iterator[tuple[int, int, int]]:
    """Runs of equal lines of two texts, in order: where each begins in either text, and how many lines it has.

    Lines that occur once in both texts are matched first, and longest runs are looked for only between them ("patience
    diff"): looking for these in whole texts takes time that grows with the square of their length.
    """
    occurrences, new_occurrences = Counter(old), Counter(new)
    places = {line: at for at, line in enumerate(new) if line and new_occurrences[line] == 1}
    start = new_start = 0
    for at, line in [*enumerate(old), (len(old), None)]:
        if line is None:
            new_at = len(new)
        elif occurrences[line] == 1 and places.get(line, -1) >= new_start:
            new_at = places[line]
        else:
            continue
        if at > start and new_at > new_start:
            between = old[start:at], new[new_start:new_at]
            matcher = difflib.SequenceMatcher(lambda words: not words, *between, autojunk=False)
            for index, other, size in matcher.get_matching_blocks():
                if size:
                    yield start + index, new_start + other, size
        if line is not None:
            yield at, new_at, 1
        start, new_start = at + 1, new_at + 1


def _said(line: str) -> str:
    return "".join(filter(str.isalnum, line))


def format_text(text: str) -> str | None:
    r"""Return a program in the usual style; ``None`` if it has mistakes of syntax. ``text`` has ``\n`` at each line end."""
    return _formatted(Snapshot(text, "<text>"))


def _formatted(snapshot: Snapshot) -> str | None:
    if snapshot.parsed.diagnostics:
        return None
    lines = _logical_lines(snapshot.tokens)
    starts, misread_lines = _starts_of_statements(snapshot), _lines_of_misread(snapshot)
    parts = [[] if line.first in misread_lines else _parts(snapshot, line, starts) for line in lines]
    needless_tokens = _needless(snapshot, parts)
    layout = _Layout(snapshot.tokens)
    for line, of_line in zip(lines, parts, strict=True):
        line_parts = [
            spaced([each for each in part if each.token not in needless_tokens]) for part in of_line
        ]
        layout.add(line, line_parts)
    last = lines[-1].last if lines else 0
    layout.comments([comment for comment in snapshot.tokens.comments if comment[0] > last], 0)
    result = layout.text()
    return result if _same(snapshot.tree, snapshot.tokens, result) else None


def _parts(snapshot: Snapshot, line: _Line, starts: Container[tuple[int, int]]) -> list[list[Lexeme]]:
    """Return the statements and headers on a logical line; none if it takes several lines, which stay as they are."""
    if line.first != line.last:
        return []
    tokens = snapshot.tokens
    begin, end = line.begin, bisect_right(tokens.lines, line.first)
    cuts = [index for index in range(begin, end) if (tokens.lines[index], tokens.columns[index]) in starts]
    if not cuts or cuts[0] > begin:
        cuts.insert(0, begin)
    parts = [lexemes(snapshot, *cut) for cut in zip(cuts, [*cuts[1:], end], strict=True)]
    return [part[:-1] if part[-1].text == ";" else part for part in parts]


def _needless_commas(part: Sequence[Lexeme]) -> Iterator[int]:
    """Yield the tokens of commas before a closing bracket that mean nothing, as those after single elements of tuples do."""
    commas = [0]
    for before, lexeme in pairwise(part):
        if before.text in ("(", "[", "{"):
            commas.append(0)
        elif before.text == ",":
            commas[-1] += 1
        if lexeme.text in (")", "]", "}") and commas.pop() > 1 and before.text == ",":
            yield before.token


def _lines_of_misread(snapshot: Snapshot) -> Container[int]:
    """Return the lines with annotated variables that would become properties or guards on lines of their own."""
    return frozenset(
        node.lineno
        for node, scope in snapshot.resolution.by_class.get(ast.AnnAssign, ())
        if scope.kind is ScopeKind.CLASS or (isinstance(node.target, ast.Name) and node.target.id in GUARDS)
    )


def _starts_of_statements(snapshot: Snapshot) -> Container[tuple[int, int]]:
    return frozenset(
        position(node)
        for cls, nodes in snapshot.resolution.by_class.items()
        if issubclass(cls, ast.stmt)
        for node, _ in nodes
    )


def _needless(snapshot: Snapshot, parts: Sequence[list[list[Lexeme]]]) -> frozenset[int]:
    """Return the tokens of commas and parentheses without which the statements of the top level are read as before."""
    candidates: list[tuple[int, ...]] = []
    for part in (part for of_line in parts for part in of_line):
        candidates += [(token,) for token in _needless_commas(part)]
        candidates += [(opening.token, closing.token) for opening, closing in needless_pairs(part)]
    lines = [snapshot.tokens.lines[each[0]] for each in candidates]  # in their order, as parts are
    needless_tokens: set[int] = set()
    for first, last, statements in _groups(snapshot.tree):
        near = candidates[bisect_left(lines, first) : bisect_right(lines, last)]
        without = {token for each in near for token in each}
        if near and not _is_read_alike(snapshot, first, last, statements, without):
            without = set()
            for each in near:
                if _is_read_alike(snapshot, first, last, statements, without.union(each)):
                    without.update(each)
        needless_tokens |= without
    return frozenset(needless_tokens)


def _is_read_alike(
    snapshot: Snapshot, first: int, last: int, statements: Sequence[ast.stmt], without: Iterable[int]
) -> bool:
    """Return whether the lines from ``first`` to ``last`` are still these statements without some marks."""
    tokens = snapshot.tokens
    rows = [line.encode() for line in snapshot.source.lines[first - 1 : last]]
    for token in without:
        row, column = tokens.lines[token] - first, tokens.columns[token]
        rows[row] = rows[row][:column] + b" " + rows[row][column + 1 :]
    result = parse("\n".join(row.decode() for row in rows) + "\n")
    return not result.diagnostics and _equal(statements, result.tree.body)


def _groups(tree: ast.Module) -> Iterator[tuple[int, int, list[ast.stmt]]]:
    """Yield the statements of the top level that share lines: their first and their last line."""
    first = last = 0
    group: list[ast.stmt] = []
    for node in tree.body:
        start = first_position(node)[0]
        if group and start > last:
            yield first, last, group
            group = []
        if not group:
            first = start
        group.append(node)
        last = max(last, node.end_lineno or node.lineno)
    if group:
        yield first, last, group


def _logical_lines(tokens: Tokens) -> list[_Line]:
    """Return the logical lines of a text with their comments."""
    lines: list[_Line] = []
    comments = deque(tokens.comments)
    depth = 0
    line: _Line | None = None
    # Specifiers that go on in an indented block belong to the line that they begin on.
    is_continued = False
    before = ""
    for index, (kind, text, at) in enumerate(zip(tokens.kinds, tokens.texts, tokens.lines, strict=True)):
        if is_continued:
            is_continued = kind != DEDENT
            ends = not is_continued
        elif kind == INDENT and before == ",":
            is_continued = True
            ends = False
            line = lines.pop()
        else:
            ends = kind == NEWLINE
            depth += (kind == INDENT) - (kind == DEDENT)
        if line is not None and (ends or (is_continued and kind == NEWLINE)):
            line.last = at if kind == NEWLINE else line.last
            while comments and comments[0][0] <= line.last:
                comment = comments.popleft()
                if comment[0] < line.first:
                    line.above.append(comment)
                elif comment[0] == line.last:
                    line.trailing = comment[2].rstrip()
            if ends:
                lines.append(line)
                line = None
        elif kind not in (NEWLINE, INDENT, DEDENT, ENDMARKER):
            if line is None:
                words = " ".join(tokens.texts[index : index + 3])
                is_definition = _DEFINITION.match(words) is not None
                line = _Line(at, at, depth, index, is_definition, text == "@")
            before = text
    return lines


class _Layout:
    """The text in the making."""

    def __init__(self, tokens: Tokens) -> None:
        self._tokens = tokens
        self._lines: list[str] = []
        self._old = tokens.text.split("\n")
        self._fixed = set(_lines_in_strings(tokens))
        self._depth = 0
        self._header = False
        self._end = 0
        self._previous: _Line | None = None

    def add(self, line: _Line, parts: Sequence[str]) -> None:
        """Write one logical line, with the comments above it: its parts, or without them the line as it stands."""
        depth = line.depth
        self._blank_lines(line, depth)
        self.comments(line.above, depth)
        self._gap(line.first, depth)
        if not parts:
            self._moved(line, depth)
        for place, part in enumerate(parts):
            depth += place > 0 and parts[place - 1].endswith(":")
            self._lines.append(_INDENTATION * depth + part)
        if parts and line.trailing:
            self._lines[-1] += f"  {line.trailing}"
        self._depth = depth
        self._end = line.last
        self._previous = line

    def comments(self, comments: Sequence[tuple[int, int, str]], depth: int) -> None:
        """Write comments that stand on lines of their own; ``depth`` is that of the statement after them."""
        for at, column, text in comments:
            level = self._level(column, depth)
            self._gap(at, level)
            self._lines.append(_INDENTATION * level + text.rstrip())
            self._end = at

    def text(self) -> str:
        """Return the text that was written."""
        return "\n".join([*self._lines, ""]) if self._lines else ""

    def _blank_lines(self, line: _Line, depth: int) -> None:
        """Set definitions apart, from what is before and after them."""
        previous = self._previous
        if previous is None or depth > self._depth:
            return
        after = self._depth > depth and self._ended_definition(depth)
        if not (line.is_definition or after) or previous.is_decorator:
            return
        count = 1 if depth else 2
        # Comments of the block before come before the gap.
        while line.above and self._level(line.above[0][1], depth) > depth:
            self.comments([line.above.pop(0)], depth)
        first = line.above[0][0] if line.above else line.first
        self._lines += [""] * count
        self._end = first - 1

    def _level(self, column: int, depth: int) -> int:
        """Return the depth of a comment at a column: a comment that is indented more than the next statement
        belongs to the block before.
        """
        levels = range(depth, max(depth, self._depth) + 1)
        return min(levels, key=lambda level: (abs(len(_INDENTATION) * level - column), -level))

    def _ended_definition(self, depth: int) -> bool:
        """Return whether the block that has just ended, at this depth, was a definition."""
        for line in reversed(self._lines):
            if line.strip() and not line.lstrip().startswith("#"):
                indentation = len(line) - len(line.lstrip())
                if indentation <= depth * len(_INDENTATION):
                    return _DEFINITION.match(line, indentation) is not None
        return False

    def _gap(self, first: int, depth: int) -> None:
        """Keep the blank lines before a line, as far as they are not too many."""
        if not self._lines:
            return
        most = 1 if depth else 2
        blank = sum(not self._old[number - 1].strip() for number in range(self._end + 1, first))
        self._lines += [""] * min(blank, most)

    def _moved(self, line: _Line, depth: int) -> None:
        """Move a line as it stands to its indentation; the inside of strings stays where it is."""
        first = self._old[line.first - 1]
        shift = len(_INDENTATION) * depth - _width(first)
        for number in range(line.first, line.last + 1):
            text = self._old[number - 1]
            if number in self._fixed:
                self._lines.append(text if number + 1 in self._fixed else text.rstrip())
                continue
            bare = text.strip(" \t\f")
            width = max(0, _width(text) + shift) if bare else 0
            keep = number + 1 in self._fixed
            self._lines.append(" " * width + (text.lstrip() if keep else bare))


def _width(line: str) -> int:
    """Return the indentation of a line, in columns."""
    return measure(line[: len(line) - len(line.lstrip())])[0]


def _lines_in_strings(tokens: Tokens) -> Iterator[int]:
    """Yield the lines that begin inside a string."""
    for kind, first, last in zip(tokens.kinds, tokens.lines, tokens.end_lines, strict=True):
        if kind in (STRING, FSTRING_MIDDLE):
            yield from range(first + 1, last + 1)


def _same(tree: ast.Module, tokens: Tokens, result: str) -> bool:
    """Return whether a text has this tree, and the comments of these tokens."""
    read = lex(result, WORDS)
    again = parse_lexed(read, filename="")
    if again.diagnostics:
        return False
    before = [text.rstrip() for _, _, text in tokens.comments]
    after = [text.rstrip() for _, _, text in read.comments]
    return before == after and _equal(tree, again.tree)


def _equal(one: object, other: object) -> bool:
    """Return whether two trees say the same, wherever their nodes stand."""
    pairs: list[tuple[Any, Any]] = [(one, other)]
    while pairs:
        left, right = pairs.pop()
        if left.__class__ is not right.__class__:
            return False
        if isinstance(left, list):
            if len(left) != len(right):
                return False
            pairs.extend(zip(left, right, strict=True))
        elif isinstance(left, ast.AST):
            mine, its = left.__dict__, right.__dict__
            pairs.extend((mine.get(name), its.get(name)) for name in left._fields)
        elif left != right:
            return False
    return True
