"""The part of the cube to sample from."""

import itertools
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from scenic.graph.domain import Domain
from tests.each import each


def union(*boxes):
    corners = np.array(boxes, dtype=float)
    return Domain(corners[:, :, 0], corners[:, :, 1])


TWO = union([[0.0, 0.5], [0.0, 1.0]], [[0.5, 1.0], [0.75, 1.0]])


def place(domain: Domain, rows: np.ndarray) -> np.ndarray:
    """Points of the domain from rows of uniform numbers: one for each axis, after those that choose the boxes."""
    axes, parts = np.arange(domain.dimension), len(domain.parts)
    return domain.place(rows[:, parts:].T, axes, domain.choose(rows[:, :parts].T)).T


def test_the_whole_cube_leaves_points_as_they_are():
    rows = np.random.default_rng(0).random((10, 4))
    whole = Domain.whole(3)
    assert whole.volume == 1
    assert whole.is_whole
    assert (place(whole, rows) == rows[:, 1:]).all()


def test_one_box_is_filled_evenly():
    domain = union([[0.4, 1.0], [0.0, 0.25]])
    assert domain.volume == pytest.approx(0.15)
    points = place(domain, np.random.default_rng(1).random((5000, 3)))
    assert stats.kstest(points[:, 0], stats.uniform(0.4, 0.6).cdf).pvalue > 1e-4
    assert stats.kstest(points[:, 1], stats.uniform(0.0, 0.25).cdf).pvalue > 1e-4
    assert domain.contains(points).all()


def test_a_union_is_filled_evenly():
    """Points of the union are points of the cube conditioned to lie in it: cell by cell in proportion to volume."""
    assert TWO.volume == pytest.approx(0.625)
    points = place(TWO, np.random.default_rng(2).random((8000, 3)))
    assert TWO.contains(points).all()
    cells = np.floor(points * 4).astype(int) @ [4, 1]
    counts = np.bincount(cells, minlength=16)
    possible = np.array([0, 1, 2, 3, 4, 5, 6, 7, 11, 15])
    assert counts.sum() == counts[possible].sum()
    assert stats.chisquare(counts[possible]).pvalue > 1e-4


def test_rows_are_placed_one_by_one():
    rows = np.random.default_rng(3).random((512, 3))
    whole = place(TWO, rows)
    for size in (1, 7):
        for start in range(0, 70, size):
            part = place(TWO, rows[start : start + size])
            assert part.tobytes() == whole[start : start + size].tobytes()
    spaced = np.zeros((512, 6))
    spaced[:, ::2] = rows
    assert place(TWO, spaced[:, ::2]).tobytes() == whole.tobytes()


corner = st.floats(0, 1)


@given(st.lists(st.tuples(corner, corner), min_size=1, max_size=4), st.floats(5e-324, 1 - 2.0**-53))
def test_points_stay_inside(box, u):
    """Also where a box touches the ends of the unit interval or is as thin as a float allows."""
    box = [(min(pair), max(pair)) for pair in box]
    if any(low == high for low, high in box):
        return
    domain = union(box)
    points = place(domain, np.full((1, 1 + len(box)), u))
    assert domain.contains(points).all()
    assert ((points > 0) & (points < 1)).all()


@pytest.mark.parametrize("domain", [union([[0.5, 1.0]]), TWO])
def test_no_point_rounds_to_the_end_of_the_cube(domain):
    """The middle between the last number below 1 and 1 itself would round up."""
    last = np.nextafter(1, 0)
    rows = np.array([[last] * (domain.dimension + 1)])
    assert (place(domain, rows) < 1).all()


def test_many_axes_do_not_underflow():
    lower, upper = np.zeros((2, 3000)), np.full((2, 3000), 0.5)
    lower[1, 0], upper[1, 0] = 0.5, 0.75
    domain = Domain(lower, upper)
    points = place(domain, np.random.default_rng(4).random((600, 3001)))
    assert 0.28 < (points[:, 0] > 0.5).mean() < 0.39


PRODUCT = Domain(
    *(np.pad(ends, ((0, 0), (0, 2)), constant_values=end) for end, ends in enumerate((TWO.lower, TWO.upper))),
    (
        Domain(
            *(
                np.pad(ends, ((0, 0), (2, 0)), constant_values=end)
                for end, ends in enumerate((TWO.lower, TWO.upper))
            )
        ),
    ),
)
"""The same union of the first two axes and, by itself, of the last two."""


