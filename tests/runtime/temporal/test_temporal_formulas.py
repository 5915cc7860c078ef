"""Monitors of temporal formulas, against a literal evaluator and against the package `rv-ltl`; and robustness."""

import itertools
import math
import random
from collections.abc import Sequence
from typing import Any

import pytest
import rv_ltl

from fuzz.traces import Formula as Tree
from fuzz.traces import verdict
from scenic.runtime.temporal.formulas import Atom, Compound, Formula, is_temporal
from scenic.runtime.temporal.monitors import FormulaMonitor, Verdict
from scenic.runtime.temporal.robustness import Robustness, joint_margin
from tests.amounts import amount

ATOMS = "abc"
WORDS = ("not", "and", "or", "implies", "next", "always", "eventually", "until")
UNARY = frozenset({"not", "next", "always", "eventually"})
PACKAGE: dict[str, Any] = {
    "not": rv_ltl.Not,
    "and": rv_ltl.And,
    "or": rv_ltl.Or,
    "implies": rv_ltl.Implies,
    "next": rv_ltl.Next,
    "always": rv_ltl.Always,
    "eventually": rv_ltl.Eventually,
    "until": rv_ltl.Until,
}


def random_tree(rng: random.Random, depth: int) -> Tree:
    if depth == 0 or rng.random() < 0.2:
        return rng.choice(ATOMS)
    word = rng.choice(WORDS)
    return (word, *(random_tree(rng, depth - 1) for _ in range(1 if word in UNARY else 2)))


def formula(tree: Tree) -> Formula:
    if isinstance(tree, str):
        return Atom(ATOMS.index(tree))
    assert isinstance(tree, tuple)
    return Compound(tree[0], tuple(map(formula, tree[1:])))


def of_package(tree: Tree, trace: list[frozenset[str]]) -> bool:
    atoms = {atom: rv_ltl.Atomic(identifier=atom) for atom in ATOMS}

    def proposition(part: Tree) -> Any:
        return PACKAGE[part[0]](*map(proposition, part[1:])) if isinstance(part, tuple) else atoms[str(part)]

    monitor = proposition(tree).create_monitor()
    for state in trace:
        monitor.update({atom: atom in state for atom in ATOMS})
    return bool(monitor.evaluate().value > 2)


def robustness(form: Formula, trace: Sequence[Sequence[float]], *, is_joint: bool = False) -> float:
    followed = Robustness(form, is_joint=is_joint)
    for state in trace:
        followed.add(lambda index, state=state: state[index])  # type: ignore[misc]
    assert followed.value is not None
    return followed.value


def by_definition(tree: Tree, trace: Sequence[Sequence[float]]) -> list[float]:
    """The robustness at every state, from the values of the operands at all states."""
    if isinstance(tree, str):
        return [state[ATOMS.index(tree)] for state in trace]
    first, *others = (by_definition(part, trace) for part in tree[1:])
    places = range(len(trace))
    match tree[0]:
        case "not":
            return [-value for value in first]
        case "and":
            return [min(first[i], others[0][i]) for i in places]
        case "or":
            return [max(first[i], others[0][i]) for i in places]
        case "implies":
            return [max(-first[i], others[0][i]) for i in places]
        case "next":
            return [*first[1:], -math.inf]
        case "always":
            return [min(first[i:]) for i in places]
        case "eventually":
            return [max(first[i:]) for i in places]
    (goal,) = others
    return [max(min([goal[j], *first[i:j]]) for j in places[i:]) for i in places]


def pairs(count: int, seed: int) -> Any:
    rng = random.Random(seed)
    for _ in range(count):
        tree = random_tree(rng, rng.randrange(1, 5))
        yield tree, [frozenset(a for a in ATOMS if rng.random() < 0.6) for _ in range(rng.randrange(1, 7))]


def follow(tree: Tree, trace: list[frozenset[str]]) -> list[Verdict]:
    monitor = FormulaMonitor(formula(tree))
    return [monitor.add(lambda index, state=state: ATOMS[index] in state) for state in trace]  # type: ignore[misc]


