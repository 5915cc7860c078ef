"""The evaluator of temporal formulas: against the package `rv-ltl`, and against the definition of certain verdicts.

The three agree but for the following, and these tests allow nothing else.

Truth. All three agree on which verdicts are falsy: the value on the finite trace is a definition without choices.

The package is *late*: its verdict is presumable where ours is certain. It looks for the first state where the goal of an
`until` is at least presumably true. (`eventually f` is an `until` with this goal, `always f` the negation of one.) If there
is none, it is presumably false, even where what has to hold until then has failed and the goal certainly has not been
reached: section 12.6 of the specification expects that. If the goal is presumably true there, a later state where
it certainly is true goes unnoticed.

The package is *hasty*: its verdict is certain where ours is presumable. If `f` certainly fails before the first state
where the goal is presumably true, it says FALSE, also where the goal was only presumably false before: in the goal
`(always a) or (eventually b)` of `a until ...`, after `{c}, {a}, {a}`, the `b` of a later state makes up for the first one.
By the definition, FALSE is wrong, since not all continuations violate the formula.

We are *blind* to tautologies: what is left to hold may be valid, or impossible, without being a constant, as for `always
(a implies a)`. By the definition that is certain; we say that it is presumable, and the package as well. What differs in
effect are formulas like `next (a implies a)`, which the last state leaves presumably false.
"""

import random
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, Final

import pytest
import rv_ltl

from fuzz import traces
from fuzz.traces import WORDS, Formula, State, Verdict, atoms_of, holds, progressed, text_of, verdict
from tests.fuzz.continuations import can_be_met

ATOMS: Final = ("a", "b", "c")
CERTAIN: Final = frozenset({Verdict.TRUE, Verdict.FALSE})
PACKAGE: Final[dict[str, Any]] = {
    "not": rv_ltl.Not,
    "and": rv_ltl.And,
    "or": rv_ltl.Or,
    "implies": rv_ltl.Implies,
    "next": rv_ltl.Next,
    "always": rv_ltl.Always,
    "eventually": rv_ltl.Eventually,
    "until": rv_ltl.Until,
}


def of_package(formula: Formula, trace: Sequence[State]) -> Verdict:
    """The verdict of the package."""
    atoms = {atom: rv_ltl.Atomic(identifier=atom) for atom in ATOMS}

    def proposition(part: Formula) -> Any:
        if isinstance(part, tuple):
            return PACKAGE[part[0]](*map(proposition, part[1:]))
        return atoms[str(part)]

    monitor = proposition(formula).create_monitor()
    for state in trace:
        monitor.update({atom: atom in state for atom in ATOMS})
    return Verdict[monitor.evaluate().name]


def by_definition(formula: Formula, trace: Sequence[State]) -> Verdict | None:
    """The certain verdict if the continuations agree on one."""
    if not can_be_met(("not", formula), trace):
        return Verdict.TRUE
    return None if can_be_met(formula, trace) else Verdict.FALSE


def is_late(formula: Formula, trace: Sequence[State]) -> bool:
    """Whether the package misses that an operator at the first state is certain."""
    match formula:
        case ("until", _, goal) | ("eventually", goal):
            wanted = True
        case ("always", goal):
            wanted = False
        case _:
            return False
    if verdict(formula, trace) not in CERTAIN:
        return False
    reached = [place for place in range(len(trace)) if holds(goal, trace, place) is wanted]
    return not reached or verdict(goal, trace[reached[0] :]) not in CERTAIN


def is_hasty(formula: Formula, trace: Sequence[State]) -> bool:
    """Whether the package takes the goal of an `until` at the first state for missed while it still can be reached."""
    match formula:
        case ("until", before, goal) if verdict(formula, trace) is Verdict.PRESUMABLY_FALSE:
            reached = [place for place in range(len(trace)) if holds(goal, trace, place)]
            return bool(reached) and any(
                verdict(before, trace[place:]) is Verdict.FALSE for place in range(reached[0])
            )
    return False


