"""Functions of the established Python API that have no counterpart of their own here, in terms of ours.

Signatures are those that existing scripts use; `scenic.established` maps the names of the modules to them.
"""

import functools
import itertools
import math
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final, TextIO

import numpy as np

from scenic.language.errors import ScenicTypeError
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.solids import proper_volume
from scenic.runtime.ground.context import verbosity as verbosity_now
from scenic.runtime.instances.objects import Point
from scenic.runtime.regions.algebra import region_of
from scenic.runtime.regions.base import Region
from scenic.runtime.scenes.dumping import NoLiteralError, literal
from scenic.runtime.values.lazy import Lazy, defer, is_lazy
from scenic.runtime.values.lazy import resolve as valueInContext  # noqa: N812 - the established name
from scenic.runtime.values.values import (
    Orientation,
    Random,
    Vector,
    is_number,
    is_random,
    operate,
    to_heading,
    to_orientation,
    to_scalar,
    to_vector,
)


class Heading(float):
    """The type of headings, for `toType` and `isA`."""


_COERCIONS: Mapping[type, Callable[[Any], Any]] = MappingProxyType(
    {float: to_scalar, Heading: to_heading, Vector: to_vector, Orientation: to_orientation}
)


def needsSampling(thing: object) -> bool:
    """Return whether a value is random, or holds something random."""
    if isinstance(thing, Point):
        return any(is_random(value) for value in thing.__dict__.values())
    return is_random(thing) or is_random(getattr(thing, "parameters", None))


def needsLazyEvaluation(thing: object) -> bool:
    """Return whether a value depends on the object being specified."""
    return is_lazy(thing)


def DelayedArgument(requiredProps: Iterable[str], value: Callable[[Any], Any], **_options: Any) -> Lazy:
    """Return a value that is computed from properties of the object being specified."""
    return Lazy(frozenset(requiredProps), value)


def toDistribution(value: object) -> Any:
    """Return a value as one that may be random: itself."""
    return value


def underlyingType(thing: object) -> type:
    """Return the type of what a value is, or of what is drawn from it; ``object`` where that is not known."""
    if not isinstance(thing, Random):
        return type(thing)
    return {
        "scalar": float,
        "integer": int,
        "boolean": bool,
        "vector": Vector,
        "orientation": Orientation,
    }.get(thing.node.kind.value, object)


def isA(thing: object, ty: type) -> bool:
    """Return whether a value is certainly of a type: also a random value, if it is known."""
    return issubclass(underlyingType(thing), ty)


def canCoerce(thing: object, ty: type, exact: bool = False) -> bool:
    """Return whether a value can be read as a type."""
    if exact or ty not in _COERCIONS:
        return isA(thing, ty)
    try:
        _COERCIONS[ty](thing)
    except (ScenicTypeError, ValueError):
        return False
    return True


def canCoerceType(typeA: type, typeB: type) -> bool:
    """Return whether values of one type can be taken as another: numbers as ``float``, pairs, triples and points as vectors."""
    if issubclass(typeA, typeB) or (typeB is float and issubclass(typeA, int | float | np.number)):
        return True
    return typeB is Vector and issubclass(typeA, tuple | list | Vector | Point)


def coerce(thing: object, ty: type, error: str = "wrong type") -> Any:
    """Return a value as a type; raises ``TypeError`` with this message where it cannot be read so."""
    return toType(thing, ty, error)


def toType(thing: object, ty: type, typeError: str = "wrong type") -> Any:
    """Return a value as a type; raises ``TypeError`` with this message where it cannot be read so."""
    return toTypes(thing, (ty,), typeError)


def toTypes(thing: object, types: Sequence[type], typeError: str = "wrong type") -> Any:
    """Return a value as the first of several types that it can be read as."""
    for ty in types:
        if canCoerce(thing, ty):
            return _COERCIONS[ty](thing) if ty in _COERCIONS else thing
    raise ScenicTypeError(typeError)


def toScalar(thing: object, typeError: str = "non-scalar in scalar context") -> Any:
    """Return a value as a number."""
    return toType(thing, float, typeError)


def toHeading(thing: object, typeError: str = "non-heading in heading context") -> Any:
    """Return a value as a heading, in radians."""
    return toType(thing, Heading, typeError)


def toOrientation(thing: object, typeError: str = "non-orientation in orientation context") -> Any:
    """Return a value as an orientation."""
    return toType(thing, Orientation, typeError)


def toVector(thing: object, typeError: str = "non-vector in vector context") -> Any:
    """Return a value as a vector."""
    return toType(thing, Vector, typeError)


_FEW_TURNS: Final = 100.0
"""Radians of which whole turns are taken one by one, as others have done it, to the last digit."""


def normalizeAngle(angle: float) -> float:
    """Return an angle in [-pi, pi] that differs by whole turns (radians)."""
    if not is_number(angle) or abs(angle) > _FEW_TURNS:
        return operate("normalize angle", angle)  # type: ignore[no-any-return]
    while angle > math.pi:
        angle -= 2 * math.pi
    while angle < -math.pi:
        angle += 2 * math.pi
    return angle