def test_verdicts_are_those_of_the_literal_evaluator() -> None:
    for tree, trace in pairs(amount(5_000, 20_000), 1):
        verdicts = follow(tree, trace)
        assert verdicts[-1].name == verdict(tree, trace).name, (tree, trace)
        values = [[1.0 if atom in state else -1.0 for atom in ATOMS] for state in trace]
        value = robustness(formula(tree), values)
        assert (value > 0) is bool(verdicts[-1]), (tree, trace)


@pytest.mark.slow
def test_truth_is_that_of_the_package() -> None:
    for tree, trace in pairs(amount(5_000, 20_000), 2):
        assert bool(follow(tree, trace)[-1]) is of_package(tree, trace), (tree, trace)


def test_truth_is_that_of_the_package_on_some() -> None:
    for tree, trace in pairs(1_000, 3):
        assert bool(follow(tree, trace)[-1]) is of_package(tree, trace), (tree, trace)


def test_certain_verdicts_stay() -> None:
    for tree, trace in pairs(2_000, 4):
        verdicts = follow(tree, trace)
        for before, after in itertools.pairwise(verdicts):
            assert not before.is_certain or before is after


def test_what_is_left_does_not_grow() -> None:
    a, b, c = Atom(0), Atom(1), Atom(2)
    inner = Compound("until", (Compound("eventually", (a,)), Compound("always", (b,))))
    hard = Compound("always", (Compound("or", (inner, Compound("next", (Compound("next", (c,)),)))),))
    monitor = FormulaMonitor(hard)
    rng = random.Random(5)
    sizes = []
    for _ in range(400):
        state = [rng.random() < 0.7 for _ in range(3)]
        monitor.add(lambda index, state=state: state[index])  # type: ignore[misc]
        sizes.append(sum(len(clause) for clause in monitor._left))
    assert max(sizes[200:]) <= max(sizes[:200])


@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_clauses_that_others_imply_are_dropped(count: int) -> None:
    """Of "always, one of these eventually" as many clauses are left as alternatives, not all their combinations."""
    alternatives = tuple(Compound("eventually", (Atom(number),)) for number in range(count))
    goal: Formula = alternatives[0] if count == 1 else Compound("or", alternatives)
    monitor = FormulaMonitor(Compound("always", (goal,)))
    for step in range(5):
        read: list[int] = []
        monitor.add(lambda index, read=read: bool(read.append(index)))  # type: ignore[misc]
        assert [len(clause) for clause in monitor._left] == [2] * count
        # What several clauses share is looked at once: the formula as a whole, and each alternative by itself.
        assert all(read.count(number) == (1 if step == 0 else 2) for number in range(count))
    # What comes true drops all clauses but one: nothing else has to be met.
    monitor.add(lambda index: index == 0)
    assert [len(clause) for clause in monitor._left] == [1]


def test_what_is_written_twice_is_one_obligation() -> None:
    def written() -> Formula:
        return Compound("always", (Compound("eventually", (Atom(0),)),))

    def eventually() -> Formula:
        return Compound("until", (Compound("next", (Atom(1),)), Atom(2)))

    monitor = FormulaMonitor(Compound("and", (written(), written(), eventually(), eventually())))
    for _ in range(3):
        monitor.add(lambda index: index == 1)
        (clause,) = monitor._left
        # "Always", "eventually", "until", and the next state's atom.
        assert len(clause) == 4


def test_what_is_left_of_both_sides_is_joined_and_absorbed() -> None:
    """``(a or b) and (a or c)`` of later states is ``a or (b and c)``: two clauses, whatever the order."""
    for order in itertools.permutations(range(3)):
        a, b, c = (Compound("next", (Atom(number),)) for number in order)
        for parts in itertools.permutations([Compound("or", (a, b)), Compound("or", (a, c))]):
            monitor = FormulaMonitor(Compound("and", tuple(parts)))
            monitor.add(lambda _: False)
            assert sorted(len(clause) for clause in monitor._left) == [1, 2]


