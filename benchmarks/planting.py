"""Plants mistakes in programs, as people make them, and knows on which lines each of them may be reported.

This is the material of ``python -m benchmarks.recovery``, which measures and prints; here nothing is run.

The programs are those in ``tests/data/recovery``. A mistake is planted only where it makes the program wrong: with this one
alone, the parser must not accept it. Those of one program are independent: between the logical lines that two of them touch,
at least one other is untouched.

The right lines of a mistake are the lines that it changes and the line of the token after it, where a reader from left to right
notices it at the latest; for a bracket that is missing or wrong also the line of its partner, and for indentation or a missing
block the lines of the statements before and after.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Final

from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS, WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import parse
from scenic.compiler.tokens import DEDENT, ENDMARKER, INDENT, NAME, NEWLINE, NUMBER, STRING, Tokens

__all__ = ["MISTAKES", "Mistake", "Program", "base_programs", "plant"]

PROGRAMS: Final = Path(__file__).parents[1] / "tests" / "data" / "recovery"

_CLOSERS: Final = {"(": ")", "[": "]", "{": "}"}
_LAYOUT: Final = (NEWLINE, INDENT, DEDENT, ENDMARKER)
_MOST_ATTEMPTS: Final = 60


@dataclass(frozen=True, slots=True)
class Mistake:
    """Lines ``first`` up to and without ``end`` (from 1) become ``lines``; ``right`` are lines relative to ``first`` afterwards.

    ``touched`` are the first and the last logical line that it concerns, counted from 0.
    """

    kind: str
    first: int
    end: int
    lines: tuple[str, ...]
    right: frozenset[int]
    touched: tuple[int, int]


@dataclass(frozen=True, slots=True)
class LogicalLine:
    """The tokens from ``start`` up to and without ``end``, the ``NEWLINE`` of the line, on ``first`` to ``last`` (from 1)."""

    start: int
    end: int
    first: int
    last: int
    indentation: int


@dataclass(slots=True)
class Program:
    """A right program, its tokens and its logical lines."""

    name: str
    text: str
    lines: list[str] = field(init=False)
    tokens: Tokens = field(init=False)
    logical: list[LogicalLine] = field(init=False)
    partner: dict[int, int] = field(init=False)
    """The closing bracket (a token) of each opening one."""

    def __post_init__(self) -> None:
        self.lines = self.text.splitlines()
        self.tokens = lex(self.text, WORDS)
        self.logical = list(self._logical_lines())
        self.partner = {}
        opened: list[int] = []
        for index, text in enumerate(self.tokens.texts):
            # Braces in f-strings belong to their own kinds of tokens, or pair up as others do.
            if text in _CLOSERS and self.tokens.kinds[index] == WORDS[text]:
                opened.append(index)
            elif opened and text == _CLOSERS[self.tokens.texts[opened[-1]]] and text in WORDS:
                self.partner[opened.pop()] = index

    def _logical_lines(self) -> Iterator[LogicalLine]:
        tokens = self.tokens
        start = 0
        for index, kind in enumerate(tokens.kinds):
            if kind in (INDENT, DEDENT, ENDMARKER):
                start = index + 1
            elif kind == NEWLINE:
                first = tokens.lines[start]
                content = self.lines[first - 1]
                yield LogicalLine(
                    start, index, first, tokens.lines[index], len(content) - len(content.lstrip())
                )
                start = index + 1

    def line_of(self, token: int) -> int:
        """The logical line of a token."""
        return next(number for number, line in enumerate(self.logical) if token <= line.end)

    def words(self, wanted: Callable[[int], bool]) -> list[int]:
        """The tokens, of those with text on a single line, that are ``wanted``."""
        tokens = self.tokens
        return [
            index
            for index, kind in enumerate(tokens.kinds)
            if kind not in _LAYOUT and tokens.lines[index] == tokens.end_lines[index] and wanted(index)
        ]

    def next_token(self, token: int) -> int:
        """The first token after ``token`` that has a text."""
        token += 1
        while self.tokens.kinds[token] in (NEWLINE, INDENT, DEDENT):
            token += 1
        return token

    def change(self, kind: str, edits: list[tuple[int, str]], extra: tuple[int, ...] = ()) -> Mistake:
        """Give tokens other texts; ``extra`` are tokens on whose lines it may be reported too."""
        tokens = self.tokens
        indices = [index for index, _ in edits]
        lines = [tokens.lines[index] for index in (*indices, *extra)]
        lines.append(tokens.lines[self.next_token(max(indices))])
        first, end = min(lines[: len(edits)]), max(lines[: len(edits)]) + 1
        changed = self.lines[first - 1 : end - 1]
        for index, text in sorted(edits, reverse=True):
            content = changed[tokens.lines[index] - first]
            before, after = content[: tokens.columns[index]], content[tokens.end_columns[index] :]
            if not text:
                after = after if before[-1:] not in (" ", "") else after.lstrip()
            changed[tokens.lines[index] - first] = before + text + after
        numbers = [self.line_of(index) for index in indices]
        right = frozenset(line - first for line in lines)
        return Mistake(kind, first, end, tuple(changed), right, (min(numbers), max(numbers)))

    def insert(self, kind: str, number: int, lines: tuple[str, ...], right: set[int]) -> Mistake:
        """Put lines, indented as that one is, after a logical line that begins no block."""
        here = self.logical[number]
        white = " " * here.indentation
        indented = tuple((white + line) if line[:1] not in "<=>" else line for line in lines)
        return Mistake(kind, here.last + 1, here.last + 1, indented, frozenset(right), (number, number + 1))


Planter = Callable[[Program, Random], "Mistake | None"]


def _token(kind: str, wanted: Callable[[Program, int], bool], text: Callable[[str, Random], str]) -> Planter:
    """Changes one of the tokens that are wanted."""

    def planter(program: Program, random: Random) -> Mistake | None:
        found = program.words(lambda index: wanted(program, index))
        if not found:
            return None
        index = random.choice(found)
        return program.change(kind, [(index, text(program.tokens.texts[index], random))])

    return planter


def _ordinary(program: Program, index: int) -> bool:
    """No bracket, and no colon at the end of a header: their mistakes are kinds of their own."""
    text = program.tokens.texts[index]
    return text not in "()[]{}" and not _ends_header(program, index) and "\n" not in text


def _ends_header(program: Program, index: int) -> bool:
    return program.tokens.texts[index] == ":" and program.tokens.kinds[index + 1] == NEWLINE


def _text_in(*words: str) -> Callable[[Program, int], bool]:
    return lambda program, index: program.tokens.texts[index] in words


def _is_keyword(program: Program, index: int) -> bool:
    kind, text = program.tokens.kinds[index], program.tokens.texts[index]
    begins = any(line.start == index for line in program.logical)
    return len(text) > 2 and (kind in HARD_KEYWORDS.values() or (begins and kind in SOFT_KEYWORDS.values()))


def _is_operand(program: Program, index: int) -> bool:
    before = program.tokens.texts[index - 1] if index else ""
    return program.tokens.kinds[index] in (NAME, NUMBER, STRING) and before in {
        "=", "+", "-", "*", "/", "<", ">", "==", "and", "or", "not", "at", "of", "by", "in", "until", "@", "facing",
    }  # fmt: skip


def _misspelt(word: str, random: Random) -> str:
    place = random.randrange(len(word) - 1)
    return random.choice(
        [word[:place] + word[place + 1 :], word[:place] + word[place + 1] + word[place] + word[place + 2 :]]
    )


def _swapped(program: Program, random: Random) -> Mistake | None:
    tokens = program.tokens
    found = program.words(
        lambda index: (
            _ordinary(program, index)
            and tokens.kinds[index + 1] not in _LAYOUT
            and tokens.lines[index] == tokens.end_lines[index + 1]
            and _ordinary(program, index + 1)
        )
    )
    if not found:
        return None
    index = random.choice(found)
    first, second = tokens.texts[index], tokens.texts[index + 1]
    if tokens.end_columns[index] == tokens.columns[index + 1]:
        first, second = f" {first}", f"{second} "
    return program.change("swapped tokens", [(index, second), (index + 1, first)])


def _bracket(kind: str, which: int, text: Callable[[str, Random], str], *, alone: bool = False) -> Planter:
    """Changes an opening (0) or closing (1) bracket; ``alone`` leaves out those that span lines."""

    def planter(program: Program, random: Random) -> Mistake | None:
        lines = program.tokens.lines
        pairs = [pair for pair in program.partner.items() if not alone or lines[pair[0]] == lines[pair[1]]]
        if not pairs:
            return None
        pair = random.choice(pairs)
        changed = pair[which]
        return program.change(
            kind, [(changed, text(program.tokens.texts[changed], random))], (pair[1 - which],)
        )

    return planter


def _open_string(program: Program, random: Random) -> Mistake | None:
    texts = program.tokens.texts
    found = program.words(
        lambda index: (
            program.tokens.kinds[index] == STRING and len(texts[index]) > 2 and texts[index][-3:] != '"""'
        )
    )
    if not found:
        return None
    index = random.choice(found)
    return program.change("open string", [(index, texts[index][:-1])])


