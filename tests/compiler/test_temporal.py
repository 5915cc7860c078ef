"""Conditions of `require`: where temporal operators can stand, what they take, what formulas mean."""

import ast
import random
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzz.traces import WORDS, Formula, Verdict, formula_of, holds, progressed, text_of, verdict
from scenic.compiler import tree
from scenic.compiler.parser import parse
from scenic.compiler.precedence import Ladder, forms_of
from tests.compiler.batches import parse_lines, same

ATOMS: Final = ("a", "b", "c")


def condition(text: str) -> ast.expr:
    """The condition of a `require` without mistakes."""
    result = parse(f"require {text}\n")
    assert result.diagnostics == (), text
    (statement,) = result.tree.body
    assert isinstance(statement, tree.Require)
    return statement.condition


def check(bare: str, reading: str) -> None:
    assert same(condition(bare), condition(reading)), bare


def check_refused(text: str, *parts: str) -> None:
    """One error, at a place that ``text`` marks with brackets if it has any, with some words in its message."""
    marked = text.find("«")
    result = parse(text.replace("«", "").replace("»", "") + "\n")
    (found,) = result.diagnostics
    message = f"{found.message} {found.help or ''}"
    assert all(part in message for part in parts), message
    if marked >= 0:
        assert found.span is not None
        assert (found.span.column, found.span.end_column) == (marked, text.find("»") - 1), found


@pytest.mark.parametrize(
    ("bare", "reading"),
    [
        # A group may be followed by every word that goes on with a condition.
        ("(always a) implies b", "((always a)) implies (b)"),
        ("(always a) until b", "((always a)) until (b)"),
        ("(always a) or b and c", "(always a) or (b and c)"),
        ("(always a) and b or c", "((always a) and b) or c"),
        ("((always a))", "always a"),
        ("(always a) implies (eventually (b until c))", "(always (a)) implies (eventually (b until c))"),
        ("not (always a)", "not always a"),
        ("not (always a) and b", "(not (always a)) and b"),
        ("always (a until b)", "always ((a until b))"),
        ("(a until b) until c", "((a) until (b)) until (c)"),
        ("a until (b until c)", "(a) until ((b) until (c))"),
        ("(a implies b) implies c", "((a implies b)) implies c"),
        ("a implies (b implies c)", "(a) implies ((b) implies (c))"),
        # A prefix takes everything up to `until`, wherever it stands.
        ("a or not next b and c", "a or (not (next (b and c)))"),
        ("a implies always b and c", "a implies (always (b and c))"),
        ("a and eventually b implies c", "a and (eventually (b implies c))"),
        ("always a implies eventually b until c", "(always (a implies (eventually b))) until c"),
        ("a until always b or c", "a until (always (b or c))"),
        ("always not eventually a", "always (not (eventually a))"),
        # Below the ladder are ordinary comparisons.
        ("always a < b < c", "always ((a < b < c))"),
        ("always x in r implies y can see z", "always ((x in r) implies (y can see z))"),
        ("always not visible r", "always (not visible r)"),
        ("not visible r until a", "(not visible r) until a"),
        ("next distance from a to b < 3", "next ((distance from a to b) < 3)"),
        # Ordinary parentheses.
        ("(a) > 5 and b", "((a) > 5) and (b)"),
        ("(a and b).c or d", "((a and b).c) or d"),
        ("(a or b)[0] until c", "((a or b)[0]) until c"),
        ("(a, b) == c and d", "((a, b) == c) and d"),
        ("(a := b) and c", "((a := b)) and c"),
        # In operator position a parenthesis after the word is no call.
        ("always(a)", "always a"),
        ("always (a) and b", "always ((a) and b)"),
        ("next(a) implies b", "next ((a) implies b)"),
        ("a until next(b)", "a until (next b)"),
        # Conditional expressions and functions without temporal operators.
        ("a if b and c else d or e", "a if (b and c) else (d or e)"),
        ("a if b else c if d else e", "a if b else (c if d else e)"),
        ("lambda: a and b", "(lambda: (a and b))"),
    ],
)
def test_readings(bare: str, reading: str) -> None:
    check(bare, reading)


@pytest.mark.parametrize("end", ["", " as n", " as 7", " as 'n m'", "; x = 1", " # so", "; require b"])
def test_a_group_may_end_the_condition(end: str) -> None:
    result = parse(f"require (always a){end}\n")
    assert result.diagnostics == ()
    assert same(getattr(result.tree.body[0], "condition", None), condition("always a"))


