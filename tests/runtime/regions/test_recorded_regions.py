"""Every kind of region gives what was recorded, whatever programs ask it."""

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest
import scenic.core.regions as named
import scenic.core.vectors
import shapely
import trimesh

from scenic.runtime.geometry.contact.scalar_bodies import placed as placed_at
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.regions import choice, composite
from scenic.runtime.regions import view_regions as views
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import Workspace, everywhere, nowhere
from scenic.runtime.values.values import Orientation, Vector
from tests.recorded import FOLDER, hold
from tests.runtime import matrices
from tests.runtime.geometry.samples import table
from tests.runtime.matrices import attempt, numbers
from tests.runtime.programs import scene, thing

TILT = Orientation.fromEuler(0.7, 0.4, -0.3)
LEAN = Orientation.fromEuler(-1.1, 0.2, 0.5)
LOOP = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
RING = shapely.Polygon([(0, 0), (6, 0), (6, 5), (0, 5)], [[(1, 1), (4, 1), (4, 3), (1, 3)]])
PAIR = shapely.MultiPolygon([RING, shapely.Polygon([(-3, -2), (-1, -2), (-2, 1)])])
HORSESHOE = trimesh.creation.extrude_polygon(
    shapely.Polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]), 1
)
SHEET = trimesh.Trimesh([(0, 0, 0), (2, 0, 1), (0, 3, 0), (2, 3, 1)], [(0, 1, 2), (1, 3, 2)])
CELLS = np.random.default_rng(1).random((4, 3, 5)) < 0.6
ITEM = thing(
    "ego = new Object at (1, 2, 3), facing (0.7, 0.4, -0.3), with width 2, with length 5, with height 0.5, "
    "with viewAngles (100 deg, 60 deg), with visibleDistance 9, with shape ConeShape(), "
    "with sideComponentThresholds ((-0.3, 0.2), (-0.25, 0.35), (-0.4, 0.45))"
)
FIELD = scenic.core.vectors.VectorField("swirl", lambda place: 0.3 * place.x - 0.2 * place.y)
NAMES: dict[str, Any] = {
    **{name: getattr(named, name) for name in dir(named) if name.endswith("Region")},
    **{name: value for name, value in globals().items() if name.isupper()},
    **vars(composite),
    "RegionChoice": choice.RegionChoice,
    "NearView": views.NearView,
    "ViewRegion": views.ViewRegion,
    "Workspace": Workspace,
    "everywhere": everywhere,
    "nowhere": nowhere,
    "Vector": Vector,
    "np": np,
    "pi": math.pi,
    "shapely": shapely,
    "trimesh": trimesh,
    "part_of": views.part_of,
    "table": table,
    "long_line": [(x / 9, math.sin(x / 9)) for x in range(150)],
    "far_line": [(x, x * x / 9, math.cos(x)) for x in range(-3, 4)],
}


def made(source: str) -> Region:
    region = eval(source, dict(NAMES))
    assert isinstance(region, Region)
    return region


Frame = Callable[[float, float, float], Vector]
"""Where shares of a region's box are; above 1 and below 0 beside it."""


def frame_of(region: Region) -> Frame:
    lower, upper = (np.clip(end[0], -5, 6) for end in region.box(*region.fixed_columns("a test")))
    return lambda x, y, z: Vector(*(lower + np.array([x, y, z]) * (upper - lower)).round(3).tolist())


def methods(at: Frame) -> dict[str, list[tuple[Any, ...]]]:
    """Arguments to ask methods with."""
    places = [
        at(0.43, 0.38, 0.52),
        at(0.71, 0.64, 0.9),
        at(0.12, 0.55, 0),
        at(0.6, 0.2, 1),
        at(-0.03, 0.5, 0.4),
        at(0.5, 1.02, 0.5),
    ]
    things = small(at(0.43, 0.38, 0.52), at(0.61, 0.58, 0.2), at(0.5, 0.5, 1) + Vector(0, 0, 0.19))
    return {
        "containsPoint": [(place,) for place in places],
        "containsObject": [(one,) for one in things],
        "containsRegion": [
            (named.PointSetRegion("a", places[:1]),),
            (named.CircularRegion(places[0], 0.2), 0.1),
            (named.BoxRegion((0.2, 0.1, 0.3), places[1], TILT),),
            (named.PathRegion(places[:2]),),
        ],
        "distanceTo": [(place,) for place in places[3:]],
        "distance_from": [(at(1.2, -0.1, 1.3),)],
        "intersects": [
            *((one,) for one in things),
            (named.BoxRegion((1, 2, 0.4), at(0.8, 0.3, 0.2), TILT),),
            (named.CircularRegion(at(0.5, 0.6, 0), 0.4),),
            (named.PathRegion([at(0.4, 0.2, -0.5), at(0.6, 0.7, 1.5)]),),
        ],
        "project": [
            (at(0.43, 0.38, 1.5) + Vector(0, 0, 1), None),
            (at(0.43, 0.38, 1.5) + Vector(0, 0, 1), (0.1, 0.05, 1)),
            (at(0.61, 0.58, -1.3), (0, 0, 1)),
            (at(-1, 0.48, 0.55), (1, 0.02, 0.01)),
            (at(0.43, 0.38, 0.52), None),
            (at(7, 7, 7), (1, 0, 0)),
        ],
        "projectVector": [(at(0.55, 0.45, 2), (0, 0, 1)), ((30, 30, 30), (0, 0, 1))],
        "orientation_at": [(places[0],), (places[1],)],
        "orient": [(places[0],)],
        "__contains__": [(places[0],), (things[0],)],
        "buffer": [(0.3,), (-0.1,)],
        "voxelized": [(0.5,), (0,), (1e-4,)],
        "dilation": [(1,), (2,), (0,), (-1,)],
        "nearestSegmentTo": [(place,) for place in places],
        "signedDistanceTo": [(place,) for place in places],
        "pointAlongBy": [(1.3,), (-0.7,), (0.4, True), (-0.25, True), (1e9,)],
        "equallySpacedPoints": [(4,)],
        "pointsSeparatedBy": [(1.7,)],
        "defaultOrientation": [(places[1],)],
        "boundFootprint": [(1, 3)],
        "approxBoundFootprint": [(-1, 0.5)],
        "gridToPoint": [((2, 1),)],
        "pointToGrid": [((4.4, 0.3),), ((1.6, -1.3),), ((-9, 0),), ((2.5, 9),)],
        "getSurfaceRegion": [()],
        "getVolumeRegion": [()],
        "__getitem__": [(1,), (-1,)],
        "__len__": [()],
        "__iter__": [()],
        "__repr__": [()],
        "__str__": [()],
        "__add__": [(named.PolylineRegion([(1, 1), (3, -1)]),), (3,)],
    }