def _open_text(program: Program, random: Random) -> Mistake | None:
    tokens = program.tokens
    found = [index for index, text in enumerate(tokens.texts) if text.endswith('"""') and len(text) > 5]
    if not found:
        return None
    index = random.choice(found)
    line, last = tokens.lines[index], tokens.end_lines[index]
    ending = program.lines[last - 1]
    cut = ending[: tokens.end_columns[index] - 3] + ending[tokens.end_columns[index] :]
    number = program.line_of(index)
    return Mistake("open text", last, last + 1, (cut,), frozenset({line - last, 0}), (number, number))


def _indented_more(program: Program, random: Random) -> Mistake | None:
    return _indentation(program, random, "indented more", lambda white: white + " " * random.randint(1, 4))


def _indented_less(program: Program, random: Random) -> Mistake | None:
    return _indentation(program, random, "indented less", lambda white: white[random.randint(1, 4) :])


def _tab(program: Program, random: Random) -> Mistake | None:
    return _indentation(program, random, "tab", lambda white: "\t" + white[random.choice((4, 8)) :])


def _indentation(program: Program, random: Random, kind: str, white: Callable[[str], str]) -> Mistake | None:
    number = random.randrange(1, len(program.logical) - 1)
    line = program.logical[number]
    if kind != "indented more" and not line.indentation:
        return None
    content = program.lines[line.first - 1]
    changed = white(content[: line.indentation]) + content[line.indentation :]
    neighbours = {program.logical[number - 1].first, program.logical[number + 1].first, line.first}
    # After the block of the line, if it has one, comes the statement that shows it at the latest.
    for later in program.logical[number + 1 :]:
        if later.indentation <= line.indentation:
            neighbours.add(later.first)
            break
    right = frozenset(each - line.first for each in neighbours)
    return Mistake(kind, line.first, line.first + 1, (changed,), right, (number - 1, number + 1))


