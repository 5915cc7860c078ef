"""Writing a document in the usual style.

What a statement looks like is the unparser's decision (`scenic.compiler.unparser`): its spacing, quotes and
parentheses; numbers and parentheses that group stay as written (`as_written`). What a tree does not hold is kept as it stands: comments, blank lines (up to two), and the layout of
statements that are written over several lines, which are only moved with their block. Lines are never split or joined.

The result means the same and formats to itself; a text with mistakes is left alone. The style is described in
``docs/reference/format.md``.
"""

import ast
import difflib
import re
from bisect import bisect_left, bisect_right
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse_lexed
from scenic.compiler.tokens import DEDENT, ENDMARKER, FSTRING_MIDDLE, INDENT, NEWLINE, STRING, Tokens
from scenic.compiler.unparser import UnparseError, unparse
from scenic.dataclass import dataclass
from scenic.ide.as_written import Token, as_written
from scenic.ide.snapshot import Snapshot
from scenic.language.diagnostics import Edit
from scenic.language.spans import Span

__all__ = ["format_text", "formatting"]

_INDENTATION: Final = "    "
_DEFINITIONS: Final = frozenset({"class", "def", "behavior", "monitor", "scenario", "@", "async"})


@dataclass(slots=True)
class _Line:
    """One logical line: its first and last line (from 1), its depth, and its comments.

    ``start`` is its first token.
    """

    first: int
    last: int
    depth: int
    start: str = ""
    has_inner_comment: bool = False
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
        chosen = tuple(
            each
            for each in edits
            if any(each.span.line <= last and _last_line(each) >= first for first, last in lines)
        )
        if _same(snapshot.tree, snapshot.tokens, _edited(before, chosen)):
            return chosen
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
    """A text after edits that are in order and do not overlap."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    parts, done = [], 0
    for each in edits:
        parts += [text[done : starts[each.span.line - 1] + each.span.column], each.text]
        done = starts[each.span.end_line - 1] + each.span.end_column
    return "".join([*parts, text[done:]])


def _changes(old: Sequence[str], new: Sequence[str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the differences of two texts: a range of lines of the old text and the range that replaces it, as
    few lines as possible.
    """
    # Lines that say the same are changed one by one; those that say nothing are like all others of their kind.
    matches = _matches([_said(line) for line in old], [_said(line) for line in new])
    done, new_done = 0, 0
    for index, other, size in matches:
        for at, new_at in zip(range(index, index + size), range(other, other + size), strict=True):
            stays = old[at] == new[new_at]
            if at > done or (new_at > new_done and stays):
                yield done, at, new_done, new_at
                done, new_done = at, new_at
            if not stays:
                # With what is inserted before it, if anything is: no two changes begin at one place.
                yield at, at + 1, new_done, new_at + 1
            done, new_done = at + 1, new_at + 1
    if done < len(old) or new_done < len(new):
        yield done, len(old), new_done, len(new)


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
    r"""A program in the usual style; ``None`` if it has mistakes of syntax. ``text`` has ``\n`` at each line end."""
    return _formatted(Snapshot(text, "<text>"))


def _formatted(snapshot: Snapshot) -> str | None:
    if snapshot.parsed.diagnostics:
        return None
    tree, tokens = snapshot.tree, snapshot.tokens
    standing = _logical_lines(tokens)
    layout = _Layout(tokens)
    units = deque(sorted(_units(tree.body, 0), key=lambda unit: unit.place))
    for line in standing:
        own = []
        while units and units[0].place[0] <= line.last:
            own.append(units.popleft())
        layout.add(line, own)
    last = standing[-1].last if standing else 0
    layout.comments([comment for comment in tokens.comments if comment[0] > last], 0)
    result = layout.text()
    return result if _same(tree, tokens, result) else None


@dataclass(frozen=True, slots=True)
class _Unit:
    """The text that the unparser writes for a statement, or for the header of a statement with blocks.

    ``place`` is where it begins: line, and column in bytes. ``text`` is ``None`` for what is kept as it stands.
    """

    place: tuple[int, int]
    depth: int
    text: str | None


