"""Interval, inverse and solver readings against the NumPy reading, for every entry of the table."""

from dataclasses import replace

import numpy as np

from graph.programs import (
    CASES,
    Case,
    Q,
    S,
    U,
    V,
    case_node,
    draw,
    evaluate,
    is_fine,
    kind_of,
    random_bounds,
    source,
)
from scenic.analysis.smt import SolverEncoding
from scenic.analysis.solver_terms import Questions, SolverAnswer, SolverTerms
from scenic.graph import bounding
from scenic.graph.bounds import Bounds
from scenic.graph.construction import make_node
from scenic.graph.kinds import Kind
from scenic.graph.operation import Operation, always
from scenic.graph.operations import TABLE
from tests.amounts import amount
from tests.each import each

LANES = 200
ROUNDS = 12


def boxes_of(case, rng):
    bounds = [random_bounds(part, rng) for part in case.operands]
    columns = [draw(part, LANES, rng, box) for part, box in zip(case.operands, bounds, strict=True)]
    # Quaternions are normalised after drawing: their box is the hull of what was drawn.
    for place, part in enumerate(case.operands):
        if part is Kind.ORIENTATION:
            bounds[place] = Bounds(columns[place].min(axis=0)[None], columns[place].max(axis=0)[None])
    return bounds, columns


def inside(values: np.ndarray, bounds: Bounds) -> np.ndarray:
    values = values.astype(float)
    held = (values >= bounds.lower) & (values <= bounds.upper)
    return held if held.ndim == 1 else held.all(axis=1)


BOUNDED = [case for case in CASES if TABLE[case.name].bounds is not None]


@each(BOUNDED)
def test_intervals_hold_every_value(case):
    rng = np.random.default_rng(11)
    informative = 0
    for _ in range(ROUNDS):
        bounds, columns = boxes_of(case, rng)
        node = case_node(case, columns)
        batch = evaluate(node, LANES)
        known = bounding.forward(node, bounds)
        fine = is_fine(batch, node)
        values = batch.full(node)[fine]
        if node.kind.is_boxed:
            values = np.array([float(value) for value in values])
        assert not known.empty().any()
        assert inside(values, known).all()
        informative += bool(np.isfinite(known.lower).all() and np.isfinite(known.upper).all())
    assert informative or case.name in ("power", "truncated normal")


@each(BOUNDED)
def test_intervals_of_points_are_narrow(case):
    """Where operands are fixed the bounds hold little more than the value."""
    rng = np.random.default_rng(13)
    if LOOSE & {case.name, str(case)} or (
        case.name in ("equal", "not equal") and Kind.ORIENTATION in case.operands
    ):
        return
    columns = [draw(part, 1, rng) for part in case.operands]
    node = case_node(case, columns)
    batch = evaluate(node, 1)
    if not is_fine(batch, node)[0]:
        return
    bounds = [Bounds(column.astype(float), column.astype(float)) for column in columns]
    known = bounding.forward(node, bounds)
    size = 1 + np.abs(batch.full(node).astype(float)).max()
    assert ((known.upper - known.lower) <= 1e-6 * size).all()


LOOSE = {"euler", "getitem", "modulo", "power", "round(s,i)", "round(s,b)"}
"""Entries (or cases of them) whose bounds say less than they could."""

INVERTED = [case for case in CASES if TABLE[case.name].inverse is not None]


@each(INVERTED)
def test_inverses_lose_no_consistent_value(case):
    """Operands whose result lies in given bounds are in the narrowed bounds."""
    rng = np.random.default_rng(17)
    narrowed_something = False
    for _ in range(ROUNDS):
        bounds, columns = boxes_of(case, rng)
        node = case_node(case, columns)
        batch = evaluate(node, LANES)
        fine = is_fine(batch, node)
        values = batch.full(node)
        if node.kind.is_boxed or not fine.any():
            continue
        values = values.astype(float)
        known = bounding.forward(node, bounds)
        chosen = values[fine][rng.integers(0, fine.sum(), 2)]
        result = Bounds(chosen.min(axis=0)[None], chosen.max(axis=0)[None]).meet(known)
        consistent = fine & inside(values, result)
        with np.errstate(all="ignore"):
            parts = TABLE[case.name].inverse(case.payload, result, *bounds)
        assert len(parts) == len(columns)
        for part, column, box in zip(parts, columns, bounds, strict=True):
            if part is not None:
                assert inside(column[consistent], part).all()
                narrowed_something |= bool(((part.lower > box.lower) | (part.upper < box.upper)).any())
    assert narrowed_something or case.name in SELDOM_NARROWING