def _missing_block(program: Program, random: Random) -> Mistake | None:
    logical = program.logical
    found = []
    for number, line in enumerate(logical[:-1]):
        end = number + 1
        while end < len(logical) and logical[end].indentation > line.indentation:
            end += 1
        if 1 < end - number <= 4 and _ends_header(program, line.end - 1) and end < len(logical):
            found.append((number, end))
    if not found:
        return None
    number, end = random.choice(found)
    first, last = logical[number + 1].first, logical[end - 1].last
    right = {logical[number].first - first, logical[number].last - first, logical[end].first - last - 1}
    return Mistake("missing block", first, last + 1, (), frozenset(right), (number, end))


def _equals(program: Program, random: Random) -> Mistake | None:
    return _token("`=` for `==`", _text_in("=="), lambda _text, _random: "=")(program, random)


def _after_simple(program: Program, random: Random) -> int | None:
    """A logical line after which a statement may be put."""
    numbers = [
        number
        for number, line in enumerate(program.logical[:-1])
        if program.tokens.texts[line.end - 1] not in (":", ",")
        and program.tokens.kinds[line.start] != SOFT_KEYWORDS["case"]
        and program.tokens.texts[line.start] != "@"
        and not _in_specifiers(program, number)
    ]
    return random.choice(numbers) if numbers else None


