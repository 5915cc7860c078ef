"""The joined grammars: keys, heights, options, distances."""

import pytest

from fuzz.derivations import AlternativeId, Derivations, load
from grammar.generator import GrammarError, read_grammar_text

GRAMMAR = """
@start file

file:
    | a=line* ENDMARKER
line:
    | a=sum NEWLINE
    | 'if' a=sum ':' b=line
sum:
    | a=sum '+' b=atom { add(a, b) }
    | a=sum !'-' '-' b=atom { subtract(a, b) }
    | atom
atom:
    | "word" NAME
    | NAME { name(a) }
    | '(' a=sum ')'
    | '[' a=','.sum+ ']'
"""
NARROWING = """
@start file

sum__subtract: CAPITALS '-' bracket
bracket:
    | atom__3
    | atom__name { atom__3 }
"""


def make(narrowing: str = NARROWING) -> Derivations:
    return Derivations(read_grammar_text(GRAMMAR), read_grammar_text(narrowing))


def test_heights_count_the_expansions_of_the_shortest_sentence():
    derivations = make()
    assert {rule: derivations.height(rule) for rule in ("file", "line", "sum", "atom")} == {
        "file": 1,
        "line": 2,
        "sum": 1,
        "atom": 1,
    }


def test_units_are_replaced_by_what_they_lead_to_and_count():
    options = make().options["sum"]
    assert [(option.rule, option.height, list(map(str, option.counts_as))) for option in options] == [
        ("atom", 1, ["sum/3", "atom/2"]),
        ("atom", 1, ["sum/3", "atom/1"]),
        ("sum", 2, ["sum/1"]),
        ("sum", 2, ["sum/2"]),
        ("atom", 2, ["sum/3", "atom/3"]),
        ("atom", 2, ["sum/3", "atom/4"]),
    ]


def test_an_alternative_of_the_narrowing_counts_as_what_it_says():
    assert [list(map(str, option.counts_as)) for option in make().options["bracket"]] == [
        ["atom/3", "atom/2"],
        ["atom/3"],
    ]


def test_all_alternatives_are_countable_but_trivial_groups():
    assert len(make().countable) == 1 + 2 + 3 + 4


def test_distances_lead_to_the_alternative():
    distances = make().distances(AlternativeId("atom", 4))
    assert (distances["atom"], distances["sum"], distances["line"], distances["file"]) == (0, 1, 2, 3)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("sum__multiply: NAME", "0 alternatives"),
        ("product__1: NAME", "no rule"),
        ("sum__9: NAME", "0 alternatives"),
        ("sum__atom: NAME\n\nsum__3: NAME", "one row"),
        ("atom: NAME", "is a rule of the grammar"),
        ("endless: '(' endless ')'", "no sentence"),
    ],
)
def test_what_the_grammar_does_not_have_is_refused(rule: str, message: str):
    with pytest.raises(GrammarError, match=message):
        make(f"@start file\n\n{rule}\n")


def test_the_narrowing_fits_the_grammar():
    derivations = load()
    # Every rule that a file needs has sentences, and none is out of reach.
    assert {each.rule for each in derivations.countable} <= derivations.options.keys()
    assert all(option.height < 10 for options in derivations.options.values() for option in options)


def test_weights_say_how_often_what_is_chosen():
    grammars = read_grammar_text(GRAMMAR), read_grammar_text(NARROWING)
    plain, weighted = Derivations(*grammars), Derivations(*grammars, {"sum__2": 5, "atom": 3})
    for before, after in zip(plain.options["sum"], weighted.options["sum"], strict=True):
        factor = {"atom": None, "sum": 5 if "sum/2" in map(str, before.counts_as) else 1}[before.rule]
        assert factor is None or after.weight == factor * before.weight
    assert {option.weight for option in weighted.options["atom"]} == {3}
    with pytest.raises(GrammarError, match="weights: there is no rule 'product'"):
        Derivations(*grammars, {"product": 2})
