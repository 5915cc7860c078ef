"""Planar regions against shapely: distances, growing and joining, footprints, heights, draws; near borders, too."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from scipy import optimize, stats

from tests.runtime.geometry.test_boundaries import HOOK, POLYGONS, RING, WEDGE, rectangle
from tests.runtime.programs import FALSE_ALARM, euler, scenario

IMPORT = "from tests.runtime.geometry.test_boundaries import POLYGONS\n"

REGIONS: dict[str, tuple[str, shapely.Geometry, float]] = {
    "a disc": ("CircularRegion((2, -1, 3), 2.2)", shapely.Point(2, -1).buffer(2.2, 4096), 3),
    "a turned rectangle": (
        "RectangularRegion((-2, 1, 5), 4.2, 3.5, 6)",
        rectangle((-2, 1), 4.2, 3.5, 6),
        5,
    ),
    **{
        name: (f"PolygonalRegion(polygon=POLYGONS[{name!r}], z=-2.5)", polygon, -2.5)
        for name, polygon in POLYGONS.items()
    },
}


def near_points(polygon: shapely.Geometry, z: float, seed: int, count: int = 40) -> np.ndarray:
    """Points beside and inside a polygon: anywhere, and within 1e-2 and 1e-3 of its border; at several heights."""
    rng = np.random.default_rng(seed)
    low, high = np.array(polygon.bounds).reshape(2, 2)
    anywhere = rng.uniform(low - 3, high + 3, (count, 2))
    border = polygon.boundary
    along = shapely.get_coordinates(border.interpolate(rng.uniform(0, border.length, count)))
    close = along + rng.normal(size=(count, 2)) * rng.choice([1e-2, 1e-3], (count, 1))
    flat = np.concatenate([anywhere, close])
    return np.column_stack([flat, z + rng.choice([0, 0.5, -4], len(flat))])


def asked(setup: str, points: np.ndarray, question: str) -> list[Any]:
    """What a program says of fixed points, and of the same points drawn in lanes."""
    listed = ", ".join(map(str, map(tuple, points.tolist())))
    fixed = scenario(f"{setup}points = [{listed}]\nparam found = [{question} for p in points]\n")
    (scene,) = fixed.sample(1, seed=0)
    drawn = scenario(f"{setup}i = DiscreteRange(0, {len(points) - 1})\np = Uniform({listed})\nparam p = p, found = {question}\n")  # fmt: skip
    places = {tuple(point): index for index, point in enumerate(points.tolist())}
    for other in drawn.sample(60, seed=1):
        index = places[tuple(other.params["p"])]
        assert other.params["found"] == scene.params["found"][index]
    return list(scene.params["found"])


@pytest.mark.parametrize("name", REGIONS)
def test_distances(name: str) -> None:
    text, polygon, z = REGIONS[name]
    points = near_points(polygon, z, 1)
    found = asked(f"{IMPORT}c = {text}\n", points, "c.distanceTo(p)")
    beside = shapely.distance(polygon, shapely.points(points[:, :2]))
    expected = np.hypot(beside, points[:, 2] - z)
    # The disc of shapely is a polygon: its arcs are a little inside the circle.
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6 if name == "a disc" else 1e-12)
    operator = asked(f"{IMPORT}c = {text}\n", points, "distance from c to p")
    assert operator == found


@pytest.mark.parametrize("name", REGIONS)
def test_membership_whatever_the_height(name: str) -> None:
    text, polygon, z = REGIONS[name]
    points = near_points(polygon, z, 2)
    inside = shapely.covers(polygon, shapely.points(points[:, :2]))
    clear = shapely.distance(polygon.boundary, shapely.points(points[:, :2])) > 1e-5
    for region in (text, f"({text}).footprint", f"Workspace({text})"):
        found = np.array(asked(f"{IMPORT}c = {region}\n", points, "c.containsPoint(p)"))
        assert (found == inside)[clear].all()
    assert 10 < inside.sum() < len(points) - 10


@pytest.mark.parametrize("name", REGIONS)
def test_draws_are_uniform_by_area_at_the_height(name: str) -> None:
    text, polygon, z = REGIONS[name]
    program = scenario(f"{IMPORT}q = new Point in {text}\nparam p = q.position\n")
    points = np.array([tuple(scene.params["p"]) for scene in program.sample(900, seed=5)])
    assert (points[:, 2] == z).all()
    assert shapely.distance(polygon, shapely.points(points[:, :2])).max() < 1e-6
    # Cells of a turned grid, each with the share of its area.
    for angle, columns in ((0.3, 4), (1.2, 3)):
        cells, shares = cells_of(polygon, angle, columns)
        counts = np.array([shapely.covers(cell, shapely.points(points[:, :2])).sum() for cell in cells])
        assert counts.sum() >= 895  # a point on an edge may count nowhere or twice
        expected = shares * counts.sum()
        assert stats.chisquare(counts, expected).pvalue > FALSE_ALARM


def cells_of(polygon: shapely.Geometry, angle: float, columns: int) -> tuple[list[Any], np.ndarray]:
    centre = polygon.centroid
    reach = 12.0
    step = 2.2
    cells = []
    for i in range(-columns, columns):
        for j in range(-columns, columns):
            low, high = (i * step, j * step), ((i + 1) * step, (j + 1) * step)
            if i == -columns or i == columns - 1:
                low, high = ((-reach, low[1]), high) if i < 0 else (low, (reach, high[1]))
            if j == -columns or j == columns - 1:
                low, high = ((low[0], -reach), high) if j < 0 else (low, (high[0], reach))
            box = shapely.affinity.translate(shapely.box(*low, *high), centre.x, centre.y)
            part = shapely.affinity.rotate(box, angle, origin=centre, use_radians=True).intersection(polygon)
            if part.area > 0.02 * polygon.area:
                cells.append(part)
    rest = polygon.difference(shapely.union_all(cells))
    if rest.area > 1e-6:
        cells.append(rest.buffer(1e-9))
    areas = np.array([cell.area for cell in cells])
    return cells, areas / areas.sum()


@pytest.mark.parametrize("distance", [0.75, 0.001, -0.2])
@pytest.mark.parametrize("name", POLYGONS)
def test_buffers(name: str, distance: float) -> None:
    grown = POLYGONS[name].buffer(distance)
    setup = f"{IMPORT}c = PolygonalRegion(polygon=POLYGONS[{name!r}], z=4).buffer({distance})\n"
    (scene,) = scenario(f"{setup}param area = c.area\n").sample(1, seed=0)
    assert scene.params["area"] == pytest.approx(grown.area, rel=1e-9)
    points = near_points(grown, 4, 3, 20)
    expected = np.hypot(shapely.distance(grown, shapely.points(points[:, :2])), points[:, 2] - 4)
    np.testing.assert_allclose(asked(setup, points, "c.distanceTo(p)"), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("margin", [0, 0.4])
def test_unions(margin: float) -> None:
    moved = shapely.affinity.translate(RING, 7, 1)
    joined = shapely.union_all([polygon.buffer(margin) for polygon in (HOOK, WEDGE, moved)]).buffer(-margin)
    setup = (
        f"{IMPORT}from shapely.affinity import translate\n"
        "parts = [POLYGONS['hook'], POLYGONS['wedge'], translate(POLYGONS['ring'], 7, 1)]\n"
        f"c = PolygonalRegion.unionAll([PolygonalRegion(polygon=part, z=1.5) for part in parts], {margin})\n"
    )
    (scene,) = scenario(f"{setup}param area = c.area\n").sample(1, seed=0)
    assert scene.params["area"] == pytest.approx(joined.area, rel=1e-9)
    points = near_points(joined, 1.5, 4, 30)
    expected = np.hypot(shapely.distance(joined, shapely.points(points[:, :2])), points[:, 2] - 1.5)
    np.testing.assert_allclose(asked(setup, points, "c.distanceTo(p)"), expected, rtol=1e-9, atol=1e-9)


def test_projection_onto_a_plane() -> None:
    text = (
        f"{IMPORT}c = PolygonalRegion(polygon=POLYGONS['ring'], z=-2.5)\n"
        "ego = new Object at (Range(-4, 4), Range(-4, 4), Range(-9, 9)), on c, with height 3\nparam p = ego.position\n"
    )
    scenes = scenario(text).sample(60, seed=3)
    points = np.array([tuple(scene.params["p"]) for scene in scenes])
    np.testing.assert_allclose(points[:, 2], -2.5 + 1.5 + 0.5e-4, atol=1e-12)
    assert shapely.covers(RING, shapely.points(points[:, :2])).all()
    tried = sum(scene.attempts for scene in scenes)
    assert stats.binomtest(60, tried, RING.area / 64).pvalue > FALSE_ALARM


# Volumes

ANGLES = (-3.6, -1.2, 0.4)


def to_ellipsoid(point: np.ndarray, half: np.ndarray) -> float:
    """The distance from a point to a solid ellipsoid about the origin, by minimising over its surface."""
    if ((point / half) ** 2).sum() <= 1:
        return 0.0

    def distance(angles: np.ndarray) -> float:
        azimuth, altitude = angles
        surface = half * (
            math.cos(azimuth) * math.cos(altitude),
            math.sin(azimuth) * math.cos(altitude),
            math.sin(altitude),
        )
        return float(np.linalg.norm(surface - point))

    x, y, z = point / half
    start = (math.atan2(y, x), math.atan2(z, math.hypot(x, y)))
    options = {"xatol": 1e-12, "fatol": 1e-14, "maxiter": 2000}
    return float(optimize.minimize(distance, start, method="Nelder-Mead", options=options).fun)


VOLUMES: dict[str, tuple[str, Callable[[np.ndarray], float]]] = {
    "a box": (
        f"BoxRegion((3, 3, 5), position=(1, -2, 3), rotation={ANGLES})",
        lambda p: float(
            np.linalg.norm(
                np.maximum(np.abs(euler(*ANGLES).inv().apply(p - (1, -2, 3))) - (1.5, 1.5, 2.5), 0)
            )
        ),
    ),
    "a spheroid": (
        f"SpheroidRegion((1, 8, 3), position=(1, -2, 3), rotation={ANGLES})",
        lambda p: to_ellipsoid(euler(*ANGLES).inv().apply(p - (1, -2, 3)), np.array([0.5, 4, 1.5])),
    ),
}


@pytest.mark.parametrize("name", VOLUMES)
def test_distances_to_volumes(name: str) -> None:
    text, distance = VOLUMES[name]
    rng = np.random.default_rng(6)
    points = rng.normal(size=(40, 3)) * rng.choice([0.5, 2, 6], (40, 1)) + (1, -2, 3)
    found = asked(f"c = {text}\n", points, "c.distanceTo(p)")
    expected = [distance(point) for point in points]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-7)
    assert 5 < np.count_nonzero(np.array(expected) == 0) < 35


@pytest.mark.parametrize("name", VOLUMES)
def test_draws_from_volumes_are_uniform(name: str) -> None:
    """In the volume's own frame: uniform coordinates of the box, radius and direction of the spheroid."""
    text, _ = VOLUMES[name]
    program = scenario(f"q = new Point in {text}\nparam p = q.position\n")
    points = np.array([tuple(scene.params["p"]) for scene in program.sample(1200, seed=8)])
    local = euler(*ANGLES).inv().apply(points - (1, -2, 3)) / ((3, 3, 5) if name == "a box" else (1, 8, 3))
    if name == "a box":
        for axis in range(3):
            assert stats.kstest(local[:, axis], stats.uniform(-0.5, 1).cdf).pvalue > FALSE_ALARM
    else:
        radius = 2 * np.linalg.norm(local, axis=1)
        assert stats.kstest(radius**3, "uniform").pvalue > FALSE_ALARM
        for axis in range(3):
            # Archimedes: each coordinate of a uniform direction is uniform.
            assert stats.kstest(2 * local[:, axis] / radius, stats.uniform(-1, 2).cdf).pvalue > FALSE_ALARM
    for first, second in ((0, 1), (1, 2), (0, 2)):
        quadrant = (local[:, first] > 0).astype(int) * 2 + (local[:, second] > 0)
        assert stats.chisquare(np.bincount(quadrant, minlength=4)).pvalue > FALSE_ALARM


