"""Values that some choice of different labels has, against trying all choices."""

from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scenic.analysis.finite.matching import matchable

LABELS = st.lists(st.lists(st.integers(0, 5), min_size=1, max_size=4), min_size=1, max_size=5)


@given(LABELS)
def test_a_value_is_left_if_and_only_if_some_choice_has_it(labels: list[list[int]]) -> None:
    choices = [
        places
        for places in product(*(range(len(mine)) for mine in labels))
        if len({mine[place] for mine, place in zip(labels, places, strict=True)}) == len(labels)
    ]
    left = matchable({number: np.array(mine) for number, mine in enumerate(labels)})
    if left is None:
        assert not choices
        return
    for number, mine in enumerate(labels):
        assert left[number].tolist() == [
            any(places[number] == place for places in choices) for place in range(len(mine))
        ]