def test_a_product_of_unions():
    """Each factor is filled as if it were alone, and independently."""
    assert PRODUCT.volume == pytest.approx(0.625**2)
    assert not PRODUCT.is_whole
    rows = np.random.default_rng(6).random((8000, 6))
    points = place(PRODUCT, rows)
    assert PRODUCT.contains(points).all()
    for first in (0, 2):
        alone = place(TWO, rows[:, [first // 2, first + 2, first + 3]])
        assert points[:, first : first + 2].tobytes() == alone.tobytes()
        outside = points.copy()
        outside[:, first : first + 2] = 0.7, 0.5
        assert not PRODUCT.contains(outside).any()
    chosen = PRODUCT.choose(rows[:, :2].T)
    for axis in range(4):
        each = PRODUCT.place_each(rows[:, 2 + axis], np.full(8000, axis), chosen)
        assert each.tobytes() == points[:, axis].tobytes()


UPPER_ENDS = union([[0.0, 0.25], [0.0, 0.5], [0.5, 1.0]], [[0.25, 1.0], [0.0, 1.0], [0.5, 1.0]])
"""Boxes that differ in where the second axis ends alone, and share the third."""


@each([TWO, PRODUCT, UPPER_ENDS, union([[0.5, 1.0], [0.0, 1.0], [0.25, 0.5]])])
def test_some_axes_in_any_order_are_placed_as_all_are(domain: Domain) -> None:
    """What is drawn together, or later, or one of several axes in each lane: each number depends on its axis and lane alone."""
    rng = np.random.default_rng(7)
    count = domain.dimension
    numbers, chosen = rng.random((count, 40)), domain.choose(rng.random((len(domain.parts), 40)))
    together = domain.place(numbers, np.arange(count), chosen)
    assert domain.contains(together.T).all()
    for size in range(1, count + 1):
        for axes in itertools.permutations(range(count), size):
            some = np.array(axes)
            assert domain.place(numbers[some], some, chosen).tobytes() == together[some].tobytes()
    each, lanes = rng.integers(0, count, 40), np.arange(40)
    found = domain.place_each(numbers[each, lanes], each, chosen)
    assert found.tobytes() == together[each, lanes].tobytes()


def test_placing_leaves_the_numbers_as_they_were() -> None:
    for domain in (TWO, PRODUCT):
        numbers = np.random.default_rng(8).random((domain.dimension, 5))
        before, chosen = numbers.copy(), np.zeros((len(domain.parts), 5), dtype=np.intp)
        domain.place(numbers, np.arange(domain.dimension), chosen)
        domain.place_each(numbers[0], np.zeros(5, dtype=np.intp), chosen)
        assert (numbers == before).all()


def test_a_product_whose_first_factor_is_whole_is_not_whole() -> None:
    """It has the volume of the others, and to data it comes back."""
    domain = Domain(np.zeros((1, 2)), np.ones((1, 2)), (TWO,))
    assert not domain.is_whole
    assert domain.volume == TWO.volume
    assert Domain(np.zeros((1, 2)), np.ones((1, 2)), (Domain.whole(2),)).is_whole
    again = Domain.from_data(domain.to_data())
    assert again.volume == TWO.volume
    outside = np.array([[0.7, 0.5], [0.7, 0.8]])
    assert domain.contains(outside).tolist() == again.contains(outside).tolist() == [False, True]


def test_two_factors_of_one_axis_are_refused():
    with pytest.raises(ValueError, match="two factors narrow one axis"):
        Domain(TWO.lower, TWO.upper, (TWO,))


def test_plain_data_round_trip():
    again = Domain.from_data(json.loads(json.dumps(PRODUCT.to_data())))
    assert [part.lower.tobytes() for part in again.parts] == [part.lower.tobytes() for part in PRODUCT.parts]
    assert [part.upper.tobytes() for part in again.parts] == [part.upper.tobytes() for part in PRODUCT.parts]
    for domain in (TWO, Domain.whole(4), union([[0.1, 0.30000000000000004]])):
        data = json.loads(json.dumps(domain.to_data()))
        again = Domain.from_data(data)
        assert again.lower.tobytes() == domain.lower.tobytes()
        assert again.upper.tobytes() == domain.upper.tobytes()
    assert TWO.to_data()["boxes"][0] == {"0": [0.0, 0.5]}


@each(
    [
        {},
        {"dimension": 1, "boxes": []},
        {"dimension": 1, "boxes": [{"5": [0, 1]}]},
        {"dimension": 1, "boxes": [{"0": [1, 0]}]},
        {"dimension": 1, "boxes": [[0, 1]]},
        {"dimension": 1, "boxes": [{"first": [0, 1]}]},
        {"dimension": 1, "boxes": [{"0": [0, 0.5, 1]}]},
        {"dimension": 1, "boxes": [{}], "factors": [[1]]},
        {"dimension": 1, "boxes": 3},
        {"dimension": None, "boxes": [{}]},
        {"dimension": 2, "boxes": [{"0": [0, 0.5]}], "factors": [[{"0": [0, 0.5]}]]},
        [],
    ]
)
def test_bad_data_is_refused(data):
    with pytest.raises(ValueError):  # noqa: PT011 - the messages differ
        Domain.from_data(data)


@each([[[0.5, 0.5]], [[-0.1, 1.0]], [[0.0, 1.1]], [[0.0, float("nan")]]])
def test_boxes_without_volume_are_refused(box):
    with pytest.raises(ValueError, match="volume"):
        union(box)


@pytest.mark.parametrize("end", [0, 1])
def test_boxes_that_differ_at_one_end_alone(end):
    """An axis whose lower, or whose upper, corners are the same in all boxes."""
    corners = np.zeros((3, 2)), np.ones((3, 2))
    corners[end][:, 0] = (0.2, 0.4, 0.6)
    corners[0][:, 1], corners[1][:, 1] = (0.0, 0.3, 0.7), (0.3, 0.7, 1.0)
    domain = Domain(*corners)
    rows = np.random.default_rng(8).random((500, 3))
    points = place(domain, rows)
    assert domain.contains(points).all()
    (chosen,) = domain.choose(rows[:, :1].T)
    assert set(chosen.tolist()) == {0, 1, 2}
    for axis in range(2):
        low, high = (ends[chosen, axis] for ends in corners)
        assert points[:, axis] == pytest.approx(low + (high - low) * rows[:, 1 + axis], abs=1e-15)


def test_a_factor_alone_may_narrow():
    """The first factor is the whole cube, and what is left is not."""
    domain = Domain(np.zeros((1, 2)), np.ones((1, 2)), (TWO,))
    assert not domain.is_whole
    assert domain.volume == pytest.approx(0.625)
    assert Domain(np.zeros((1, 2)), np.ones((1, 2)), (Domain.whole(2),)).is_whole


@pytest.mark.parametrize(("low", "high"), [(0.5, 1.0), (0.0, 0.5), (0.25, 0.5)])
def test_one_end_is_enough_to_narrow_an_axis(low, high):
    part = union([[low, high]])
    with pytest.raises(ValueError, match="two factors narrow one axis"):
        Domain(part.lower, part.upper, (part,))


def test_an_axis_that_some_boxes_of_a_factor_narrow_is_placed_in_these():
    part = union([[0, 0.25], [0, 1]], [[0.25, 1], [0.5, 1]])
    domain = Domain(np.zeros((1, 2)), np.ones((1, 2)), (part,))
    points = place(domain, np.random.default_rng(7).random((4000, 4)))
    assert part.contains(points).all()
    assert np.mean(points[:, 0] < 0.25) == pytest.approx(0.25 / 0.625, abs=0.03)


def test_plain_data_hold_what_is_narrowed_alone():
    """The ends of an axis where either is not that of the cube, and factors where there are any."""
    part = union([[0, 0.25], [0, 1], [0.5, 1]], [[0.25, 1], [0.5, 0.75], [0, 1]])
    boxes = [{"0": [0.0, 0.25], "2": [0.5, 1.0]}, {"0": [0.25, 1.0], "1": [0.5, 0.75]}]
    assert part.to_data() == {"dimension": 3, "boxes": boxes}
    whole = Domain(np.zeros((1, 3)), np.ones((1, 3)), (part,))
    assert whole.to_data() == {"dimension": 3, "boxes": [{}], "factors": [boxes]}
    assert Domain.whole(2).to_data() == {"dimension": 2, "boxes": [{}]}


@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        (np.zeros(2), np.ones(2)),
        (np.zeros((1, 2)), np.ones((2, 2))),
        (np.zeros((1, 2)), np.ones((1, 3))),
        (np.zeros((0, 2)), np.ones((0, 2))),
    ],
)
def test_corners_are_of_the_same_boxes(lower, upper):
    with pytest.raises(ValueError, match="not boxes: corners of shapes"):
        Domain(lower, upper)


@pytest.mark.parametrize("axis", ["-1", "2"])
def test_axes_that_the_cube_does_not_have_are_refused(axis):
    with pytest.raises(ValueError, match="not a domain"):
        Domain.from_data({"dimension": 2, "boxes": [{axis: [0.25, 0.5]}]})


def test_one_bad_box_among_good_ones_is_refused():
    for box in ([0.5, 0.5], [0.6, 0.4], [-0.5, 0.5], [0.5, 1.5]):
        for place in range(2):
            boxes = [[[0.0, 0.25]]]
            boxes.insert(place, [box])
            with pytest.raises(ValueError, match="volume"):
                union(*boxes)


def test_the_outermost_numbers_choose_the_outermost_boxes():
    """Shares are rounded: their sum may lie below the largest number that is drawn."""
    first, last = np.nextafter(0.0, 1.0), np.nextafter(1.0, 0.0)
    below = 0
    for seed in range(30):
        widths = np.random.default_rng(seed).random((200, 1)) / 1000
        lower = np.linspace(0, 0.9, 200)[:, np.newaxis]
        domain = Domain(lower, lower + widths)
        below += bool(domain._shares()[-1] < last)
        assert domain.choose(np.array([[first, last]])).tolist() == [[0, 199]]
    assert below


@pytest.mark.parametrize("larger", [0, 1])
def test_boxes_of_very_different_volume(larger):
    """Of many axes: one is no more than a point beside the other, and neither volume is a float."""
    lower, upper = np.zeros((2, 4000)), np.full((2, 4000), 0.5)
    lower[1, 0], upper[1, 0] = 0.5, 1.0
    upper[1 - larger, 1:] = 0.25
    domain = Domain(lower, upper)
    draws = np.array([[np.nextafter(0.0, 1.0), 0.25, 0.5, 0.999, np.nextafter(1.0, 0.0)]])
    assert set(domain.choose(draws)[0, 1:-1].tolist()) == {larger}
    assert domain.volume >= 0
