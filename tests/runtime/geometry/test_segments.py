"""Chains of segments: which segment counts where several are as near, however many there are."""

import numpy as np
import pytest
import shapely

from scenic.graph import quaternions
from scenic.runtime.geometry.flat import segments
from scenic.runtime.geometry.flat.segments import Lines, Segments

FEW_AND_MANY = (7, 95, 96, 97, 128, 400)
"""Long lines are asked through a tree."""


def ring(count: int, turn: float = 0.0) -> np.ndarray:
    """The corners of a regular polygon, the first of them at the end, too."""
    angle = 2 * np.pi * np.arange(count) / count + turn
    corners = np.stack([7 * np.cos(angle), 7 * np.sin(angle), 0 * angle], axis=1)
    return np.concatenate([corners, corners[:1]])


@pytest.mark.parametrize("count", FEW_AND_MANY)
@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
def test_where_segments_meet_the_first_one_counts_also_where_a_line_closes(count: int, turn: float) -> None:
    corners = ring(count, turn)
    line = Segments.of_chains([corners])
    for share in (1.0, 1.0001, 1.7, 30.0):  # beside a corner all are as near whose corner it is
        _, number, place = line.nearest(corners[:-1] * share)
        np.testing.assert_array_equal(number, np.maximum(np.arange(count) - 1, 0))
        np.testing.assert_allclose(place, corners[:-1], atol=1e-12)
    # In the middle of a segment no other is as near.
    middles = (corners[1:] + corners[:-1]) / 2
    for share in (1.0, 1.3):
        np.testing.assert_array_equal(line.nearest(middles * share)[1], np.arange(count))


@pytest.mark.parametrize("count", FEW_AND_MANY)
def test_where_chains_cross_the_first_one_counts(count: int) -> None:
    """Chains that all begin, or all end, at one place; before them one that only passes it by."""
    tips = ring(count)[:-1]
    passing = [(1.0, 0, 9), (2.0, 0, 9)]
    for chains in ([[(0, 0, 0), tip] for tip in tips], [[tip, (0, 0, 0)] for tip in tips]):
        line = Segments.of_chains([passing, *chains])
        for above in (0.0, 1e-3, 2.0):
            distance, number, _ = line.nearest(np.array([[0.0, 0, above]]))
            assert distance[0] == above
            assert number[0] == 1


@pytest.mark.parametrize("count", FEW_AND_MANY)
def test_nearest_points_of_lines(count: int) -> None:
    rng = np.random.default_rng(count)
    chain = rng.normal(size=(count + 1, 2)).cumsum(axis=0)
    line = Segments.of_chains([np.column_stack([chain, np.zeros(count + 1)])])
    points = np.concatenate([rng.uniform(chain.min(), chain.max(), (150, 2)), chain])
    distance, number, place = line.nearest(np.column_stack([points, np.zeros(len(points))]))
    expected = shapely.LineString(chain).distance(shapely.points(points))
    np.testing.assert_allclose(distance, expected, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(place[:, :2] - points, axis=1), expected, atol=1e-12)
    pieces = shapely.linestrings(np.stack([chain[:-1], chain[1:]], axis=1)[number])
    np.testing.assert_allclose(shapely.distance(pieces, shapely.points(points)), expected, atol=1e-12)


@pytest.mark.parametrize("count", [3, 130])
def test_at_a_joint_the_segment_before_it_counts(count: int) -> None:
    """As for the nearest segment. Before the beginning it is the first segment, behind the end the last one."""
    corners = np.column_stack([np.arange(count + 1.0), np.zeros((count + 1, 2))])
    line = Segments.of_chains([corners, corners + 5])  # the way between the chains is none of the line
    ways = np.arange(2 * count + 1.0)
    number = np.concatenate([[0], np.arange(2 * count)])
    np.testing.assert_array_equal(line.number_at(ways), number)
    np.testing.assert_array_equal(line.at(ways)[1:], line.ends)
    np.testing.assert_array_equal(line.at(ways)[0], corners[0])
    np.testing.assert_array_equal(line.number_at(np.array([-3.0, 2 * count + 3])), [0, 2 * count - 1])
    np.testing.assert_array_equal(line.at(np.array([-3.0, 2 * count + 3])), [corners[0], corners[-1] + 5])
    np.testing.assert_allclose(line.at(ways[1:] - 0.25)[:, 0], line.ends[:, 0] - 0.25)
    assert line.length == 2 * count