@pytest.mark.parametrize(
    "text",
    [
        "next(it)", "always(a)", "always + 1", "eventually.f", "next = always", "implies = 3", "x = next(it) + implies",
        "def next(always): return eventually", "f(next=1, implies=2)", "for next in eventually: pass",
        "terminate when next(it)", "record always as implies", "require x.next > y.always", "require next.a",
        "require always == 3 and b", "require f(next=1)", "require a.implies(b)", "import next",
        "require implies implies implies", "require always", "require eventually as next",
    ],
)  # fmt: skip
def test_the_words_are_names_elsewhere(text: str) -> None:
    result = parse(f"{text}\n")
    assert result.diagnostics == ()
    temporal = [node for node in ast.walk(result.tree) if isinstance(node, tree.Temporal)]
    assert len(temporal) == (text == "require implies implies implies")


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("require a until b «until» c", ["until"]),
        ("require a implies b «implies» c", ["implies"]),
        ("require always a until b «until» c", ["until"]),
        ("require a implies b until c «until» d", ["until"]),
        ("require «always a» if b else c", ["always", "conditional"]),
        ("require a if «next b» else c", ["next", "conditional"]),
        ("require a if b else «eventually c»", ["eventually", "conditional"]),
        ("require a if b else «c until d»", ["until", "conditional"]),
        ("require (a if b else «c implies d») and e", ["implies", "conditional"]),
        ("require f(«always(a)»)", ["always"]),
        ("require [«next(a)» for a in b]", ["next"]),
        ("require b + «always(a)»", ["always"]),
        ("require lambda: «always(a)»", ["always"]),
        ("require a > «eventually(b)»", ["eventually"]),
        ("require (always a) > 3", []),
        ("require (always a).b", []),
        ("require (a until b)[0]", []),
        ("require lambda: always a", []),
        ("require f(always a)", []),
        ("require [always a]", []),
        ("require a + always b", []),
        ("require always", None),
        ("require a until", []),
        ("require until a", []),
        ("require a implies", []),
        ("x = always a", []),
        ("x = a until b", []),
        ("x = a implies b", []),
        ("terminate when always a", []),
        ("record eventually a", []),
        ("if next a: pass", []),
    ],
)
def test_what_is_refused(text: str, parts: list[str] | None) -> None:
    if parts is None:
        assert parse(text).diagnostics == ()  # a name
    else:
        check_refused(text, *parts)


# By meaning.

ORDINARY_WORDS: Final = ("and", "or")


def formulas(atoms: tuple[str, ...] = ATOMS) -> st.SearchStrategy[Formula]:
    """Random formulas."""

    def larger(smaller: st.SearchStrategy[Formula]) -> st.SearchStrategy[Formula]:
        fixed = [st.tuples(st.just(word), *[smaller] * count) for word, count in WORDS.items()]
        return st.one_of(*fixed, *(st.tuples(st.just(word), smaller, smaller) for word in ORDINARY_WORDS))

    return st.recursive(st.sampled_from(atoms), larger, max_leaves=8)


TRACES: Final = st.lists(st.sets(st.sampled_from(ATOMS)).map(frozenset), min_size=1, max_size=6)


def random_words(chance: random.Random, depth: int) -> str:
    """A random condition, with some parentheses; not all of them are right."""
    if depth == 0 or chance.random() < 0.15:
        return chance.choice(ATOMS)
    word = chance.choice([*WORDS, *ORDINARY_WORDS])
    count = WORDS.get(word, 2)
    operands = [random_words(chance, depth - 1) for _ in range(count)]
    text = f" {word} ".join(operands) if count == 2 else f"{word} {operands[0]}"
    return f"({text})" if chance.random() < 0.25 else text


def test_bare_and_parenthesised_conditions_mean_the_same() -> None:
    """The verdicts of what is read from a bare text, and from the same with parentheses around every operation."""
    chance = random.Random(12)
    texts = [random_words(chance, chance.randint(1, 5)) for _ in range(3000)]
    statements = parse_lines([f"require {text}" for text in texts])
    found = [
        (text, formula_of(statement.condition))
        for text, statement in zip(texts, statements, strict=True)
        if isinstance(statement, tree.Require)
    ]
    assert 1000 < len(found) < len(texts)
    full = parse_lines([f"require {text_of(formula)}" for _, formula in found])
    for (text, formula), statement in zip(found, full, strict=True):
        assert isinstance(statement, tree.Require), text
        again = formula_of(statement.condition)
        for _ in range(3):
            trace = [
                frozenset(atom for atom in ATOMS if chance.random() < 0.5)
                for _ in range(chance.randint(1, 5))
            ]
            assert verdict(formula, trace) is verdict(again, trace), text


@given(formulas(), TRACES)
def test_what_is_written_is_what_is_read(formula: Formula, trace: list[frozenset[str]]) -> None:
    read = formula_of(condition(text_of(formula)))
    # Negation of certain and presumable verdicts, through another way to write it.
    negated = verdict(formula_of(condition(f"not ({text_of(formula)})")), trace)
    assert verdict(read, trace) is verdict(formula, trace)
    assert negated.value == 5 - verdict(formula, trace).value


