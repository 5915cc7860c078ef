"""Every source of random numbers: what some lanes get, alone and in company, by one address and by many."""

from collections.abc import Callable

import numpy as np
import pytest

from scenic.graph.draws import (
    BOX,
    Counter,
    LaneOwners,
    NumberSource,
    Points,
    box_addresses,
    open_unit,
    words_of,
)
from scenic.graph.node import Graph, axis
from scenic.graph.points import GivenPoints, PointSet, Sobol
from scenic.runtime.sampling.point_set_draws import driven

COUNT = 7
AXES = [axis(place=number) for number in (11, 12, 13)]
GRAPH = Graph(AXES)
OWN = [GRAPH.address(node) for node in AXES]
ADDRESSES = np.array([*OWN, 99, 5], dtype=np.uint64)
"""Those of the graph, and two that are not in it."""


def lanes() -> LaneOwners:
    """Lanes of two seeds, of scenes and attempts that are not in order."""
    parts = [LaneOwners.of(number % 2, 3 + 5 * number % 7, number // 3) for number in range(COUNT)]
    columns = ("seeds", "scenes", "attempts", "keys")
    return LaneOwners(*(np.concatenate([getattr(part, name) for part in parts]) for name in columns))


def given() -> Points:
    rng = np.random.default_rng(2)
    words = {int(ADDRESSES[3]): rng.integers(0, 2**63, COUNT).astype(np.uint64)}
    return Points({int(OWN[1]): rng.random(COUNT), 5: rng.random(COUNT)}, Counter(lanes().keys), words)


def of_points(points: PointSet) -> Callable[[], NumberSource]:
    return lambda: driven(points, GRAPH)(lanes())


SOURCES: dict[str, Callable[[], NumberSource]] = {
    "hash": lambda: Counter(lanes().keys),
    "points": given,
    "Sobol": of_points(Sobol()),
    "rows": of_points(GivenPoints(np.random.default_rng(4).random((20, 3)))),
    "rows of two axes": of_points(GivenPoints(np.random.default_rng(4).random((20, 2)))),
}


@pytest.mark.parametrize("name", SOURCES)
def test_some_lanes_get_what_they_get_among_all(name: str) -> None:
    source = SOURCES[name]()
    assert len(source) == COUNT
    numbers, words = source.uniforms(ADDRESSES), source.words(ADDRESSES)
    assert numbers.shape == words.shape == (len(ADDRESSES), COUNT)
    assert ((numbers > 0) & (numbers < 1)).all()
    assert len(np.unique(words)) == words.size
    for some in ([4, 1, 6], [2], list(range(COUNT))[::-1], []):
        part = source.take(np.array(some, dtype=np.intp))
        assert len(part) == len(some)
        np.testing.assert_array_equal(part.uniforms(ADDRESSES), numbers[:, some])
        np.testing.assert_array_equal(part.words(ADDRESSES), words[:, some])
        if len(some) == 3:
            again = part.take(np.array([2, 0], dtype=np.intp))
            np.testing.assert_array_equal(again.uniforms(ADDRESSES), numbers[:, [6, 4]])
            np.testing.assert_array_equal(again.words(ADDRESSES), words[:, [6, 4]])


@pytest.mark.parametrize("name", SOURCES)
def test_an_address_in_each_lane(name: str) -> None:
    source = SOURCES[name]()
    which = np.array([0, 3, 1, 1, 4, 2, 0])
    np.testing.assert_array_equal(
        source.uniform_each(ADDRESSES[which]), source.uniforms(ADDRESSES)[which, np.arange(COUNT)]
    )


def test_the_hash_is_that_of_key_and_address_alone() -> None:
    keys = lanes().keys
    found = Counter(keys).words(ADDRESSES)
    for row, address in enumerate(ADDRESSES):
        for lane, key in enumerate(keys):
            alone = words_of(np.array([key]), np.array([address]))
            assert alone[0, 0] == found[row, lane]
            assert open_unit(alone)[0, 0] == Counter(keys).uniforms(ADDRESSES)[row, lane]


def test_given_numbers_and_words_are_those_of_their_addresses() -> None:
    source, hashed = given(), Counter(lanes().keys)
    rng = np.random.default_rng(2)
    words, first, last = rng.integers(0, 2**63, COUNT).astype(np.uint64), rng.random(COUNT), rng.random(COUNT)
    numbers = hashed.uniforms(ADDRESSES)
    numbers[1], numbers[4] = first, last
    np.testing.assert_array_equal(source.uniforms(ADDRESSES), numbers)
    expected = hashed.words(ADDRESSES)
    expected[3] = words
    np.testing.assert_array_equal(source.words(ADDRESSES), expected)


def test_each_factor_of_a_domain_is_chosen_by_a_draw_of_its_own() -> None:
    several = box_addresses(5).tolist()
    assert len({*several, *ADDRESSES.tolist()}) == 5 + len(ADDRESSES)
    for parts in range(1, 5):  # further factors leave the choices of the first ones as they are
        assert box_addresses(parts).tolist() == several[:parts]


def test_rows_are_by_scene_and_the_rest_is_hashed() -> None:
    rows = np.random.default_rng(4).random((20, 2))
    source, who = driven(GivenPoints(rows), GRAPH)(lanes()), lanes()
    found = source.uniforms(ADDRESSES)
    np.testing.assert_array_equal(found[:2], rows[who.scenes].T)
    np.testing.assert_array_equal(found[2:], Counter(who.keys).uniforms(ADDRESSES)[2:])
    np.testing.assert_array_equal(source.words(ADDRESSES), Counter(who.keys).words(ADDRESSES))


def test_the_first_choice_among_boxes_is_a_number_of_the_row() -> None:
    points, who = Sobol(), lanes()
    where = np.array([OWN[2], BOX, BOX + 1], dtype=np.uint64)
    found = driven(points, GRAPH)(who).uniforms(where)
    np.testing.assert_array_equal(found[:2], points.of_scenes(np.array([2, -1]), len(OWN), who))
    np.testing.assert_array_equal(found[2:], Counter(who.keys).uniforms(where[2:]))
