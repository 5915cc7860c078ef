"""Deep and long programs give a tree or a diagnostic, from the parser and from the whole static check, in linear time."""

import gc
from collections.abc import Callable

import pytest

from scenic.compiler.check import check_text
from scenic.compiler.generated import HARD_KEYWORDS, OPERATORS
from scenic.compiler.parser import parse
from tests.each import each
from tests.work import calls_while

Text = Callable[[int], str]

DEPTH = 190
"""Of the deep texts: nearly as deep as brackets may nest."""
BLOCKS = 0.4
"""Blocks in blocks, by the depth of other texts."""


def repeated(start: str, middle: str, end: str = "", *, prefix: str = "x = ") -> Text:
    return lambda count: prefix + start * count + middle + end * count + "\n"


def chain(operator: str, operand: str = "a", *, prefix: str = "x = ") -> Text:
    return lambda count: prefix + f" {operator} ".join([operand] * (count + 1)) + "\n"


def blocks(*headers: str, inner: str = "pass", after: tuple[str, ...] = ()) -> Text:
    """Blocks in blocks; ``after`` are the lines that end each block."""

    def text(count: int) -> str:
        count = int(count * BLOCKS)
        lines = []
        depth = 0
        for _ in range(count):
            for header in headers:
                lines.append(" " * depth + header)
                depth += 1
        lines.append(" " * depth + inner)
        for _ in range(count):
            depth -= len(headers)
            lines += [" " * depth + line for line in after]
        return "\n".join(lines) + "\n"

    return text


BINARY = (
    *("+", "-", "*", "/", "//", "%", "@", "**", "<<", ">>", "&", "|", "^", "<", "<=", ">", ">=", "==", "!="),
    *("and", "or", "in", "not in", "is", "is not"),
    *("visible from", "not visible from", "can see", "intersects", "relative to", "offset by", "at"),
)
PREFIX = (
    *("-", "+", "~", "not", "lambda:", "lambda a:", "await"),
    *(
        "visible",
        "not visible",
        "front of",
        "top back right of",
        "distance to",
        "distance from",
        "distance past",
    ),
    *("angle to", "altitude from", "minimum distance to", "relative position of", "relative heading of"),
    *("apparent heading of", "angle to not", "not distance to", "a if b else", "a if", "a offset along"),
    *(
        "new C with x",
        "new C at",
        "new C beyond",
        "new C facing",
        "(yield",
        "[*",
        "{**",
        "f(*",
        "f(**",
        "f(a=",
    ),
    *(
        "a[",
        "a[:",
        "a[*",
        "{a:",
        "[a for b in",
        "{a for b in",
        "(a for b in",
        "(a :=",
        "f(a for b in",
        "(",
        "[",
        "{",
    ),
    *("([{", "f(a[", "((),", "(lambda: [", "distance from (", "(a if (", "f'{", "f'{a:{", '"a" f\'{'),
)
CLOSED = {"(": ")", "[": "]", "{": "}"}


def closers(start: str) -> str:
    """What closes the brackets of a repeated beginning."""
    stack = []
    for character in start:
        if character in CLOSED:
            stack.append(CLOSED[character])
        elif character in CLOSED.values():
            stack.pop()
        elif character == "'":
            stack.append("'")
    # The quote of an empty string would not be left open; here each one opens an f-string.
    return "".join(reversed(stack)).replace(":'", "'")


