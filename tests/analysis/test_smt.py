"""The solver's verdicts, against brute force and on cases worked by hand."""

import math
from functools import cache

import numpy as np
import pytest
from graph.programs import Triple, constant, make, one_of, source, uniform
from scipy.optimize import linprog

from analysis.random_programs import accepted, conditions
from scenic.analysis import solver_terms as terms_module
from scenic.analysis.contraction import contract
from scenic.analysis.facts import Fact
from scenic.analysis.smt import judge
from scenic.analysis.solver_terms import Questions, SolverAnswer, SolverTerms
from scenic.graph import construction
from scenic.graph import node as graph
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operation import Operation, always
from tests.amounts import amount


def verdict(*nodes):
    """Labels of the members of each contradiction, and of the tautologies."""
    items = [Fact(node, str(place)) for place, node in enumerate(nodes)]
    found = judge(items)
    return (
        [[item.label for item in core.conditions] for core in found.contradictions],
        [item.label for item in found.tautologies],
    )


def test_two_requirements_contradict_each_other():
    x = uniform(0, 10)
    assert verdict(make("greater", x, 6), make("less", x, 3)) == ([["0", "1"]], [])


def test_the_core_is_minimal():
    x, y, z = (uniform(0, 10) for _ in range(3))
    nodes = [
        make("less", x, y),
        make("less", z, 9.0),
        make("less", y, z),
        make("greater", x, 1.0),
        make("less", z, x),
    ]
    assert verdict(*nodes) == ([["0", "2", "4"]], [])


def test_the_core_names_the_draws_it_rests_on():
    x, y = uniform(0, 10), uniform(1, 4)
    found = judge([Fact(make("greater", make("subtract", x, y), 9.5), "")])
    (core,) = found.contradictions
    assert [(item.node is x, item.phrase) for item in core.supports] == [
        (True, "is at most 10"),
        (False, "is at least 1"),
    ]


def test_an_impossible_requirement_is_reported_alone_and_the_rest_judged_without_it():
    x = uniform(0, 1)
    impossible, low, high = make("greater", x, 2.0), make("less", x, 0.3), make("greater", x, 0.6)
    assert verdict(low, impossible, high) == ([["1"], ["0", "2"]], [])


def test_independent_contradictions_are_all_reported():
    x, y = uniform(0, 1), uniform(0, 1)
    nodes = [make(name, item, 0.5) for item in (x, y) for name in ("less", "greater")]
    cores, _ = verdict(*nodes)
    assert sorted(cores) == [["0", "1"], ["2", "3"]]


def test_what_always_holds():
    x = uniform(0, 1)
    assert verdict(make("greater", x, -1.0), make("greater", x, 0.5)) == ([], ["0"])


def test_constants():
    assert verdict(make("less", 2, 1), make("less", 1, 2)) == ([["0"]], ["1"])


def test_choices_and_integers():
    x = one_of(1, 5, 9)
    assert verdict(make("greater", x, 9)) == ([["0"]], [])
    assert verdict(make("greater", x, 5), make("less", x, 9)) == ([["0", "1"]], [])
    k = make("discrete range", graph.axis(), 1, 3)
    assert verdict(make("greater", k, 1), make("less", k, 2)) == ([["0", "1"]], [])
    w = make("weighted integer", graph.axis(), payload=(0, (0.5, 0.5, 1.0)))
    assert verdict(make("equal", w, 1)) == ([["0"]], [])


def test_distances():
    x, y = uniform(-1, 1), uniform(-1, 1)
    here = make("vector", x, y, 0.0)
    origin = constant(Triple((0.0, 0.0, 0.0)))
    assert verdict(make("greater", make("distance", here, origin), 2.5)) == ([["0"]], [])
    assert verdict(make("greater", make("norm", here), 1.2)) == ([], [])
    far = make("vector", make("add", x, 5.0), y, 0.0)
    assert verdict(make("less", make("distance", here, far), 4.9)) == ([["0"]], [])


def test_random_ends_in_either_order():
    low = uniform(0, 1)
    x = make("range", graph.axis(), low, -1.0)
    assert verdict(make("greater", x, 1.5)) == ([["0"]], [])
    assert verdict(make("greater", x, 0.5)) == ([], [])


def test_an_undrawn_impossible_range_contradicts_nothing():
    empty = make("discrete range", graph.axis(), 3, uniform(0, 2))
    assert verdict(make("less", one_of(empty, 1), 2)) == ([], [])


def test_a_branch_not_taken_contradicts_nothing():
    x = uniform(-1, 1)
    root = make("power", x, 0.5)
    assert verdict(make("or", make("less", x, -0.5), make("greater", root, 2.0)))[0] == []


