"""The lexer against the standard library's `tokenize`, and by itself where that one cannot follow."""

import ast
import unicodedata
from typing import Final

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from scenic.compiler.lexer import lex
from scenic.compiler.text_lines import MOST_DIAGNOSTICS
from scenic.compiler.tokens import DEDENT, ENDMARKER, ERROR, INDENT, NAME
from tests.compiler.python_tokens import WORDS, of_tokenize, rows, with_whole_formatted_strings


def brief(text: str) -> list[str]:
    """The tokens in short: the text of words and operators, the kind in front of the text of others."""
    return [
        text if kind in ("NAME", "OP") else f"{kind} {text}".rstrip(" ")
        for kind, text, _, _ in rows(lex(text, WORDS))
    ]


def complaints(text: str) -> list[tuple[str, int, int]]:
    return [
        (diagnostic.code, diagnostic.span.line, diagnostic.span.column)
        for diagnostic in lex(text, WORDS).diagnostics
        if diagnostic.span is not None
    ]


FRAGMENTS: Final = [
    *["x", "if", "else", "é", "ﬁ", "1", "0x_f", "1_0.5e-3j", ".5", "1.", "0777", "1__0", "3m", "1if", "00"],
    *[
        "'a'",
        '"',
        "'",
        '"""',
        "'''",
        "rb'\\''",
        "u''",
        "b",
        "\\",
        "\n",
        "\r\n",
        "\r",
        "\n    ",
        "\n\t",
        "\n  ",
    ],
    *[
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ":",
        ",",
        ";",
        ".",
        "...",
        "->",
        ":=",
        "**=",
        "!=",
        "=",
        "==",
        "@",
        "~",
        "<>",
    ],
    *["#c", " ", "\t", "\f", "$", "?", "\\\n", "def f():", "return", "pass", "\ufeff", "“", "\xa0", "\0"],
]
FORMATTED: Final = [
    "f'",
    'f"',
    "rf'''",
    "{",
    "}",
    "{{",
    "}}",
    "{x!r}",
    "{x:>{w}}",
    "!r",
    "=}",
    "\\N{DASH}",
    "\\{",
]


