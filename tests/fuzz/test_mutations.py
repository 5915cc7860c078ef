"""Mutations: each one happens, and most of what they make is no program any more."""

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from fuzz.draws import RandomDraws
from fuzz.grammar import from_grammar
from fuzz.mutations import Mutant, make_mutant, mutated
from scenic.compiler.parser import parse

SETTINGS = settings(
    max_examples=2000,
    deadline=None,
    database=None,
    derandomize=True,
    phases=(Phase.generate,),
    suppress_health_check=list(HealthCheck),
)


def search(wanted: Callable[[Mutant], bool], original: str, other: str = "") -> Mutant:
    """A mutant of the wanted kind, with one mutation."""
    for seed in range(20_000):
        mutant = make_mutant(RandomDraws(seed), original, lambda: other, most=1)
        if wanted(mutant):
            return mutant
    raise AssertionError("there is none")


@pytest.mark.parametrize(
    ("name", "result"),
    [
        ("a token is deleted", "if x:\n    \n"),
        ("two change places", "if y:\n    x\n"),
        ("one is doubled", "if xx:\n    y\n"),
        ("the end is missing", "if"),
        ("a character is odd", "if x\0:\n    y\n"),
        ("half a character", "if x:\ud800\n    y\n"),
        ("beyond the basic plane", "if x😀:\n    y\n"),
        ("the indentation is wrong", "if x:\n\ty\n"),
    ],
)
def test_it_happens_that(name: str, result: str):
    assert search(lambda mutant: mutant.text == result, "if x:\n    y\n")


@pytest.mark.parametrize("word", ["requre", "requiire", "rqeuire", "raquire", "Require", "REQUIRE"])
def test_it_happens_that_a_word_is_misspelt(word: str):
    assert search(lambda mutant: mutant.text == f"{word} x\n", "require x\n")


def test_it_happens_that_part_of_another_program_gets_in():
    assert search(lambda mutant: "class" in mutant.text and "+" in mutant.text, "a + b\n", "class C")


def test_most_mutants_are_no_programs():
    wrong = []

    @settings(SETTINGS, max_examples=60)
    @given(mutated(from_grammar()))
    def check(mutant: Mutant) -> None:
        wrong.append(bool(parse(mutant.text).diagnostics))

    check()
    assert sum(wrong) > len(wrong) / 3


@settings(SETTINGS, max_examples=150)
@given(mutated(from_grammar()))
def test_a_mutant_knows_where_it_was_changed(mutant: Mutant):
    text, original = mutant.text, mutant.original
    assert 0 <= mutant.start <= mutant.end <= len(text)
    assert text[: mutant.start] == original[: mutant.start]
    rest = len(text) - mutant.end
    assert mutant.start + rest <= len(original)
    assert text[mutant.end :] == original[len(original) - rest :]
    if text == original:
        assert mutant.start == len(text)
    elif mutant.start < min(len(text), len(original)):
        assert text[mutant.start] != original[mutant.start]


@pytest.mark.parametrize(
    ("original", "text", "start", "end"),
    [
        ("a b c", "a c", 2, 2),
        ("a b c", "a b b c", 4, 6),
        ("a b", "a", 1, 1),
        ("a", "a", 1, 1),
        ("aa", "aaa", 2, 3),
        ("x = 1", "x  1", 2, 2),
    ],
)
def test_the_changed_part(original: str, text: str, start: int, end: int):
    found = search(lambda mutant: mutant.text == text, original)
    assert (found.start, found.end) == (start, end)


def test_half_of_the_mutants_have_one_mutation():
    counts = []
    for seed in range(400):
        draws = RandomDraws(seed)
        make_mutant(draws, "x", lambda: "y")
        # The first number decides how many there are.
        counts.append(draws.choices[0] < 2)
    assert 160 < sum(counts) < 240