def test_the_same_formula_written_twice_is_one():
    """Even where the solver knows nothing of a function, it is one function."""
    x = uniform(0, 1)
    cores, _ = verdict(make("greater", make("sin", x), 0.5), make("less", make("sin", x), 0.25))
    assert cores == [["0", "1"]]


def test_different_unknown_values_are_not_taken_for_one():
    unknown = Operation("unknown", always(Kind.SCALAR), lambda call, a: a, "A test.", pure=False)
    x = uniform(0, 1)
    first, second = construction.make_node(unknown, [x]), construction.make_node(unknown, [x])
    assert verdict(make("less", first, 0.0), make("greater", second, 0.0)) == ([], [])


def test_python_objects_are_left_open():
    word = source(Kind.OTHER, np.array(["a"], dtype=object))
    assert verdict(make("equal", word, "a"), make("not equal", word, "a")) == ([], [])
    assert verdict(make("greater", one_of(1, "a", word), 5)) == ([], [])
    # Nor is anything said of conditions that are no truth values.
    assert verdict(word, uniform(0, 1), make("vector", 1.0, 2.0, uniform(0, 1))) == ([], [])


def test_not_a_number_is_left_open():
    nan = make("minimum", constant(math.nan), constant(math.inf))
    assert verdict(make("less", nan, 1.0)) == ([], [])
    for row in ((1.0, math.inf, 0.0), (math.nan, 0.0, 0.0), (0.0, 0.0, -math.inf)):
        part = make("component", constant(Triple(row)), payload=1)
        assert verdict(make("less", part, 1.0), make("greater", part, 2.0)) == ([["0", "1"]], [])
        assert verdict(make("less", make("norm", constant(Triple(row))), 1.0)) == ([], [])


def test_functions_of_one_name_are_different_functions():
    x = uniform(0, 1)
    first, second = (
        construction.make_node(Operation("unknown", always(Kind.SCALAR), lambda call, a: a, "A test."), [x])
        for _ in range(2)
    )
    assert verdict(make("less", first, 0.0), make("greater", second, 0.0)) == ([], [])
    assert verdict(make("less", first, 0.0), make("greater", first, 0.0)) == ([["0", "1"]], [])


@cache
def judged(seed):
    """Conditions, and the contradictions and tautologies among them; the solver's terms take 20 MB each time."""
    items = conditions(seed)
    found = judge(items)
    return items, found.contradictions, found.tautologies


SEEDS = range(amount(30, 50))


@pytest.mark.parametrize("seed", SEEDS)
def test_verdicts_agree_with_brute_force(seed):
    """What the solver calls impossible no sample meets; what it says always holds every sample meets."""
    items, contradictions, tautologies = judged(seed)
    network = Graph([item.node for item in items])
    points = np.random.default_rng(seed).random((1000, network.dimension))
    for core in contradictions:
        assert not accepted(network, points, list(core.conditions)).any()
        # Minimal: without any one condition the solver finds no contradiction among the others.
        for left_out in core.conditions:
            rest = [item for item in core.conditions if item is not left_out]
            assert not any(len(other.conditions) == len(rest) for other in judge(rest).contradictions)
    for item in tautologies:
        assert accepted(network, points, [item]).all()


def test_brute_force_sees_verdicts_of_both_kinds():
    """The seeds above are worth something only if the solver says something in a good part of them."""
    found = [judged(seed) for seed in SEEDS]
    assert sum(bool(contradictions) for _, contradictions, _ in found) >= 10
    assert sum(bool(tautologies) for _, _, tautologies in found) >= 5


def test_a_hard_question_is_given_up_by_count():
    terms = SolverTerms()
    x, y, z = (terms.fresh(Kind.INTEGER) for _ in range(3))
    one = terms.real(1)
    sums = x * x * x + y * y * y + z * z * z == terms.real(114)
    questions = Questions(terms, [(x > one) | (x < -one)], [sums])
    assert questions.ask([0]) is not SolverAnswer.IMPOSSIBLE


def test_the_last_of_a_contradiction_is_left_out_of_what_follows():
    """It is the one to blame: without it the others can hold together."""
    x = uniform(0, 1)
    nodes = [make("less", x, 0.5), make("less", x, 0.6), make("greater", x, 0.8)]
    (core,), _ = verdict(*nodes)
    assert core in (["0", "2"], ["1", "2"])


class Unhelpful:
    """A solver that names all that it was asked about where nothing meets it."""

    def __init__(self, solver):
        self._solver = solver
        self._asked = ()

    def check(self, *names):
        self._asked = names
        return self._solver.check(*names)

    def unsat_core(self):
        return self._asked

    def __getattr__(self, name):
        return getattr(self._solver, name)


