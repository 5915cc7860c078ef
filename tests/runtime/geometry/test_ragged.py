"""Groups of different lengths against loops and NumPy's `unique`."""

import numpy as np
import pytest

from scenic.runtime.geometry.ragged import distinct, expand, first_of_each, group_starts, pieces, rows


@pytest.mark.parametrize("count", [0, 1, 2, 17, 5000])
@pytest.mark.parametrize("kinds", [1, 3, 4000])
def test_first_and_different_numbers(count: int, kinds: int) -> None:
    keys = np.random.default_rng(count + kinds).integers(0, kinds, count)
    expected, first = np.unique(keys, return_index=True)
    np.testing.assert_array_equal(distinct(keys), expected)
    np.testing.assert_array_equal(first_of_each(keys), first)
    np.testing.assert_array_equal(distinct(np.stack([keys, keys[::-1]])), expected)
    ordered = np.sort(keys)
    starts = group_starts(ordered, kinds)
    assert len(starts) == kinds + 1
    for group in range(min(kinds, 50)):
        assert (ordered[starts[group] : starts[group + 1]] == group).all()
    np.testing.assert_array_equal(np.diff(starts), np.bincount(keys, minlength=kinds))


@pytest.mark.parametrize("counts", [[], [0], [3], [0, 2, 0, 0, 5, 1, 0], [1] * 9, [40, 1, 1, 90, 0, 2]])
def test_members_of_groups_and_pieces_of_them(counts: list[int]) -> None:
    numbers = np.array(counts, dtype=np.intp)
    owner, offset = expand(numbers)
    pairs = [(group, member) for group, many in enumerate(counts) for member in range(many)]
    assert list(zip(owner.tolist(), offset.tolist(), strict=True)) == pairs
    for most in (1, 3, 10, 1000):
        parts = list(pieces(numbers, most))
        assert [index for part in parts for index in range(part.start, part.stop)] == list(range(len(counts)))
        for part in parts:
            assert part.stop - part.start == 1 or numbers[part].sum() <= most
        if most == 1000:
            assert len(parts) <= 1


def test_slices_of_rows() -> None:
    for count, width, most in ((0, 3, 10), (10, 3, 10), (7, 100, 10), (9, 0, 4), (12, 4, 48)):
        parts = list(rows(count, width, most))
        assert [index for part in parts for index in range(part.start, part.stop)] == list(range(count))
        assert all((part.stop - part.start) * width <= max(most, width) for part in parts)
    assert len(list(rows(12, 4, 48))) == 1
    assert len(list(rows(12, 4, 47))) == 2
