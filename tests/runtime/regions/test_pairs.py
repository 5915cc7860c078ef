"""Tables of pairs of kinds: which cells count, and how a question without an answer is refused."""

import pytest

import scenic
from scenic.language.errors import UnknownPairError
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.fixed_intersections import MEETING
from scenic.runtime.regions.lines import PathRegion
from scenic.runtime.regions.pairs import Cell, PairTable
from scenic.runtime.regions.planar import PlanarRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.volumes import BoxRegion

DISC, RECTANGLE, BOX = CircularRegion((0, 0), 1), RectangularRegion((0, 0), 0, 1, 1), BoxRegion((1, 1, 1))
TABLE = (
    Cell(CircularRegion, PlanarRegion, lambda one, two: "disc" if one is DISC and two is not DISC else None),
    Cell(PlanarRegion, PlanarRegion, lambda _one, _two: "plane"),
    Cell(BoxRegion, PlanarRegion, None),
)


def test_the_first_cell_that_fits_and_answers_counts() -> None:
    either, one_way = PairTable("{} {}", TABLE, symmetric=True), PairTable("{} {}", TABLE, symmetric=False)
    assert (
        either.ask(DISC, RECTANGLE) == either.ask(RECTANGLE, DISC) == one_way.ask(DISC, RECTANGLE) == "disc"
    )
    assert either.ask(DISC, DISC) == one_way.ask(RECTANGLE, DISC) == "plane"


@pytest.mark.parametrize("pair", [(BOX, DISC), (BOX, BOX)])
def test_what_is_not_known_names_both_regions(pair: tuple[BoxRegion, BoxRegion]) -> None:
    """A declared cell and a missing one alike."""
    with pytest.raises(UnknownPairError, match=r"whether BoxRegion.* and .* touch is not known"):
        PairTable("whether {} and {} touch", TABLE, symmetric=True).ask(*pair)


def test_pairs_that_are_not_known_are_declared_and_told_at_their_place() -> None:
    assert any(cell.rule is None and issubclass(PathRegion, cell.first) for cell in MEETING)
    text = "a = PathRegion([(0, 0, 0), (1, 1, 1)])\nb = PathRegion([(0, 0, 1), (1, 1, 0)])\nparam x = a.intersects(b)\nego = new Object"
    with pytest.raises(UnknownPairError) as caught:
        scenic.scenarioFromString(text)
    assert isinstance(caught.value, NotImplementedError)
    assert "3:" in str(caught.value)


def test_pairs_that_turn_out_unknown_in_samples_are_told_at_the_requirement() -> None:
    text = """\
line = PolylineRegion([(0, 0), (1, 3), (5, 4)]).difference(BoxRegion(dimensions=(5, 6, 7)))
ego = new Object in CircularRegion((0, 0), 3)
other = new Object at (Range(20, 30), 20)
require other.position.x + ego.position.x > 0
require ego intersects line
"""
    with pytest.raises(UnknownPairError) as caught:
        scenic.scenarioFromString(text).sample(5, seed=1)
    assert caught.value.line == 5
