"""Collision and containment where they change, against exact Booleans, shapely and closed forms."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from scipy import stats

from tests.amounts import amount
from tests.runtime.boundaries import ROUNDING, Thing, apart, covers, flip, flips, holds, together, unit_mesh
from tests.runtime.programs import FALSE_ALARM, euler, scenario

SCENES = amount(6, 10)
PAIRS = amount(8, 14)
WAYS = amount(6, 10)
"""Directions in which a thing, or a point, leaves another."""
NARROW, WIDE = 1e-3, 1e-2

HALF = math.pi / 2
SIZES = [(1, 1, 0.4), (0.4, 2, 1), (0.3, 0.3, 1.7), (1, 1, 1), (2, 0.5, 0.5)]
ANGLES = [(0, 0, 0), (4.0, 0.7, -2.5), (-5.5, HALF, 1.0), (2.0, -HALF, 0.3), (0.8, 0, 0), (0, 3.6, 0)]
NAMES = ["box", "box", "spheroid", "cone", "cylinder", "table", "hollow", "bumpy"]


def pairs(seed: int, count: int) -> list[tuple[Thing, Thing, tuple[float, float, float]]]:
    """Pairs of things around one place, and a direction in which the second is moved away."""
    rng = np.random.default_rng(seed)
    found = []
    for index in range(count):
        place = tuple(rng.uniform(-30, 30, 3).round(3).tolist())
        one, other = (
            Thing(NAMES[(index + step) % len(NAMES)], SIZES[rng.integers(5)], place, ANGLES[rng.integers(6)])
            for step in (0, int(rng.integers(1, 4)))
        )
        way = rng.normal(size=3)
        found.append((one, other, tuple((way / np.linalg.norm(way)).round(6).tolist())))
    return found


def moved(thing: Thing, way: tuple[float, float, float], d: float) -> Thing:
    return replace(thing, position=tuple(p + w * d for p, w in zip(thing.position, way, strict=True)))


def moving_text(thing: Thing, way: tuple[float, float, float], name: str) -> str:
    parts = (f"({p}) + ({w}) * {name}" for p, w in zip(thing.position, way, strict=True))
    return f"({', '.join(parts)})"


def compare(
    text: str, cases: list[tuple[str, str, Callable[[float], bool], Callable[[float], float]]], seed: int
) -> None:
    """Check scenes of a program: each case has parameter, draw, expected answer, and how far the draw is from a change."""
    asked = text + "".join(f"param {answer} = {answer}, {draw} = {draw}\n" for answer, draw, _, _ in cases)
    decided = np.zeros(2, dtype=int)
    for scene in scenario(asked).sample(SCENES, seed=seed):
        for answer, draw, expected, margin in cases:
            d = scene.params[draw]
            if margin(d) > ROUNDING:
                wanted = expected(d)
                assert scene.params[answer] is wanted, (answer, d)
                decided[int(wanted)] += 1
    assert decided.min() > 0.15 * decided.sum()


@pytest.mark.parametrize("width", [NARROW, WIDE])
@pytest.mark.parametrize("seed", range(amount(2, 3)))
def test_things_that_nearly_touch(seed: int, width: float, tmp_path: Path) -> None:
    text, cases = "", []
    for index, (one, other, way) in enumerate(pairs(seed, PAIRS)):

        def hits(d: float, one: Thing = one, other: Thing = other, way: Any = way) -> bool:
            return together(one, moved(other, way, d))

        changes = flips(hits, np.linspace(3, 0, 31).tolist())
        if not changes:
            continue
        place = changes[seed % len(changes)]
        text += (
            f"d{index} = Range({place - width}, {place + width})\na{index} = {one.text(tmp_path)}\n"
            f"b{index} = {other.text(tmp_path, position=moving_text(other, way, f'd{index}'))}\n"
            f"hit{index} = a{index} intersects b{index}\n"
        )
        cases.append((f"hit{index}", f"d{index}", hits, lambda d, place=place: abs(d - place)))
    assert len(cases) >= 0.6 * PAIRS
    compare(text, cases, seed)


@pytest.mark.parametrize("seed", range(2))
def test_things_that_grow_and_turn_until_they_touch(seed: int, tmp_path: Path) -> None:
    """Sizes and angles that are random: nothing about the pair is the same in two lanes."""
    text, cases = "", []
    for index, (one, other, way) in enumerate(pairs(100 + seed, PAIRS)):
        other = moved(other, way, 0.9)
        grows = index % 2

        def changed(d: float, other: Thing = other, grows: int = grows) -> Thing:
            if grows:
                return replace(other, size=(d, *other.size[1:]))
            return replace(other, angles=(d, *other.angles[1:]))

        def hits(d: float, one: Thing = one, changed: Callable[[float], Thing] = changed) -> bool:
            return together(one, changed(d))

        changes = flips(hits, np.linspace(0.05, 3, 25).tolist() if grows else np.linspace(-7, 7, 30).tolist())
        if not changes:
            continue
        place = changes[0]
        name = f"d{index}"
        angles = f"({name}, {other.angles[1]}, {other.angles[2]})"
        second = other.text(tmp_path, width=name) if grows else other.text(tmp_path, angles=angles)
        text += (
            f"{name} = Range({place - NARROW}, {place + NARROW})\na{index} = {one.text(tmp_path)}\n"
            f"b{index} = {second}\nhit{index} = b{index} intersects a{index}\n"
        )

        def margin(d: float, one: Thing = one, changed: Callable[[float], Thing] = changed) -> float:
            gap = apart(one, changed(d))
            return gap if gap > 0 else math.sqrt((one.solid() ^ changed(d).solid()).volume())

        cases.append((f"hit{index}", name, hits, margin))
    assert len(cases) >= 0.4 * PAIRS
    compare(text, cases, seed)


def test_collisions_reject_as_much_as_they_must(tmp_path: Path) -> None:
    """Without tolerance of collisions the accepted scenes are those apart, and as many as there should be."""
    cases = [
        ("box", "box", (0.9, 0.3, 0.2)),
        ("table", "box", (0.1, 0.05, 1)),
        ("spheroid", "cone", (0.5, -0.6, 0.3)),
    ]
    for first, second, way in cases:
        one = Thing(first, (1, 2, 0.5), (7, -3, 2), (4.0, HALF, 0.4))
        other = Thing(second, (0.7, 0.7, 1.5), (7, -3, 2), (-5.0, 0.3, -HALF))
        place = max(flips(lambda d: together(one, moved(other, way, d)), np.linspace(4, 0, 41).tolist()))  # noqa: B023
        text = (
            f"d = Range({place - 3 * WIDE}, {place + WIDE})\na = {one.text(tmp_path)}\n"
            f"b = {other.text(tmp_path, position=moving_text(other, way, 'd'))}\nparam d = d\n"
        ).replace(", with allowCollisions True", "")
        scenes = scenario(text).sample(60, seed=4)
        assert min(scene.params["d"] for scene in scenes) > place - ROUNDING
        tried = sum(scene.attempts for scene in scenes)
        assert stats.binomtest(60, tried, 0.25).pvalue > FALSE_ALARM


# Containers: text, and whether they hold a thing.

RING = shapely.Polygon(
    [(3 * math.cos(k / 5), 3 * math.sin(k / 5)) for k in range(31)],
    [[(0.4 * math.cos(k), 0.4 * math.sin(k)) for k in range(6)]],
)
HOOK = shapely.Polygon([(-3, -3), (3, -3), (3, 3), (1, 3), (1, -1), (-1, -1), (-1, 3), (-3, 3)])
WEDGE = shapely.Polygon([(-3, -2), (4, -1.5), (1, 3.5)])
POLYGONS = {"ring": RING, "hook": HOOK, "wedge": WEDGE}


def local(thing: Thing, dimensions: Any, position: Any, angles: Any) -> np.ndarray:
    return euler(*angles).inv().apply(thing.vertices() - position) / dimensions


def disc(center: Any, radius: float, resolution: int) -> shapely.Polygon:
    angles = np.arange(4 * resolution) * (HALF / resolution)
    return shapely.Polygon(np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius + center[:2])


def rectangle(position: Any, heading: float, width: float, length: float) -> shapely.Polygon:
    box = shapely.box(-width / 2, -length / 2, width / 2, length / 2)
    turned = shapely.affinity.rotate(box, heading, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, position[0], position[1])


CONTAINERS: dict[str, tuple[str, Callable[[Thing], bool]]] = {
    "a turned box": (
        "BoxRegion((3, 3, 5), position=(1, -2, 3), rotation=(4.0, 0.6, -2.0))",
        lambda thing: bool(np.abs(local(thing, (3, 3, 5), (1, -2, 3), (4.0, 0.6, -2.0))).max() <= 0.5),
    ),
    "an upended box": (
        f"BoxRegion((4, 3, 3), position=(1, -2, 3), rotation=(0.5, {HALF}, 0.7))",
        lambda thing: bool(np.abs(local(thing, (4, 3, 3), (1, -2, 3), (0.5, HALF, 0.7))).max() <= 0.5),
    ),
    "a stretched spheroid": (
        "SpheroidRegion((4, 8, 5), position=(-1, 2, 0.5), rotation=(-3.6, -1.2, 0.4))",
        lambda thing: bool(
            np.linalg.norm(local(thing, (4, 8, 5), (-1, 2, 0.5), (-3.6, -1.2, 0.4)), axis=1).max() <= 0.5
        ),
    ),
    "a disc": ("CircularRegion((2, -1, 3), 2.2, 3)", lambda thing: covers(disc((2, -1), 2.2, 3), thing)),
    "a turned rectangle": (
        "RectangularRegion((-2, 1, 5), 4.2, 3.5, 6)",
        lambda thing: covers(rectangle((-2, 1), 4.2, 3.5, 6), thing),
    ),
    **{
        name: (
            f"PolygonalRegion(polygon=POLYGONS['{name}'], z=2)",
            lambda thing, polygon=polygon: covers(polygon, thing),
        )
        for name, polygon in POLYGONS.items()
    },
}
INNER = [
    Thing("box", (0.6, 0.6, 1.2), angles=(0.7, 0.4, 3.9)),
    Thing("cone", (1.1, 0.5, 0.5), angles=(-4.0, -HALF, 0.2)),
    Thing("table", (1, 1, 0.5), angles=(2.2, HALF, 0.1)),
]
CENTRES = {"a turned box": (1, -2, 3), "an upended box": (1, -2, 3), "a stretched spheroid": (-1, 2, 0.5), "a disc": (2, -1, 0), "a turned rectangle": (-2, 1, 9), "ring": (1.6, 0.4, -3), "hook": (2, 1, 2), "wedge": (0.5, 0, 1)}  # fmt: skip


@pytest.mark.parametrize("name", CONTAINERS)
def test_things_that_nearly_leave_a_container(name: str, tmp_path: Path) -> None:
    container, held = CONTAINERS[name]
    text, cases = f"from tests.runtime.geometry.test_boundaries import POLYGONS\nc = {container}\n", []
    rng = np.random.default_rng(7)
    for index in range(9):
        thing = replace(INNER[index % 3], position=CENTRES[name])
        assert held(thing), "the centre is a bad one"
        way = tuple((rng.normal(size=3) * (1, 1, 0.3)).round(4).tolist())

        def inside(d: float, thing: Thing = thing, way: Any = way) -> bool:
            return held(moved(thing, way, d))

        places = flips(inside, np.linspace(0, 12, 61).tolist())
        place = places[index % len(places)]
        width = (NARROW, WIDE)[index % 2]
        text += (
            f"d{index} = Range({place - width}, {place + width})\n"
            f"a{index} = {thing.text(tmp_path, position=moving_text(thing, way, f'd{index}'))}\n"
            f"held{index} = c.containsObject(a{index})\n"
        )
        cases.append((f"held{index}", f"d{index}", inside, lambda d, place=place: abs(d - place)))
    compare(text, cases, 3)


@pytest.mark.parametrize("outer", ["box", "cylinder", "spheroid", "bumpy", "hollow"])
def test_things_that_nearly_leave_an_object(outer: str, tmp_path: Path) -> None:
    room = Thing(outer, (4, 4, 6), (5, -7, 2), (3.7, 1.1, -HALF))
    text, cases = f"room = {room.text(tmp_path)}\n", []
    rng = np.random.default_rng(17)
    for index in range(WAYS):
        thing = replace(INNER[index % 3], size=(0.5, 0.5, 0.3))
        way = tuple(rng.normal(size=3).round(4).tolist())

        def inside(d: float, thing: Thing = thing, way: Any = way) -> bool:
            return holds(room, moved(replace(thing, position=room.position), way, d))

        places = flips(inside, np.linspace(0, 5, 51).tolist())
        place = places[index % len(places)]
        thing = replace(thing, position=room.position)
        text += (
            f"d{index} = Range({place - NARROW}, {place + NARROW})\n"
            f"a{index} = {thing.text(tmp_path, position=moving_text(thing, way, f'd{index}'))}\n"
            f"held{index} = room.occupiedSpace.containsObject(a{index})\n"
        )
        cases.append((f"held{index}", f"d{index}", inside, lambda d, place=place: abs(d - place)))
    compare(text, cases, 5)


@pytest.mark.parametrize("name", CONTAINERS)
def test_containers_reject_as_much_as_they_must(name: str, tmp_path: Path) -> None:
    """As a requirement, of one object and of the workspace."""
    container, held = CONTAINERS[name]
    thing = replace(INNER[0], position=CENTRES[name])
    way = (0.6, 0.7, 0.2)
    place = flip(lambda d: held(moved(thing, way, d)), 0, 12)
    made = thing.text(tmp_path, position=moving_text(thing, way, "d"))
    for text in (
        f"c = {container}\na = {made}, with regionContainedIn c\n",
        f"workspace = Workspace({container})\na = {made}\n",
    ):
        program = scenario(
            f"from tests.runtime.geometry.test_boundaries import POLYGONS\nd = Range({place - WIDE}, {place + 3 * WIDE})\n{text}param d = d\n"
        )
        scenes = program.sample(40, seed=2)
        assert max(scene.params["d"] for scene in scenes) < place + ROUNDING
        assert max(scene.params["d"] for scene in scenes) > place - WIDE / 2


# Points


def ellipsoid_margin(point: np.ndarray, dimensions: Any, position: Any, angles: Any) -> float:
    local_point = euler(*angles).inv().apply(point - position) / dimensions
    return float(np.linalg.norm(local_point) - 0.5)


def box_margin(point: np.ndarray, dimensions: Any, position: Any, angles: Any) -> float:
    local_point = euler(*angles).inv().apply(point - position) / dimensions
    return float(np.abs(local_point).max() - 0.5)


POINT_REGIONS: dict[str, tuple[str, Callable[[np.ndarray], bool], tuple[float, float, float]]] = {
    "a turned box": (
        CONTAINERS["a turned box"][0],
        lambda p: box_margin(p, (3, 3, 5), (1, -2, 3), (4.0, 0.6, -2.0)) <= 0,
        (1, -2, 3),
    ),
    "a stretched spheroid": (
        CONTAINERS["a stretched spheroid"][0],
        lambda p: ellipsoid_margin(p, (4, 8, 5), (-1, 2, 0.5), (-3.6, -1.2, 0.4)) <= 0,
        (-1, 2, 0.5),
    ),
    "a disc": (
        "CircularRegion((2, -1, 3), 2.2, 3)",
        lambda p: math.hypot(p[0] - 2, p[1] + 1) <= 2.2,
        (2, -1, 40),
    ),
    "a turned rectangle": (
        CONTAINERS["a turned rectangle"][0],
        lambda p: rectangle((-2, 1), 4.2, 3.5, 6).covers(shapely.Point(p[:2])),
        (-2, 1, -7),
    ),
    **{
        name: (CONTAINERS[name][0], lambda p, polygon=polygon: polygon.covers(shapely.Point(p[:2])), CENTRES[name])
        for name, polygon in POLYGONS.items()
    },
}  # fmt: skip


@pytest.mark.parametrize("name", POINT_REGIONS)
def test_points_that_nearly_leave_a_region(name: str) -> None:
    region, held, centre = POINT_REGIONS[name]
    text, cases = f"from tests.runtime.geometry.test_boundaries import POLYGONS\nc = {region}\n", []
    rng = np.random.default_rng(23)
    for index in range(10):
        way = tuple(rng.normal(size=3).round(4).tolist())

        def inside(d: float, way: Any = way) -> bool:
            return bool(held(np.array(centre) + np.array(way) * d))

        places = flips(inside, np.linspace(0, 20, 101).tolist())
        place = places[index % len(places)]
        width = (NARROW, WIDE)[index % 2]
        point = moving_text(Thing("box", position=centre), way, f"d{index}")
        text += (
            f"d{index} = Range({place - width}, {place + width})\nheld{index} = c.containsPoint({point})\n"
        )
        cases.append((f"held{index}", f"d{index}", inside, lambda d, place=place: abs(d - place)))
    compare(text, cases, 9)


@pytest.mark.parametrize("shape", ["box", "cone", "cylinder", "spheroid", "table", "hollow", "bumpy"])
def test_points_that_nearly_leave_an_object(shape: str, tmp_path: Path) -> None:
    body = Thing(shape, (1, 1, 3), (-4, 3, 8), (2.9, -1.3, 4.4))
    speck = Thing("box", (1e-7, 1e-7, 1e-7))
    text, cases = f"c = {body.text(tmp_path)}\n", []
    rng = np.random.default_rng(29)
    for index in range(WAYS):
        way = tuple(rng.normal(size=3).round(4).tolist())
        face = unit_mesh(shape)[1][rng.integers(len(unit_mesh(shape)[1]))]
        start = replace(speck, position=tuple(body.vertices()[face].mean(axis=0).tolist()))

        def inside(d: float, way: Any = way, start: Thing = start) -> bool:
            return together(body, moved(start, way, d))

        places = flips(inside, np.linspace(-2.01, 2, 80).tolist())
        if not places:  # along a face
            continue
        place = places[index % len(places)]
        point = moving_text(start, way, f"d{index}")
        text += (
            f"d{index} = Range({place - NARROW}, {place + NARROW})\nheld{index} = c.containsPoint({point})\n"
        )
        cases.append((f"held{index}", f"d{index}", inside, lambda d, place=place: abs(d - place) - 1e-6))
    assert len(cases) >= 0.6 * WAYS
    compare(text, cases, 11)