TEXTS: dict[str, Text] = {
    **{f"chain of {operator}": chain(operator) for operator in BINARY},
    **{
        f"chain of {word} in a condition": chain(word, prefix="require ")
        for word in ("and", "or", "implies", "until", "==")
    },
    **{f"repeated {start}": repeated(f"{start} ", "a", closers(start)) for start in PREFIX},
    **{f"repeated {start}, a mistake": repeated(f"{start} ", "a a", closers(start)) for start in PREFIX},
    **{f"repeated {start}, unclosed": repeated(f"{start} ", "a") for start in PREFIX if closers(start)},
    "closing brackets": repeated(")", "", prefix=""),
    "crossing brackets": repeated("([", "a", ")]"),
    "every bracket, the wrong one closed": repeated("([{", "a", ")]}"),
    "powers": chain("**", "-a"),
    "attributes": lambda count: "x = a" + ".b" * count + "\n",
    "calls": lambda count: "x = a" + "()" * count + "\n",
    "calls with arguments": lambda count: "x = a" + "(b, c=d)" * count + "\n",
    "subscripts": lambda count: "x = a" + "[b]" * count + "\n",
    "mixed primaries": lambda count: "x = a" + ".b(c)[d:e]" * count + "\n",
    "deg": lambda count: "x = a" + " deg" * count + "\n",
    "vectors": chain("@", "1"),
    "offset along by": repeated("a offset along ", "b", " by c"),
    "conditionals": repeated("a if b else ", "c"),
    "conditional tests": repeated("a if ", "b", " else c"),
    "conditional bodies": repeated("(", "a", " if b else c)"),
    "distance from to": repeated("distance from ", "a", " to b"),
    "follow": repeated("follow ", "a", " from b for c"),
    "follow distance": repeated("follow distance to ", "a", " from b for c"),
    "assignments": lambda count: "x = " * count + "3\n",
    "targets": repeated("(", "x", ",)", prefix="for "),
    "commas": chain(",", "a"),
    "statements on a line": chain(";", "a", prefix=""),
    "arguments": lambda count: "f(" + ", ".join(f"a{index}=b" for index in range(count)) + ")\n",
    "parameters": lambda count: "def f(" + ", ".join(f"a{index}=b" for index in range(count)) + "): pass\n",
    "comparisons of all kinds": chain("< a in b not in c is d ==", "a"),
    "temporal prefixes": repeated("always ", "a", prefix="require "),
    "temporal groups": repeated("(always ", "a", ")", prefix="require "),
    "temporal negations": repeated("not ", "always a", prefix="require "),
    "temporal implications": repeated("a implies (", "b", ")", prefix="require "),
    "temporal untils": repeated("(a until ", "b", ")", prefix="require "),
    "temporal conditionals": repeated("a if b else ", "c", prefix="require "),
    "generators in calls": repeated("f(", "1", " for x in y)"),
    "targets of statements": repeated("(", "x", ")", prefix=""),
    "context managers": lambda count: "with " + "(" * count + "x" + ")" * count + " as y: pass\n",
    "defaults of lambdas": repeated("lambda a=", "1", ": 1"),
    "offset along unfinished": repeated("a offset along ", "b"),
    "distances in a row": repeated("distance from a | ", "a"),
    "distance from calls": repeated("distance from f(", "a", ")"),
    "new in parentheses": repeated("new C at (", "a", ")"),
    "beyond": repeated("new C beyond ", "a", " by 3"),
    "conditions": repeated("(", "a", ")", prefix="require "),
    "conditions with a mistake": repeated("(", "a a", ")", prefix="require "),
    "conditions and more": repeated("(", "a", ") and b", prefix="require "),
    "conditions that are none": repeated("(", "a", ") + 1", prefix="require "),
    "temporal conditions that are none": repeated("always (", "a", ") + 1", prefix="require "),
    "soft keyword": repeated("(", "a", ")", prefix="take "),
    "do until": lambda count: "do " + "f(" * count + "a" + ")" * count + " until x\n",
    "keyword patterns": lambda count: "match x:\n case " + "C(a=" * count + "a" + ")" * count + ": pass\n",
    "patterns with a mistake": lambda count: (
        "match x:\n case " + "C(" * count + "a a" + ")" * count + ": pass\n"
    ),
    "specifiers": lambda count: "x = new C" + ",".join([" with a b"] * count) + "\n",
    "patterns": lambda count: "match x:\n case " + "[" * count + "a" + "]" * count + ": pass\n",
    "class patterns": lambda count: "match x:\n case " + "C(" * count + "a" + ")" * count + ": pass\n",
    "mapping patterns": lambda count: "match x:\n case " + "{1: " * count + "a" + "}" * count + ": pass\n",
    "alternative patterns": lambda count: "match x:\n case " + " | ".join(["1"] * count) + ": pass\n",
    "dotted patterns": lambda count: "match x:\n case a" + ".b" * count + ": pass\n",
    "strings": lambda count: "x = " + "'a' " * count + "\n",
    "f-strings in a row": lambda count: "x = " + "f'{a}b' " * count + "\n",
    "fields of an f-string": lambda count: "x = f'" + "{a}b" * count + "'\n",
    "formats in formats": repeated("f'{a:{", "b", "}}'"),
    "f-strings never closed": repeated("f'{", ""),
    "triple f-strings never closed": repeated("f'''{\n", ""),
    "decorators": lambda count: "@a\n" * count + "def f(): pass\n",
    "dots of an import": lambda count: "from " + "." * count + " import a\n",
    "names of an import": lambda count: "import a" + ".b" * count + "\n",
    "elif": lambda count: "if a: pass\n" + "elif b: pass\n" * count,
    "elif with blocks": lambda count: "if a:\n  pass\n" + "elif b:\n  pass\n" * count + "else:\n  x x\n",
    "except": lambda count: "try: pass\n" + "except a: pass\n" * count,
    "interrupt": lambda count: "behavior B():\n try: wait\n" + " interrupt when a: wait\n" * count,
    "case": lambda count: "match a:\n" + " case b.c: pass\n" * count,
    "else without if": lambda count: "else: pass\n" * count,
    "mistakes": lambda count: "x x\n" * count,
    "lines continued": lambda count: "x = " + "a + \\\n" * count + "a\n",
    "empty continuations": lambda count: "\\\n" * count + "x = 1\n",
    "lines in brackets": lambda count: "x = (\n" * count + "a" + "\n)" * count + "\n",
    "indents": lambda count: "".join(" " * depth + "x\n" for depth in range(int(count * BLOCKS))),
    "backticks": lambda count: "`" * count + "\n",
}
for _header in (
    ("if a:",),
    ("while a:",),
    ("for b in c:",),
    ("with a as b:",),
    ("class C:",),
    ("class C(D):", "def f(self):"),
    ("def f(a, b=c):",),
    ("async def f():",),
    ("try:",),
    ("try:", "pass"),
    ("match a:", "case b:"),
    ("behavior B():",),
    ("behavior B():", "try:"),
    ("monitor M():",),
    ("scenario S():",),
    ("scenario S():", "setup:"),
    ("scenario S():", "compose:"),
    ("do",),
    ("x",),
):
    _after = ("finally: pass",) if _header[-1] == "try:" and _header[0] == "try:" else ()
    TEXTS[f"blocks of {' '.join(_header)}"] = blocks(*_header, after=_after)
    TEXTS[f"blocks of {' '.join(_header)} with a mistake"] = blocks(*_header, inner="x x", after=_after)
    TEXTS[f"blocks of {' '.join(_header)} with brackets"] = blocks(
        *_header, inner="x = " + "(" * 100 + ")" * 100
    )
