"""The table as a whole: which entry has which reading, and what every reading must be."""

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from graph.programs import CASES, I, Q, S, V, case_node, draw, evaluate, is_fine, kind_of, source
from scenic.analysis.solver_terms import SolverTerms
from scenic.graph.bounds import Bounds
from scenic.graph.operations import TABLE
from tests.each import each

GOLDEN = Path(__file__).parent / "data" / "table.json"
READINGS = ("batch", "python", "bounds", "inverse", "solver")


def test_the_readings_of_every_entry(request):
    cells = {
        name: {
            reading: "supported" if getattr(operation, reading) is not None else "unsupported"
            for reading in READINGS
        }
        | {"strict": operation.strict}
        for name, operation in TABLE.items()
    }
    if request.config.getoption("--update-golden", default=False):
        GOLDEN.write_text(json.dumps(cells, indent=1) + "\n")
    assert cells == json.loads(GOLDEN.read_text())


def test_the_table_is_read_only():
    with pytest.raises(TypeError):
        TABLE["add"] = TABLE["subtract"]


def test_every_entry_is_pure():
    """The solver takes what the same operation makes of the same operands for one value."""
    assert all(operation.pure for operation in TABLE.values())


def test_every_entry_has_a_case_and_a_description():
    assert {case.name for case in CASES} == set(TABLE)
    assert all(operation.doc.endswith(".") and operation.name == name for name, operation in TABLE.items())


def bits(column: np.ndarray) -> bytes:
    if column.dtype == object:
        return repr(column.tolist()).encode()
    return np.ascontiguousarray(column).tobytes()


def same(first, second, case):
    """Equal bit for bit, faults and rejections included."""
    node, other = first[1], second[1]
    fine = is_fine(*first)
    assert (fine == is_fine(*second)).all(), case
    assert bits(first[0].full(node)[fine]) == bits(second[0].full(other)[fine]), case


@each(CASES)
def test_batches_and_strides_change_no_bit(case):
    """Rows are the same in batches of 1, 7 and 512, and when columns are strided or repeat one row."""
    rng = np.random.default_rng(3)
    lanes = 512
    columns = [draw(part, lanes, rng) for part in case.operands]
    # Integer kinds depend on the limits of all values, which every part of the batch must share.
    whole = case_node(case, columns)

    def part_of(rows):
        sources = [
            replace_column(operand, column[rows])
            for operand, column in zip(whole.operands, columns, strict=True)
        ]
        node = replace(whole, operands=tuple(sources))
        return evaluate(node, len(columns[0][rows])), node

    full = part_of(slice(None))
    values, fine = full[0].full(full[1]), is_fine(*full)
    for size in (1, 7):
        for start in range(0, 30 * size, size):
            rows = slice(start, start + size)
            batch, node = part_of(rows)
            assert (is_fine(batch, node) == fine[rows]).all()
            assert bits(batch.full(node)[fine[rows]]) == bits(values[rows][fine[rows]])

    strided = []
    for operand, column in zip(whole.operands, columns, strict=True):
        spaced = np.zeros((2 * lanes, *column.shape[1:]), dtype=operand.kind.dtype)
        spaced[::2] = column
        strided.append(replace_column(operand, spaced[::2]))
    node = replace(whole, operands=tuple(strided))
    same((evaluate(node, lanes), node), full, case)

    constant_row = [
        replace_column(operand, column[:1]) for operand, column in zip(whole.operands, columns, strict=True)
    ]
    node = replace(whole, operands=tuple(constant_row))
    batch = evaluate(node, 9)
    if fine[0]:
        assert bits(batch.full(node)) == bits(np.repeat(values[:1], 9, axis=0))
    else:
        assert not is_fine(batch, node).any()


def replace_column(operand, column):
    return replace(operand, payload=(np.asarray(column, dtype=operand.kind.dtype),))


@each(CASES)
def test_columns_have_the_form_of_the_kind(case):
    rng = np.random.default_rng(5)
    columns = [draw(part, 20, rng) for part in case.operands]
    node = case_node(case, columns)
    column = evaluate(node, 20).column(node)
    assert column.dtype == node.kind.dtype
    assert column.shape[1:] == node.kind.trailing
    assert len(column) in (1, 20)


PLAIN = [
    case
    for case in CASES
    if TABLE[case.name].python is not None and not any(kind_of(part).trailing for part in case.operands)
]


@each(PLAIN)
def test_batches_agree_with_python(case):
    """The NumPy reading gives in every lane what Python's own function gives, and fails as it fails."""
    rng = np.random.default_rng(7)
    columns = [draw(part, 60, rng) for part in case.operands]
    node = case_node(case, columns)
    batch = evaluate(node, 60)
    fine = is_fine(batch, node)
    for lane in range(60):
        values = [
            np.asarray(column, kind_of(part).dtype)[lane].item()
            for part, column in zip(case.operands, columns, strict=True)
        ]
        try:
            expected = TABLE[case.name].python(*values)
        except ArithmeticError:
            assert not fine[lane]
            continue
        if isinstance(expected, complex):
            assert not fine[lane]
            continue
        assert fine[lane]
        found = batch.value(node, lane)
        assert repr(found) == repr(expected), values
        assert type(found) is type(expected)