def small(*places: Vector) -> list[Any]:
    """Small tilted things there."""
    made = [
        f"new Object at ({x}, {y}, {z}), facing (0.5, -0.3, 0.2), with width 0.3, with length 0.2, with height 0.4, "
        "with shape CylinderShape(), with allowCollisions True"
        for x, y, z in places
    ]
    return list(scene("ego = " + "\n".join(made)).objects)


def members(source: str) -> str:
    """What programs ask: every public attribute, and methods with some arguments."""
    region = made(source)
    lines = []
    known = methods(frame_of(region))
    for name in sorted({*dir(region)} - _UNASKED):
        if name.startswith("_") and name not in known:
            continue
        if name in known:
            for arguments in known[name]:
                shown = ", ".join(map(_argument, arguments))
                lines.append(
                    f"{name}({shown}): {attempt(lambda n=name, a=arguments: getattr(region, n)(*a))}"
                )
        else:
            found = attempt(lambda n=name: getattr(region, n))
            if not found.startswith(("method ", "function ", "builtin", "_Algebra", "ABCMeta", "Kind")):
                lines.append(f"{name}: {found}")
    return "\n".join(lines)


def _argument(value: Any) -> str:
    if isinstance(value, Region):
        return type(value).__name__
    return f"thing at {value.position}" if hasattr(value, "position") else repr(value)


_UNASKED = {
    "algebra", "at_once", "body", "cells_within", "fixed_columns", "kdTree", "kindred", "scenic_kind", "sample", "single",
    "uniformPointInner", "uniform_placement", "parameters", "random_parts", "sampled", "name", "source", "pieces", "outline",
    "tolerance", "parameter_names", "may_find_none", "is_random", "has_closed_form", "draws", "is_alike", "dimension", "has_orientation",
    "part_of", "voxel_points", "footprint", "members", "chains",
}  # fmt: skip
"""What is asked otherwise, or says nothing."""


def pairs(source: str) -> str:
    """What two regions have in common, for each pair of the lines."""
    regions = [made(line) for line in source.strip("\n").split("\n")]
    lines = []
    for i, one in enumerate(regions):
        for j, other in enumerate(regions):
            lines.append(f"{i} {j} meet {attempt(lambda a=one, b=other: a.intersects(b))}")
            lines.append(f"{i} {j} holds {attempt(lambda a=one, b=other: a.containsRegion(b, 0.05))}")
            lines.append(f"{i} {j} both {attempt(lambda a=one, b=other: a.intersect(b))}")
            lines.append(f"{i} {j} rest {attempt(lambda a=one, b=other: a.difference(b))}")
            if i <= j:
                lines.append(f"{i} {j} either {attempt(lambda a=one, b=other: a.union(b))}")
    return "\n".join(lines)


def at_once(source: str) -> str:
    """What is told of one thing at a time: as told over lanes, or nothing."""
    region = made(source)
    single, columns = region.at_once, region.fixed_columns("a test")
    assert single is not None
    rng = np.random.default_rng(8)
    lower, upper = (end[0] for end in region.box(*columns))
    extent = np.maximum(upper - lower, 0.3)
    places = (lower + upper) / 2 + rng.uniform(-0.8, 0.8, (12, 3)) * extent
    places[:, 2] = np.where(np.arange(12) % 2, places[:, 2], (lower + upper)[2] / 2)
    lines = [f"holds {told(single.holds_point(tuple(place)) for place in places.tolist())}"]
    distances = [single.distance(tuple(place)) for place in places.tolist()]
    lines.append(f"distances {numbers([np.nan if found is None else found for found in distances])}")
    size, turn = rng.uniform(0.1, 1.2, (12, 3)), matrices.turns(rng, 12)
    for mesh in (primitives.box(), primitives.cone(), table()):
        placed = [
            placed_at(tuple(p), tuple(q), tuple(s), mesh)
            for p, q, s in zip(places.tolist(), turn.tolist(), size.tolist(), strict=True)
        ]
        lines.append(f"holds {told(map(single.holds_body, placed))}")
        lines.append(f"meets {told(map(single.meets_body, placed))}")
    return "\n".join(lines)


def told(answers: Iterable[bool | None]) -> str:
    return "".join({True: "X", False: "o", None: "?"}[answer] for answer in answers)


@pytest.mark.parametrize("form", ["members", "pairs", "at_once"])
def test_regions(form: str, request: pytest.FixtureRequest) -> None:
    answer = {"members": members, "pairs": pairs, "at_once": at_once}[form]
    hold(FOLDER / f"regions_{form}.txt", answer, request)
