"""What is known of containment from bounds: nothing that is held is called outside, however tight the bounds are."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from scenic.graph.bounds import Bounds
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Poses
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.knowledge import (
    Containment,
    containment_bounds,
    containment_inverse,
)
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.values.values import Orientation, Vector
from tests.amounts import amount
from tests.runtime.boundaries import flip
from tests.runtime.geometry.samples import SHAPES

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
REGIONS: dict[str, Region] = {
    "disc": CircularRegion((1, -2, 0), 3),
    "rectangle": RectangularRegion((1, 2, 5), 0.6, 7, 3),
    "notched polygon": PolygonalRegion([(-4, -4), (4, -4), (4, 4), (0, 0.5), (-4, 4)]),
    "box": BoxRegion((6, 4, 3), Vector(0.5, 1, 2), TILT),
    "ball": SpheroidRegion((6, 4, 5), Vector(0.5, 1, 2), TILT),
}
INSIDE = {
    "disc": (1.2, -1.8, 0),
    "rectangle": (1, 2, 0),
    "notched polygon": (-1, -1.6, 0),
    "box": (0.4, 1.1, 2.1),
    "ball": (0.4, 1.1, 2.1),
}


def exactly(column: Any) -> Bounds:
    rows = np.asarray(column, dtype=float)
    return Bounds(rows, rows)


def held(region: Region, mesh: Mesh, place: Floats, turn: Floats, size: Floats) -> bool:
    body = Body((mesh,), None, Poses(place[None], turn[None], size[None]))
    return bool(region.contains_bodies(body, 1, *region.fixed_columns("the region"))[0])


def operands(region: Region, low: Floats, high: Floats, turn: Floats, size: Floats) -> list[Bounds | None]:
    """Bounds of position, orientation, size, shape and parameters."""
    known = [exactly(column) for column in region.fixed_columns("the region")]
    return [Bounds(low, high), exactly(turn[None]), exactly(size[None]), None, *known]


def last_place(region: Region, mesh: Mesh, start: Floats, way: Floats, turn: Floats, size: Floats) -> Floats:
    """Where a body that moves out of a region is held for the last time."""
    steps = np.linspace(0, 12, 60).tolist()
    inside = [held(region, mesh, start + step * way, turn, size) for step in steps]
    last = inside.index(False)
    at = flip(
        lambda along: held(region, mesh, start + along * way, turn, size), steps[last - 1], steps[last], 1e-9
    )
    place: Floats = start + (at - 2e-9) * way
    return place


@pytest.mark.parametrize("name", REGIONS)
@pytest.mark.parametrize("shape", ["box", "cone"])
def test_what_is_held_is_never_called_outside(name: str, shape: str) -> None:
    region, mesh = REGIONS[name], SHAPES[shape]()
    random = np.random.default_rng(5)
    payload = Containment(region, mesh)
    known = 0
    for number in range(amount(7, 14)):
        way = random.normal(size=3) * (1, 1, region.dimension == 3)
        way /= np.linalg.norm(way)
        turn = Rotation.random(random_state=number).as_quat()
        size = random.uniform(0.1, 0.9, 3)
        start = np.array(INSIDE[name], dtype=float)
        if not held(region, mesh, start, turn, size):
            continue
        place = last_place(region, mesh, start, way, turn, size)
        # It is in a corner of the bounds, all others are farther out; or between them.
        far = np.abs(random.uniform(0, 3, 3)) * np.sign(way + 1e-300)
        for low, high in (
            (place, place),
            (np.minimum(place, place + far), np.maximum(place, place + far)),
            (np.minimum(start, place), np.maximum(start, place)),
        ):
            given = operands(region, low[None], high[None], turn, size)
            found = containment_bounds(payload, *given)
            assert found is not None
            assert found.upper[0] == 1
            assert found.lower[0] == 0  # that something is inside for certain is never said
            narrowed = containment_inverse(payload, exactly([1.0]), *given)[0]
            assert narrowed is not None
            assert (narrowed.lower[0] <= place).all()
            assert (place <= narrowed.upper[0]).all()
            # Nothing follows from its being outside, or from what is not known.
            for unsure in (exactly([0.0]), Bounds(np.zeros(1), np.ones(1))):
                nothing = containment_inverse(payload, unsure, *given)[0]
                assert nothing is None or not np.isfinite(nothing.lower).any()
        beyond = place + 9 * way
        found = containment_bounds(payload, *operands(region, beyond[None], beyond[None], turn, size))
        assert found is not None
        assert found.upper[0] == 0
        little = place + 0.8 * way
        found = containment_bounds(payload, *operands(region, little[None], little[None], turn, size))
        assert found is not None
        known += found.upper[0] == 0
    assert known > amount(1, 3)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("side", [-1, 1])
def test_what_sticks_out_by_less_than_the_tolerance_may_be_held(axis: int, side: int) -> None:
    region, mesh = BoxRegion((2, 2, 2)), SHAPES["box"]()
    turn, size, way = np.array([0.0, 0, 0, 1]), np.ones(3), side * np.eye(3)[[axis]]
    for off, outside in ((5e-7, False), (1e-4, True)):
        given = operands(region, (0.5 + off) * way, (0.5 + off) * way, turn, size)
        found = containment_bounds(Containment(region, mesh), *given)
        assert found is not None
        assert bool(found.upper[0] == 0) is outside
        narrowed = containment_inverse(Containment(region, mesh), exactly([1.0]), *given)[0]
        assert narrowed is not None
        assert narrowed.upper[0] == pytest.approx(0.5 + 1e-6, abs=1e-8)
        assert narrowed.lower[0] == pytest.approx(-0.5 - 1e-6, abs=1e-8)


def test_several_boxes_at_once_are_told_apart() -> None:
    """Also where orientations and sizes differ from box to box, and a parameter is not fixed."""
    region, mesh = CircularRegion((0, 0, 0), 2), SHAPES["box"]()
    places = np.array([[0.0, 0, 0], [1.7, 0, 0], [9, 0, 0], [0, 2.6, 0]])
    turns = np.array([[0, 0, 0, 1.0], [0, 0, math.sin(0.4), math.cos(0.4)], [0, 0, 0, 1], [0, 0, 0, 1]])
    sizes = np.array([[1.0, 1, 1], [0.1, 0.1, 1], [1, 1, 1], [0.2, 4, 1]])
    known = [exactly(column) for column in region.fixed_columns("the region")]
    payload = Containment(region, mesh)
    found = containment_bounds(payload, exactly(places), exactly(turns), exactly(sizes), None, *known)
    assert found is not None
    assert found.upper.tolist() == [1, 1, 0, 0]
    wide = Bounds(np.array([1.0]), np.array([2.0]))
    near = Bounds(np.array([[-0.1, 0, 0]]), np.array([[0.1, 0, 0]]))
    for loose in ([known[0], wide], [near, known[1]]):
        found = containment_bounds(payload, exactly(places), exactly(turns), exactly(sizes), None, *loose)
        assert found is not None
        assert found.upper.tolist() == [1, 1, 0, 0]
    assert region.extent(None, known[1]) is None
    assert containment_bounds(payload, exactly(places), None, exactly(sizes), None, *known) is None
    none = containment_bounds(
        Containment(region, None), exactly(places), exactly(turns), exactly(sizes), None, *known
    )
    assert none is None


@pytest.mark.parametrize("spread", [0.0, 0.3])
def test_sizes_and_turns_within_bounds(spread: float) -> None:
    """A body that is held for some size and turn within the bounds is not outside."""
    region, mesh = BoxRegion((3, 3, 3)), SHAPES["box"]()
    random = np.random.default_rng(8)
    for _ in range(14):
        yaw, size = random.uniform(-1, 1), random.uniform(0.3, 1, 3)
        turn = np.array([0, 0, math.sin(yaw / 2), math.cos(yaw / 2)])
        place = last_place(region, mesh, np.zeros(3), np.array([1.0, 0, 0]), turn, size)
        least, most = np.array([size]), np.array([size + spread])
        around = np.array([turn])
        low = np.minimum(around, around + random.normal(size=(1, 4)) * spread / 5)
        high = np.maximum(around, around + random.normal(size=(1, 4)) * spread / 5)
        known = [exactly(column) for column in region.fixed_columns("the region")]
        payload = Containment(region, mesh)
        given = [exactly(place[None]), Bounds(low, high), Bounds(least, most), None, *known]
        found = containment_bounds(payload, *given)
        assert found is not None
        assert found.upper[0] == 1
        narrowed = containment_inverse(payload, exactly([1.0]), *given)[0]
        assert narrowed is not None
        assert (narrowed.lower[0] <= place).all()
        assert (place <= narrowed.upper[0]).all()


@pytest.mark.parametrize("name", REGIONS)
def test_bounds_of_points_of_regions(name: str) -> None:
    region = REGIONS[name]
    columns = region.fixed_columns("the region")
    found = region.extent(*[exactly(column) for column in columns])
    lower, upper = region.box(*columns)
    assert found is not None
    np.testing.assert_array_equal([found.lower, found.upper], [lower, upper])
    random = np.random.default_rng(2)
    points, _ = region.draw_points(random.random((region.draws, 500)), np.zeros(500, np.uint64), *columns)
    assert ((found.lower - 1e-9 <= points) & (points <= found.upper + 1e-9)).all()


def test_nothing_follows_from_distances_of_bodies_of_which_little_is_known() -> None:
    """A body whose place, turn or size has no bounds says nothing of the other's place, and nothing breaks."""
    from scenic.runtime.regions.body_regions import _GAP

    place, turn, size = exactly([[5.0, 0, 0]]), exactly([[0.0, 0, 0, 1]]), exactly([[1.0, 1, 1]])
    known: list[Bounds | None] = [place, turn, size, None]
    within = exactly([2.0])
    assert _GAP.inverse is not None
    full = _GAP.inverse(None, within, *known, *known)
    assert full[0] is not None
    assert full[4] is not None
    # Half a diagonal, or an extent, of each beside the distance: a body at 7.5 may be that near, one at 9 is not.
    assert full[0].lower[0, 0] < 2.1
    assert 7.9 < full[0].upper[0, 0] < 9
    for missing in range(3):
        less: list[Bounds | None] = [None if part == missing else item for part, item in enumerate(known)]
        one, other = _GAP.inverse(None, within, *less, *known), _GAP.inverse(None, within, *known, *less)
        for found, mine, theirs in ((one, 0, 4), (other, 4, 0)):
            # Without its place the other's still says where it is, without its size nothing does.
            assert (found[mine] is not None, found[theirs] is not None) == {
                0: (True, False),
                1: (True, True),
                2: (False, False),
            }[missing]
            for part in (mine, theirs):
                mine_now, before = found[part], full[part]
                if mine_now is not None and before is not None:
                    assert (mine_now.lower <= before.lower).all()
                    assert (mine_now.upper >= before.upper).all()