def _units(statements: Sequence[Any], depth: int) -> Iterator[_Unit]:
    """The statements of a block, and those in them; not in order."""
    stack: list[tuple[Any, int]] = [(node, depth) for node in statements]
    while stack:
        node, depth = stack.pop()
        for decorator in getattr(node, "decorator_list", ()):
            yield _Unit(
                (decorator.lineno, decorator.col_offset - 1),
                depth,
                _decorator(decorator),
            )
        yield _Unit((node.lineno, node.col_offset), depth, _text_of(node))
        for handler in (*getattr(node, "handlers", ()), *getattr(node, "interrupts", ())):
            starred = isinstance(node, ast.TryStar)
            yield _Unit((handler.lineno, handler.col_offset), depth, _text_of_part(handler, starred=starred))
            stack.extend((each, depth + 1) for each in handler.body)
        for guard in getattr(node, "guards", ()):
            yield _Unit((guard.lineno, guard.col_offset), depth + 1, _text_of(guard))
        for case in getattr(node, "cases", ()):
            # A case has no place of its own; it begins the line of its pattern.
            yield _Unit((case.pattern.lineno, 0), depth + 1, _text_of_case(case))
            stack.extend((each, depth + 2) for each in case.body)
        for name in ("body", "orelse", "finalbody", "setup", "compose"):
            stack.extend((each, depth + 1) for each in getattr(node, name, None) or ())


def _decorator(node: ast.expr) -> str | None:
    return _first_line(lambda: f"@{unparse(node)}")


_BLOCKS: Final[Mapping[str, Any]] = {
    "body": [ast.Pass()],
    "setup": [ast.Pass()],
    "orelse": [],
    "finalbody": [],
    "decorator_list": [],
    "guards": [],
    "compose": None,
    "docstring": None,
}


def _text_of(node: Any) -> str | None:
    """A statement as the unparser writes it; of one with blocks, its header."""
    if isinstance(node, ast.Try | ast.TryStar | scenic.TryInterrupt):
        return "try:"
    if scenic.is_documentation(node):
        return None
    if isinstance(node, scenic.PropertyDef):
        # Only in a class has a property a text.
        owner = ast.ClassDef("C", [], [], [node], [])
        return _only_line(lambda: unparse(owner).partition("\n")[2].strip())
    if isinstance(node, scenic.Guard):
        return _only_line(lambda: f"{node.kind}: {unparse(node.condition)}")
    if isinstance(node, ast.Match):
        return _first_line(lambda: f"match {unparse(node.subject)}:")
    if any(field in node._fields for field in ("body", "setup")):
        fields = {name: getattr(node, name, None) for name in node._fields}
        fields.update((name, block) for name, block in _BLOCKS.items() if name in fields)
        return _first_line(lambda: unparse(node.__class__(**fields)))
    return _only_line(lambda: unparse(node))


def _text_of_case(case: ast.match_case) -> str | None:
    """The header of a case."""
    alone = ast.match_case(case.pattern, case.guard, [ast.Pass()])
    match = ast.Match(ast.Name("x", ast.Load()), [alone])
    return _first_line(lambda: unparse(match).partition("\n")[2].strip())


def _text_of_part(node: Any, *, starred: bool) -> str | None:
    """The header of a handler."""
    if isinstance(node, scenic.Interrupt):
        return _first_line(lambda: f"interrupt when {unparse(node.condition)}:")
    if node.type is None:
        return "except:"
    word = "except*" if starred else "except"
    name = f" as {node.name}" if node.name else ""
    return _first_line(lambda: f"{word} {unparse(node.type)}{name}:")


def _first_line(write: Callable[[], str]) -> str | None:
    try:
        return write().partition("\n")[0]
    except UnparseError:
        return None


def _only_line(write: Callable[[], str]) -> str | None:
    try:
        line, _, more = write().rstrip("\n").partition("\n")
    except UnparseError:
        return None
    return None if more else line


