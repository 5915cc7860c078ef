"""Mutations: each one happens, and most of what they make is no program any more."""

import pytest
from hypothesis import HealthCheck, Phase, find, given, settings
from hypothesis import strategies as st

from fuzz.grammar import from_grammar
from fuzz.mutations import mutated
from scenic.compiler.parser import parse

SETTINGS = settings(
    max_examples=2000,
    deadline=None,
    database=None,
    derandomize=True,
    phases=(Phase.generate,),
    suppress_health_check=list(HealthCheck),
)


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
    assert (
        find(mutated(st.just("if x:\n    y\n"), most=1), lambda text: text == result, settings=SETTINGS)
        == result
    )


def test_it_happens_that_part_of_another_program_gets_in():
    texts = st.sampled_from(["a + b\n", "class C"])
    find(mutated(texts, most=1), lambda text: "class" in text and "+" in text, settings=SETTINGS)


def test_most_mutants_are_no_programs():
    wrong = []

    @settings(SETTINGS, max_examples=60)
    @given(mutated(from_grammar()))
    def check(text: str) -> None:
        wrong.append(bool(parse(text).diagnostics))

    check()
    assert sum(wrong) > len(wrong) / 3