def everywhere(formula: Formula, trace: Sequence[State]) -> Iterator[tuple[Formula, Sequence[State]]]:
    """All formulas in a formula, each at all states."""
    if isinstance(formula, tuple):
        for place in range(len(trace)):
            yield formula, trace[place:]
        for part in formula[1:]:
            yield from everywhere(part, trace)


def compare(formula: Formula, trace: Sequence[State]) -> str:
    """How the package differs from us; fails if it may not."""
    ours, theirs = traces.verdict(formula, trace), of_package(formula, trace)
    where = (
        f"{text_of(formula)} on {[sorted(state) for state in trace]}: {ours.name}, the package {theirs.name}"
    )
    assert bool(ours) == bool(theirs) == holds(formula, trace, 0), where
    if ours is theirs:
        return "equal"
    kind, reason = ("late", is_late) if ours in CERTAIN else ("hasty", is_hasty)
    assert any(reason(*each) for each in everywhere(formula, trace)), f"{where}, and is not {kind}"
    return kind


def random_formula(chance: random.Random, depth: int) -> Formula:
    if depth == 0 or chance.random() < 0.2:
        return chance.choice(ATOMS)
    word = chance.choice([*WORDS, "until", "and", "or"])
    return (word, *(random_formula(chance, depth - 1) for _ in range(WORDS.get(word, 2))))


def random_cases(seed: int, number: int) -> Iterator[tuple[Formula, list[State]]]:
    chance = random.Random(seed)
    for _ in range(number):
        trace = [
            frozenset(atom for atom in ATOMS if chance.random() < 0.5) for _ in range(chance.randint(1, 5))
        ]
        yield random_formula(chance, chance.randint(1, 4)), trace


def compare_all(seed: int, number: int) -> Counter[str]:
    return Counter(compare(*case) for case in random_cases(seed, number))


def states(text: str) -> list[State]:
    """A trace from a text such as ``c a ab -``."""
    return [frozenset(word) - {"-"} for word in text.split()]


def test_the_package_agrees_but_where_it_is_late_or_hasty() -> None:
    found = compare_all(1, 12_000)
    assert found["late"] > 200
    assert found["equal"] > 10_000


def test_haste_is_found_and_wrong() -> None:
    """With goals that can be open, where the package is hasty, the definition leaves the verdict open."""
    chance = random.Random(5)
    hasty = 0
    for _, trace in random_cases(6, 2500):
        goal = ("or", ("always", random_formula(chance, 1)), ("eventually", random_formula(chance, 1)))
        formula: Formula = ("until", random_formula(chance, 1), goal)
        if compare(formula, trace) == "hasty":
            hasty += 1
            assert by_definition(formula, trace) is None
    assert hasty > 10


def test_the_known_case_of_haste() -> None:
    formula: Formula = ("until", "a", ("or", ("always", "a"), ("eventually", "b")))
    trace = states("c a a")
    assert of_package(formula, trace) is Verdict.FALSE
    assert verdict(formula, trace) is Verdict.PRESUMABLY_FALSE
    # Both can still come.
    assert verdict(formula, [*trace, *states("b")]) is Verdict.TRUE
    assert verdict(("not", formula), [*trace, *states("-")]) is Verdict.PRESUMABLY_TRUE
    assert by_definition(formula, trace) is None


@pytest.mark.parametrize(
    ("formula", "trace", "ours", "theirs"),
    [
        # Any number of states later.
        (("until", "a", "b"), "- - - -", Verdict.FALSE, Verdict.PRESUMABLY_FALSE),
        (("until", "a", "b"), "- - - b", Verdict.FALSE, Verdict.FALSE),
        # The goal is presumably true in the first state, certainly in the second.
        (("eventually", ("or", ("always", "a"), "b")), "a ab", Verdict.TRUE, Verdict.PRESUMABLY_TRUE),
        (("always", ("and", ("eventually", "a"), "b")), "b -", Verdict.FALSE, Verdict.PRESUMABLY_FALSE),
    ],
)
def test_known_cases_of_lateness(formula: Formula, trace: str, ours: Verdict, theirs: Verdict) -> None:
    assert verdict(formula, states(trace)) is ours
    assert of_package(formula, states(trace)) is theirs