def _in_specifiers(program: Program, number: int) -> bool:
    """Return whether the line is a line of specifiers but the last, which no statement may follow."""
    before = program.tokens.texts[program.logical[number].start - 1] if number else ""
    return before == "," or program.tokens.texts[program.logical[number].end - 1] == ","


def _inserted(kind: str, choices: tuple[tuple[str, ...], ...], extra: tuple[int, ...] = ()) -> Planter:
    def planter(program: Program, random: Random) -> Mistake | None:
        number = _after_simple(program, random)
        if number is None or _follows_specifiers(program, number):
            return None
        lines = random.choice(choices)
        return program.insert(kind, number, lines, {*range(len(lines)), *extra})

    return planter


def _follows_specifiers(program: Program, number: int) -> bool:
    """Return whether the line is a line of specifiers, so that a statement after it has another indentation."""
    logical, texts = program.logical, program.tokens.texts
    return number > 0 and texts[logical[number - 1].end - 1] == ","


def _half_typed(program: Program, random: Random) -> Mistake | None:
    """In a real editor the cursor's line: in a block, or between statements."""
    number = _after_simple(program, random)
    if number is None or _follows_specifiers(program, number):
        return None
    line = random.choice(_HALF_TYPED)
    here, after = program.logical[number], program.logical[number + 1]
    return program.insert("half-typed line", number, (line,), {0, after.first - here.last})


def _conflict(program: Program, random: Random) -> Mistake | None:
    number = _after_simple(program, random)
    if number is None:
        return None
    line = program.logical[number]
    own = program.lines[line.first - 1 : line.last]
    lines = ("<<<<<<< HEAD", *own, "=======", *own, ">>>>>>> branch")
    if _follows_specifiers(program, number):
        return None
    return Mistake(
        "conflict markers",
        line.first,
        line.last + 1,
        lines,
        frozenset({0, len(own) + 1, 2 * len(own) + 2}),
        (number, number + 1),
    )


def _wrong_order(program: Program, random: Random) -> Mistake | None:
    """Two neighbouring clauses of a statement change places."""
    lines = []
    for number, line in enumerate(program.logical):
        content = program.lines[line.first - 1]
        for first, second in ((" every ", " as "), (" if ", " else "), (" by ", " at ")):
            if line.first == line.last and 0 < content.find(first) < content.find(second):
                begin, _, rest = content.partition(first)
                middle, _, ending = rest.partition(second)
                lines.append((number, line.first, begin + second + ending + first + middle))
    if not lines:
        return None
    number, first, changed = random.choice(lines)
    return Mistake("wrong order", first, first + 1, (changed,), frozenset({0}), (number, number))


def _missing_head(program: Program, random: Random) -> Mistake | None:
    clause = random.choice(("else:", "elif x:", "except ValueError:", "finally:", "interrupt when x:"))
    return _inserted("clause without head", ((clause, "    pass"),))(program, random)


def _missing_comma(program: Program, index: int) -> bool:
    return program.tokens.texts[index] == ","


_HALF_TYPED: Final = (
    "x = ", "require ", "ego.", "new Car at (", "do ", "y = f(", "z = [1, ", "if ego", "for x in ", "print('a",
    "param a = ", "new Object at", "behavior B(", "class C", "import ", "take ", "return (", "w = 'abc",
)  # fmt: skip
_STRAY: Final = ("$", "?", "¿", "…", "`", "!")