@pytest.mark.parametrize("helpful", [True, False])
@pytest.mark.parametrize("seed", range(25))
def test_contradictions_are_minimal_for_a_linear_program_too(seed, helpful):
    """Half-planes: another solver finds no point in what is called impossible, and one as soon as any of it is taken away."""
    rng = np.random.default_rng(seed)
    normals = rng.integers(-3, 4, (9, 2))
    limits = rng.integers(-4, 3, 9)
    terms = SolverTerms()
    x, y = terms.fresh(Kind.SCALAR), terms.fresh(Kind.SCALAR)
    formulas = [
        terms.real(int(a)) * x + terms.real(int(b)) * y <= terms.real(int(c))
        for (a, b), c in zip(normals, limits, strict=True)
    ]

    def possible(members):
        rows = list(members)
        return not rows or linprog([0, 0], normals[rows], limits[rows], bounds=(None, None)).status == 0

    questions = Questions(terms, [], formulas)
    if not helpful:
        questions._solver = Unhelpful(questions._solver)
    core = questions.contradiction(range(9))
    if core is None:
        assert possible(range(9))
    else:
        assert not possible(core)
        for left_out in core:
            assert possible(member for member in core if member != left_out)


def test_what_is_not_decided_takes_nothing_away(monkeypatch):
    """Of three conditions that contradict each other by two, all are told if the solver has no answer about fewer."""
    terms = SolverTerms()
    x = terms.fresh(Kind.SCALAR)
    questions = Questions(terms, [], [x > terms.real(2), x < terms.real(5), x < terms.real(1)])
    real = Questions.ask
    monkeypatch.setattr(
        Questions,
        "ask",
        lambda self, members: real(self, members) if len(members) == 3 else SolverAnswer.UNKNOWN,
    )
    core = questions.contradiction([0, 1, 2])
    monkeypatch.undo()
    assert core is not None
    assert questions.ask(core) is SolverAnswer.IMPOSSIBLE


@pytest.mark.parametrize(
    "huge", [10**400, -(10**400), 2**70, -(2**70)], ids=lambda huge: f"{huge.bit_length()} bits"
)
def test_integers_beyond_all_floats(huge):
    x = uniform(0, 1)
    cores, always = verdict(make("greater", x, huge))
    assert (cores, always) == (([["0"]], []) if huge > 0 else ([], ["0"]))
    less = make("less", x, huge)
    assert not contract(Graph([less]), [Fact(less, "")]).impossible or huge < 0


BEYOND = 2**53
DRAWN = {
    "choice": lambda first: one_of(first, first + 1, first + 2),
    "select": lambda first: one_of(first, first + 1, first + 2, make("discrete range", graph.axis(), 5, 6)),
    "discrete range": lambda first: make("discrete range", graph.axis(), first, first + 2),
    "weighted integer": lambda first: make(
        "weighted integer", graph.axis(), payload=(first, (0.25, 0.5, 1.0))
    ),
}


@pytest.mark.parametrize("first", [BEYOND - 1, BEYOND, -BEYOND - 2, 2**60 + 5])
@pytest.mark.parametrize("name", DRAWN)
def test_draws_of_whole_numbers_that_no_float_is_may_be_each_of_them(name, first):
    """And no other: neither verdicts nor domains round them."""
    for place in range(3):
        drawn = DRAWN[name](first)
        for condition in (make("equal", drawn, first + place), make("less or equal", first + place, drawn)):
            assert verdict(condition)[0] == []
            network = Graph([condition])
            found = contract(network, [Fact(condition, "")])
            assert not found.impossible
            points = np.random.default_rng(place).random((200, network.dimension))
            met = accepted(network, points, [Fact(condition, "")])
            assert met.any()
            assert found.domain.contains(points)[met].all()
    for other in (first - 1, first + 3):
        assert verdict(make("equal", DRAWN[name](first), other)) == ([["0"]], [])


@pytest.mark.parametrize("name", ["floor divide", "modulo", "power", "round", "divide"])
def test_operands_beyond_all_floats(name):
    x, huge = uniform(0, 1), constant(10**400)
    small, large = make(name, x, huge), make(name, huge, make("add", x, 1.0))
    cores, _ = verdict(make("less or equal", small, 1.0), make("greater or equal", small, 0.0))
    assert cores == []
    assert verdict(make("equal", large, huge))[1] == []


def test_nothing_is_decided_once_the_count_is_spent(monkeypatch):
    monkeypatch.setattr(terms_module, "TOTAL", 0)
    assert verdict(make("less", 2, 1), make("less", 1, 2)) == ([], [])


