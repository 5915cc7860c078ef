"""Bounds and inverses where they are most easily wrong: at corners, seams, zeros and neighbours; and how tight they are."""

import math

import numpy as np
import pytest

from graph.programs import B, I, P, Q, S, U, V
from graph.readings import CASES, bounds_of, has, kind_of, narrowed, values_of
from scenic.graph.bounds import Bounds
from scenic.graph.operations import TABLE
from tests.amounts import amount
from tests.each import each

TINY, HUGE = 5e-324, 1.7e308


def around(*numbers: float) -> list[float]:
    """Numbers with their neighbours."""
    return [
        each
        for number in numbers
        for each in (math.nextafter(number, -math.inf), number, math.nextafter(number, math.inf))
    ]


CORNERS = {
    S: [
        *around(0.0, 1.0, -1.0, math.pi, -math.pi, math.pi / 2, 0.5, 2.5, math.tau, 3 * math.pi),
        *(-0.0, TINY, -TINY, 1e-160, 7.3, -100.25, 2.0**53, 2.0**53 + 2, -(2.0**53), 1e17, HUGE, -HUGE),
    ],
    I: [0, 1, -1, 2, 3, -4, 7, 10, 2**31, 2**53 - 1, 2**53, 2**53 + 1, -(2**53) - 1, 2**60],
    B: [False, True],
    P: [TINY, 1e-3, 0.5, 1.0, 2.0, 1e3],
    U: [TINY, 0.25, math.nextafter(0.5, 0), 0.5, 0.75, math.nextafter(1.0, 0)],
}
# Squares of the smallest numbers vanish, and with them the digits of lengths.
CORNERS[V] = [number for number in CORNERS[S] if abs(number) != 1e-160]
SMALL = [0, 1, -1, 2, 3, -4, 7]
"""Whole numbers that can be exponents."""

BOUNDED = [case for case in CASES if has(case, "bounds") and set(case.operands) <= {S, I, B, V, P, U}]
INVERTED = [case for case in BOUNDED if has(case, "inverse")]
SLOW = {"floor divide", "modulo", "power"}
SMALL_ONLY = {"power", "round", "getitem"}


def components(part: object) -> int:
    return 3 if part is V else 1


def corner_box(
    part: object, rng: np.random.Generator, *, small: bool = False
) -> tuple[list[float], list[float]]:
    """Ends of an operand, component by component: two corners, or an interval of a few units in the last place."""
    lows, highs = [], []
    for _ in range(components(part)):
        corners = SMALL if small and part is I else CORNERS[part]
        one, other = (corners[rng.integers(len(corners))] for _ in range(2))
        style = rng.integers(3)
        if style == 0:
            other = one
        elif style == 1 and part in (S, V):
            other = one
            for _ in range(int(rng.integers(1, 5))):
                other = math.nextafter(other, math.inf)
        lows.append(min(one, other))
        highs.append(max(one, other))
        if part is U:
            lows[-1], highs[-1] = max(lows[-1], TINY), min(highs[-1], math.nextafter(1.0, 0))
    return lows, highs