def test_certain_verdicts_are_those_of_the_definition_but_for_tautologies() -> None:
    kinds: Counter[str] = Counter()
    for formula, trace in random_cases(2, 1500):
        if sum(map(text_of(formula).count, ("always", "eventually", "next", "until"))) > 5:
            continue
        ours, meant = verdict(formula, trace), by_definition(formula, trace)
        where = f"{text_of(formula)} on {[sorted(state) for state in trace]}: {ours.name}, not {meant}"
        rest = formula
        for state in trace:
            rest = progressed(rest, state)
        if ours in CERTAIN:
            assert meant is ours, where
        elif meant is not None:
            # What is left has one value whatever comes.
            assert by_definition(rest, []) is meant, where
            kinds["blind"] += 1
        else:
            assert can_be_met(rest, []), where
            assert can_be_met(("not", rest), []), where
            kinds["open"] += 1
    assert kinds["blind"] > 3
    assert kinds["open"] > 100


@pytest.mark.parametrize(
    ("formula", "trace", "meant"),
    [
        ("a", "a", Verdict.TRUE),
        ("a", "-", Verdict.FALSE),
        (("next", "a"), "a", None),
        (("always", "a"), "a a", None),
        (("eventually", "a"), "- a", Verdict.TRUE),
        (("until", "a", "b"), "a -", Verdict.FALSE),
        (("always", ("eventually", "a")), "- a", None),
        # No finite part tells, but no infinite trace is both.
        (
            ("and", ("always", ("eventually", "a")), ("eventually", ("always", ("not", "a")))),
            "a",
            Verdict.FALSE,
        ),
        (("implies", ("eventually", ("always", "a")), ("always", ("eventually", "a"))), "-", Verdict.TRUE),
        (("and", ("always", ("eventually", "a")), ("always", ("eventually", ("not", "a")))), "a", None),
        (("and", ("until", "a", "b"), ("always", ("not", "b"))), "a", Verdict.FALSE),
        (("or", ("until", "a", "b"), ("always", "a")), "a", None),
        (("and", ("always", "a"), ("next", ("next", ("not", "a")))), "a", Verdict.FALSE),
    ],
)
def test_the_definition(formula: Formula, trace: str, meant: Verdict | None) -> None:
    assert by_definition(formula, states(trace)) is meant


# Faults that these comparisons notice.


def weak(formula: Formula, trace: Sequence[State]) -> Verdict:
    """An `until` whose goal need not come."""
    return verdict(_replaced(formula, lambda f, g: ("or", ("until", f, g), ("always", f))), trace)


def overlapping(formula: Formula, trace: Sequence[State]) -> Verdict:
    """An `until` whose first operand has to hold when the goal comes, too."""
    return verdict(_replaced(formula, lambda f, g: ("until", f, ("and", f, g))), trace)


def reflexive(formula: Formula, trace: Sequence[State]) -> Verdict:
    """An `until` whose goal must not come at once."""
    return verdict(_replaced(formula, lambda f, g: ("and", f, ("next", ("until", f, g)))), trace)


def impatient(formula: Formula, trace: Sequence[State]) -> Verdict:
    """All is certain at the end."""
    return Verdict.TRUE if verdict(formula, trace) else Verdict.FALSE


def never_certain(formula: Formula, trace: Sequence[State]) -> Verdict:
    """Nothing is certain before the end."""
    return Verdict.PRESUMABLY_TRUE if verdict(formula, trace) else Verdict.PRESUMABLY_FALSE


def _replaced(formula: Formula, until: Any) -> Formula:
    if not isinstance(formula, tuple):
        return formula
    operands = [_replaced(each, until) for each in formula[1:]]
    return until(*operands) if formula[0] == "until" else (formula[0], *operands)


@pytest.mark.parametrize("fault", [weak, overlapping, reflexive, impatient, never_certain])
def test_wrong_evaluators_are_noticed(fault: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(traces, "verdict", fault)
    with pytest.raises(AssertionError):
        compare_all(3, 1000)


def test_atoms() -> None:
    assert atoms_of(("until", ("not", "a"), ("next", ("or", "b", "a")))) == {"a", "b"}
    assert atoms_of(True) == frozenset()
