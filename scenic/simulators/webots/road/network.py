"""The regions of the roads of a program's world."""

from dataclasses import field
from typing import Any

from scenic.dataclass import dataclass
from scenic.formats.webots_reading import WORLD_PARAMETER, WorldError, read_world
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.regions.fields import PolygonalVectorField
from scenic.runtime.regions.lines import PolylineRegion
from scenic.runtime.regions.planar import PolygonalRegion
from scenic.simulators.webots.road.streets import streets_of

__all__ = ["NoWorldError", "RoadRegions", "regions_of_program"]


class NoWorldError(InvalidScenarioError, RuntimeError):
    """A program with the world model of roads that has not chosen its world."""

    code = "SC620"


@dataclass(frozen=True)
class RoadRegions:
    """Regions of the roads of a world; those that a world lacks are ``None``."""

    direction: PolygonalVectorField
    road: PolygonalRegion
    curb: PolylineRegion | None
    intersection: PolygonalRegion | None
    outside_intersections: PolygonalRegion | None
    sidewalk: PolygonalRegion | None
    crossing: PolygonalRegion | None
    walkway: PolygonalRegion | None
    everything: PolygonalRegion = field(repr=False)


def regions_of_program(parameters: Any) -> RoadRegions:
    """Return the regions of the world that a program has chosen.

    Raises:
        NoWorldError: it has chosen none, or the world has no roads.
        WorldError: the world cannot be read.

    """
    path = parameters[WORLD_PARAMETER] if WORLD_PARAMETER in parameters else None  # noqa: SIM401 - they have no `get`
    if path is None:
        raise NoWorldError(
            "the program has not set a world",
            help="write `from scenic.simulators.webots.road.world import setLocalWorld`, then "
            "`setLocalWorld(__file__, 'FILE.wbt')`, before the model",
        )
    try:
        roads = streets_of(read_world(str(path)))
    except WorldError as error:
        raise NoWorldError(error.message, help=error.help) from error
    if not roads.streets and not roads.crossroads:
        raise NoWorldError(f"the world '{path}' has no roads", help="it needs nodes `Road` or `Crossroad`")
    direction = PolygonalVectorField(
        "roadDirection", [cell for street in roads.streets for cell in street.lanes], defaultHeading=0.0
    )
    surfaces = [street.surface for street in roads.streets]
    roadway = _union([*surfaces, *roads.crossroads])
    sidewalks = _union([each for street in roads.streets for each in street.sidewalks]).difference(roadway)
    crossings = _union(roads.crossings)
    junctions = _union(roads.crossroads)
    road = _region(roadway, direction)
    everything = _region(_union([roadway, sidewalks, crossings]))
    assert road is not None
    assert everything is not None
    lines = [line for street in roads.streets for line in street.curbs]
    return RoadRegions(
        direction,
        road,
        _curb(lines),
        _region(junctions),
        _region(_union(surfaces).difference(junctions), direction),
        _region(sidewalks),
        _region(crossings),
        _region(_union([sidewalks, crossings])),
        everything,
    )


def _union(polygons: Any) -> Any:
    from shapely.ops import unary_union  # slow to import

    return unary_union(list(polygons))


def _region(polygon: object, direction: PolygonalVectorField | None = None) -> PolygonalRegion | None:
    from shapely.geometry import MultiPolygon

    parts = [part for part in getattr(polygon, "geoms", [polygon]) if part.area > 1e-9]
    return PolygonalRegion(polygon=MultiPolygon(parts), orientation=direction) if parts else None


def _curb(lines: object) -> PolylineRegion | None:
    from shapely.geometry import MultiLineString

    return PolylineRegion(polyline=MultiLineString(lines)) if lines else None
