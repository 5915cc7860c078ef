"""Samplers: laws, updates after feedback from the formulas, and that all of them find a minimum."""

import itertools
import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ndtr
from scipy.stats import qmc

import scenic
from scenic.falsification.samplers import SAMPLERS, make_sampler
from scenic.falsification.samplers.buckets import Bandit, CrossEntropy, EpsilonGreedy
from scenic.falsification.samplers.search_sampler import NoMorePointsError, SamplerError
from scenic.falsification.space import Coordinate, Space, space_of

SPACE = Space((Coordinate(1, "x"), Coordinate(2, "d", 1, 4, 4), Coordinate(3, "y", shares=(0.5, 0.0, 0.5))))


@pytest.mark.parametrize("name", SAMPLERS)
def test_points_lie_in_the_cube_and_follow_from_the_seed(name: str) -> None:
    def run(seed: int) -> np.ndarray:
        sampler = make_sampler(name, SPACE, seed)
        rows = []
        for _ in range(6):
            points = sampler.ask(4)
            sampler.tell(points, points.sum(axis=1) - 1)
            rows.append(points)
        return np.concatenate(rows)

    found = run(5)
    assert found.shape == (24, 3)
    assert ((found >= 0) & (found <= 1)).all()
    assert (run(5) == found).all()
    if name != "grid":
        assert (run(6) != found).any()


@pytest.mark.parametrize("name", ["sa", "cma", "tpe"])
def test_what_learns_comes_nearer_than_chance(name: str) -> None:
    def best(name: str, seed: int) -> float:
        sampler = make_sampler(name, Space(tuple(Coordinate(k, f"x{k}") for k in range(3))), seed)
        least = math.inf
        for _ in range(20):
            points = sampler.ask(5)
            values = np.abs(points - [0.3, 0.6, 0.8]).sum(axis=1)
            sampler.tell(points, values)
            least = min(least, float(values.min()))
        return least

    seeds = range(5 if name != "tpe" else 3)
    assert np.median([best(name, seed) for seed in seeds]) < np.median(
        [best("random", seed) for seed in range(9)]
    )


def test_cross_entropy_moves_towards_the_bucket_drawn() -> None:
    sampler = CrossEntropy(SPACE, 0, {"alpha": 0.7, "thres": -0.5})
    points = np.array([[0.45, 0.3, 0.9]])
    sampler.tell(points, np.array([-0.5]))  # not below the threshold
    assert [len(item) for item in sampler.distributions] == [5, 4, 3]
    assert np.allclose(sampler.distributions[0], 0.2)
    sampler.tell(points, np.array([-0.6]))
    assert np.allclose(sampler.distributions[0], [0.14, 0.14, 0.44, 0.14, 0.14])
    assert np.allclose(sampler.distributions[1], [0.175, 0.475, 0.175, 0.175])
    assert np.allclose(sampler.distributions[2], [0.35, 0.0, 0.65])
    sampler.tell(points, np.array([np.nan]))
    assert np.allclose(sampler.distributions[2], [0.35, 0.0, 0.65])


def test_epsilon_halves_every_hundred_updates() -> None:
    sampler = EpsilonGreedy(SPACE, 0)
    assert sampler.epsilon == 0.5
    sampler.tell(np.full((100, 3), 0.5), np.ones(100))
    assert sampler.epsilon == 0.25


def test_a_bandit_takes_the_highest_bound() -> None:
    sampler = Bandit(Space((Coordinate(1, "x"),)), 0)
    counts, errors, time = np.ones(5), np.zeros(5), 1
    rng = np.random.default_rng(3)
    for _ in range(200):
        (point,) = sampler.ask(1)
        bucket = min(int(point[0] * 5), 4)
        bound = errors / counts + np.sqrt(2 * math.log(time) / counts)
        assert bound[bucket] == pytest.approx(bound.max())
        value = -1.0 if bucket == 3 and rng.random() < 0.8 else 1.0
        sampler.tell(point[np.newaxis], np.array([value]))
        counts[bucket] += 1
        errors[bucket] += value < 0
        time += 1
    assert sampler.counts[0].tolist() == counts.tolist()
    assert counts.argmax() == 3


def test_a_grid_is_the_product_with_the_first_coordinate_fastest() -> None:
    sampler = make_sampler("grid", SPACE, 0, {"N": [3, 2]})
    found = sampler.ask(100)
    values = [
        tuple(item.value(place) for item, place in zip(SPACE.coordinates, row, strict=True)) for row in found
    ]
    wanted = [(x, d, y) for y, d, x in itertools.product([0, 1], [1, 2, 3, 4], [0, 0.5, 1])]
    assert values == wanted
    with pytest.raises(NoMorePointsError):
        sampler.ask(1)
    again = make_sampler("grid", SPACE, 0, {"N": [3, 2], "repeat": True})
    assert (again.ask(30)[24:] == found[:6]).all()
    with pytest.raises(SamplerError, match="`N`"):
        make_sampler("grid", SPACE, 0, {"N": [3]})


def test_coordinates_become_numbers_of_the_law() -> None:
    places = np.array([0.0, 0.25, 0.4, 0.99, 1.0])
    assert SPACE.coordinates[1].number(places) == pytest.approx([0.125, 0.375, 0.375, 0.875, 0.875])
    assert SPACE.coordinates[2].number(places) == pytest.approx([0, 0.375, 0.5, 0.985, 1])
    assert all(
        (item.number(places) > 0).all() and (item.number(places) < 1).all() for item in SPACE.coordinates
    )
    for item in SPACE.coordinates:
        value = item.value(0.3)
        assert item.value(item.coordinate(value)) == pytest.approx(value)