MISTAKES: Final[dict[str, Planter]] = {
    "deleted token": _token("deleted token", _ordinary, lambda _text, _random: ""),
    "doubled token": _token("doubled token", _ordinary, lambda text, _random: f"{text} {text}"),
    "swapped tokens": _swapped,
    "deleted colon": _token("deleted colon", _ends_header, lambda _text, _random: ""),
    "deleted closing bracket": _bracket("deleted closing bracket", 1, lambda _text, _random: ""),
    "wrong closing bracket": _bracket(
        "wrong closing bracket",
        1,
        lambda text, random: random.choice([other for other in ")]}" if other != text]),
    ),
    "extra closing bracket": _token(
        "extra closing bracket", _ordinary, lambda text, random: text + random.choice(")]}")
    ),
    "deleted opening bracket": _bracket("deleted opening bracket", 0, lambda _text, _random: " "),
    "open string": _open_string,
    "open text": _open_text,
    "misspelt keyword": _token("misspelt keyword", _is_keyword, _misspelt),
    "keyword as name": _token(
        "keyword as name",
        lambda program, index: program.tokens.kinds[index] == NAME,
        lambda _text, random: random.choice(("class", "for", "at", "to", "on", "is", "import", "by", "do")),
    ),
    "missing operand": _token("missing operand", _is_operand, lambda _text, _random: ""),
    "missing comma": _token("missing comma", _missing_comma, lambda _text, _random: ""),
    "missing word": _token(
        "missing word", _text_in("of", "by", "to", "from", "in", "as"), lambda _text, _random: ""
    ),
    "stray character": _token(
        "stray character", _ordinary, lambda text, random: f"{text} {random.choice(_STRAY)}"
    ),
    "curly quotes": _token(
        "curly quotes",
        lambda program, index: (
            program.tokens.kinds[index] == STRING and program.tokens.texts[index][0] in "'\""
        ),
        lambda text, _random: f"“{text[1:-1]}”",
    ),
    "indented more": _indented_more,
    "indented less": _indented_less,
    "tab": _tab,
    "missing block": _missing_block,
    "`=` for `==`": _equals,
    "old print": _inserted("old print", (("print ego",), ("print 'a', 3",), ('print "%d" % 3',))),
    "conflict markers": _conflict,
    "deleted `new`": _token("deleted `new`", _text_in("new"), lambda _text, _random: ""),
    "half-typed line": _half_typed,
    "clause without head": _missing_head,
    "wrong order": _wrong_order,
}
"""Makers of each kind of mistake, where the program has a place for it."""


def base_programs() -> list[Program]:
    """The right programs."""
    return [
        Program(path.stem, path.read_text(encoding="utf-8")) for path in sorted(PROGRAMS.glob("*.scenic"))
    ]


def plant(program: Program, count: int, random: Random) -> tuple[str, list[tuple[Mistake, frozenset[int]]]]:
    """The program with ``count`` independent mistakes, or with as many as fit, each with its right lines."""
    chosen: list[Mistake] = []
    kinds = list(MISTAKES)
    attempts = 0
    while len(chosen) < count and attempts < _MOST_ATTEMPTS:
        attempts += 1
        mistake = MISTAKES[random.choice(kinds)](program, random)
        if mistake is None or any(_close(mistake, each) for each in chosen):
            continue
        if parse(_apply(program, [mistake])[0]).diagnostics:
            chosen.append(mistake)
    return _apply(program, chosen)


def _close(first: Mistake, second: Mistake) -> bool:
    """Return whether fewer than one logical line lies between two mistakes."""
    return first.touched[0] - 1 <= second.touched[1] and second.touched[0] - 1 <= first.touched[1]


def _apply(program: Program, mistakes: list[Mistake]) -> tuple[str, list[tuple[Mistake, frozenset[int]]]]:
    lines = list(program.lines)
    placed = []
    shift = 0
    for mistake in sorted(mistakes, key=lambda each: each.first):
        first = mistake.first + shift
        lines[first - 1 : mistake.end + shift - 1] = mistake.lines
        placed.append((mistake, frozenset(first + each for each in mistake.right)))
        shift += len(mistake.lines) - (mistake.end - mistake.first)
    return "\n".join(lines) + "\n", placed
