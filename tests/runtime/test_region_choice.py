"""A random choice among regions: in specifiers, containers, conditions and values."""

import numpy as np
import pytest

from runtime.programs import draws, failure, thing
from scenic.language.errors import InvalidScenarioError

REGIONS = (
    "disc = CircularRegion((0, 0, 1), 2)\nplate = RectangularRegion((10, 0, 3), 0.5, 2, 4)\n"
    "ball = SpheroidRegion((2, 2, 2), (0, 20, 0))\nlocal = Uniform(disc, plate, ball)\n"
)


def test_points_are_drawn_in_each_option_with_its_probability() -> None:
    text = (
        REGIONS
        + "p = new Point in local\nparam x = (p.x, p.y, p.z, disc.containsPoint(p), plate.containsPoint(p), ball.containsPoint(p))\n"
    )
    values = np.array(draws(text, n=900), dtype=float)
    counts = values[:, 3:].sum(axis=0)
    assert counts.sum() == 900
    assert (np.abs(counts - 300) < 75).all()
    assert set(np.round(values[values[:, 3] == 1, 2], 12)) == {1.0}
    assert set(np.round(values[values[:, 4] == 1, 2], 12)) == {3.0}


def test_a_container_may_be_a_choice() -> None:
    text = REGIONS + (
        "room = Uniform(disc, plate)\n"
        "o = new Object in room, with regionContainedIn room, with width 0.5, with length 0.5\n"
        "param x = (disc.containsObject(o), plate.containsObject(o))\n"
    )
    values = draws(text, n=60)
    assert all(one != other for one, other in values)
    assert {one for one, _ in values} == {True, False}


def test_conditions_ask_the_drawn_region_alone() -> None:
    text = REGIONS + "x = Range(0, 12)\nroom = Uniform(disc, plate)\nrequire (x, 0, 1) in room\nparam x = x\n"
    values = np.array(draws(text, n=100))
    assert ((values < 2) | (values > 8)).all()
    assert {bool(value < 5) for value in values} == {True, False}
    distance = REGIONS + "param x = distance from (0, 0, 1) to local\n"
    found = sorted({round(value, 9) for value in draws(distance, n=60)})
    assert found[0] == 0
    assert found[-1] == pytest.approx(np.hypot(20, 1) - 1)
    assert len(found) == 3


def test_a_region_with_random_parameters_is_sampled() -> None:
    text = "r = CircularRegion((0, 0), Range(1, 2))\nparam x = (r.radius, r)\n"
    for radius, region in draws(text, n=20):
        assert region.radius == radius
        assert region.containsPoint((radius * 0.999, 0)) is True
        assert region.containsPoint((radius * 1.001, 0)) is False


def test_all_of_space_cannot_be_drawn_from() -> None:
    assert isinstance(failure(REGIONS + "new Object in Uniform(disc, everywhere)"), InvalidScenarioError)


def roll_of_a_tilted_top() -> float:
    """The roll of the top of the object below that is rolled by 0.5."""
    tilted = thing("ego = new Object facing (0.3, 0, 0.5)")
    return float(tilted.topSurface.orientation[tilted.top.position].roll)


def test_things_land_on_the_option_that_is_drawn() -> None:
    text = (
        "low = new Object at (0, 0, 0), with allowCollisions True\n"
        "high = new Object at (0, 0, 9), with allowCollisions True\n"
        "tilted = new Object at (0, 0, 20), facing (0.3, 0, 0.5), with allowCollisions True\n"
        "aside = new Object at (40, 0, 0)\n"
        "new Object at (0, 0, 30), on {where}, with allowCollisions True, with onDirection (0, 0, 1)\n"
        "param x = (ego.z, ego.parentOrientation)\n"
    )
    level = text.replace("new Object at (0, 0, 30)", "ego = new Object at (0, 0, 30)")
    heights = [height for height, _ in draws(level.format(where="Uniform(low, high)"), n=60)]
    assert sorted({round(height, 3) for height in heights}) == [1, 10]
    assert 15 < sum(height > 5 for height in heights) < 45
    # Where the option that is drawn is missed, the candidate is rejected; one that is not drawn rejects nothing.
    missed = [height for height, _ in draws(level.format(where="Uniform(low, aside, high)"), n=60)]
    assert 15 < sum(height > 5 for height in missed) < 45
    frames = [frame for _, frame in draws(level.format(where="Uniform(tilted, high)"), n=40)]
    assert {round(frame.roll, 6) for frame in frames} == {0.0, round(roll_of_a_tilted_top(), 6)}


def test_random_vectors_are_places_to_stand_on() -> None:
    found = draws("ego = new Object on Uniform((1, 2), (3, 4, 5))\nparam x = tuple(ego.position)", n=30)
    assert {tuple(round(part, 4) for part in place) for place in found} == {(1, 2, 0.5), (3, 4, 5.5)}