def test_random_parameters_are_those_of_their_lane() -> None:
    """A disc and a rectangle whose parameters are all random, asked in the same lanes."""
    text = (
        "r, h, x, z = Range(0.5, 2), Range(-7, 7), Range(-3, 3), Range(-2, 2)\n"
        "p = (Range(-4, 4), Range(-4, 4), Range(-4, 4))\n"
        "disc = CircularRegion((x, 1, z), r)\nflat = RectangularRegion((1, x, z), h, r, 3)\n"
        "box = BoxRegion((r, 2, 3), position=(x, 1, z), rotation=(h, 0.4, x))\n"
        "ball = SpheroidRegion((r, 2, 6), position=(x, 1, z), rotation=(h, 0.4, x))\n"
        "param r = r, h = h, x = x, z = z, p = p, a = disc.distanceTo(p), b = flat.distanceTo(p)\n"
        "param c = box.distanceTo(p), d = ball.distanceTo(p), e = disc.containsPoint(p), f = flat.containsPoint(p)\n"
        "param g = box.containsPoint(p), i = ball.containsPoint(p)\n"
    )
    for scene in scenario(text).sample(60, seed=12):
        r, h, x, z, p = (scene.params[name] for name in "rhxzp")
        point = np.array(tuple(p))
        beside = max(0.0, math.hypot(p[0] - x, p[1] - 1) - r)
        assert scene.params["a"] == pytest.approx(math.hypot(beside, p[2] - z), abs=1e-9)
        assert scene.params["e"] == (beside == 0)
        beside = rectangle((1, x), h, r, 3).distance(shapely.Point(p[0], p[1]))
        assert scene.params["b"] == pytest.approx(math.hypot(beside, p[2] - z), abs=1e-9)
        assert scene.params["f"] == (beside == 0)
        local = euler(h, 0.4, x).inv().apply(point - (x, 1, z))
        outside = np.maximum(np.abs(local) - (r / 2, 1, 1.5), 0)
        assert scene.params["c"] == pytest.approx(float(np.linalg.norm(outside)), abs=1e-9)
        assert scene.params["g"] == (not outside.any())
        expected = to_ellipsoid(local, np.array([r / 2, 1, 3]))
        assert scene.params["d"] == pytest.approx(expected, rel=1e-6, abs=1e-7)
        assert scene.params["i"] == (expected == 0)
