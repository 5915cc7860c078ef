"""Comments that silence diagnostics: ``# scenic: ignore[SC304]`` and ``# scenic: ignore-file[SC304]``.

A comment speaks of the diagnostics that start on its own line. On the first or the last line of a statement that is
written over several lines (of a compound statement: of its header), it speaks of all that start in these lines.
``ignore-file`` speaks of the whole file, and stands before the first statement. Without codes a comment silences
warnings and information; with codes, errors too, but never those that are always shown (`is_lasting`).

Comments are those of the lexer: a string that holds such a text is none.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field
from typing import Final

from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NEWLINE, Tokens
from scenic.dataclass import dataclass
from scenic.language.code_selection import is_lasting, is_selector, similar_selector
from scenic.language.diagnostics import Diagnostic, Edit, Fix, Severity
from scenic.language.source import Source
from scenic.language.spans import Span
from scenic.language.spelling import nearest

__all__ = ["BAD", "UNUSED", "apply_ignores"]

UNUSED: Final = "SC390"
BAD: Final = "SC391"
_OWN: Final = (UNUSED, BAD)

# Compiled when they are first needed: most programs have no such comment.
_DIRECTIVE: Final = (
    r"#[ \t]*scenic[ \t]*:[ \t]*(?P<word>[A-Za-z][A-Za-z_-]*)"
    r"[ \t]*(?:\[(?P<codes>[^\[\]#]*)(?P<close>\])?)?"
)
_WORDS: Final = ("ignore", "ignore-file")
_BARE_CODES: Final = r"[ \t:=(]*(?P<codes>SC[0-9]+(?:[ \t]*,[ \t]*SC[0-9]+)*)\)?"
_CODE: Final = r"[^\s,](?:[^,]*[^\s,])?"
_STATIC: Final = ("SC1", "SC2", "SC3", "SC9")
"""Beginnings of the codes that are found without running the program; others may be found by ``--deep``."""


def apply_ignores(
    text: str, diagnostics: Sequence[Diagnostic], *, filename: str, complain: bool = True
) -> tuple[Diagnostic, ...]:
    """Return the diagnostics that no comment silences, and unless ``complain`` is false those about the comments.

    Comments that silence nothing are only complained of in a program without errors: with errors, not everything
    has been looked for.
    """
    if "scenic" not in text or re.search(_DIRECTIVE, text) is None:
        return tuple(diagnostics)
    source = Source(text, filename)
    tokens = lex(source.text, WORDS)
    comments = list(_comments(tokens, source))
    if not comments:
        return tuple(diagnostics)
    has_errors = any(item.severity is Severity.ERROR for item in diagnostics)
    is_silenced = _Silencer(comments, _statements(tokens))
    remaining = [item for item in diagnostics if not is_silenced(item)]
    if complain:
        about_comments = [diagnostic for comment in comments for diagnostic in _bad(comment, source)]
        if not has_errors:
            about_comments += [
                diagnostic
                for each in comments
                for diagnostic in _unused(each, source, lambda code: code not in _OWN)
            ]
        remaining += [item for item in about_comments if not is_silenced(item)]
        if not has_errors:
            remaining += [
                diagnostic for each in comments for diagnostic in _unused(each, source, _OWN.__contains__)
            ]
    return tuple(remaining)


@dataclass(slots=True)
class _Code:
    """One code of a comment; ``used`` once it has silenced something."""

    text: str
    span: Span
    used: bool = False


@dataclass(slots=True)
class _Comment:
    """An ignore comment.

    ``span`` reaches from its ``#`` to its last code, ``brackets`` is what stands between ``[`` and ``]``.
    """

    span: Span
    whole_file: bool
    codes: list[_Code] = field(default_factory=list)
    brackets: Span | None = None
    problem: Diagnostic | None = None
    used: bool = False

    @property
    def says_something(self) -> bool:
        """Return whether it can silence anything."""
        return self.problem is None or bool(self.codes)

    def silences(self, diagnostic: Diagnostic) -> bool:
        """Return whether it silences a diagnostic at its place, which is noted; it must say something."""
        if not self.codes and self.brackets is None:
            if diagnostic.severity is Severity.ERROR or diagnostic.code in _OWN:
                return False
            self.used = True
            return True
        for code in self.codes:
            if diagnostic.code.startswith(code.text) and is_selector(code.text):
                code.used = self.used = True
                return True
        return False


class _Silencer:
    """Finds the comment that silences a diagnostic, and notes its use."""

    def __init__(self, comments: Sequence[_Comment], statements: Sequence[tuple[int, int]]) -> None:
        # A line may have very many comments that say nothing, and as many diagnostics about them.
        comments = [comment for comment in comments if comment.says_something]
        self._of_file = [comment for comment in comments if comment.whole_file]
        self._of_line: dict[int, list[_Comment]] = {}
        for comment in comments:
            if not comment.whole_file:
                self._of_line.setdefault(comment.span.line, []).append(comment)
        comments_of_line = {line: tuple(there) for line, there in self._of_line.items()}
        for first, last in statements:
            for edge in (first, last):
                for line in range(first, last + 1) if edge in comments_of_line else ():
                    if line != edge:
                        self._of_line.setdefault(line, []).extend(comments_of_line[edge])

    def __call__(self, diagnostic: Diagnostic) -> bool:
        if is_lasting(diagnostic):
            return False
        here = [] if diagnostic.span is None else self._of_line.get(diagnostic.span.line, [])
        return any(comment.silences(diagnostic) for comment in (*here, *self._of_file))


def _statements(tokens: Tokens) -> list[tuple[int, int]]:
    """First and last line of each logical line that is written over several lines.

    Specifiers that go on after a comma in an indented block belong to the line that they begin on.
    """
    ranges: list[tuple[int, int]] = []
    first: int | None = None
    is_continued = False
    kinds = tokens.kinds
    for index, (kind, line) in enumerate(zip(kinds, tokens.lines, strict=True)):
        if kind == NEWLINE:
            if index and tokens.texts[index - 1] == "," and kinds[index + 1] != DEDENT:
                is_continued = is_continued or kinds[index + 1] == INDENT
                if is_continued:
                    continue
            if first is not None and line > first:
                ranges.append((first, line))
            first, is_continued = None, False
        elif first is None and kind not in (INDENT, DEDENT, ENDMARKER):
            first = line
    return ranges


def _comments(tokens: Tokens, source: Source) -> Iterator[_Comment]:
    first = next(
        (
            line
            for kind, line in zip(tokens.kinds, tokens.lines, strict=True)
            if kind not in (NEWLINE, INDENT, DEDENT)
        ),
        1,
    )
    for line, column, text in tokens.comments:
        for match in re.finditer(_DIRECTIVE, text):
            comment = _comment(_Written(match, line, column, source), before_program=line < first)
            if comment is not None:
                yield comment


@dataclass(frozen=True, slots=True)
class _Written:
    """An ignore comment as it stands in the text."""

    match: re.Match[str]
    line: int
    column: int
    source: Source

    def span(self, start: int, end: int) -> Span:
        """The place of a part of its line."""
        return Span(self.line, self.column + start, self.line, self.column + end)

    @property
    def whole(self) -> Span:
        """Its place, with the codes."""
        return self.span(
            self.match.start(),
            self.match.end() if self.match["codes"] is not None else self.match.end("word"),
        )

    def bad(self, message: str, advice: str, edit: Edit | None = None) -> Diagnostic:
        """A problem with it, and the change that mends it."""
        place, fix = self.whole, None
        if edit is not None:
            place, fix = edit.span, Fix(f"Write `{edit.text}`", (edit,))
        return Diagnostic(BAD, message, place, Severity.WARNING, self.source.filename, advice, fix=fix)


def _comment(written: _Written, *, before_program: bool) -> _Comment | None:
    match, word = written.match, written.match["word"]
    if word not in _WORDS:
        keyword = nearest(word, _WORDS) or (word.lower() if word.lower() in _WORDS else None)
        if keyword is None:
            return None
        edit = Edit(written.span(match.start("word"), match.end("word")), keyword)
        problem = written.bad(f"`{word}` silences nothing", f"did you mean `{keyword}`?", edit)
        return _Comment(written.whole, False, problem=problem)
    comment = _Comment(written.whole, word == "ignore-file")
    if match["codes"] is None:
        bare = re.compile(_BARE_CODES, re.IGNORECASE).match(match.string, match.end("word"))
        if bare is not None:
            codes = ", ".join(each.strip().upper() for each in bare["codes"].split(","))
            edit = Edit(written.span(match.end("word"), bare.end()), f"[{codes}]")
            comment.span = written.span(match.start(), bare.end())
            comment.problem = written.bad(
                "the codes of an ignore comment stand in brackets", f"write `{word}[{codes}]`", edit
            )
            return comment
    elif not _read_codes(comment, written):
        return comment
    if comment.whole_file and not before_program:
        comment.problem = written.bad(
            "`ignore-file` stands after the first statement, where it silences nothing",
            "move it to the top of the file",
        )
        comment.codes = []
    return comment


def _read_codes(comment: _Comment, written: _Written) -> bool:
    """Read the codes in brackets; returns whether the bracket is closed."""
    start, end = written.match.span("codes")
    comment.brackets = written.span(start, end)
    if written.match["close"] is None:
        comment.problem = written.bad("the bracket of this ignore comment is not closed", "add `]`")
        return False
    comment.codes = [
        _Code(each[0], written.span(each.start(), each.end()))
        for each in re.compile(_CODE).finditer(written.match.string, start, end)
    ]
    if not comment.codes:
        comment.problem = written.bad(
            "this ignore comment names no codes",
            "name codes between the brackets, or leave the brackets out to silence all warnings",
        )
    return True


def _bad(comment: _Comment, source: Source) -> Iterator[Diagnostic]:
    """Yield the diagnostics about a comment that cannot be understood."""
    if comment.problem is not None:
        yield comment.problem
    for code in comment.codes:
        if not is_selector(code.text):
            suggestion = similar_selector(code.text)
            advice = (
                "`scenic explain` lists all codes" if suggestion is None else f"did you mean `{suggestion}`?"
            )
            certain = suggestion is not None and suggestion.endswith(code.text.upper())
            fix = (
                None
                if suggestion is None or not certain
                else Fix(f"Write `{suggestion}`", (Edit(code.span, suggestion),))
            )
            yield Diagnostic(
                BAD,
                f"there is no code `{code.text}`",
                code.span,
                Severity.WARNING,
                source.filename,
                advice,
                fix=fix,
            )


def _unused(comment: _Comment, source: Source, concerns: Callable[[str], bool]) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each code, among those of concern, that a comment silences in vain."""
    if comment.problem is not None:
        return
    if comment.brackets is None:
        if not comment.used and concerns(""):
            yield _in_vain(
                "this ignore comment silences nothing", comment.span, source, _removal(comment, source)
            )
        return
    useless = [
        code
        for code in comment.codes
        if not code.used and concerns(code.text) and (code.text == "SC" or code.text.startswith(_STATIC))
    ]
    useless = [code for code in useless if is_selector(code.text)]
    if not useless:
        return
    names = ", ".join(f"`{code.text}`" for code in useless)
    if len(useless) == len(comment.codes):
        yield _in_vain(
            f"this comment ignores {names}, but there is nothing to ignore",
            comment.span,
            source,
            _removal(comment, source),
        )
        return
    useful_codes = ", ".join(code.text for code in comment.codes if code not in useless)
    fix = Fix(f"Remove {names}", (Edit(comment.brackets, useful_codes),))
    yield _in_vain(
        f"this comment ignores {names}, but there is nothing to ignore", useless[0].span, source, fix
    )


def _in_vain(message: str, span: Span, source: Source, fix: Fix) -> Diagnostic:
    return Diagnostic(UNUSED, message, span, Severity.WARNING, source.filename, _lower(fix.title), fix=fix)


def _lower(title: str) -> str:
    return title[:1].lower() + title[1:]


def _removal(comment: _Comment, source: Source) -> Fix:
    """Removes a comment with the reason after it, with its line if that holds nothing else."""
    line = comment.span.line
    content = source.line(line)
    other = content.find("#", comment.span.end_column)
    before = content[: comment.span.column].rstrip()
    if other >= 0:
        span = Span(line, comment.span.column, line, other)
    elif before or line >= len(source.lines):
        span = Span(line, len(before), line, len(content))
    else:
        span = Span(line, 0, line + 1, 0)
    return Fix("Remove the comment", (Edit(span, ""),))