@each([case for case in CASES if TABLE[case.name].scalar is not None])
def test_plain_numbers_give_the_same_bits(case):
    """What is computed at once equals what a batch computes, in every bit."""
    rng = np.random.default_rng(11)
    lanes = 300
    columns = [draw(part, lanes, rng) for part in case.operands]
    node = case_node(case, columns)
    batch = evaluate(node, lanes)
    fine = is_fine(batch, node)
    values = batch.full(node)
    compared = 0
    for lane in np.flatnonzero(fine).tolist():
        rows = [column[lane].tolist() for column in columns]
        rows = [tuple(row) if isinstance(row, list) else row for row in rows]
        if any(isinstance(row, bool) for row in rows):
            continue
        found = TABLE[case.name].scalar(case.payload, *rows)
        assert bits(np.asarray(found, dtype=values.dtype)) == bits(values[lane]), rows
        compared += 1
    assert compared or any(kind_of(part).value == "boolean" for part in case.operands)


_SIZES = (0.0, -0.0, 1.0, -2.5, 1e200, -1e-200, 5e-324)
AT_CORNERS = {
    S: (
        *(0.0, -0.0, 1.0, -3.0, 1e-300, -1e300, math.inf, -math.inf, math.nan),
        *(math.nextafter(turns * math.pi, way) for turns in (-4, -3, -1, 1, 2, 3, 4) for way in (-99, 99)),
        *(turns * math.pi for turns in (-17, -13, -3, -1, -0.5, 0.5, 1, 3, 13, 17, 1e6 + 1)),
    ),
    I: (0, 1, -1, 3, -5),
    V: (*itertools.product(_SIZES, repeat=3), (math.inf, 1.0, 0.0), (math.nan, 0.0, 0.0)),
    Q: (*itertools.product((0.0, -0.0, 1.0, -1.0), repeat=4), (0.5, -0.5, 0.5, 0.5), (0.0, 0.6, 0.0, -0.8)),
}
"""Where formulas change: zeros of both signs, seams of angles, squares that vanish or overflow, half turns."""


@each(
    [
        case
        for case in CASES
        if TABLE[case.name].scalar is not None and set(case.operands) <= AT_CORNERS.keys()
    ]
)
def test_plain_numbers_at_corners_give_the_same_bits(case):
    rng = np.random.default_rng(13)
    options = [AT_CORNERS[part] for part in case.operands]
    chosen = (
        [np.arange(len(options[0]))]
        if len(options) == 1
        else [rng.integers(0, len(of), 400) for of in options]
    )
    columns = [
        np.array(of, dtype=kind_of(part).dtype)[places]
        for part, of, places in zip(case.operands, options, chosen, strict=True)
    ]
    node = case_node(case, columns)
    batch = evaluate(node, len(columns[0]))
    fine, values = is_fine(batch, node), batch.full(node)
    for lane in range(len(values)):
        rows = [
            tuple(row) if isinstance(row, list) else row for row in (each[lane].tolist() for each in columns)
        ]
        if not fine[lane]:
            with pytest.raises((ArithmeticError, ValueError)):
                TABLE[case.name].scalar(case.payload, *rows)
            continue
        found = TABLE[case.name].scalar(case.payload, *rows)
        if found is not NotImplemented:
            found = np.asarray(found, dtype=values.dtype)
            np.testing.assert_array_equal(found, values[lane], str(rows))
            known = found == found  # a NaN has no sign that counts
            np.testing.assert_array_equal(
                np.signbit(found)[known], np.signbit(values[lane])[known], str(rows)
            )


SAMPLES = {
    S: 2.0,
    I: 3,
    V: (1.0, -2.0, 0.5),
    Q: (0.6, 0.0, 0.0, 0.8),
}
REFUSING = {"add": 2, "subtract": 2, "multiply": 2, "divide": 2, "negative": 1}
"""Operations, and of how many operands, that Python defines for some kinds and not for others."""


@each(REFUSING)
def test_what_python_does_not_define_is_not_computed_at_once(name):
    """Nobody may take the rows of vectors and orientations for something else than what they are."""
    refused = 0
    for kinds in itertools.product(SAMPLES, repeat=REFUSING[name]):
        rows = [SAMPLES[kind] for kind in kinds]
        if (
            TABLE[name]
            .kind([source(kind, [row]) for kind, row in zip(kinds, rows, strict=True)], None)
            .is_boxed
        ):
            assert TABLE[name].scalar(None, *rows) is NotImplemented, kinds
            refused += 1
    assert refused


PARTLY_DEFINED = {
    **REFUSING,
    **dict.fromkeys(("floor divide", "modulo", "power", "minimum", "maximum"), 2),
    **dict.fromkeys(("positive", "absolute", "round", "int", "float"), 1),
}


@each(PARTLY_DEFINED)
def test_nothing_is_known_of_what_python_does_not_define(name):
    """Neither bounds nor the solver take a vector or an orientation for something else; where it is defined, both say something."""
    terms = SolverTerms()
    for kinds in itertools.product((S, V, Q), repeat=PARTLY_DEFINED[name]):
        rows = [np.array([SAMPLES[kind]], dtype=float) for kind in kinds]
        known = TABLE[name].bounds(None, *(Bounds(row, row) for row in rows))
        parts = [
            tuple(map(terms.real, row[0].tolist())) if row.ndim > 1 else terms.real(row[0]) for row in rows
        ]
        kind = TABLE[name].kind([source(kind, [SAMPLES[kind]]) for kind in kinds], None)
        defined = set(kinds) == {S} or (kind is V and Q not in kinds)
        assert (known is not None) is defined, kinds
        if defined or name != "float":  # the kind of a float is a number whatever Python makes of its operand
            assert (TABLE[name].solver(terms, None, *parts) is not None) is defined, kinds
