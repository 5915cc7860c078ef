"""Layout has no meaning: however a sentence is laid out, the lexer reads the same tokens."""

import re

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzz.grammar import Program, programs
from fuzz.layout import lay_out
from fuzz.terminals import Piece, Shape
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.tokens import FSTRING_MIDDLE, Tokens


def words(text: str, shape: Shape = Shape.WORD) -> list[Piece]:
    return [Piece(word, shape if word.isidentifier() else Shape.OPERATOR) for word in text.split()]


def test_seed_0_is_plain():
    pieces = [
        *words("if f ( x , y ) and not ( a . b ) :"),
        Piece("", Shape.NEWLINE),
        Piece("", Shape.INDENT),
        *words("x [ a : b ] = ~ c"),
        Piece("1", Shape.NUMBER),
        *words(". real"),
        Piece("", Shape.NEWLINE),
        Piece("", Shape.DEDENT),
        *words("pass ;"),
        Piece("", Shape.NEWLINE),
    ]
    assert lay_out(pieces, seed=0).splitlines() == [
        "if f(x, y) and not (a.b):",
        "    x[a: b] = ~c 1 .real",
        "pass;",
    ]


def test_the_text_of_an_f_string_stays_as_it_is():
    pieces = [
        Piece("f'", Shape.FORMATTED_START),
        Piece("a ", Shape.FORMATTED_TEXT),
        Piece("{", Shape.FIELD_OPEN),
        *words("{ }"),
        Piece("=", Shape.FIELD_MARK),
        Piece("!", Shape.FIELD_MARK),
        Piece("r", Shape.WORD),
        Piece("}", Shape.FIELD_CLOSE),
        Piece("'", Shape.FORMATTED_END),
    ]
    assert lay_out(pieces) == "f'a { {}=!r}'"


def tokens_of(tokens: Tokens) -> list[tuple[int, str]]:
    """Kinds and texts; neighbouring pieces of the text of an f-string as one."""
    found: list[tuple[int, str]] = []
    for kind, text in zip(tokens.kinds, tokens.texts, strict=True):
        if kind == FSTRING_MIDDLE and found and found[-1][0] == kind:
            text = found.pop()[1] + text
        # Indentation differs, of course.
        found.append((kind, "" if text.isspace() else text))
    return found


@settings(
    max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
)
@given(programs(), st.lists(st.integers(1, 10**6), min_size=4, max_size=4))
def test_layout_has_no_meaning(program: Program, seeds: list[int]):
    plain = lex(lay_out(program.pieces, seed=0), WORDS)
    assert not plain.diagnostics
    for seed in seeds:
        text = lay_out(program.pieces, seed=seed)
        assert tokens_of(lex(text, WORDS)) == tokens_of(plain), text


@settings(
    max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
)
@given(programs())
def test_every_token_is_in_the_text(program: Program):
    text = re.sub(r"\r\n?", "\n", program.text)
    place = 0
    for piece in program.pieces:
        place = text.index(piece.text, place) + len(piece.text)
