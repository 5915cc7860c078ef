"""An intersection, read from a JSON file of its guideways.

The file is an object: ``main_gw`` is the main guideway, ``vehicle_gw``, ``bicycle_gw`` and ``rail_gw`` are lists of guideways,
``crosswalks`` a list of crosswalks and ``conflict_zones`` one of zones. A guideway has ``id``, ``direction``, ``origin_lane`` (with
``lane_id``), ``median``, ``left_border`` and ``right_border``; a crosswalk has borders; a zone has a ``polygon``. Lines are lists of
latitude and longitude in degrees, in the direction of travel. The first point of the main guideway's median is the origin; x is
east, y is north, in metres.
"""

import json
import math
import os
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.program.veneer import param
from scenic.runtime.regions.fields import PolygonalVectorField
from scenic.runtime.regions.planar import PolygonalRegion

__all__ = ["Guideway", "Intersection", "intersection_of_program", "setLocalIntersection"]

_PARAMETER: Final = "webotsIntersection"
_EQUATOR: Final = 6_378_137.0
"""Radius of the Earth at the equator in metres (WGS 84)."""
_FLATNESS: Final = 1 / 298.257223563

Array = npt.NDArray[np.float64]


class IntersectionError(InvalidScenarioError, RuntimeError):
    """A program without an intersection, or a file that describes none."""

    code = "SC620"


def setLocalIntersection(module: str, relpath: str) -> None:
    """Choose the intersection of a program, before it imports `scenic.simulators.webots.guideways.model`.

    Args:
        module: the file of the program, ``__file__``.
        relpath: the path of the JSON file, relative to the folder of the program.

    """
    param({_PARAMETER: os.path.join(os.path.dirname(os.path.abspath(module)), relpath)})


@dataclass(frozen=True)
class Guideway:
    """A way through the intersection: its polygon between two borders, and the cells of its direction.

    ``cells`` are pairs of a polygon and a heading in radians, anticlockwise from north.
    """

    id: Any
    direction: str
    lane: Any
    region: PolygonalRegion
    cells: tuple[tuple[Any, float], ...]


@dataclass(frozen=True)
class Intersection:
    """The guideways, crosswalks and conflict zones of an intersection, and the field of the directions of travel."""

    mainGuideway: Guideway
    vehicleGuideways: tuple[Guideway, ...]
    bikeGuideways: tuple[Guideway, ...]
    railGuideways: tuple[Guideway, ...]
    crosswalks: tuple[PolygonalRegion, ...]
    conflictZones: tuple[PolygonalRegion, ...]
    roadDirection: PolygonalVectorField

    def guidewayWithID(self, id: object) -> Guideway:
        """Return the guideway with an id; raises `KeyError` if there is none."""
        ways = (self.mainGuideway, *self.vehicleGuideways, *self.bikeGuideways, *self.railGuideways)
        found = next((way for way in ways if way.id == id), None)
        if found is None:
            raise KeyError(f"no guideway has the id {id!r}")
        return found

    @property
    def road(self) -> PolygonalRegion:
        """The guideways of vehicles, with their directions."""
        from shapely.ops import unary_union  # slow to import

        ways = (self.mainGuideway, *self.vehicleGuideways)
        return _region(unary_union([way.region.polygons for way in ways]), self.roadDirection)


def intersection_of_program(parameters: Any) -> Intersection:
    """Return the intersection that a program has chosen; raises `IntersectionError` if it has none, or it cannot be read."""
    path = parameters[_PARAMETER] if _PARAMETER in parameters else None  # noqa: SIM401 - they have no `get`
    if path is None:
        raise IntersectionError(
            "the program has not set an intersection",
            help="write `from scenic.simulators.webots.guideways.intersection import setLocalIntersection`, then "
            "`setLocalIntersection(__file__, 'FILE.json')`, before the model",
        )
    try:
        with open(str(path), encoding="utf-8") as stream:
            data = json.load(stream)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise IntersectionError(
            f"the intersection '{path}' cannot be read: {reason}", help="check the path"
        ) from error
    except ValueError as error:
        raise IntersectionError(f"'{path}' is not JSON: {error}") from error
    try:
        return _intersection(data)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        what = f"`{error.args[0]}` is missing" if isinstance(error, KeyError) else str(error)
        raise IntersectionError(
            f"'{path}' describes no intersection: {what}", help="its format is that of `Intersection`"
        ) from error