@given(st.lists(st.sampled_from(FRAGMENTS), max_size=14).map("".join))
@example("\ta\n        b")
@example("if x:\n        a\n\tb")
@example("if x:\n  \\\n    a\n  b\n")
@example("\\\n\n  # c\n\nx")
@example("x = 1 \\\n  + 2 # c\n")
def test_what_python_accepts_is_tokenised_as_by_tokenize(text: str) -> None:
    try:
        # With the line ends that the lexer makes: Python accepts a backslash before a last "\r\n" only.
        ast.parse(text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n"))
    except (SyntaxError, ValueError, Warning):
        return
    tokens = lex(text, WORDS)
    assert tokens.diagnostics == []
    assert ERROR not in tokens.kinds
    if "\\\n" not in text.replace("\r\n", "\n").replace("\r", "\n") and "\f" not in text:
        # `tokenize` differs from Python's parser about blanks before and after these two.
        assert with_whole_formatted_strings(tokens) == of_tokenize(text.removeprefix("\ufeff"))


@given(
    st.one_of(
        st.text(max_size=40),
        st.lists(st.sampled_from(FRAGMENTS + FORMATTED), max_size=25).map("".join),
        st.text("fr'\"{}:!=\\ \nxN", max_size=30),
    )
)
@example("f'{")
@example('f"{x:{')
@example("f'''{x\nclass C: pass")
@example("(\n\n# c\ndef f(): pass")
@example("x = '\\")
@example('"' * 7)
def test_any_text_gives_consistent_tokens(text: str) -> None:
    tokens = lex(text, WORDS)
    everything = list(rows(tokens))
    assert everything[-1][0] == "END"
    assert tokens.kinds.count(INDENT) == tokens.kinds.count(DEDENT)
    lines = [line.encode("utf-8", "surrogatepass") + b"\n" for line in tokens.text.split("\n")]
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    source = b"".join(lines)
    previous = 0
    for kind, string, (line, column), (end_line, end_column) in everything:
        start, end = starts[line - 1] + column, starts[end_line - 1] + end_column
        assert previous <= start <= end
        between = source[previous:start].decode("utf-8", "surrogatepass")
        # What lies between tokens is blank, a comment or a line end.
        for part in between.split("\n"):
            assert part.strip(" \t\f\\") == "" or part.lstrip(" \t\f").startswith("#")
        covered = source[start:end].decode("utf-8", "surrogatepass")
        if kind in ("NUMBER", "STRING", "OP", "FSTART", "FEND", "INDENT") or (kind == "ERROR" and string):
            assert covered == string
        elif kind == "NAME":
            assert unicodedata.normalize("NFKC", covered) == string
        elif kind == "FMIDDLE":
            assert string in (covered, covered.replace("{{", "{").replace("}}", "}"))
        previous = end
    if ERROR in tokens.kinds:
        assert tokens.diagnostics
    for diagnostic in tokens.diagnostics:
        span = diagnostic.span
        assert span is not None
        assert span.end_line <= len(lines)


@pytest.mark.parametrize(
    "text", ["0", "00_0", "1_2", "0b1_0", "0o17", "0XfF", "1.5", "1.", ".5", "1e5", "1.e-5j", "0777.5", "08j"]
)
def test_numbers(text: str) -> None:
    ast.literal_eval(text)
    assert brief(text) == [f"NUMBER {text}", "NEWLINE", "END"]
    assert brief(text + "if") == [f"NUMBER {text}", "if", "NEWLINE", "END"]


@pytest.mark.parametrize(
    "text", ["0777", "1_", "1__0", "0x", "0b12", "0o8", "1e+", "2x", "0_7", "0b_", "1_.5", "1.real", "0777or"]
)
def test_bad_numbers(text: str) -> None:
    with pytest.raises(SyntaxError):
        ast.parse(text)
    assert complaints(f"x = {text}") == [("SC104", 1, 4)]


def test_kinds_of_words() -> None:
    tokens = lex("if ego: ego.éa = ｅgo\n", WORDS)
    assert tokens.kinds[:3] == [WORDS["if"], WORDS["ego"], WORDS[":"]]
    # A name that only normalises to a keyword is none.
    assert tokens.kinds[7] == NAME
    assert tokens.texts[7] == "ego"


def test_comments_are_kept_apart() -> None:
    tokens = lex("# one\nx = (  # two é\n  # three\n  1)  \n\n  # four", WORDS)
    assert tokens.comments == [(1, 0, "# one"), (2, 7, "# two é"), (3, 2, "# three"), (6, 2, "# four")]
    assert tokens.texts == ["x", "=", "(", "1", ")", "", ""]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('f"a{x}b"', ['FSTART f"', "FMIDDLE a", "{", "x", "}", "FMIDDLE b", 'FEND "']),
        ('f"{x["a"]}"', ['FSTART f"', "{", "x", "[", 'STRING "a"', "]", "}", 'FEND "']),
        ('f"{x!r:>{w}.2}"', ['FSTART f"', *"{x!r:", "FMIDDLE >", *"{w}", "FMIDDLE .2", "}", 'FEND "']),
        ('f"{x=}"', ['FSTART f"', *"{x=}", 'FEND "']),
        ('f"{{{x}}}"', ['FSTART f"', "FMIDDLE {", *"{x}", "FMIDDLE }", 'FEND "']),
        ('f"{x:=5}"', ['FSTART f"', *"{x:", "FMIDDLE =5", "}", 'FEND "']),
        ('f"{(x:=5)}"', ['FSTART f"', *"{(x", ":=", "NUMBER 5", ")", "}", 'FEND "']),
        ('f"{x!=y}"', ['FSTART f"', "{", "x", "!=", "y", "}", 'FEND "']),
        ('f"{a[1:2]}"', ['FSTART f"', *"{a[", "NUMBER 1", ":", "NUMBER 2", "]", "}", 'FEND "']),
        (r'f"\N{DASH}\{x}"', ['FSTART f"', r"FMIDDLE \N{DASH}\\"[:-1], *"{x}", 'FEND "']),
        (r'rf"\N{x}\""', ['FSTART rf"', r"FMIDDLE \N", *"{x}", r"FMIDDLE \"", 'FEND "']),
        ("f'''{\nx # c\n}\n'''", ["FSTART f'''", *"{x}", "FMIDDLE \n", "FEND '''"]),
        (
            'f"{f"{f"{1}"}"}"',
            ['FSTART f"', "{", 'FSTART f"', "{", 'FSTART f"', "{", "NUMBER 1"] + ["}", 'FEND "'] * 3,
        ),
        ('f"{x:{y:{z}}}"', ['FSTART f"', *"{x:{y:{z}}}", 'FEND "']),
        ('f"{lambda x: 1}"', ['FSTART f"', "{", "lambda", "x", ":", "FMIDDLE  1", "}", 'FEND "']),
        (
            'f"{ {1: 2}[1] }"',
            ['FSTART f"', *"{{", "NUMBER 1", ":", "NUMBER 2", *"}[", "NUMBER 1", *"]}", 'FEND "'],
        ),
        ('f""', ['FSTART f"', 'FEND "']),
    ],
)
def test_formatted_strings(text: str, expected: list[str]) -> None:
    assert brief(text) == [*expected, "NEWLINE", "END"]
    assert complaints(text) == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x = $\ny = 1 ? 2", [("SC100", 1, 4), ("SC100", 2, 6)]),
        ("x = “a”", [("SC100", 1, 4)]),
        ("x\xa0= 1", [("SC100", 1, 1)]),
        ("x = !y", [("SC100", 1, 4)]),
        ("é = '\0' # \ud800", [("SC100", 1, 5), ("SC100", 1, 10)]),
        ("x = 'abc\ny", [("SC101", 1, 4)]),
        ("x = b'''abc\ny", [("SC101", 1, 4)]),
        ("x = f'abc\ny", [("SC101", 1, 4)]),
        ("if x:\n    a\n  b\nc", [("SC102", 3, 0)]),
        ("if x:\n        a\n\tb", [("SC102", 3, 0)]),
        ("x = (1, 2\ny = 3", [("SC103", 1, 4)]),
        ("x = [1, (2]\ny = 3)", [("SC103", 1, 10), ("SC103", 2, 5)]),
        ("x = (1,\ndef f():\n    g(]\n", [("SC103", 1, 4), ("SC103", 3, 6), ("SC103", 3, 5)]),
        ("x = 0777", [("SC104", 1, 4)]),
        ('x = f"{x"', [("SC105", 1, 8)]),
        ("x = f'{x:>3'", [("SC105", 1, 11)]),
        ("x = f'}'", [("SC105", 1, 6)]),
        ("x = f'{x\n", [("SC105", 1, 6)]),
        ("x = 1 \\ \n  + 2\n", [("SC106", 1, 6)]),
        ("x = 1 \\ 2\n", [("SC106", 1, 6)]),
        ("x = 1 \\\n", [("SC106", 1, 6)]),
        ("x = 1 \\", [("SC106", 1, 6)]),
    ],
)
def test_errors_and_their_places(text: str, expected: list[tuple[str, int, int]]) -> None:
    assert complaints(text) == expected
    for diagnostic in lex(text, WORDS).diagnostics:
        assert diagnostic.help