def test_zeros_of_either_sign_are_one_place() -> None:
    line = Segments.of_chains([[(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (-0.0, 0, -0.0)]])
    assert line.nearest(np.array([[-0.5, 0.0, 0], [-0.5, -0.5, 0]]))[1].tolist() == [0, 0]


def test_lines_straight_up_and_down_have_no_yaw() -> None:
    line = Segments.of_chains([[(0, 0, 0), (0, 0, 2)], [(3, 0, 2), (3, 0, 0)], [(0, 0, 0), (0, -2, 0)]])
    ahead = quaternions.rotate(line.frames, [0, 1, 0])
    np.testing.assert_allclose(ahead, [(0, 0, 1), (0, 0, -1), (0, -1, 0)], atol=1e-15)
    right = quaternions.rotate(line.frames, [1, 0, 0])
    np.testing.assert_allclose(right, [(1, 0, 0), (1, 0, 0), (-1, 0, 0)], atol=1e-15)


def test_more_pairs_than_are_looked_at_together(monkeypatch: pytest.MonkeyPatch) -> None:
    line = Segments.of_chains([ring(7)])
    points = np.random.default_rng(2).uniform(-9, 9, (50, 3))
    expected = line.nearest(points)
    for together in (1, 7, 60, 349):
        monkeypatch.setattr(segments, "CHUNK", together)
        for found, known in zip(line.nearest(points), expected, strict=True):
            np.testing.assert_array_equal(found, known)


def test_boxes_hold_the_parts_of_lines_between_two_lengths() -> None:
    random = np.random.default_rng(3)
    parts = [
        Segments.of_chains([random.normal(size=(count, 3)).tolist() for count in counts])
        for counts in ((5, 2, 9), (2,), (4, 3))
    ]
    lines = Lines(tuple(parts))
    which = random.integers(0, 3, 600)
    ends = np.sort(random.random((2, 600)), axis=0)
    ends[:, :9] = [[0.0] * 9, [0.0, 1.0, 0.5] * 3]
    ends *= lines.lengths[which]
    lower, upper = lines.boxes_between(which, *ends)
    for number, line in enumerate(parts):
        mine = which == number
        first, last = ends[:, mine]
        for share in random.random(50):
            points = line.at(first + share * (last - first))
            assert (lower[mine] - 1e-12 <= points).all()
            assert (points <= upper[mine] + 1e-12).all()
    # Short parts have small boxes: no vertex is counted that a part does not pass.
    assert (upper - lower).max(axis=1)[ends[1] - ends[0] < 1e-3].max(initial=0) < 1e-2


def test_points_in_a_box_are_uniform_on_the_parts_within_it() -> None:
    line = Segments.of_chains([[(0, 0, 0), (10, 0, 0), (10, 10, 0)], [(-5, 2, 0), (20, 2, 0)]])
    lower, upper = np.array([[6.0, -1.0, -1.0]]), np.array([[12.0, 3.0, 1.0]])
    numbers = (np.arange(2000) + 0.5) / 2000
    points, there = line.at_in(numbers, lower.repeat(2000, axis=0), upper.repeat(2000, axis=0))
    assert there.all()
    assert ((lower - 1e-6 <= points) & (points <= upper + 1e-6)).all()
    # 4 m of the first segment, 3 m of the second, 6 m of the line across.
    on_first, across = (
        np.isclose(points[:, 1], 0),
        np.isclose(points[:, 1], 2) & ~np.isclose(points[:, 0], 10),
    )
    assert on_first.mean() == pytest.approx(4 / 13, abs=0.01)
    assert across.mean() == pytest.approx(6 / 13, abs=0.01)
    assert np.sort(points[on_first, 0]) == pytest.approx(np.linspace(6, 10, on_first.sum()), abs=0.02)
    alone, _ = line.at_in(numbers[7:8], lower, upper)
    assert (alone[0] == points[7]).all()
    assert not line.at_in(numbers[:1], lower + 100, upper + 100)[1].any()
