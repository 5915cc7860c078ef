"""After a change only a part of a text is lexed again, also where mistakes are; and what is far away may matter still."""

import pytest

from scenic.compiler.careful import lex_carefully
from scenic.compiler.generated import WORDS
from scenic.compiler.incremental import revise
from scenic.compiler.lexer import lex
from scenic.compiler.relexing import LOOKAHEAD, Change, Lexed, lex_again

BLOCK = """\
# about {0}
class Chair{0}(Object):
    width: {0}  # metres

def f{0}(a,
         b):
    return 'é' if a else "{0}"
"""


def program(count: int, **changes: str) -> str:
    """Numbered blocks; those of some numbers are other texts."""
    return "".join(changes.get(f"b{number}", BLOCK.replace("{0}", str(number))) for number in range(count))


def read(text: str) -> Lexed:
    afresh: list[int] = []
    return Lexed(lex_carefully(text, WORDS, afresh), afresh)


def change(before: str, after: str) -> Change:
    old, new = before.split("\n"), after.split("\n")
    first = next(index for index, (one, other) in enumerate(zip(old, new, strict=False)) if one != other)
    last = next(
        index
        for index, (one, other) in enumerate(zip(reversed(old), reversed(new), strict=False))
        if one != other
    )
    return Change(first, min(last, len(old) - first, len(new) - first), len(old), len(new))


@pytest.mark.parametrize(
    "mistake", ["def g(:\n", "y = 'abc\n", "x = (1, 2\nif x:\n    y = 3 3\n", "    odd\n"]
)
def test_only_a_part_is_read_again(mistake: str) -> None:
    before = program(60, b20=mistake)
    for after in (
        program(60, b20=mistake, b40="z = 1\n"),
        program(60, b20=mistake, b3="q = [1, 2\n"),
        program(60, b20=mistake + "w = 1\n"),
        program(60),
    ):
        sizes = []

        def noted(text: str, sizes: list[int] = sizes) -> Lexed:
            sizes.append(len(text))
            return read(text)

        again = lex_again(after, after.split("\n"), read(before), change(before, after), noted)
        assert again is not None
        assert again[0].tokens == read(after).tokens
        assert list(again[0].afresh) == list(read(after).afresh)
        assert sum(sizes) < 6 * LOOKAHEAD


@pytest.mark.parametrize("marks", ['"""', "'''"])
def test_the_end_of_a_text_may_be_far_away(marks: str) -> None:
    opened = program(40, b5=f"t = {marks}abc\n")
    closed = program(40, b5=f"t = {marks}abc\n", b35=f"{marks}\n")
    for before, after in ((opened, closed), (closed, opened)):
        revision = revise(after, revise(before))
        assert revision.tokens == lex(after, WORDS)
        assert (
            revision.careful is None
            or revision.careful[0] != tuple(after.split("\n"))
            or (revision.careful[1].tokens == read(after).tokens)
        )


def test_a_mistake_that_goes_and_comes_back() -> None:
    right, wrong = program(30), program(30, b10="x = (\n")
    revision = revise(wrong)
    for text in (right, wrong, right, program(30, b10="x = (", b20="y = )\n")):
        revision = revise(text, revision)
        assert revision.result.diagnostics == revise(text).result.diagnostics
        assert revision.tokens == lex(text, WORDS)