def headingOfSegment(pointA: object, pointB: object) -> Any:
    """The heading from one point of the plane to another (radians)."""
    start, end = to_vector(pointA), to_vector(pointB)
    return operate("azimuth", operate("subtract", end, start))


def averageVectors(a: Any, b: Any, weight: float = 0.5) -> Any:
    """The point that divides the way from ``a`` to ``b`` by ``weight``, as a pair."""
    return tuple((1 - weight) * p + weight * q for p, q in zip(tuple(a)[:2], tuple(b)[:2], strict=True))


def viewAngleToPoint(point: object, base: object, heading: float) -> Any:
    """The angle of a point seen from ``base``, relative to ``heading`` (radians)."""
    return normalizeAngle(headingOfSegment(base, point) - heading)


def apparentHeadingAtPoint(point: object, heading: float, base: object) -> Any:
    """A heading at a point relative to the line of sight from ``base`` (radians)."""
    return normalizeAngle(heading - headingOfSegment(base, point))


def rotateVector(vector: object, angle: float) -> Any:
    """Return a vector of the plane turned anticlockwise, as a pair."""
    turned = to_vector(vector).rotatedBy(angle)
    return (turned.x, turned.y)


def pointIsInCone(point: object, base: object, heading: float, angle: float) -> bool:
    """Return whether a point of the plane lies within ``angle / 2`` of ``heading`` seen from ``base`` (radians)."""
    return bool(abs(viewAngleToPoint(point, base, heading)) <= angle / 2)


def distanceToLine(point: Any, a: Any, b: Any) -> float:
    """The distance of a point of the plane from the line through two others, in metres."""
    (x, y), (ax, ay), (bx, by) = (tuple(item)[:2] for item in (point, a, b))
    return float(abs((bx - ax) * (ay - y) - (ax - x) * (by - ay)) / math.hypot(bx - ax, by - ay))


def findMinMax(iterable: Iterable[Any]) -> tuple[Any, Any]:
    """The least and the greatest of some numbers."""
    numbers = list(iterable)
    return min(numbers, default=math.inf), max(numbers, default=-math.inf)


def removeHoles(polygon: Any) -> Any:
    """Return a shapely polygon or multipolygon without its holes."""
    import shapely

    parts = [shapely.Polygon(part.exterior) for part in getattr(polygon, "geoms", [polygon])]
    return shapely.union_all(parts) if polygon.geom_type == "MultiPolygon" else parts[0]


def triangulatePolygon(polygon: object) -> list[Any]:
    """Return a shapely polygon, perhaps with holes, as triangles that fill it."""
    import shapely

    parts: list[Any] = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon)).tolist()
    return parts


def regionFromShapelyObject(obj: object, orientation: object = None) -> Region:
    """Return the region of a shapely geometry: its polygons, else its lines, else its points."""
    return region_of(obj, 0.0, orientation)


def convertToFootprint(region: Region) -> Region:
    """Return the columns above and below a region of the plane; any other region as it is."""
    return region.footprint


def toPolygon(thing: object) -> Any:
    """Return the shapely geometry of a polygon, of a region of the plane, its footprint or a line; ``None`` of anything else."""
    if hasattr(thing, "geom_type"):
        return thing if "Polygon" in thing.geom_type else None
    return getattr(thing, "polygons", getattr(thing, "lineString", None))


def polygonUnion(
    polys: Iterable[Any], buf: float = 0, tolerance: float = 0, holeTolerance: float = 0.002
) -> Any:
    """Return the union of shapely polygons.

    Gaps narrower than twice ``buf`` are closed. With a ``tolerance``, outlines are simplified by so much, and holes smaller than
    ``holeTolerance`` square metres are filled.
    """
    import shapely

    members = list(polys)
    if len(members) == 1:
        return members[0]
    outline = shapely.union_all([poly.buffer(buf) for poly in members] if buf else members)
    if buf:
        outline = outline.buffer(-buf)
    if tolerance:
        outline = outline.simplify(tolerance)
    parts = [part for part in getattr(outline, "geoms", [outline]) if part.geom_type == "Polygon"]
    if tolerance:
        parts = [
            shapely.Polygon(
                part.exterior,
                [ring for ring in part.interiors if shapely.Polygon(ring).area >= holeTolerance],
            )
            for part in parts
        ]
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def argsToString(args: Sequence[object], kwargs: Mapping[str, object] = MappingProxyType({})) -> str:
    """The arguments of a call as text."""
    return ", ".join([*map(repr, args), *(f"{name}={value!r}" for name, value in kwargs.items())])


def batched(iterable: Iterable[object], n: int) -> Iterator[tuple[Any, ...]]:
    """Yield tuples of ``n`` successive items; the last may be shorter."""
    items = iter(iterable)
    while part := tuple(itertools.islice(items, n)):
        yield part


