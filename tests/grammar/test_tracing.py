"""Tracing tells what a text's derivation uses, and nothing that was only tried."""

from types import SimpleNamespace
from typing import Any

import pytest

from grammar.generator import read_grammar_text
from grammar.tracing import AlternativeId, Choice, TracingParser, choices, explain


def trace(rules: str, words: str) -> set[str]:
    """What blank-separated tokens do: the alternatives, and the forms of their items."""
    grammar = read_grammar_text("@start file\n" + rules)
    vocabulary = {
        **grammar.vocabulary.hard_keywords,
        **grammar.vocabulary.operators,
        **grammar.vocabulary.soft_keywords,
    }
    texts = words.split()
    kinds = [vocabulary.get(text, 4 if text.isdigit() else 256) for text in texts] + [0] * 5
    places = list(range(len(kinds)))
    actions = SimpleNamespace(
        flat=lambda items: tuple(items),
        words=lambda items: None if len(items) > 2 else tuple(items),
        joined=lambda items: tuple(items),
    )
    lists: tuple[Any, ...] = (kinds, [*texts, "", ""], places, places, places, places)
    found = TracingParser(grammar).parse(lists, actions)
    assert found.choices <= set(choices(grammar))
    assert (found.tree is None) == (not found.choices)
    return {
        str(each.alternative) + (f" {each.item} {each.outcome}" if each.item else "")
        for each in found.choices
        if each.alternative.rule != "file"
    }


LADDER = """\
file: a=either ENDMARKER { [a] }
either:
    | a=sum 'or' b=sum { flat([a, b]) }
    | sum
sum:
    | a=sum '+' b=atom { flat([a, b]) }
    | a=sum '-' b=atom { flat([a, b]) }
    | atom
atom:
    | '(' a=either ')' { [a] }
    | '(' a=either ',' b=either ')' { [a, b] }
    | NAME { [1] }
"""


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("a", {"either/2", "sum/3", "atom/3"}),
        ("a or b", {"either/1", "sum/3", "atom/3"}),
        ("a + b + c", {"either/2", "sum/1", "sum/3", "atom/3"}),
        ("a - b or c", {"either/1", "sum/2", "sum/3", "atom/3"}),
        ("( a )", {"either/2", "sum/3", "atom/1", "atom/3"}),
        ("( a , b )", {"either/2", "sum/3", "atom/2", "atom/3"}),
        ("( a + b )", {"either/2", "sum/1", "sum/3", "atom/1", "atom/3"}),
        ("a +", set()),
        ("( a", set()),
    ],
)
def test_ladders(words: str, found: set[str]) -> None:
    assert trace(LADDER, words) == found


ITEMS = """\
file: a=item+ ENDMARKER { [a] }
item:
    | 'x' a=(';' | ':')? b=NAME* { [a, b] }
    | 'y' a=','.NUMBER+ &('x' | 'y' | 'z' | ENDMARKER) { [a] }
    | 'z' { [1] }
"""


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("x", {"item/1", "item/1 2 absent", "item/1 3 absent"}),
        ("x ; a", {"item/1", "item/1 2 present", "item/1 2 ';'", "item/1 3 present"}),
        ("x : a b", {"item/1", "item/1 2 present", "item/1 2 ':'", "item/1 3 present"}),
        ("y 1", {"item/2", "item/2 2 one", "item/2 3 ENDMARKER"}),
        ("y 1 , 2 y 3", {f"item/2{each}" for each in ("", " 2 one", " 2 several", " 3 'y'", " 3 ENDMARKER")}),
    ],
)
def test_forms_of_items(words: str, found: set[str]) -> None:
    assert trace(ITEMS, words) == found


def test_groups_have_alternatives() -> None:
    assert trace("file: 'z' a=(NAME ':' { [1] } | NUMBER '.' { [2] }) ENDMARKER { [a] }\n", "z 3 .") == {
        "group_1/2"
    }


ABANDONED = """\
file: a=line ENDMARKER { [a] }
line:
    | a=pair ':' { [a] }
    | a=single ':' { [a] }
    | a=pair b=single { [a, b] }
    | !pair a=single &single b=single { [a, b] }
pair: a=single ',' b=single { [a, b] }
single (memo):
    | a=NAME '.' b=NAME { words([a, b]) }
    | a=NAME { words([a]) }
    | a=NUMBER+ { words(a) }
    | a=NUMBER b=NUMBER c=NUMBER { [a, b, c] }
"""


@pytest.mark.parametrize(
    ("words", "found"),
    [
        # `pair` and `single` fail after `a`; what is kept of `a` counts once it is used.
        ("a :", {"line/2", "single/2"}),
        ("a , b :", {"line/1", "pair/1", "single/2"}),
        # The first two alternatives match a part; what they found is used by the third.
        ("a , b c . d", {"line/3", "pair/1", "single/1", "single/2"}),
        # `pair` is looked for in vain, and what is looked at is parsed again.
        ("a 1", {"line/4", "single/2", "single/3", "single/3 1 one"}),
        # An action that refuses makes way for the next alternative.
        ("1 2 3 :", {"line/2", "single/4"}),
        ("1 2 :", {"line/2", "single/3", "single/3 1 several"}),
    ],
)
def test_what_is_abandoned_does_not_count(words: str, found: set[str]) -> None:
    assert trace(ABANDONED, words) == found


def test_rules_that_are_only_looked_at_are_not_wanted() -> None:
    grammar = read_grammar_text(
        "@start file\nfile: &look a=NAME ENDMARKER { [a] }\nlook:\n    | NAME ENDMARKER { 1 }\n    | NUMBER { 2 }\n"
    )
    assert choices(grammar) == (Choice(AlternativeId("file", 1)),)


def test_choices_are_explained() -> None:
    grammar = read_grammar_text(
        "@start file\nfile:\n    | 'x' a=('y' b=NAME | NUMBER)? { [a] }\n    | NAME { [1] }\n"
    )
    texts = [explain(grammar, choice) for choice in choices(grammar)]
    assert texts[0] == "file/1: 'x' ('y' NAME | NUMBER)?"
    assert texts[1] == "file/1: absent for ('y' NAME | NUMBER)? in 'x' ('y' NAME | NUMBER)?"
    assert texts[3] == "file/2: NAME"