def test_atoms_outside_temporal_operators_are_read_once() -> None:
    asked: list[int] = []

    def evaluate(index: int) -> bool:
        asked.append(index)
        return True

    monitor = FormulaMonitor(Compound("and", (Atom(0), Compound("always", (Atom(1),)))))
    for _ in range(3):
        monitor.add(evaluate)
    assert asked == [0, 1, 1, 1]


def test_an_exception_counts_only_where_nothing_else_decides() -> None:
    def evaluate(index: int) -> bool:
        if index == 0:
            raise ZeroDivisionError
        return index == 1

    for tree, decided in (
        (Compound("or", (Atom(0), Atom(1))), Verdict.TRUE),
        (Compound("and", (Atom(0), Atom(2))), Verdict.FALSE),
        (Compound("implies", (Atom(2), Atom(0))), Verdict.TRUE),
        (Compound("until", (Atom(0), Atom(1))), Verdict.TRUE),
    ):
        assert FormulaMonitor(tree).add(evaluate) is decided
    with pytest.raises(ZeroDivisionError):
        FormulaMonitor(Compound("or", (Atom(0), Atom(2)))).add(evaluate)


def test_exceptions_count_in_later_states_as_in_the_first() -> None:
    """Steps that a monitor has kept change no verdict where an atom fails."""
    generator = random.Random(4)

    def evaluate(state: tuple[bool | None, ...], index: int) -> bool:
        if state[index] is None:
            raise ZeroDivisionError(index)
        return bool(state[index])

    def outcome(monitor: FormulaMonitor, state: tuple[bool | None, ...]) -> object:
        try:
            return monitor.add(lambda index: evaluate(state, index))
        except ZeroDivisionError as error:
            return error.args

    for tree, _ in pairs(400, 9):
        kept = FormulaMonitor(formula(tree))
        for _ in range(12):
            state = tuple(generator.choice((True, True, False, None)) for _ in ATOMS)
            fresh = FormulaMonitor(formula(tree))
            fresh._start, fresh._left, fresh.verdict = kept._start, kept._left, kept.verdict
            assert outcome(kept, state) == outcome(fresh, state)
            assert kept.left == fresh.left


def test_of_several_exceptions_the_first_is_raised() -> None:
    def evaluate(index: int) -> bool:
        raise (ZeroDivisionError, KeyError)[index]

    with pytest.raises(ZeroDivisionError):
        FormulaMonitor(Compound("or", (Atom(0), Atom(1)))).add(evaluate)


def test_operations_are_checked() -> None:
    with pytest.raises(ValueError, match="unknown operator"):
        Compound("sometimes", (Atom(0),))
    with pytest.raises(ValueError, match="takes 2 operands"):
        Compound("until", (Atom(0),))
    assert not is_temporal(Compound("implies", (Atom(0), Atom(1))))
    assert is_temporal(Compound("not", (Compound("next", (Atom(0),)),)))


def test_robustness_is_that_of_the_definition() -> None:
    rng = random.Random(6)
    for tree, states in pairs(4_000, 6):
        # Few different numbers, so that many are equal, and some that are not finite.
        trace = [
            [rng.choice([-math.inf, -2.0, -1.0, 1.0, 2.0, 3.0, math.inf]) for _ in ATOMS] for _ in states
        ]
        assert robustness(formula(tree), trace) == by_definition(tree, trace)[0], (tree, trace)


def test_joint_robustness_has_the_sign_of_robustness() -> None:
    for tree, _ in pairs(amount(200, 2000), 11):
        rng = random.Random(str(tree))
        values = [[rng.uniform(-1, 1) for _ in ATOMS] for _ in range(3)]
        plain = robustness(formula(tree), values)
        joint = robustness(formula(tree), values, is_joint=True)
        assert joint >= plain > 0 or joint == plain