def of_box(bounds: Bounds | None, number: int) -> Bounds | None:
    """What is known of one of many boxes; a single row is that of all."""
    if bounds is None:
        return None
    place = number if len(bounds.lower) > 1 else 0
    return Bounds(bounds.lower[place : place + 1], bounds.upper[place : place + 1])


def assert_alike(found: Bounds | None, expected: Bounds | None) -> None:
    assert (found is None) is (expected is None)
    if found is not None:  # library functions may round a single number otherwise than one of many
        np.testing.assert_allclose(found.lower, expected.lower, rtol=1e-13, atol=1e-300)
        np.testing.assert_allclose(found.upper, expected.upper, rtol=1e-13, atol=1e-300)


@each(BOUNDED)
def test_boxes_do_not_depend_on_company(case):
    """Of many boxes at a time, where one operand may be the same in all of them, each is told what it is told alone."""
    rng = np.random.default_rng(23)
    operation, count, operands = TABLE[case.name], amount(8, 16), []
    shared = int(rng.integers(-1, len(case.operands)))
    for place, part in enumerate(case.operands):
        rows = [random_bounds(part, rng) for _ in range(1 if place == shared else count)]
        operands.append(
            Bounds(*(np.concatenate([getattr(row, end) for row in rows]) for end in ("lower", "upper")))
        )
    alone = [[of_box(each, number) for each in operands] for number in range(count)]
    with np.errstate(all="ignore"):
        known = operation.bounds(case.payload, *operands)
        for number in range(count):
            assert_alike(of_box(known, number), operation.bounds(case.payload, *alone[number]))
        if operation.inverse is None or known is None:
            return
        middle = np.clip((known.lower + known.upper) / 2, -1e9, 1e9)
        for result in (Bounds(known.lower, middle), Bounds(middle, known.upper)):
            parts = operation.inverse(case.payload, result, *operands)
            for number in range(count):
                mine = operation.inverse(case.payload, of_box(result, number), *alone[number])
                for part, expected in zip(parts, mine, strict=True):
                    assert_alike(of_box(part, number), expected)


@each(BOUNDED)
def test_values_of_points_are_held_to_the_last_unit(case):
    """Of thousands of single values: what rounding has made of them is within the bounds, and they are kept by the inverse."""
    rng = np.random.default_rng(29)
    columns = [draw(part, 3000, rng) for part in case.operands]
    if case.name == "power":
        columns = [column[:200] for column in columns]
    node = case_node(case, columns)
    batch = evaluate(node, len(columns[0]))
    if node.kind.is_boxed:
        return
    fine, values = is_fine(batch, node), batch.full(node).astype(float)
    points = [Bounds(column.astype(float), column.astype(float)) for column in columns]
    known = bounding.forward(node, points)
    assert inside(values, known)[fine].all()
    if TABLE[case.name].inverse is not None:
        with np.errstate(all="ignore"):
            parts = TABLE[case.name].inverse(case.payload, Bounds(values, values), *points)
        for part, column in zip(parts, columns, strict=True):
            assert part is None or inside(column, part)[fine].all()


SELDOM_NARROWING = {
    "and",
    "or",
    "equal",
    "not equal",
    "truth",
    "positive",
    "float",
    "power",
    "round",
    "int",
    "floor divide",
}
"""Entries that random operands and results seldom narrow; `tests/graph/test_inverses.py` has directed cases."""

EXACT = {
    "absolute", "add", "and", "component", "cross", "divide", "dot", "equal", "float", "floor divide",
    "greater", "greater or equal", "if", "int", "len", "less", "less or equal", "maximum", "minimum",
    "modulo", "multiply", "negative", "not", "not equal", "or", "positive", "rotate", "select", "subtract",
    "truth", "vector",
}  # fmt: skip
"""Entries whose term has one value when the operands have; the others are only held to allow the value."""

SOLVED = [case for case in CASES if TABLE[case.name].solver is not None]


