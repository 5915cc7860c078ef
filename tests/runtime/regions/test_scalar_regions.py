"""Regions, contacts and sight on plain floats: the same answers as over lanes, also where things touch."""

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from scenic.runtime.geometry.contact.collision import collide
from scenic.runtime.instances.objects import Object
from scenic.runtime.regions import generic
from scenic.runtime.regions import visibility_nodes as sight
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.circular import CircularRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.runtime.regions.rectangular import RectangularRegion
from scenic.runtime.regions.stacked import body_of, body_operands
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.shapes.shapes import BoxShape, ConeShape, CylinderShape, Shape, SpheroidShape
from scenic.runtime.values.values import Orientation, Vector, as_node
from tests.amounts import amount
from tests.runtime.programs import thing

TURN = Orientation.fromEuler(0.4, 0.2, -0.3)
REGIONS: dict[str, Region] = {
    "rectangle": RectangularRegion((1, 2, 0.5), 0.3, 6, 4),
    "upright rectangle": RectangularRegion((0, 0), 0, 4, 4),
    "disc": CircularRegion((1, -1, 0.25), 3),
    "convex polygon": PolygonalRegion([(-3, -2), (3, -2), (4, 3), (-3, 3)], z=1.5),
    "notched polygon": PolygonalRegion([(-4, -4), (4, -4), (4, 4), (0, 0.5), (-4, 4)], z=-1.5),
    "box": BoxRegion(dimensions=(4, 4, 4)),
    "turned box": BoxRegion(dimensions=(5, 4, 3), position=(0.5, 0, 0), rotation=TURN),
    "ball": SpheroidRegion(dimensions=(6, 5, 4), position=(0.5, 0, 0), rotation=TURN),
}
SHAPES: tuple[Shape, ...] = (BoxShape(), ConeShape(), CylinderShape(), SpheroidShape())


def objects(count: int, *, reach: float = 4.0, seed: int = 0, boxes: bool = False) -> Iterator[Any]:
    """Objects at random; every fourth on a grid, so that many touch something."""
    random = np.random.default_rng(seed)
    template = thing("ego = new Object")
    for number in range(count):
        made: Any = Object._make({name: getattr(template, name) for name in Object.scenic_properties})
        position, size = random.uniform(-reach, reach, 3), random.uniform(0.2, 3, 3)
        turn: Orientation = Orientation.fromEuler(*random.uniform(-3, 3, 3).tolist())
        if number % 4 == 0:
            position, size, turn = np.round(position), np.ones(3) * 2, Orientation()
        elif number % 4 == 1:
            position[2], turn = size[2] / 2, Orientation.fromEuler(float(random.uniform(-3, 3)), 0.0, 0.0)
        shape = SHAPES[0] if boxes else SHAPES[number % 7 % len(SHAPES)]
        width, length, height = size.tolist()
        made.__dict__.update(position=Vector(*position.tolist()), orientation=turn, shape=shape)
        made.__dict__.update(width=width, length=length, height=height, heading=turn.yaw)
        yield made


def columns(values: Any) -> list[Any]:
    return [as_node(value).payload.column for value in values]


def over_lanes(thing_: Any) -> Any:
    return body_of(*columns(body_operands(thing_)))


@pytest.mark.parametrize("name", REGIONS)
def test_points_in_regions(name: str) -> None:
    region = REGIONS[name]
    random = np.random.default_rng(1)
    points = random.uniform(-4, 4, (amount(600, 2000), 3))
    points[::2] = np.round(points[::2] * 2) / 2  # many on borders
    held = region.contains_points(points, *region.fixed_columns("the region"))
    assert 0 < held.sum() < len(points)
    distances = region.distances(points, *region.fixed_columns("the region"))
    for point, expected, distance in zip(points.tolist(), held.tolist(), distances.tolist(), strict=True):
        assert region.containsPoint(Vector(*point)) is expected
        assert region.distance_from(Vector(*point)) == distance


@pytest.mark.parametrize("name", REGIONS)
def test_objects_in_regions(name: str) -> None:
    region = REGIONS[name]
    certain, found = 0, []
    for item in objects(400, reach=3.0, seed=2):
        expected = bool(region.contains_bodies(over_lanes(item), 1, *region.fixed_columns("the region"))[0])
        assert bool(region.containsObject(item)) is expected
        found.append(expected)
        single, body = region.at_once, sight.placed_of(item)
        assert single is not None
        assert body is not None
        certain += single.holds_body(body) is not None
    assert 10 < sum(found) < 390
    assert certain > 100  # boxes need no closer look


def test_objects_that_intersect() -> None:
    found = []
    items = list(objects(160, reach=2.5, seed=3))
    for one, other in itertools.pairwise(items):
        bodies = [over_lanes(one), over_lanes(other)]
        expected = not collide(bodies, np.array([[0, 1]]), lanes=1).free[0]
        assert bool(one.intersects(other)) is expected
        found.append(expected)
    assert 20 < sum(found) < 140


@pytest.mark.parametrize("name", [name for name in REGIONS if name != "ball"])
def test_objects_that_meet_regions(name: str) -> None:
    region, found = REGIONS[name], []
    for item in objects(60, reach=5.0, seed=4, boxes=True):
        expected = bool(generic.intersects(item.occupiedSpace, region))
        assert bool(item.intersects(region)) is expected
        assert bool(region.intersects(item)) is expected
        found.append(expected)
    assert 5 < sum(found) < 60


@pytest.mark.parametrize("angles", [(6.2832, 3.1416), (1.5, 1.0), (3.0, 3.1416)])
def test_what_observers_see(angles: tuple[float, float]) -> None:
    certain, found = 0, []
    items = list(objects(90, reach=5.0, seed=5))
    for item in items:
        item.__dict__.update(viewAngles=angles, visibleDistance=12.0, viewRayDensity=2.0)
    for place, observer in enumerate(items):
        target = items[(place + 5) % len(items)]
        others = items[(place + 7) % 80 : (place + 7) % 80 + 3]
        for what in (target, target.position):
            expected = bool(sight._looked(observer, what, others, False))
            assert bool(sight.sees(observer, what, others)) is expected
            certain += sight._at_once(observer, what, others) is not None
            found.append(expected)
    assert 8 < sum(found) < 175
    assert certain > 90


def test_a_wall_hides_and_its_edge_does_not() -> None:
    items = list(objects(3, seed=6, boxes=True))
    observer, wall, target = items
    for item, position, size in (
        (observer, (0, 0, 0), (1, 1, 1)),
        (wall, (0, 4, 0), (6, 0.1, 6)),
        (target, (0, 8, 0), (1, 1, 1)),
    ):
        item.__dict__.update(position=Vector(*position), orientation=Orientation(), visibleDistance=50.0)
        item.__dict__.update(zip(("width", "length", "height"), map(float, size), strict=True))
    assert sight._at_once(observer, target, items) is False
    wall.__dict__["position"] = Vector(4, 4, 0)
    assert sight._at_once(observer, target, items) is True
    wall.__dict__["position"] = Vector(3, 4, 0)  # its edge is right before the middle
    assert sight._at_once(observer, target, items) is None
    assert sight.sees(observer, target, items) is bool(sight._looked(observer, target, items, False))
    wall.__dict__["occluding"] = False
    assert sight._at_once(observer, target, items) is True