def inner_values(
    part: object, lows: list[float], highs: list[float], rng: np.random.Generator, n: int
) -> np.ndarray:
    """Values of a box: its ends, their neighbours within, zeros of both signs, and others."""
    columns = []
    for low, high in zip(lows, highs, strict=True):
        if part in (I, B):
            values = [low, high, *(int(value) for value in (low // 2 + high // 2, 0, 1, 2))]
            values = [value for value in values if low <= value <= high]
        else:
            with np.errstate(over="ignore"):
                middle = low / 2 + high / 2
            values = [
                low,
                high,
                math.nextafter(low, math.inf),
                math.nextafter(high, -math.inf),
                middle,
                0.0,
                -0.0,
                1.0,
            ]
            values += [math.pi, -math.pi, 0.25, 0.5, -1.0]
            values = [value for value in values if low <= value <= high]
        columns.append([values[index] for index in rng.integers(0, len(values), n)])
        columns[-1][: len(values)] = values[:n]
    if part is V:
        return np.array(columns, dtype=float).T
    return np.array(columns[0], dtype=kind_of(part).dtype)


@each(BOUNDED)
def test_bounds_hold_at_corners(case):
    rng = np.random.default_rng(41)
    for _ in range(amount(12, 25) if case.name in SLOW else amount(15, 40)):
        ends = [corner_box(part, rng, small=case.name in SMALL_ONLY) for part in case.operands]
        columns = [inner_values(part, *box, rng, 40) for part, box in zip(case.operands, ends, strict=True)]
        for column in columns[1:]:
            rng.shuffle(column)
        with np.errstate(all="ignore"):
            try:
                values, fine = values_of(case, columns)
            except (OverflowError, MemoryError):
                continue  # whole numbers of many digits, which no column holds
        boxes = [(low if part is V else low[0], high if part is V else high[0]) for part, (low, high) in zip(case.operands, ends, strict=True)]  # fmt: skip
        lower, upper = bounds_of(case, columns, boxes)
        fine &= ~np.isnan(values.reshape(len(values), -1)).any(axis=1)
        assert ((values[fine] >= lower) & (values[fine] <= upper)).all(), (boxes, lower, upper)


@each(INVERTED)
def test_inverses_lose_no_corner(case):
    """Operands whose result is exactly the one asked for, or within a few units in the last place, are kept."""
    rng = np.random.default_rng(43)
    for _ in range(amount(10, 25)):
        ends = [corner_box(part, rng, small=case.name in SMALL_ONLY) for part in case.operands]
        columns = [inner_values(part, *box, rng, 24) for part, box in zip(case.operands, ends, strict=True)]
        for column in columns[1:]:
            rng.shuffle(column)
        with np.errstate(all="ignore"):
            try:
                values, fine = values_of(case, columns)
            except (OverflowError, MemoryError):
                continue
        fine &= np.isfinite(values.reshape(len(values), -1)).all(axis=1)
        boxes = [(low if part is V else low[0], high if part is V else high[0]) for part, (low, high) in zip(case.operands, ends, strict=True)]  # fmt: skip
        for lane in np.flatnonzero(fine)[:6]:
            low = high = values[lane]
            for _ in range(int(rng.integers(0, 4))):
                high = np.nextafter(high, np.inf)
            for part, column, (lower, upper) in zip(
                case.operands, columns, narrowed(case, (low, high), boxes), strict=True
            ):
                kept = (column[lane] >= lower) & (column[lane] <= upper)
                assert np.all(kept), (part, column[lane], lower, upper, low)


# How tight bounds are: dense grids, on which the values nearly reach them.

WIDE = {"modulo", "floor divide", "getitem", "divmod", "round", "truncated normal"}
"""Operations whose bounds say less than they could."""
GRID = {1: 401, 2: 41, 3: 13}
MODERATE = {S: (-4, 4), I: (-6, 6), P: (0.1, 3), U: (0.05, 0.95), V: (-3, 3)}


def grid(case, ends):
    """All combinations of evenly spaced values of the operands' components."""
    axes = []
    count = sum(components(part) for part in case.operands)
    number = GRID.get(count, 4 if count > 4 else 7)
    for part, (lows, highs) in zip(case.operands, ends, strict=True):
        for low, high in zip(lows, highs, strict=True):
            if part is B:
                axes.append(np.unique([low, high]))
            elif part is I:
                axes.append(np.arange(low, high + 1))
            else:
                axes.append(np.unique(np.linspace(low, high, number)))
    mesh = [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]
    columns, place = [], 0
    for part in case.operands:
        size = components(part)
        columns.append(
            np.stack(mesh[place : place + size], axis=1)
            if part is V
            else mesh[place].astype(kind_of(part).dtype)
        )
        place += size
    return columns


def moderate_box(part, rng):
    if part is B:
        low, high = sorted(rng.integers(0, 2, 2).tolist())
        return [bool(low)], [bool(high)]
    lows, highs = [], []
    for _ in range(components(part)):
        one, other = sorted(rng.uniform(*MODERATE[part], 2).tolist())
        if part is I:
            one, other = round(one), round(other)
        lows.append(one)
        highs.append(other)
    return lows, highs


RARE = {"truth", "equal", "not equal", "discrete range"}
"""Results that a grid need not meet."""
TIGHT = [
    case
    for case in BOUNDED
    if case.name not in WIDE | RARE and not (case.name == "normal" and case.operands[2] is S)
]


@each(TIGHT)
def test_bounds_are_tight(case):
    rng = np.random.default_rng(47)
    ratios = []
    for _ in range(12):
        ends = [moderate_box(part, rng) for part in case.operands]
        columns = grid(case, ends)
        with np.errstate(all="ignore"):
            values, fine = values_of(case, columns)
        if not fine.all():
            continue
        boxes = [(low if part is V else low[0], high if part is V else high[0]) for part, (low, high) in zip(case.operands, ends, strict=True)]  # fmt: skip
        lower, upper = bounds_of(case, columns, boxes)
        if not np.isfinite([lower, upper]).all():
            continue  # by a divisor that may be nothing
        least, most = values.min(axis=0), values.max(axis=0)
        assert (least >= lower).all()
        assert (most <= upper).all()
        ratios.append(np.max((upper - lower) - (most - least)) / (np.max(most - least) + 1e-6))
    assert ratios
    # A grid misses a little of the range, more so with many components; steep powers most of all.
    assert np.median(ratios) < 0.3


GRIDS_OF_INVERSES = [case for case in INVERTED if sum(components(part) for part in case.operands) <= 3 and case.name not in {"modulo", "power", "round", "truth", "normalize angle"}]  # fmt: skip


@each(GRIDS_OF_INVERSES)
def test_inverses_are_tight(case):
    """What is left of an operand is hardly more than what some choice of the others still needs."""
    rng = np.random.default_rng(53)
    found = []
    for _ in range(14):
        ends = [moderate_box(part, rng) for part in case.operands]
        columns = grid(case, ends)
        with np.errstate(all="ignore"):
            values, fine = values_of(case, columns)
        if not fine.all() or values.ndim > 1:
            continue
        span = values.max() - values.min()
        middle = values[rng.integers(len(values))]
        low, high = (middle - 0.1 * span, middle + 0.1 * span) if kind_is_real(values) else (middle, middle)
        consistent = (values >= low) & (values <= high)
        boxes = [(low_[0] if part is not V else low_, high_[0] if part is not V else high_) for part, (low_, high_) in zip(case.operands, ends, strict=True)]  # fmt: skip
        for column, (before_low, before_high), (lower, upper) in zip(
            columns, boxes, narrowed(case, (low, high), boxes), strict=True
        ):
            if column.ndim > 1 or before_high <= before_low:
                continue
            needed = column[consistent].astype(float)
            assert lower <= needed.min()
            assert upper >= needed.max()
            whole = before_high - before_low
            found.append(((upper - lower) - (needed.max() - needed.min())) / whole)
    # Where results say little there is nothing to be tight about; but where they do, it is used.
    if found:
        assert np.median(found) < 0.35


def kind_is_real(values):
    return bool((values != np.rint(values)).any())


# Places where formulas change.


def of(name, *kinds, payload=None):
    return next(
        case for case in CASES if case.name == name and case.operands == kinds and case.payload == payload
    )


def ends_of(name, *boxes, payload=None):
    kinds = (S,) * len(boxes)
    case = of(name, *kinds, payload=payload)
    columns = [np.array([float(low)]) for low, _ in boxes]
    return bounds_of(case, columns, list(boxes))


@pytest.mark.parametrize(
    ("name", "boxes", "expected"),
    [
        ("sin", [(0, math.pi)], (0, 1)),
        ("sin", [(-math.pi / 2, 0)], (-1, 0)),
        ("sin", [(math.pi / 2 + 0.1, math.pi)], (0, math.sin(math.pi / 2 + 0.1))),
        ("sin", [(3, 3 + 6.2)], (-1, 1)),
        ("cos", [(-0.1, 0.2)], (math.cos(0.2), 1)),
        ("cos", [(math.pi - 0.3, math.pi + 0.1)], (-1, math.cos(math.pi - 0.3))),
        ("cos", [(100 * math.tau + 0.5, 100 * math.tau + 0.75)], (math.cos(0.75), math.cos(0.5))),
        ("normalize angle", [(3, 3.1)], (3, 3.1)),
        ("normalize angle", [(3, 3.2)], (-math.pi, math.pi)),
        ("normalize angle", [(4, 5)], (4 - math.tau, 5 - math.tau)),
        ("normalize angle", [(-5, -4)], (math.tau - 5, math.tau - 4)),
        ("normalize angle", [(-math.pi, math.pi)], (-math.pi, math.pi)),
        ("normalize angle", [(-9.5, -9.3)], (-math.pi, math.pi)),
        ("absolute", [(-3, 2)], (0, 3)),
        ("absolute", [(-3, -2)], (2, 3)),
        ("absolute", [(-0.0, 0.0)], (0, 0)),
        ("divide", [(1, 2), (4, 5)], (0.2, 0.5)),
        ("divide", [(-1, 2), (-5, -4)], (-0.5, 0.25)),
        ("multiply", [(-2, 3), (-5, 7)], (-15, 21)),
        ("multiply", [(-2, -1), (-5, -3)], (3, 10)),
        ("minimum", [(0, 5), (2, 3)], (0, 3)),
        ("maximum", [(0, 5), (2, 3)], (2, 5)),
        ("hypot", [(-3, 1), (-4, 2)], (0, 5)),
        ("hypot", [(3, 6), (-8, -4)], (5, 10)),
        ("power", [(-2, 3), (2, 2)], (0, 9)),
        ("power", [(-2, 3), (3, 3)], (-8, 27)),
        ("power", [(2, 3), (-1, -1)], (1 / 3, 1 / 2)),
    ],
)
def test_bounds_by_hand(name, boxes, expected):
    lower, upper = ends_of(name, *boxes)
    assert (lower, upper) == pytest.approx(expected, rel=1e-10, abs=1e-12)
    assert lower <= expected[0] + 1e-15 * (1 + abs(expected[0]))
    assert upper >= expected[1] - 1e-15 * (1 + abs(expected[1]))


@pytest.mark.parametrize(("strict", "loose"), [("less", "less or equal"), ("greater", "greater or equal")])
def test_orders_of_neighbours(strict, loose):
    one, two = 1.0, math.nextafter(1.0, 2)
    smaller, larger = ((one, one), (two, two)) if strict == "less" else ((two, two), (one, one))
    touching = [((0, 1.0), (1.0, 2)), ((1.0, 2), (0, 1.0))][strict == "greater"]
    assert ends_of(strict, smaller, larger) == (1, 1)
    assert ends_of(loose, smaller, larger) == (1, 1)
    assert ends_of(strict, (one, one), (one, one)) == (0, 0)
    assert ends_of(loose, (one, one), (one, one)) == (1, 1)
    assert ends_of(strict, *touching) == (0, 1)
    assert ends_of(loose, *touching) == (1, 1)
    assert ends_of(strict, *touching[::-1]) == (0, 0)
    assert ends_of(loose, *touching[::-1]) == (0, 1)
    case = of(strict, S, S)
    wide = [(0.0, 10.0), (0.0, 10.0)]
    left, right = narrowed(case, (1.0, 1.0), [wide[0], (3.0, 4.0)])
    limit = math.nextafter(4.0, 0) if strict == "less" else 10.0
    assert left[1] == limit
    assert left[0] == (0.0 if strict == "less" else math.nextafter(3.0, 9))
    assert right == (3.0, 4.0)
    left, _ = narrowed(of(loose, S, S), (1.0, 1.0), [wide[0], (3.0, 4.0)])
    assert left == ((0.0, 4.0) if strict == "less" else (3.0, 10.0))
    left, _ = narrowed(case, (0.0, 0.0), [wide[0], (3.0, 4.0)])
    assert left == ((3.0, 10.0) if strict == "less" else (0.0, 4.0))


@pytest.mark.parametrize("infinite", [(-math.inf, math.inf), (0.0, math.inf), (-math.inf, 0.0)])
@pytest.mark.parametrize("case", [case for case in INVERTED if set(case.operands) <= {S}], ids=str)
def test_infinite_bounds_say_nothing_wrong(case, infinite):
    """With one operand unbounded, what is known of finite values stays true."""
    rng = np.random.default_rng(59)
    for place in range(len(case.operands)):
        ends = [(-2.0, 3.0)] * len(case.operands)
        ends[place] = infinite
        finite = [(max(low, -1e3), min(high, 1e3)) for low, high in ends]
        columns = [rng.uniform(low, high, 60) for low, high in finite]
        with np.errstate(all="ignore"):
            values, fine = values_of(case, columns)
        lower, upper = bounds_of(case, columns, ends)
        assert ((values[fine] >= lower) & (values[fine] <= upper)).all()
        if not fine.any():
            continue
        lane = int(np.flatnonzero(fine)[0])
        for column, (low, high) in zip(
            columns, narrowed(case, (values[lane], values[lane]), ends), strict=True
        ):
            assert low <= column[lane] <= high


@pytest.mark.parametrize("base", [3.7, 1e-20, 1e20, 0.999])
@pytest.mark.parametrize("exponent", [-3.0, 0.5, 5.0])
def test_powers_have_room_for_libraries_that_err_by_a_unit(base, exponent):
    lower, upper = ends_of("power", (base, base), (exponent, exponent))
    value = base**exponent
    room = 2 * math.ulp(value)
    assert value - 10 * room < lower <= value - room
    assert value + room <= upper < value + 10 * room


def test_angles_have_room_at_the_seam_and_at_the_poles():
    for case in CASES:
        if case.name == "euler":
            limit = math.pi / 2 if case.payload == 1 else math.pi
            lower, upper = bounds_of(case, [np.array([[0.0, 0.0, 0.0, 1.0]])], [((-1.0,) * 4, (1.0,) * 4)])
            assert lower <= math.nextafter(-limit, -4)
            assert upper >= math.nextafter(limit, 4)


def test_nothing_is_certain_of_numbers_that_may_be_none():
    """The difference of infinities is no number, and unequal to itself."""
    for name, certain in (("equal", (0, 1)), ("not equal", (0, 1))):
        for end in (math.inf, -math.inf):
            assert ends_of(name, (end, end), (end, end)) == certain
    assert ends_of("equal", (2.0, 2.0), (2.0, 2.0)) == (1, 1)


LENGTHS = [(of("norm", V), 1), (of("distance", V, V), 2), (of("hypot", S, S, S), 3), (of("hypot", S, S), 2)]


@pytest.mark.parametrize(("case", "count"), LENGTHS, ids=str)
def test_a_length_that_was_computed_keeps_what_it_was_computed_of(case, count):
    """All but one component known, and the length as it came out: what rounding took must not be held against the last one."""
    rng = np.random.default_rng(61)
    columns = [rng.normal(size=(150, 3) if part is V else 150) * 3 for part in case.operands]
    values, _ = values_of(case, columns)
    for lane, value in enumerate(values):
        for place in range(count):
            boxes = [(column[lane], column[lane]) for column in columns]
            if case.operands[place] is V:
                free = int(rng.integers(3))
                low, high = columns[place][lane].copy(), columns[place][lane].copy()
                low[free], high[free] = -20.0, 20.0
                boxes[place] = (low, high)
            else:
                boxes[place] = (-20.0, 20.0)
            for column, (lower, upper) in zip(columns, narrowed(case, (value, value), boxes), strict=True):
                assert np.all((lower <= column[lane]) & (column[lane] <= upper))


def test_a_number_that_scales_a_vector_has_to_suit_every_component():
    box, free = ([1.0, 2.0, 4.0], [1.0, 2.0, 4.0]), (0.0, 10.0)
    result = ([0.5, 0.1, 0.1], [3.0, 3.0, 3.0])
    for name, kinds, boxes, place in (
        ("multiply", (V, S), [box, free], 1),
        ("multiply", (S, V), [free, box], 0),
    ):
        assert narrowed(of(name, *kinds), result, boxes)[place] == pytest.approx((0.5, 0.75))
    quotient = narrowed(of("divide", V, S), result, [box, (0.1, 10.0)])[1]
    assert quotient == pytest.approx((4 / 3, 2.0))


def test_vectors_turned_onto_an_axis_keep_their_length():
    """A component of the result is then as long as the vector: nothing of that may be cut off."""
    rng = np.random.default_rng(5)
    for _ in range(200):
        target = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
        vector = rng.normal(size=3) * 10 ** rng.uniform(-3, 3)
        length = np.linalg.norm(vector)
        axis = np.cross(vector / length, target)
        turn = np.array([*axis, 1 + vector @ target / length])
        turn /= np.linalg.norm(turn)
        ends = [Bounds(part[np.newaxis], part[np.newaxis]) for part in (turn, vector)]
        found = TABLE["rotate"].bounds(None, *ends)
        assert np.all(found.lower <= length * target + 1e-15 * length)
        assert np.all(found.upper >= length * target - 1e-15 * length)


def test_lengths_of_extreme_vectors_are_right_among_usual_ones():
    rows = np.array([[3, 4, 0], [3e200, 4e200, 0], [3e-300, 0, 4e-300], [0, 0, 0], [1e308, 1e308, 0]])
    values, _ = values_of(of("norm", V), [rows])
    assert values.tolist() == pytest.approx([5, 5e200, 5e-300, 0, math.sqrt(2) * 1e308], rel=1e-15)
    for row, value in zip(rows, values, strict=True):
        assert values_of(of("norm", V), [row[np.newaxis]])[0][0] == value


def test_turns_that_undo_each_other_are_held_to_the_last_unit():
    """Their product is no turn but for rounding, by which a part of it may be larger than 1."""
    rng = np.random.default_rng(67)
    turns = rng.normal(size=(3000, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    back = turns * [-1, -1, -1, 1]
    values, _ = values_of(of("compose", Q, Q), [turns, back])
    assert (values[:, 3] > 1).any()
    known = TABLE["compose"].bounds(None, Bounds(turns, turns), Bounds(back, back))
    assert ((known.lower <= values) & (values <= known.upper)).all()
    ones = np.where(values[:, 3:] > 1, values, [0.0, 0.0, 0.0, 1.0])
    for name, payload in (("inverse", None), *(("quaternion", index) for index in range(4))):
        known = TABLE[name].bounds(payload, Bounds(ones, ones))
        found, _ = values_of(of(name, Q, payload=payload), [ones])
        assert ((known.lower <= found) & (found <= known.upper)).all()


WHOLE = [
    *("add", "subtract", "multiply", "floor divide", "modulo", "minimum", "maximum"),
    *("negative", "positive", "absolute", "int", "round", "float"),
]
HUGE_WHOLE = [sign * (2**bits + more) for bits in (52, 53, 54, 57, 60) for more in (-1, 0, 0, 1, 5) for sign in (1, -1)]  # fmt: skip


@each(WHOLE)
def test_whole_numbers_that_no_float_is_are_held_exactly(name):
    """Comparing Python's own numbers: as floats, a value outside could look like the end of its bounds."""
    rng = np.random.default_rng(71)
    operation, boxes_at_once = TABLE[name], 800

    def outward_boxes(ends):
        lower, upper = (np.array([float(pair[side]) for pair in ends]) for side in (0, 1))
        above = [end > pair[0] for end, pair in zip(lower.tolist(), ends, strict=True)]
        below = [end < pair[1] for end, pair in zip(upper.tolist(), ends, strict=True)]
        return Bounds(
            np.where(above, np.nextafter(lower, -np.inf), lower),
            np.where(below, np.nextafter(upper, np.inf), upper),
        )

    def number():
        return int(rng.choice(HUGE_WHOLE)) if rng.random() < 0.6 else int(rng.integers(-13, 14))

    operands = []
    for _ in range(2 if WHOLE.index(name) < 7 else 1):
        pairs = [sorted((number(), number())) for _ in range(boxes_at_once)]
        operands.append([pair if rng.random() < 0.5 else pair[:1] * 2 for pair in pairs])
    boxes = [outward_boxes(ends) for ends in operands]
    rows = [tuple(pair[int(rng.integers(2))] for pair in each) for each in zip(*operands, strict=True)]
    values = []
    for row in rows:
        try:
            values.append(operation.python(*row))
        except ArithmeticError:
            values.append(None)
    with np.errstate(all="ignore"):
        known = operation.bounds(None, *boxes)
        found = outward_boxes([(value or 0, value or 0) for value in values])
        parts = operation.inverse(None, found, *boxes) if operation.inverse is not None else ()
    for number_of_box, (row, value) in enumerate(zip(rows, values, strict=True)):
        if value is not None:
            held = [(known, value), *zip(parts, row, strict=False)]
            for bounds, inside in held:
                if bounds is not None:
                    low, high = bounds.lower[number_of_box].item(), bounds.upper[number_of_box].item()
                    assert low <= inside <= high, (row, value)