def test_bayesian_optimisation_finds_a_minimum_with_few_values() -> None:
    space = Space((Coordinate(1, "x"), Coordinate(2, "d", 1, 4, 4), Coordinate(3, "y")))
    sampler = make_sampler("bo", space, 0)
    least = math.inf
    for _ in range(25):
        points = sampler.ask(1)
        assert points[0, 1] in (0.125, 0.375, 0.625, 0.875)
        value = (points[0, 0] - 0.3) ** 2 + (points[0, 2] - 0.8) ** 2 + abs(points[0, 1] - 0.625)
        # Rejections and infinities are no reason to stop.
        sampler.tell(points, np.array([math.nan if points[0, 0] > 0.95 else value]))
        least = min(least, float(value))
    assert least < 0.005


def test_bayesian_optimisation_soon_looks_into_the_corners() -> None:
    slopes = np.array([1, -2, 3, -1])
    space = Space(tuple(Coordinate(k, f"x{k}") for k in range(4)))
    least = []
    for seed in range(3):
        sampler = make_sampler("bo", space, seed)
        values = []
        for _ in range(9):
            point = sampler.ask(1)
            values.append(float((point @ slopes)[0]))
            sampler.tell(point, np.array(values[-1:]))
        least.append(min(values))
    # The corner (0, 1, 0, 1) itself, not a place near it.
    assert np.median(least) == -3


def test_annealing_begins_each_epoch_anywhere_and_ends_at_the_best() -> None:
    space = Space((Coordinate(1, "x"), Coordinate(2, "y")))
    sampler = make_sampler("sa", space, 1, {"iterations": 50, "num_epoch": 2, "decay_rate": 0.8})
    found = []
    for _ in range(200):
        point = sampler.ask(1)
        value = np.abs(point - 0.2).sum(axis=1)
        sampler.tell(point, value)
        found.append((point[0], float(value[0])))
    places = np.array([point for point, _ in found])
    for first in (0, 50):
        # Independent points: on average as far from each other as even ones are, and no coordinate twice.
        assert (np.diff(places[first : first + 10], axis=0) != 0).all()
    # Half of the coordinates stay as they are in the steps of the cold walk.
    assert (np.diff(places[120:], axis=0) == 0).any()
    best = min(value for _, value in found[:100])
    assert min(value for _, value in found[100:]) < best
    assert np.median([value for _, value in found[150:]]) < np.median([value for _, value in found[:10]])


def test_bayesian_optimisation_says_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn", None)
    with pytest.raises(SamplerError, match="needs the package `scikit-learn`"):
        make_sampler("bo", SPACE, 0)


def test_priors_have_buckets_and_weights_of_zero_take_no_room() -> None:
    found = scenic.scenarioFromString(
        "param y = VerifaiRange(0, 4, weights=[1, 0, 3, 0]), d = VerifaiDiscreteRange(1, 4, weights=[1, 1, 0, 2]),"
        " p = VerifaiParameter.withPrior(Normal(10, 2)),"
        " t = VerifaiParameter.withPrior(TruncatedNormal(0, 1, -1, 2), buckets=3)\nego = new Object"
    )
    y, d, p, t = space_of(found, "external").coordinates
    assert [y.value(place) for place in (0, 0.25, 0.5, 0.75, 1)] == [0, 0.5, 2, 2.5, 3]
    assert [d.value(place) for place in (0, 0.5, 0.7, 1)] == [1, 2, 4, 4]
    assert [p.value(place) for place in (0.2, 0.4, 0.5, 0.8)] == pytest.approx([7, 9, 10, 13])
    assert [t.value(place) for place in (1 / 3, 2 / 3, 1)] == pytest.approx([0, 1, 2])
    assert p.shares == pytest.approx(np.diff(ndtr([-np.inf, -1.5, -0.5, 0.5, 1.5, np.inf])))
    for item in (y, d, p, t):
        value = item.value(0.3)
        assert item.value(item.coordinate(value)) == pytest.approx(value)
    for impossible in (1.5, 3.5, 4.5):
        with pytest.raises(ValueError, match="no value"):
            y.coordinate(impossible)
    # Within a scene the same: what the numbers of the draws become.
    points = np.array([[0.25, 0.7, 0.8, 1 / 3]])
    numbers = {item.address: item.number(points[:, k]) for k, item in enumerate((y, d, p, t))}
    (scene,) = found.chosen(numbers, 1, seed=0, first=0, max_attempts=1)
    assert [scene.params[name] for name in "ydpt"] == pytest.approx([0.5, 4, 13, 0])
    # A grid takes the middles of a prior's buckets, Halton's sequence leaves them to chance.
    assert len(make_sampler("grid", Space((y, p)), 0, {"N": 3}).ask(100)) == 15
    halton = make_sampler("halton", Space((p, y)), 0).ask(3)
    assert halton[:, 1].tolist() == [0.5, 0.25, 0.75]


def test_halton_imports_no_statistics() -> None:
    text = (
        "import sys\nfrom scenic.falsification.samplers import make_sampler\n"
        "from scenic.falsification.space import Coordinate, Space\n"
        "make_sampler('halton', Space((Coordinate(1, 'x'),)), 0).ask(3)\nprint('scipy.stats' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


@given(st.integers(0, 10**6), st.integers(0, 30))
def test_halton_is_the_sequence_of_scipy(start: int, skipped: int) -> None:
    space = Space(tuple(Coordinate(place, f"x{place}") for place in range(3)))
    points = make_sampler("halton", space, 0, {"sample_index": start, "bases_skipped": skipped}).ask(5)
    sequence = qmc.Halton(3 + skipped, scramble=False)
    sequence.fast_forward(start + 1)
    assert np.abs(points - sequence.random(5)[:, skipped:]).max() < 1e-12