@given(formulas(), formulas(), formulas(), TRACES)
def test_the_scope_of_a_prefix(a: Formula, b: Formula, c: Formula, trace: list[frozenset[str]]) -> None:
    one, two, three = map(text_of, (a, b, c))
    read = formula_of(condition(f"{one} and always {two} or {three}"))
    assert verdict(read, trace) is verdict(("and", a, ("always", ("or", b, c))), trace)
    read = formula_of(condition(f"always {one} implies {two} until {three}"))
    assert verdict(read, trace) is verdict(("until", ("always", ("implies", a, b)), c), trace)


# The evaluator itself.


@given(formulas(), TRACES, TRACES)
def test_certain_verdicts_stay(
    formula: Formula, trace: list[frozenset[str]], more: list[frozenset[str]]
) -> None:
    first, later = verdict(formula, trace), verdict(formula, [*trace, *more])
    if first in {Verdict.TRUE, Verdict.FALSE}:
        assert later is first
        assert holds(formula, [*trace, *more], 0) == bool(first)


@given(formulas(), TRACES)
def test_a_certain_verdict_is_the_value_on_the_finite_trace(
    formula: Formula, trace: list[frozenset[str]]
) -> None:
    found = verdict(formula, trace)
    if found in {Verdict.TRUE, Verdict.FALSE}:
        assert bool(found) == holds(formula, trace, 0)
    # Progression through all states but the last, and the value of what is left there, is the value of the whole.
    rest = formula
    for state in trace[:-1]:
        rest = progressed(rest, state)
    assert holds(rest, trace[-1:], 0) == holds(formula, trace, 0)


@pytest.mark.parametrize(
    ("text", "trace", "expected"),
    [
        ("a", ["a", ""], Verdict.TRUE),
        ("a", ["", "a"], Verdict.FALSE),
        ("next a", ["a"], Verdict.PRESUMABLY_FALSE),
        ("not next a", ["a"], Verdict.PRESUMABLY_TRUE),
        ("next a", ["", "a"], Verdict.TRUE),
        ("next a", ["a", ""], Verdict.FALSE),
        ("next next a", ["", "a"], Verdict.PRESUMABLY_FALSE),
        ("always next a", ["a", "a", "a"], Verdict.PRESUMABLY_FALSE),
        ("always (a implies next b)", ["a", "b"], Verdict.PRESUMABLY_TRUE),
        ("always (a implies next b)", ["", "a"], Verdict.PRESUMABLY_FALSE),
        ("always (a implies next b)", ["a", ""], Verdict.FALSE),
        ("always a", ["a", "a"], Verdict.PRESUMABLY_TRUE),
        ("always a", ["a", "", "a"], Verdict.FALSE),
        ("eventually a", ["", ""], Verdict.PRESUMABLY_FALSE),
        ("eventually a", ["", "a", ""], Verdict.TRUE),
        ("always eventually a", ["a", ""], Verdict.PRESUMABLY_FALSE),
        ("always eventually a", ["", "a"], Verdict.PRESUMABLY_TRUE),
        ("eventually always a", ["a", ""], Verdict.PRESUMABLY_FALSE),
        ("eventually always a", ["", "a"], Verdict.PRESUMABLY_TRUE),
        ("a until b", ["a", "a"], Verdict.PRESUMABLY_FALSE),
        ("a until b", ["a", "b"], Verdict.TRUE),
        ("a until b", ["a", "", "b"], Verdict.FALSE),
        ("a until b", ["b"], Verdict.TRUE),
        ("not (a until b)", ["a"], Verdict.PRESUMABLY_TRUE),
        ("a implies eventually b", ["", ""], Verdict.TRUE),
        ("a implies eventually b", ["a", ""], Verdict.PRESUMABLY_FALSE),
    ],
)
def test_the_verdicts_of_the_specification(text: str, trace: list[str], expected: Verdict) -> None:
    assert verdict(formula_of(condition(text)), [frozenset(state) for state in trace]) is expected


def test_progression_and_the_empty_trace() -> None:
    assert progressed(("until", "a", "b"), {"a"}) == ("until", "a", "b")
    assert progressed(("always", ("next", "a")), set()) == ("and", "a", ("always", ("next", "a")))
    with pytest.raises(ValueError, match="empty"):
        verdict("a", [])


def test_the_ladder_has_all_temporal_operators() -> None:
    levels = {
        word: forms_of("Temporal", word, Ladder.TEMPORAL)[0].level
        for word in ("until", "always", "eventually", "next", "implies")
    }
    assert levels["until"] < levels["always"] == levels["eventually"] == levels["next"] < levels["implies"]