BOUNDED = {
    "range": (uniform(-1, 2), -1, 2),
    "reversed range": (uniform(2, -1), -1, 2),
    "discrete range": (make("discrete range", graph.axis(), -1, 3), -1, 3),
    "weighted integer": (make("weighted integer", graph.axis(), payload=(4, (0.0, 0.5, 1.0, 1.0))), 5, 6),
    "truncated normal": (make("truncated normal", graph.axis(), 9.0, 1.0, payload=(-1.0, 2.0)), -1, 2),
    "half normal": (make("truncated normal", graph.axis(), 0.0, 1.0, payload=(0.5, math.inf)), 0.5, None),
}


@pytest.mark.parametrize("name", list(BOUNDED))
def test_what_no_draw_reaches_is_impossible_on_either_side(name):
    """By the end that it lies beyond, which is named; what lies between is possible."""
    node, low, high = BOUNDED[name]
    for end, words, beyond, within in (
        (low, "is at least", "less", "greater or equal"),
        (high, "is at most", "greater", "less or equal"),
    ):
        if end is not None:
            (core,) = judge([Fact(make(beyond, node, end), "")]).contradictions
            assert [item.phrase for item in core.supports] == [f"{words} {end:g}"]
            assert judge([Fact(make(within, node, end), "")]).tautologies
    assert verdict(make("less or equal", node, low)) == ([], [])


def truth():
    return make("less", uniform(0, 1), 0.5)


def two_or_three():
    return make("discrete range", graph.axis(), 2, 3)


MIXED = {
    "truth or number": (lambda: one_of(truth(), 5.0), {0, 1, 5}),
    "number or truth": (lambda: one_of(5.0, truth()), {0, 1, 5}),
    "truth or whole number": (lambda: one_of(truth(), two_or_three()), {0, 1, 2, 3}),
    "truth or true": (lambda: one_of(truth(), True), {0, 1}),
    "the less of truth and number": (lambda: make("minimum", truth(), 0.5), {0, 0.5}),
    "the less of number and truth": (lambda: make("minimum", 0.5, truth()), {0, 0.5}),
    "the more of truth and number": (lambda: make("maximum", truth(), two_or_three()), {2, 3}),
    "the more of two truths": (lambda: make("maximum", truth(), truth()), {0, 1}),
    "one branch is a truth": (lambda: make("if", truth(), True, 3.0), {1, 3}),
    "the other is": (lambda: make("if", truth(), two_or_three(), truth()), {0, 1, 2, 3}),
    "vector or number": (lambda: one_of(Triple((1.0, 2.0, 3.0)), uniform(0, 1)), None),
    "number or vector": (lambda: make("if", truth(), 4, Triple((1.0, 2.0, 3.0))), None),
}


@pytest.mark.parametrize("name", MIXED)
def test_choices_among_different_kinds_may_be_each_of_their_values(name):
    """A truth value counts as a number among numbers; of vectors among numbers nothing is said."""
    build, possible = MIXED[name]
    for value in (-1, 0, 1, 2, 3, 4, 5, 0.5):
        told = verdict(make("equal", build(), value))[0]
        assert told == ([] if possible is None or value in possible else [["0"]])


def test_vectors_are_equal_component_by_component():
    """And never equal to a number, nor out of reach where any component may differ."""
    x = uniform(0, 1)
    for place in range(3):
        parts = [1.0, 2.0, 3.0]
        parts[place] = make("add", x, parts[place])
        moving = make("vector", *parts)
        fixed = [1.0, 2.0, 3.0]
        fixed[place] += 0.5
        same = make("equal", moving, Triple(fixed))
        assert verdict(same) == ([], [])
        assert verdict(same, make("equal", x, 0.25))[0] == [["0", "1"]]
        assert verdict(same, make("equal", x, 0.5))[0] == []
        for other in range(3):
            apart = list(fixed)
            apart[other] += 1.0
            assert verdict(make("equal", moving, Triple(apart)))[0] == [["0"]]
            assert verdict(make("not equal", moving, Triple(apart)))[1] == ["0"]
        assert verdict(make("equal", moving, x))[0] == [["0"]]
        assert verdict(make("not equal", x, moving))[1] == ["0"]
        item = make("getitem", moving, place)
        assert verdict(make("greater", item, place + 2.0))[0] == [["0"]]
        assert verdict(make("less", make("getitem", moving, place - 3), place + 1.0))[0] == [["0"]]
        assert verdict(make("equal", make("len", moving), 3))[1] == ["0"]
