"""Every class of regions over lanes with parameters of their own: each lane gets the answer that it gets alone."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
import scenic.core.regions as named

from scenic.graph.kinds import Column
from scenic.language.errors import UndefinedSamplingException, UnsupportedError
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.regions import combinations
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import RegionChoice
from tests.runtime.geometry.samples import table
from tests.runtime.programs import thing
from tests.runtime.regions.test_region_readings import NO_DISTANCE, NOT_DRAWN, REGIONS

LANES = 7
SIDES = ("top", "bottom", "left", "right", "front", "back")


def _moving() -> dict[str, Region]:
    """Of the regions of `REGIONS`, those whose parameters may be random, and combinations of such."""
    found = {name: region for name, region in REGIONS.items() if region.parameters}
    item = thing(
        "ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with width 2, with length 3, with height 1, "
        "with shape CylinderShape(), with sideComponentThresholds ((-0.3, 0.3), (-0.3, 0.3), (-0.3, 0.3))"
    )
    found |= {f"{side} of a tilted object": getattr(item, f"{side}Surface") for side in SIDES}
    box, ball, disc = found["tilted box"], found["tilted ellipsoid"], found["disc"]
    rectangle = named.RectangularRegion((1, 2, 3), 0.6, 5, 4)
    found |= {
        "choice": RegionChoice(1, [box, disc, item.occupiedSpace]),
        "union": combinations.UnionRegion(box, item.occupiedSpace, disc),
        "intersection": combinations.IntersectionRegion(item.occupiedSpace, ball),
        "difference": combinations.DifferenceRegion(rectangle, item.occupiedSpace),
        "choice among surfaces": RegionChoice(1, [item.topSurface, item.surface, item.leftSurface]),
        "union with a choice": combinations.UnionRegion(
            disc, RegionChoice(1, [rectangle, disc, item.topSurface])
        ),
        "intersection with a choice": combinations.IntersectionRegion(
            box, RegionChoice(1, [ball, disc, item.occupiedSpace])
        ),
        "difference with a choice": combinations.DifferenceRegion(
            rectangle, RegionChoice(1, [disc, ball, item.occupiedSpace])
        ),
        "union of flats": combinations.UnionRegion(disc, rectangle),
        "footprint of a rectangle": rectangle.footprint,
    }
    return found


MOVING = _moving()


def columns_of(region: Region, rng: np.random.Generator) -> list[Column]:
    """Parameters that differ from lane to lane, as far as they are numbers."""
    result: list[Column] = []
    for parameter, column in zip(region.parameters, region.fixed_columns("a test"), strict=True):
        values = np.asarray(column)
        if values.dtype.kind == "i":  # which option of a choice
            result.append(np.arange(LANES) % 3)
        elif values.dtype.kind != "f" or hasattr(parameter, "faces"):
            result.append(values)
        elif values.shape[1:] == (4,):
            rows = values + rng.normal(0, 0.5, (LANES, 4))
            result.append(rows / np.linalg.norm(rows, axis=1, keepdims=True))
        elif (values > 0).all():
            result.append(values * rng.uniform(0.7, 1.3, (LANES, *values.shape[1:])))
        else:
            result.append(values + rng.normal(0, 0.4, (LANES, *values.shape[1:])))
    # A parameter that all lanes have in common is one row.
    result[0] = result[0] if len(result) < 3 else result[0][:1]
    return result


def bodies(points: Column, rng: np.random.Generator) -> Body:
    turns = rng.normal(size=(LANES, 4))
    poses = Poses(
        points, turns / np.linalg.norm(turns, axis=1, keepdims=True), rng.uniform(0.05, 0.9, (LANES, 3))
    )
    return Body((primitives.box(), table()), np.arange(LANES) % 2, poses)


def readings(region: Region, name: str) -> Iterator[tuple[str, Callable[..., list[Column]]]]:
    """Everything that is asked over lanes: of a point, a body, numbers and keys, and the parameters of each lane."""

    def boxed(*corners: Column) -> list[Column]:
        return [np.asarray(corner) for corner in corners]

    yield "points", lambda points, body, numbers, keys, *mine: [region.contains_points(points, *mine)]
    yield "gaps", lambda points, body, numbers, keys, *mine: [region.gaps(points, *mine)]
    yield "box", lambda points, body, numbers, keys, *mine: boxed(*region.box(*mine))
    yield "container", lambda points, body, numbers, keys, *mine: boxed(*region.container_box(*mine))
    yield (
        "bodies",
        lambda points, body, numbers, keys, *mine: [region.contains_bodies(body, len(points), *mine)],
    )
    yield "sizes", lambda points, body, numbers, keys, *mine: [region.sizes(*mine)]
    if name not in NO_DISTANCE:
        yield "distances", lambda points, body, numbers, keys, *mine: [region.distances(points, *mine)]
    if region.has_orientation:
        yield "orientations", lambda points, body, numbers, keys, *mine: [region.orientations(points, *mine)]
    if name not in NOT_DRAWN:

        def draw(points: Column, body: Body, numbers: Column, keys: Column, *mine: Column) -> list[Column]:
            drawn, known = region.draw_points(numbers, keys, *mine)
            every = np.ones(len(points), bool) if known is None else np.broadcast_to(known, len(points))
            return [np.where(every[:, np.newaxis], drawn, 0.0), every]

        yield "draws", draw


@pytest.mark.parametrize("name", MOVING)
def test_each_lane_gets_the_answer_that_it_gets_alone(name: str) -> None:
    region, rng = MOVING[name], np.random.default_rng(3)
    columns = columns_of(region, rng)
    lower, upper = region.box(*columns)
    ends = np.clip(np.broadcast_to(np.stack([lower, upper], axis=1), (LANES, 2, 3)), -20, 20)
    points = ends[:, 0] + rng.uniform(-0.1, 1.1, (LANES, 3)) * (ends[:, 1] - ends[:, 0])
    body = bodies(points, rng)
    numbers, keys = rng.random((region.draws, LANES)), rng.integers(0, 2**63, LANES).astype(np.uint64)
    asked = 0
    for what, reading in readings(region, f"{name}"):
        try:
            together = reading(points, body, numbers, keys, *columns)
        except (NotImplementedError, UnsupportedError, UndefinedSamplingException):
            continue  # not known of this kind
        asked += 1
        for lane in range(LANES):
            one = np.array([lane])
            mine = [column if len(column) == 1 else column[one] for column in columns]
            alone = Body(body.meshes, body.choice[one], body.poses.take(one))  # type: ignore[index] # a choice is given
            answers = reading(points[one], alone, numbers[:, one], keys[one], *mine)
            rows = [given[lane if len(given) > 1 else 0] for given in together]
            if what in ("box", "container") and ("of a" in name or "surfaces" in name):
                # That of a side is closer where the body is fixed.
                assert (rows[0] <= answers[0][0] + 1e-9).all()
                assert (rows[1] >= answers[1][0] - 1e-9).all()
                continue
            for row, answer in zip(rows, answers, strict=True):
                np.testing.assert_allclose(
                    row, answer[0], rtol=1e-9, atol=1e-12, err_msg=f"{what} of lane {lane}"
                )
    assert asked >= 5


OCTAHEDRON = Mesh(
    0.5 * np.vstack([np.eye(3), -np.eye(3)]),
    [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)],
)


def _spread(column: Column) -> Column:
    return np.repeat(column, LANES, axis=0) if len(column) == 1 else column


@pytest.mark.parametrize("shared", ["pose", "shape and parameters"])
@pytest.mark.parametrize("name", [name for name in MOVING if "of a tilted" not in name])
def test_what_all_lanes_share_is_as_if_each_had_it(name: str, shared: str) -> None:
    """Given as one row, whatever else differs from lane to lane."""
    region, rng = MOVING[name], np.random.default_rng(4)
    fixed = region.fixed_columns("a test")
    columns = columns_of(region, rng) if shared == "pose" else fixed
    lower, upper = region.box(*fixed)
    points = np.clip(lower, -20, 20) + rng.uniform(0.2, 0.8, (LANES, 3)) * np.clip(upper - lower, 0, 9)
    choice, poses = rng.integers(0, 2, LANES), bodies(points, rng).poses
    if shared == "pose":
        poses, points = poses.take(np.array([1])), points[1:2]
    else:
        choice = choice[1:2]
    meshes = (OCTAHEDRON, primitives.box())
    body = Body(meshes, choice, poses)
    apart = Body(
        meshes,
        _spread(choice),
        Poses(*(_spread(part) for part in (poses.position, poses.orientation, poses.size))),
    )
    own = [_spread(column) for column in columns]
    for given, expected in (
        (region.contains_points(points, *columns), region.contains_points(_spread(points), *own)),
        (region.contains_bodies(body, LANES, *columns), region.contains_bodies(apart, LANES, *own)),
        (region.meets_bodies(body, LANES, *columns), region.meets_bodies(apart, LANES, *own)),
    ):
        np.testing.assert_array_equal(np.broadcast_to(given, LANES), expected)
    for reading in (region.gaps, region.distances):
        if "view" in name:  # whose distances take long, and are tried below
            continue
        try:
            expected = reading(_spread(points), *own)
        except UnsupportedError:
            continue
        np.testing.assert_allclose(
            np.broadcast_to(reading(points, *columns), len(expected)), expected, atol=1e-12
        )


@pytest.mark.parametrize("changed", ["horizontal", "vertical"])
def test_views_of_which_lanes_share_an_angle_are_their_own(changed: str) -> None:
    """Their meshes are made by pairs of angles."""
    view = named.ViewRegion(4, (1.0, 0.8), position=(1, 2, 3))
    camera, turn, *_ = view.fixed_columns("a test")
    across = np.array([1.0, 2.5, 1.0, 0.4]) if changed != "vertical" else np.ones(4)
    upward = np.array([0.8, 0.8, 2.0, 0.3]) if changed != "horizontal" else np.full(4, 0.8)
    columns = [camera, turn, across, upward, np.array([4.0])]
    # One beside the middle, one above it, one ahead.
    places = np.array([1.0, 2, 3]) + np.array([(2.0, 2, 0), (0, 2, 1.6), (0, 3, 0)])
    for place in places:
        body = Body((primitives.box(),), None, Poses.fixed(place, size=(0.2, 0.2, 0.2)))
        held = view.contains_bodies(body, 4, *columns)
        far = view.distances(place[np.newaxis], *columns)
        for lane in range(4):
            mine = [camera, turn, across[[lane]], upward[[lane]], np.array([4.0])]
            assert held[lane] == view.contains_bodies(body, 1, *mine)[0]
            assert far[lane] == pytest.approx(view.distances(place[np.newaxis], *mine)[0])
    # Each lane with a place of its own, too.
    points = places[[2, 0, 1, 1]]
    found = view.distances(points, *columns)
    for lane in range(4):
        mine = [camera, turn, across[[lane]], upward[[lane]], np.array([4.0])]
        assert found[lane] == pytest.approx(view.distances(points[[lane]], *mine)[0])


@pytest.mark.parametrize("side", [*SIDES, ""])
def test_one_point_is_on_the_sides_of_those_lanes_alone_that_reach_it(side: str) -> None:
    item = thing(
        "ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with width 2, with length 3, with height 1"
    )
    region = getattr(item, f"{side}Surface" if side else "surface")
    columns = region.fixed_columns("a test")
    (place,) = [number for number, column in enumerate(columns) if np.array_equal(column, [(1, 2, 3)])]
    point = np.array([tuple(region.uniformPointInner())])
    shifts = np.zeros((LANES, 3))
    shifts[[0, 2, 5]] = (0.02, 0.03, 0.05)
    moved = [column + shifts if number == place else column for number, column in enumerate(columns)]
    assert region.contains_points(point, *moved).tolist() == [lane not in (0, 2, 5) for lane in range(LANES)]