def test_joint_margins_fall_with_each_part() -> None:
    assert joint_margin([3.0]) == joint_margin([-1.0, 3.0]) == 3.0
    assert joint_margin([-1.0, 0.0]) == 0.0
    assert joint_margin([1.0, math.inf]) == math.inf
    assert joint_margin([5e-324, -1.0]) > 0
    falling = [joint_margin([4.0, part]) for part in (3.0, 2.0, 1.0, 0.5, 0.0)]
    assert falling == sorted(falling, reverse=True)
    assert len(set(falling)) == 5
    assert joint_margin([2.0, 4.0]) == pytest.approx(2 * joint_margin([1.0, 2.0]))
    either = Compound("always", (Compound("or", (Atom(0), Atom(1))),))
    assert robustness(either, [[3, 2], [2, 2]], is_joint=True) == pytest.approx(joint_margin([2, 2]))


def test_robustness_of_obligations_that_both_sides_share_is_that_of_the_definition() -> None:
    rng = random.Random(9)
    shared: list[Tree] = [
        ("always", "a"),
        ("eventually", "b"),
        ("until", "a", "b"),
        ("next", "b"),
        "a",
        "b",
        "c",
    ]

    def joined(depth: int) -> Tree:
        if depth == 0:
            return rng.choice(shared)
        word = rng.choice(["and", "or", "implies", "not"])
        return (word, *(joined(depth - 1) for _ in range(1 if word == "not" else 2)))

    for _ in range(1_500):
        tree = joined(rng.randrange(2, 4))
        trace = [[float(rng.randrange(-3, 4)) for _ in ATOMS] for _ in range(rng.randrange(1, 5))]
        assert robustness(formula(tree), trace) == by_definition(tree, trace)[0], (tree, trace)


def test_robustness_of_clauses_that_come_about_in_several_ways_is_the_greatest() -> None:
    """Choices of which each parts gives numbers now and obligations for later: several pairs of them leave the same obligations."""
    rng = random.Random(12)
    later: list[Tree] = [("next", "a"), ("next", "b"), ("next", "c"), ("always", "c")]

    def choice() -> Tree:
        return ("or", *(("and", rng.choice(ATOMS), rng.choice(later)) for _ in range(2)))

    for _ in range(600):
        tree: Tree = (rng.choice(["and", "or"]), choice(), choice())
        if rng.random() < 0.3:
            tree = ("not", tree)
        trace = [[float(rng.randrange(-3, 4)) for _ in ATOMS] for _ in range(rng.randrange(2, 4))]
        assert robustness(formula(tree), trace) == by_definition(tree, trace)[0], (tree, trace)


def test_what_robustness_keeps_does_not_grow() -> None:
    a, b, c = Atom(0), Atom(1), Atom(2)
    inner = Compound("until", (Compound("eventually", (a,)), Compound("always", (b,))))
    followed = Robustness(Compound("always", (Compound("or", (inner, Compound("next", (c,)))),)))
    rng = random.Random(5)
    sizes = []
    for _ in range(400):
        state = [rng.gauss() for _ in range(3)]
        followed.add(lambda index, state=state: state[index])  # type: ignore[misc]
        sizes.append(len(followed._left))
    assert max(sizes[200:]) <= max(sizes[:200])


def test_an_atom_without_a_value_holds_neither_as_it_is_nor_negated() -> None:
    a, b = Atom(0), Atom(1)
    for operator, value in (("or", 2.0), ("and", -math.inf)):
        for part in (a, Compound("not", (a,))):
            assert robustness(Compound(operator, (part, b)), [[math.nan, 2.0]]) == value


def test_robustness_of_each_operator() -> None:
    trace = [[1.0, -2.0], [3.0, -1.0], [-0.5, 4.0]]
    a, b = Atom(0), Atom(1)
    expected = {
        "always": -0.5,
        "eventually": 3.0,
        "next": 3.0,
        "not": -1.0,
    }
    for operator, value in expected.items():
        assert robustness(Compound(operator, (a,)), trace) == value
    assert robustness(Compound("until", (a, b)), trace) == 1.0
    assert robustness(Compound("implies", (a, b)), trace) == -1.0
    assert robustness(Compound("next", (a,)), trace[:1]) == -math.inf


def test_before_the_first_state_nothing_is_known() -> None:
    for form in (formula("a"), formula(("always", "a")), formula(("not", ("eventually", "a")))):
        assert Robustness(form).value is None
        assert FormulaMonitor(form).verdict is None