@each(SOLVED)
def test_terms_agree_with_numpy(case):
    """On fixed operands the term allows the computed value and, where the encoding is exact, no other."""
    rng = np.random.default_rng(19)
    for _ in range(amount(2, 4)):
        columns = [draw(part, 1, rng) for part in case.operands]
        if case.name == "power":
            columns[1] = np.array([rng.integers(0, 5)], dtype=columns[1].dtype)
        node = case_node(case, columns)
        batch = evaluate(node, 1)
        if node.kind.is_boxed or not is_fine(batch, node)[0]:
            continue
        value = batch.full(node)[0]
        fixed = [fixed_node(part, column) for part, column in zip(case.operands, columns, strict=True)]
        encoding = SolverEncoding([replace(node, operands=tuple(fixed))])
        terms = encoding.terms
        term = encoding.term(encoding.nodes[-1])
        close = matches(terms, term, value)
        supports = [fact for fact, _ in encoding.supports]
        questions = Questions(terms, [*terms.definitions, *supports], [close, ~close])
        assert questions.ask([0]) is SolverAnswer.POSSIBLE
        if case.name in EXACT and case.operands != (Kind.ORIENTATION, Kind.ORIENTATION):
            assert questions.ask([1]) is SolverAnswer.IMPOSSIBLE


def fixed_node(part, column):
    if part == U:
        return make_node(
            TABLE["range"], [source(S, [0.5])] * 3
        )  # any unknown number: primitives ignore their axis
    kind = kind_of(part)
    row = column[0]
    from scenic.graph.node import constant

    return constant(row.tolist(), kind, row)


def matches(terms, term, value):
    """The term is the value, up to rounding."""
    if isinstance(term, tuple):
        result = terms.truth(True)
        for part, number in zip(term, value.tolist(), strict=True):
            result = result & matches(terms, part, np.float64(number))
        return result
    if value.dtype == np.bool_:
        return term if value else ~term
    margin = 1e-9 * (1 + abs(float(value)))
    number = terms.number(term)
    low, high = terms.real(float(value) - margin), terms.real(float(value) + margin)
    return (number >= low) & (number <= high)


def test_unknown_readings_say_nothing():
    """An operation without bounds or terms of its own has those of its kind."""
    mystery = Operation("mystery", always(Kind.BOOLEAN), lambda call, a: a > 0, "A test.")
    node = make_node(mystery, [source(S, [1.0])])
    known = bounding.forward(node, [Bounds.exactly(1.0)])
    assert (known.lower[0], known.upper[0]) == (0, 1)
    encoding = SolverEncoding([node])
    questions = Questions(encoding.terms, [], [encoding.truth(node), ~encoding.truth(node)])
    assert questions.ask([0]) is questions.ask([1]) is SolverAnswer.POSSIBLE


UNDEFINED = {
    "add": [(V, S), (S, V), (V, Q), (Q, Q)],
    "subtract": [(V, S), (Q, V), (Q, Q)],
    "multiply": [(V, V), (Q, S), (S, Q), (Q, V)],
    "divide": [(S, V), (V, V), (Q, S), (V, Q)],
    **{key: [(V, S), (S, V), (V, V), (Q, S)] for key in ("floor divide", "modulo", "power")},
    **{key: [(Q,)] for key in ("negative", "positive")},
    "absolute": [(V,), (Q,)],
    "int": [(V,), (Q,)],
    "round": [(V,), (V, S), (Q,)],
}


@each(UNDEFINED)
def test_nothing_is_said_where_python_defines_no_such_operation(name):
    """Each lane fails there, which is for sampling to tell; of boxes of any number nothing is known."""
    terms = SolverTerms()
    for kinds in UNDEFINED[name]:
        columns = [np.ones((2, *kind.trailing)) for kind in kinds]
        node = case_node(Case(name, kinds), columns)
        boxes = [Bounds(column - 0.5, column + 0.5) for column in columns]
        assert bounding.forward(node, boxes) is None, kinds
        assert bounding.forward(node, [of_box(each, 0) for each in boxes]) is None, kinds
        fixed = [terms.real(1.0) if kind is S else (terms.real(1.0),) * kind.trailing[0] for kind in kinds]
        assert TABLE[name].solver(terms, None, *fixed) is None, kinds
