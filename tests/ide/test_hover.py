import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenic.ide.hover import hover
from scenic.ide.snapshot import Snapshot
from scenic.language.keywords import MEANINGS
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

PROGRAM = """\
# new things
param time = 12
class Chair:
    width: Range(1, 2)
ego = new Object at (0, 0), with width 3
chair = new Chair left of ego by 2, facing toward ego, on floor
require (distance to chair) < 5 and "new" != 'at'
require always chair.heading > 30 deg
mutate chair by 2
front = distance = 3
if front: pass
"""


def at(word: str, *, nth: int = 1, text: str = PROGRAM) -> str | None:
    """What is said about the ``nth`` occurrence of a word, on each of its characters."""
    offset = [found.start() for found in re.finditer(rf"\b{word}\b", text)][nth - 1]
    line, column = text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset) - 1
    answers = {hover(Snapshot(text, "f.scenic"), line, column + index) for index in range(len(word))}
    (answer,) = answers
    if answer is None:
        return None
    assert answer.span == Span(line, column, line, column + len(word))
    return answer.markdown


@pytest.mark.parametrize(
    ("word", "nth", "expected"),
    [
        ("param", 1, STATEMENTS["Param"].documentation),
        ("width", 1, "default:"),
        ("Range", 1, NAMES["Range"].documentation),
        ("new", 2, "Creates an instance"),
        ("Object", 1, NAMES["Object"].documentation),
        ("with", 1, SPECIFIERS["with"].documentation),
        ("width", 2, "default:"),
        ("left", 1, SPECIFIERS["left of"].documentation),
        ("by", 1, SPECIFIERS["left of"].documentation),
        ("toward", 1, SPECIFIERS["facing toward"].documentation),
        ("ego", 3, MEANINGS["ego"]),
        ("require", 1, STATEMENTS["Require"].documentation),
        ("to", 1, "distance"),
        ("deg", 1, OPERATORS["deg"].documentation),
        ("heading", 1, "heading"),
        ("mutate", 1, STATEMENTS["Mutate"].documentation),
        ("if", 1, "random"),
        ("and", 1, "requirement"),
    ],
)
def test_words(word: str, nth: int, expected: str) -> None:
    markdown = at(word, nth=nth)
    assert markdown is not None
    assert expected in markdown
    assert markdown.startswith("```scenic\n")


@pytest.mark.parametrize(
    ("word", "nth"),
    [("new", 1), ("new", 4), ("at", 2), ("front", 1), ("distance", 2), ("floor", 1), ("time", 1)],
)
def test_nothing_is_said_about(word: str, nth: int) -> None:
    # In order: in a comment, in strings, and names that the program defines.
    assert at(word, nth=nth) is None


def test_what_is_not_built_yet_is_marked() -> None:
    refused = [name for name, each in SPECIFIERS.items() if not each.available and name == "following"]
    for name in refused:
        markdown = at(name, text=f"new Object {name} field from p for 3\n")
        assert markdown is not None
        assert "does not build it yet" in markdown


def test_in_a_broken_program() -> None:
    markdown = at("require", text="x = (\nrequire x >\n")
    assert markdown is not None


def test_beyond_ascii() -> None:
    text = "é = '😀'; z = 30 deg\n"
    markdown = at("deg", text=text)
    assert markdown is not None


def test_places_outside_the_text() -> None:
    assert [hover(Snapshot(PROGRAM, "f"), *place) for place in ((0, 0), (99, 0), (1, 99), (12, 0))] == [
        None
    ] * 4


@given(st.text("new at()[]:,\n 'x\"front of é😀.", max_size=40), st.integers(0, 4), st.integers(0, 20))
def test_any_place_of_any_text(text: str, line: int, column: int) -> None:
    found = hover(Snapshot(text, "f"), line, column)
    assert found is None or found.span.line == line