def proper_mesh(mesh: object, pitch: float = 1 / 64, verbose: bool = True) -> Any:  # noqa: ARG001 - of the established call
    """Return a trimesh mesh as one that bounds a volume: vertices merged, normals outwards. Raises ``ValueError`` where it has holes."""
    return _solid_of(mesh, unify=False)


def united_mesh(mesh: object, verbose: bool = False) -> Any:  # noqa: ARG001 - of the established call
    """Return a trimesh mesh with its overlapping bodies united."""
    return _solid_of(mesh, unify=True)


def _solid_of(mesh: Any, *, unify: bool) -> Any:
    import trimesh

    solid = proper_volume(Mesh(mesh.vertices, mesh.faces), unify=unify)
    return trimesh.Trimesh(np.array(solid.vertices), np.array(solid.faces), process=False)


def plotPolygon(polygon: object, plt: Any, style: str = "r-", **options: Any) -> None:
    """Draw the outlines of a shapely polygon or multipolygon with a ``matplotlib.pyplot``."""
    for part in getattr(polygon, "geoms", [polygon]):
        for ring in (part.exterior, *part.interiors):
            x, y = ring.xy
            plt.plot(x, y, style, **options)


def makeDelayedFunctionCall(
    func: Callable[..., Any], args: Sequence[object], kwargs: Mapping[str, object] = MappingProxyType({})
) -> Any:
    """A call that is made when the object that its arguments depend on is being specified."""
    return defer(func, *args, **kwargs)


def dumpAsScenicCode(value: object, stream: TextIO) -> None:
    """Write a value as an expression of the language."""
    try:
        stream.write(literal(value))
    except NoLiteralError:
        stream.write(repr(value))


def scenicToJSON(obj: object) -> Any:
    """Convert vectors to lists, for ``json.dumps(..., default=scenicToJSON)``."""
    if isinstance(obj, Vector):
        return list(obj)
    raise TypeError(f"Object of type {type(obj).__name__} is not JSON serializable")


class SimulatorInterfaceWarning(UserWarning):
    """A warning of an interface to a simulator."""


class SampleChecker:
    """An order of requirements; here their order follows measurements, and never changes results."""

    def __init__(self, *_arguments: Any, **_options: Any) -> None:
        pass


class BasicChecker(SampleChecker):
    """As `SampleChecker`."""


class WeightedAcceptanceChecker(SampleChecker):
    """As `SampleChecker`."""


cached_property = functools.cached_property


def cached_method(method: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method without arguments that is computed once for each instance."""
    name = f"_cached_{method.__name__}"

    @functools.wraps(method)
    def lookup(self: object) -> Any:
        if name not in self.__dict__:
            self.__dict__[name] = method(self)
        return self.__dict__[name]

    return lookup


def cached(function: Callable[[], Any]) -> Callable[[], Any]:
    """Return a function without arguments that is computed once."""
    return functools.cache(function)


def alwaysGlobalOrientation(thing: object) -> bool:
    """Return whether an orientation is certainly that of the world."""
    return isinstance(thing, Orientation) and thing == Orientation()


globalOrientation = Orientation()  # noqa: N816 - the established name


def setSeed(seed: int) -> None:
    """Seed Python's and NumPy's global generators, and so the scenes that `Scenario.generate` makes from then on."""
    random.seed(seed)
    np.random.seed(seed % 2**32)  # noqa: NPY002 - the global one is meant


def setDebuggingOptions(
    *,
    verbosity: int = 0,
    fullBacktrace: bool = False,  # noqa: ARG001 - of the established call
    debugExceptions: bool = False,  # noqa: ARG001 - of the established call
    debugRejections: bool = False,  # noqa: ARG001 - of the established call
) -> None:
    """Set the amount of output (`verbosity`, from 0 to 3); the other options belong to the commands here."""
    verbosity_now.set(verbosity)


__all__ = [
    "BasicChecker",
    "DelayedArgument",
    "Heading",
    "SampleChecker",
    "SimulatorInterfaceWarning",
    "WeightedAcceptanceChecker",
    "alwaysGlobalOrientation",
    "apparentHeadingAtPoint",
    "argsToString",
    "averageVectors",
    "batched",
    "cached",
    "cached_method",
    "cached_property",
    "canCoerce",
    "coerce",
    "convertToFootprint",
    "distanceToLine",
    "dumpAsScenicCode",
    "findMinMax",
    "globalOrientation",
    "headingOfSegment",
    "isA",
    "makeDelayedFunctionCall",
    "needsLazyEvaluation",
    "needsSampling",
    "normalizeAngle",
    "plotPolygon",
    "pointIsInCone",
    "polygonUnion",
    "proper_mesh",
    "regionFromShapelyObject",
    "removeHoles",
    "rotateVector",
    "scenicToJSON",
    "setDebuggingOptions",
    "setSeed",
    "toDistribution",
    "toHeading",
    "toOrientation",
    "toPolygon",
    "toScalar",
    "toType",
    "toTypes",
    "toVector",
    "triangulatePolygon",
    "underlyingType",
    "united_mesh",
    "valueInContext",
    "viewAngleToPoint",
]