def test_mismatch_points_at_the_opener() -> None:
    (diagnostic,) = lex("f(a[1)\nx = 1\n", WORDS).diagnostics
    assert diagnostic.span is not None
    assert (diagnostic.span.column, diagnostic.labels[0].span.column) == (5, 3)
    # The outer bracket is closed with it, so that the next line is a statement again.
    assert brief("f(a[1)\nx\n")[-4:] == ["NEWLINE", "x", "NEWLINE", "END"]


def test_statement_word_ends_open_brackets() -> None:
    expected = ["x", "=", "(", "ERROR", "NEWLINE", "def", "f", "(", ")", ":"]
    assert brief("x = (\n\n\ndef f():\n    pass\n")[:10] == expected


def test_bad_unindent_leaves_the_blocks_whole() -> None:
    kinds = lex("if x:\n    a\n  b\nc\n", WORDS).kinds
    assert (kinds.count(INDENT), kinds.count(DEDENT)) == (1, 1)


def test_line_ends_and_marks() -> None:
    plain = list(rows(lex("if x:\n  'a\\\nb'\ny\n", WORDS)))
    assert list(rows(lex("\ufeffif x:\r\n  'a\\\r\nb'\ry", WORDS))) == plain
    assert lex("\ufeffx", WORDS).columns[0] == 0


def test_many_errors_are_cut_short() -> None:
    tokens = lex("$ " * 5000, WORDS)
    assert tokens.kinds.count(ERROR) == 5000
    assert len(tokens.diagnostics) == MOST_DIAGNOSTICS


HOSTILE: Final = [
    *[
        "(" * 20_000,
        "([{" * 7_000 + ")" * 7_000,
        "f'{" * 5_000,
        'f"{x:' * 5_000,
        "'\n" * 20_000,
        "\\" * 50_000,
    ],
    *["\\\n" * 20_000, "\t" * 50_000, "é" * 50_000 + "\xa0", "1_" * 20_000, "{" * 9_000 + "]" * 9_000],
    *["".join(" " * depth + "if x:\n" for depth in range(500)), "'''" + "\\'''" * 20_000],
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_texts(text: str) -> None:
    tokens = lex(text, WORDS)
    assert tokens.kinds[-1] == ENDMARKER
    assert tokens.diagnostics or "if" in text or text.isspace()


@pytest.mark.parametrize(
    "text", ['("""\n= 1 ==', '("""a\nbcd"""\n', '(f"""a\nbcd"""\n', '["\\\n    workspace']
)
def test_an_open_bracket_is_noticed_at_the_end_of_the_last_token(text: str) -> None:
    [problem] = [each for each in lex(text, WORDS).diagnostics if each.code == "SC103"]
    [label] = problem.labels
    line = text.split("\n")[1]
    assert (label.span.line, label.span.column) == (2, len(line))
