"""Sobol's sequence beside SciPy's own, the laws of its scrambling, and points that are given."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chisquare, kstest, qmc

from scenic.graph.draws import LaneOwners
from scenic.graph.points import GivenPoints, Sobol

FALSE_ALARM = 1e-6


def lanes(count: int, *, seed: int = 0, first: int = 0, attempt: int = 0) -> LaneOwners:
    parts = [LaneOwners.of(seed, first + k, attempt) for k in range(count)]
    columns = ("seeds", "scenes", "attempts", "keys")
    return LaneOwners(*(np.concatenate([getattr(part, name) for part in parts]) for name in columns))


def rows(count: int, dimensions: int, **options: int) -> NDArray[np.float64]:
    return Sobol().of_scenes(np.arange(dimensions), dimensions, lanes(count, **options)).T


@pytest.mark.parametrize("seed", range(3))
def test_scrambled_rows_are_as_evenly_spread_as_the_sequence(seed: int) -> None:
    """Owen's scrambling keeps elementary intervals: each cell of a grid of 2**m rows holds one row."""
    found = rows(1024, 6, seed=seed)
    for first in range(5):
        pair = found[:, [first, first + 1]]
        assert qmc.discrepancy(pair) < 0.05 * qmc.discrepancy(np.random.default_rng(seed).random((1024, 2)))
    for column in found.T:
        assert len(np.unique(np.floor(column * 1024))) == 1024


def places_of_difference(numbers: NDArray[np.float64]) -> NDArray[np.int64]:
    """For each two rows, by columns, how many of 20 bits are left where they first differ."""
    bits = np.floor(numbers * 2**20).astype(np.int64)
    return np.frexp((bits[:, np.newaxis] ^ bits).astype(np.float64))[1].astype(np.int64)


@pytest.mark.parametrize("first", [0, 700])
def test_rows_are_those_of_the_sequence_but_for_the_scrambling(first: int) -> None:
    """Nested scrambling turns bits by the bits before them: where two numbers first differ, those of the sequence do."""
    count, attempt = 3, 2
    sobol, who = Sobol(), lanes(128, first=first, attempt=attempt)
    sequence = qmc.Sobol(2 * 512 * 3 + 2, scramble=False, bits=20)
    plain = (sequence.fast_forward(first) if first else sequence).random(128)
    scenes = sobol.of_scenes(np.arange(-1, count), count, who)
    draws = np.array([0, 5, 511])
    simulations = sobol.of_simulations(draws, count, who)
    for found, columns in (
        (scenes, 2 * ((count + 1) * attempt + np.arange(count + 1))),
        (simulations, 2 * (512 * attempt + draws) + 1),
    ):
        np.testing.assert_array_equal(places_of_difference(found.T), places_of_difference(plain[:, columns]))


def test_a_number_has_the_uniform_law_whatever_its_row() -> None:
    """Over seeds: a row of a scrambled sequence is a point like any other."""
    found = np.array([rows(1, 2, seed=seed, first=5)[0] for seed in range(3000)])
    for column in found.T:
        assert kstest(column, "uniform").pvalue > FALSE_ALARM
    cells = np.floor(found * 5) @ [5, 1]
    assert chisquare(np.bincount(cells.astype(int), minlength=25)).pvalue > FALSE_ALARM


def test_candidates_seeds_and_simulations_are_independent() -> None:
    sobol, scenes, again = Sobol(), lanes(1024), lanes(1024, attempt=1)
    axis = np.array([0])
    columns = [
        sobol.of_scenes(axis, 1, scenes)[0],
        sobol.of_scenes(axis, 1, again)[0],
        sobol.of_scenes(axis - 1, 1, scenes)[0],
        sobol.of_simulations(axis, 1, scenes)[0],
        sobol.of_simulations(axis, 1, again)[0],
    ]
    for place, one in enumerate(columns):
        for other in columns[:place]:
            # Jointly even, too: what is drawn when the first candidate was rejected depends in no way on why.
            cells = np.floor(one * 4) * 4 + np.floor(other * 4)
            assert np.bincount(cells.astype(int), minlength=16).tolist() == pytest.approx([64] * 16, abs=24)
    other_seed = sobol.of_scenes(axis, 1, lanes(1024, seed=1))[0]
    assert not np.array_equal(columns[0], other_seed)


def test_rows_do_not_depend_on_company() -> None:
    sobol, axes = Sobol(), np.arange(40)
    whole = sobol.of_scenes(axes, 40, lanes(300))
    alone = Sobol().of_scenes(np.array([39, 3]), 40, lanes(1, first=250))
    assert alone.tolist() == whole[[39, 3], 250:251].tolist()
    late = sobol.of_scenes(axes[:2], 40, lanes(2, first=2**20 - 1))
    assert len(np.unique(late)) == 4
    assert Sobol().of_scenes(axes[:2], 40, lanes(1, first=2**20))[:, 0].tolist() == late[:, 1].tolist()