def _logical_lines(tokens: Tokens) -> list[_Line]:
    """The logical lines of a text with their comments."""
    found: list[_Line] = []
    comments = deque(tokens.comments)
    depth = 0
    line: _Line | None = None
    # Specifiers that go on in an indented block belong to the line that they begin on.
    continued = False
    before = ""
    for kind, text, at in zip(tokens.kinds, tokens.texts, tokens.lines, strict=True):
        if continued:
            continued = kind != DEDENT
            ends = not continued
        elif kind == INDENT and before == ",":
            continued = True
            ends = False
            line = found.pop()
        else:
            ends = kind == NEWLINE
            depth += (kind == INDENT) - (kind == DEDENT)
        if line is not None and (ends or (continued and kind == NEWLINE)):
            line.last = at if kind == NEWLINE else line.last
            while comments and comments[0][0] <= line.last:
                comment = comments.popleft()
                if comment[0] < line.first:
                    line.above.append(comment)
                elif comment[0] == line.last:
                    line.trailing = comment[2].rstrip()
                else:
                    line.has_inner_comment = True
            if ends:
                found.append(line)
                line = None
        elif kind not in (NEWLINE, INDENT, DEDENT, ENDMARKER):
            if line is None:
                line = _Line(at, at, depth, text)
            before = text
    return found


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

    def add(self, line: _Line, units: Sequence[_Unit]) -> None:
        """Write one logical line, with the comments above it; ``units`` begin on it."""
        depth = line.depth
        self._blank_lines(line, depth)
        self.comments(line.above, depth)
        self._gap(line.first, depth)
        written = self._written(line, units)
        if written is None:
            self._moved(line, depth)
        else:
            self._lines += written
            if line.trailing:
                self._lines[-1] += f"  {line.trailing}"
        self._depth = depth + (units[-1].depth - units[0].depth if written and units else 0)
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
        """All that was written."""
        return "\n".join([*self._lines, ""]) if self._lines else ""

    def _blank_lines(self, line: _Line, depth: int) -> None:
        """Set definitions apart, from what is before and after them."""
        previous = self._previous
        if previous is None or depth > self._depth:
            return
        after = self._depth > depth and self._ended_definition(depth)
        if not (_is_definition(line) or after) or previous.start == "@":
            return
        wanted = 1 if depth else 2
        # Comments of the block before come before the gap.
        while line.above and self._level(line.above[0][1], depth) > depth:
            self.comments([line.above.pop(0)], depth)
        first = line.above[0][0] if line.above else line.first
        self._lines += [""] * wanted
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
                    return line.split(maxsplit=1)[0] in _DEFINITIONS
        return False

    def _gap(self, first: int, depth: int) -> None:
        """Keep the blank lines before a line, as far as they are not too many."""
        if not self._lines:
            return
        most = 1 if depth else 2
        blank = sum(not self._old[number - 1].strip() for number in range(self._end + 1, first))
        self._lines += [""] * min(blank, most)

    def _moved(self, line: _Line, depth: int) -> None:
        """A line as it stands, moved to its indentation; what is inside strings stays where it is."""
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

    def _tokens_between(self, line: int, begin: int, end: int | None) -> list[Token]:
        """The tokens of a line from one column on, maybe before another one."""
        tokens = self._tokens
        return [
            Token(tokens.kinds[index], tokens.texts[index])
            for index in range(bisect_left(tokens.lines, line), bisect_right(tokens.lines, line))
            if tokens.columns[index] >= begin
            and (end is None or tokens.columns[index] < end)
            and tokens.kinds[index] not in (NEWLINE, INDENT, DEDENT, ENDMARKER)
        ]

    def _written(self, line: _Line, units: Sequence[_Unit]) -> list[str] | None:
        """A line as the unparser writes it; ``None`` if it stays as it stands."""
        if line.first != line.last:
            return None
        old = self._old[line.first - 1]
        start = len(old) - len(old.lstrip())
        found: list[str] = []
        clause = _CLAUSE.match(old, start)
        if not units or units[0].place[1] > start:
            # A clause without a node of its own, maybe with its block on the same line.
            if clause is None:
                return None
            found.append(f"{_INDENTATION * line.depth}{clause[1]}:")
        base = units[0].depth - (line.depth + len(found)) if units else 0
        places = [unit.place[1] for unit in units]
        for unit, begin, end in zip(units, places, [*places, None][1:], strict=True):
            if unit.text is None:
                return None
            text = as_written(self._tokens_between(line.first, begin, end), unit.text)
            if not found and old.startswith("elif", start):
                text = f"el{text}"
            found.append(_INDENTATION * (unit.depth - base) + text)
        return found


def _width(line: str) -> int:
    """Return the indentation of a line, in columns."""
    expanded = line.expandtabs()
    return len(expanded) - len(expanded.lstrip())


_CLAUSE: Final = re.compile(r"(else|finally|try|setup|compose)[ \t]*:")


def _is_definition(line: _Line) -> bool:
    return line.start in _DEFINITIONS


def _lines_in_strings(tokens: Tokens) -> Iterator[int]:
    """The lines that begin inside a string."""
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


def _equal(one: ast.AST, other: ast.AST) -> bool:
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