def _intersection(data: Any) -> Intersection:
    origin = _pair(data["main_gw"]["median"][0])
    main = _guideway(data["main_gw"], origin)
    vehicles, bicycles, rails = (
        tuple(_guideway(each, origin) for each in data[name])
        for name in ("vehicle_gw", "bicycle_gw", "rail_gw")
    )
    cells = [cell for way in (main, *vehicles) for cell in way.cells]
    return Intersection(
        main,
        vehicles,
        bicycles,
        rails,
        tuple(_region(_between(each, origin)[0]) for each in data["crosswalks"]),
        tuple(_region(_polygon(_projected(each["polygon"], origin))) for each in data["conflict_zones"]),
        PolygonalVectorField("roadDirection", cells, defaultHeading=0.0),
    )


def _pair(point: Any) -> tuple[float, float]:
    latitude, longitude = point
    return float(latitude), float(longitude)


def _projected(points: Sequence[object], origin: tuple[float, float]) -> Array:
    """Convert latitudes and longitudes to metres east and north of the origin, ``(n, 2)``, on the tangent plane there."""
    degrees = np.array([_pair(point) for point in points], dtype=np.float64).reshape(-1, 2)
    latitude = math.radians(origin[0])
    squared = _FLATNESS * (2 - _FLATNESS)
    root = math.sqrt(1 - squared * math.sin(latitude) ** 2)
    east = _EQUATOR / root * math.cos(latitude)
    north = _EQUATOR * (1 - squared) / root**3
    away = np.radians(degrees - np.array(origin))
    return np.stack([away[:, 1] * east, away[:, 0] * north], axis=1)


def _guideway(data: Any, origin: tuple[float, float]) -> Guideway:
    polygon, cells = _between(data, origin)
    lane = data["origin_lane"]["lane_id"]
    return Guideway(data["id"], str(data["direction"]), lane, _region(polygon), tuple(cells))


def _between(data: Any, origin: tuple[float, float]) -> tuple[Any, list[tuple[Any, float]]]:
    """Return the polygon between two borders, and its cells with their headings.

    The borders are divided into equally many pieces, at equal shares of their lengths.
    """
    left, right = (_projected(data[name], origin) for name in ("left_border", "right_border"))
    if min(len(left), len(right)) < 2:
        raise ValueError("a border has fewer than two points")
    polygon = _polygon(np.vstack([right, left[::-1]]))
    shares = np.unique(np.concatenate([_shares(left), _shares(right)]))
    left, right = _at(left, shares), _at(right, shares)
    cells = []
    for start in range(len(shares) - 1):
        dx, dy = (left[start + 1] + right[start + 1] - left[start] - right[start]) / 2
        cell = _polygon(np.array([right[start], right[start + 1], left[start + 1], left[start]]))
        if cell.area > 1e-9:
            cells.append((cell, math.atan2(-dx, dy)))
    return polygon, cells


def _shares(line: Array) -> Array:
    """The share of a line's length before each of its points."""
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    if not lengths[-1] > 0:
        raise ValueError("a border has no length")
    shares: Array = np.round(lengths / lengths[-1], 9)
    return shares


def _at(line: Array, shares: Array) -> Array:
    own = _shares(line)
    return np.stack([np.interp(shares, own, line[:, axis]) for axis in (0, 1)], axis=1)


def _polygon(points: Array) -> Any:
    from shapely.geometry import Polygon  # slow to import

    polygon = Polygon(points)
    return polygon if polygon.is_valid else polygon.buffer(0)


def _region(polygon: object, direction: PolygonalVectorField | None = None) -> PolygonalRegion:
    return PolygonalRegion(polygon=polygon, orientation=direction)