def test_what_has_no_dimension_is_left_to_others() -> None:
    found = Sobol().of_scenes(np.array([0, 8000]), 10_000, lanes(1, attempt=1))
    assert np.isnan(found).tolist() == [[False], [True]]
    draws = Sobol().of_simulations(np.array([0, 511, 512]), 10_000, lanes(1))
    assert np.isnan(draws).tolist() == [[False], [False], [True]]


def test_given_points() -> None:
    points = GivenPoints([[0.1, 0.2], [0.3, 0.4]])
    assert points.of_scenes(np.array([1, 0]), 2, lanes(2)).tolist() == [[0.2, 0.4], [0.1, 0.3]]
    assert points.of_simulations(np.array([0]), 1, lanes(2)).tolist() == [[0.2, 0.4]]
    assert np.isnan(points.of_simulations(np.array([1]), 1, lanes(2))).all()
    assert np.isnan(points.of_scenes(np.array([-1]), 2, lanes(2))).all()
    # What belongs to the draws of simulations is none of the scene's, however many numbers a scene asks for.
    found = points.of_scenes(np.array([0, 1, 2]), 1, lanes(2))
    assert found[0].tolist() == [0.1, 0.3]
    assert np.isnan(found[1:]).all()
    assert len(points) == 2
    with pytest.raises(IndexError, match="no row for scene 2: 2 rows"):
        points.of_scenes(np.array([0]), 1, lanes(3))
    for wrong in ([[0.0]], [[1.0]], [[float("nan")]], [[[0.5]]]):
        with pytest.raises(ValueError, match="between 0 and 1"):
            GivenPoints(wrong)


def test_no_two_draws_have_a_dimension_in_common() -> None:
    """Axes, the choice of a box and draws of simulations, over several attempts."""
    sobol, count = Sobol(), 3
    numbers = [
        column
        for attempt in range(3)
        for column in (
            *sobol.of_scenes(np.arange(-1, count), count, lanes(8, attempt=attempt)),
            *sobol.of_simulations(np.array([0, 1, 2, 511]), count, lanes(8, attempt=attempt)),
        )
    ]
    assert len({tuple(column) for column in numbers}) == len(numbers)


def test_the_next_sequence_is_another_one() -> None:
    axes = np.arange(2)
    first = Sobol().of_scenes(axes, 2, lanes(4, first=5))
    for sequence in (1, 2, 3):
        later = Sobol().of_scenes(axes, 2, lanes(4, first=5 + sequence * 2**20))
        assert not np.isclose(first, later).any()


def test_no_rows_are_given_for_no_scene() -> None:
    """A single row may be written without its brackets, and a row without numbers leaves all of them to others."""
    assert [len(GivenPoints(rows)) for rows in ([], [[]], 0.5, [0.5, 0.25], [[0.5], [0.25]])] == [
        0,
        1,
        1,
        1,
        2,
    ]
    assert len(GivenPoints(np.zeros((0, 3)))) == 0
    with pytest.raises(IndexError, match="no row for scene 0: 0 rows"):
        GivenPoints([]).of_scenes(np.array([0]), 1, lanes(1))
    with pytest.raises(IndexError, match="no row for scene 0: 0 rows"):
        GivenPoints([]).of_simulations(np.array([0]), 1, lanes(1))
    assert GivenPoints([0.5, 0.25]).of_scenes(np.array([1, 0]), 2, lanes(1)).tolist() == [[0.25], [0.5]]
    assert np.isnan(GivenPoints([[]]).of_scenes(np.array([0]), 1, lanes(1))).all()


def test_given_rows_are_kept_as_they_were() -> None:
    rows = np.array([[0.25, 0.5]])
    points = GivenPoints(rows)
    rows[:] = 0.75
    assert points.of_scenes(np.array([0, 1]), 2, lanes(1)).tolist() == [[0.25], [0.5]]


def test_direction_numbers_are_made_once_for_all_smaller_questions(monkeypatch: pytest.MonkeyPatch) -> None:
    """More rows and more axes are asked for by turns: what is known of either is not forgotten."""
    made: list[int] = []

    class Counted(qmc.Sobol):
        def __init__(self, d: int, **options: object) -> None:
            made.append(d)
            super().__init__(d, **options)

    monkeypatch.setattr(qmc, "Sobol", Counted)
    sobol, few, many = Sobol(), np.arange(2), np.arange(60)
    for _ in range(5):
        for axes, first in ((few, 2), (few, 5000), (many, 3), (few, 5000), (few, 9000), (many, 9001)):
            sobol.of_scenes(axes, len(axes), lanes(1, first=first))
    assert len(made) == 4