TEXTS["blocks of if with else"] = blocks("if a:", after=("else: pass",))
TEXTS["blocks of all kinds"] = blocks(
    "class C:", "def f(self):", "if a:", "for b in c:", "while d:", "with e:"
)


def test_every_operator_is_here() -> None:
    """An operator of the grammar that is missing above would not be tried."""
    words = {word for text in (*BINARY, *PREFIX) for word in text.replace("(", " ").split()}
    missing = {
        each for each in OPERATORS if not each.endswith("=") or each in ("==", "!=", "<=", ">=")
    } - words
    assert missing == {"->", ".", "...", ",", ";", ":", ")", "]", "}", "!", "(", "[", "{"} & missing
    assert {
        "and",
        "or",
        "not",
        "in",
        "is",
        "lambda",
        "await",
        "if",
        "else",
        "at",
        "to",
        "from",
    } <= words & set(HARD_KEYWORDS)


def check(text: str) -> None:
    """Check a text, and see that everything that is said has a place."""
    for found in check_text(text, filename="deep.scenic"):
        assert found.span is not None


@each(TEXTS)
def test_checking_nested_texts_takes_linear_time(name: str) -> None:
    # Below some depth a block with a mistake may be parsed once more for every block around it.
    factor = 10 if name.startswith("blocks of") else 1
    small, large = (calls_while(check, TEXTS[name](factor * count)) for count in (20, 40))
    assert large < 2.6 * small + 3000


@pytest.mark.slow
@each(TEXTS)
def test_deep_texts(name: str) -> None:
    text = TEXTS[name](DEPTH)
    if "mistake" in name or "unclosed" in name:
        result = parse(text)
        assert result.diagnostics
        assert all(each.span is not None for each in result.diagnostics)
        del result
    else:
        check(text)
    gc.collect(1)
