"""Pairs of boxes that meet, against all pairs compared."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scenic.runtime.geometry.flat.near_boxes import near_boxes, tree_of_boxes

NUMBERS = st.integers(0, 6)
BOXES = st.lists(st.tuples(NUMBERS, NUMBERS, st.integers(0, 2)), min_size=1, max_size=6)


@given(BOXES, BOXES, st.integers(1, 4))
def test_all_pairs_that_meet_are_given_in_order(
    known: list[tuple[int, ...]], asked: list[tuple[int, ...]], again: int
) -> None:
    here, there = np.array(known, dtype=float), np.repeat(np.array(asked, dtype=float), again, axis=0)
    tree = tree_of_boxes(here[:, :2], here[:, :2] + 1)
    found = near_boxes(tree, there[:, :2], there[:, :2] + there[:, 2:])
    meets = (there[:, None, :2] <= here[:, :2] + 1) & (here[:, :2] <= (there[:, :2] + there[:, 2:])[:, None])
    expected = np.nonzero(meets.all(axis=2))
    assert [part.tolist() for part in found] == [part.tolist() for part in expected]
