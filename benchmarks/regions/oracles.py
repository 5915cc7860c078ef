"""The regions of the table at an ego, by NumPy, SciPy and shapely alone: the queries that plain rejection needs.

Things are unit cubes, turned about the vertical by a heading. Nothing here is shared with the package.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
import shapely
import trimesh
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls
from scipy.spatial import ConvexHull, HalfspaceIntersection

Floats = NDArray[np.float64]
Ego = tuple[float, float, float]
"""Position and heading."""

_SIDES: Final = 128
_CORNERS: Final = np.array([(x, y) for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))])
_ROOM: Final = shapely.Polygon([(-9, -9), (9, -9), (9, 0), (0, 2), (0, 9), (-9, 9)])


class Oracle(Protocol):
    """A region at an ego."""

    @property
    def is_flat(self) -> bool:
        """Return whether it lies in the plane."""

    def covers(self, points: Floats) -> NDArray[np.bool_]:
        """Return a mask ``(n,)`` of the points ``(n, 3)`` that lie in the region."""

    def holds(self, place: Floats, heading: float) -> bool:
        """Return whether the region holds a whole thing."""

    def meets(self, place: Floats, heading: float) -> bool:
        """Return whether the region shares a point with a thing."""

    def distance(self, point: Floats) -> float:
        """Return the distance of a point from the region."""


def turned(points: Floats, heading: float) -> Floats:
    """Points ``(n, 2)`` turned anticlockwise."""
    cos, sin = math.cos(heading), math.sin(heading)
    return np.column_stack([points[:, 0] * cos - points[:, 1] * sin, points[:, 0] * sin + points[:, 1] * cos])


def _outline(place: Floats, heading: float) -> Any:
    return shapely.Polygon(turned(_CORNERS, heading) + place[:2])


def _corners(place: Floats, heading: float) -> Floats:
    flat = turned(_CORNERS, heading)
    return np.array([(*corner, z) for corner in flat for z in (-0.5, 0.5)]) + place


# Regions of the plane


def _disc(x: float, y: float, radius: float) -> Any:
    ways = np.arange(_SIDES) * (2 * math.pi / _SIDES)
    return shapely.Polygon(np.column_stack([x + radius * np.cos(ways), y + radius * np.sin(ways)]))


def _rectangle(x: float, y: float, heading: float, width: float, length: float) -> Any:
    return shapely.Polygon(turned(_CORNERS * (width, length), heading) + np.array([x, y]))


def _sector(ego: Ego, radius: float) -> Any:
    x, y, heading = ego
    ways = heading + np.radians(np.linspace(-50, 50, 100))
    arc = np.column_stack([x - radius * np.sin(ways), y + radius * np.cos(ways)])
    return shapely.Polygon([(x, y), *arc])


@dataclass(frozen=True)
class Flat:
    """A polygon at the height of the ego; as a container, all that is above and below it."""

    polygon: Any
    is_flat: bool = True

    def covers(self, points: Floats) -> NDArray[np.bool_]:
        return np.asarray(shapely.intersects_xy(self.polygon, points[:, 0], points[:, 1]))

    def holds(self, place: Floats, heading: float) -> bool:
        return bool(self.polygon.covers(_outline(place, heading)))

    def meets(self, place: Floats, heading: float) -> bool:
        return bool(self.polygon.intersects(_outline(place, heading)))

    def distance(self, point: Floats) -> float:
        return math.hypot(self.polygon.distance(shapely.Point(point[:2])), point[2])


# Solids

_CUBE: Final = np.array(
    [(*(sign * np.eye(3)[axis]), -0.5) for axis in range(3) for sign in (-1, 1)]
)  # a x + b y + c z + d <= 0


def _placed(planes: Floats, place: Floats, heading: float) -> Floats:
    """Half-spaces ``(k, 4)`` turned about the vertical, then moved."""
    normals = np.column_stack([turned(planes[:, :2], heading), planes[:, 2]])
    return np.column_stack([normals, planes[:, 3] - normals @ place])


@dataclass(frozen=True)
class Polytope:
    """A convex solid: half-spaces ``(k, 4)``."""

    planes: Floats
    is_flat: bool = False

    def covers(self, points: Floats) -> NDArray[np.bool_]:
        return np.asarray((points @ self.planes[:, :3].T + self.planes[:, 3] <= 0).all(axis=1))

    def holds(self, place: Floats, heading: float) -> bool:
        return bool(self.covers(_corners(place, heading)).all())

    def meets(self, place: Floats, heading: float) -> bool:
        return self.shared(place, heading) is not None

    def shared(self, place: Floats, heading: float) -> tuple[Floats, Floats] | None:
        """Half-spaces of what a thing shares with the region, and a point well inside."""
        planes = np.vstack([self.planes, _placed(_CUBE, place, heading)])
        lengths = np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
        found = linprog(
            [0, 0, 0, -1], np.hstack([planes[:, :3], lengths]), -planes[:, 3], bounds=(None, None)
        )
        return (planes, found.x[:3]) if found.x is not None and found.x[3] > 0 else None

    def distance(self, point: Floats) -> float:
        # Least distance programming (Lawson and Hanson, "Solving Least Squares Problems", chapter 23).
        beyond = self.planes[:, :3] @ point + self.planes[:, 3]
        if (beyond <= 0).all():
            return 0.0
        matrix = np.vstack([-self.planes[:, :3].T, beyond])
        weights, _ = nnls(matrix, np.array([0.0, 0, 0, 1]))
        rest = matrix @ weights - np.array([0.0, 0, 0, 1])
        return float(np.linalg.norm(rest[:3] / rest[3]))


def _box(size: tuple[float, float, float]) -> Floats:
    return np.column_stack([_CUBE[:, :3], -np.repeat(np.array(size) / 2, 2)])


def _cone() -> Floats:
    mesh = trimesh.creation.cone(radius=1, height=2, sections=12)
    lower, upper = mesh.bounds
    vertices = (mesh.vertices - (lower + upper) / 2) / (upper - lower) * (9, 9, 6)
    return np.asarray(ConvexHull(vertices).equations)


@dataclass(frozen=True)
class Ball:
    """A ball."""

    centre: Floats
    radius: float
    is_flat: bool = False

    def covers(self, points: Floats) -> NDArray[np.bool_]:
        return np.asarray(np.linalg.norm(points - self.centre, axis=1) <= self.radius)

    def holds(self, place: Floats, heading: float) -> bool:
        return bool(self.covers(_corners(place, heading)).all())

    def meets(self, place: Floats, heading: float) -> bool:
        local = self.centre - place
        local[:2] = turned(local[np.newaxis, :2], -heading)[0]
        return float(np.linalg.norm(np.maximum(np.abs(local) - 0.5, 0))) <= self.radius

    def distance(self, point: Floats) -> float:
        return max(float(np.linalg.norm(point - self.centre)) - self.radius, 0.0)


@dataclass(frozen=True)
class WithoutBall:
    """A convex solid without a ball that lies inside it."""

    solid: Polytope
    ball: Ball
    is_flat: bool = False

    def covers(self, points: Floats) -> NDArray[np.bool_]:
        return np.asarray(self.solid.covers(points) & ~self.ball.covers(points))

    def holds(self, place: Floats, heading: float) -> bool:
        return self.solid.holds(place, heading) and not self.ball.meets(place, heading)

    def meets(self, place: Floats, heading: float) -> bool:
        shared = self.solid.shared(place, heading)
        # What is shared is in the ball if all of its corners are.
        return shared is not None and not self.ball.covers(HalfspaceIntersection(*shared).intersections).all()

    def distance(self, point: Floats) -> float:
        depth = self.ball.radius - float(np.linalg.norm(point - self.ball.centre))
        return depth if depth > 0 else self.solid.distance(point)


_RISE: Final = math.tan(math.radians(30))


@dataclass(frozen=True)
class View:
    """Places within a distance, 45 degrees to either side and 30 degrees up and down, seen from an ego."""

    ego: Ego
    reach: float
    is_flat: bool = False

    def _local(self, points: Floats) -> Floats:
        """Points ahead, to the left and above."""
        x, y, heading = self.ego
        ahead, left = turned(points[:, :2] - (x, y), -heading - math.pi / 2).T
        return np.column_stack([ahead, left, points[:, 2]])

    def covers(self, points: Floats) -> NDArray[np.bool_]:
        ahead, left, up = self._local(points).T
        near = np.hypot(np.hypot(ahead, left), up) <= self.reach
        return np.asarray(near & (np.abs(left) <= ahead) & (np.abs(up) <= _RISE * np.hypot(ahead, left)))

    def holds(self, place: Floats, heading: float) -> bool:
        ahead, left, up = self._local(_corners(place, heading)).T
        nearest = _outline(place, heading).distance(shapely.Point(self.ego[:2]))
        is_near = bool((np.hypot(np.hypot(ahead, left), up) <= self.reach).all())
        return is_near and bool((np.abs(left) <= ahead).all()) and np.abs(up).max() <= _RISE * nearest

    def meets(self, place: Floats, heading: float) -> bool:
        x, y, way = self.ego
        wedge = turned(np.array([(0, 0), (50, 50), (-50, 50)], dtype=np.float64), way) + np.array([x, y])
        part = _outline(place, heading).intersection(shapely.Polygon(wedge))
        if part.is_empty:
            return False
        least = max(abs(place[2]) - 0.5, 0.0)
        camera = shapely.Point(x, y)
        nearest, farthest = part.distance(camera), shapely.hausdorff_distance(part, camera)
        return bool(nearest <= math.sqrt(self.reach**2 - least**2) and farthest >= least / _RISE)

    def distance(self, point: Floats) -> float:
        ahead, left, up = self._local(point[np.newaxis])[0]
        if abs(left) <= ahead:
            return self._in_section(math.hypot(ahead, left), up)
        sides = (
            ((ahead + side * left) / math.sqrt(2), (ahead - side * left) / math.sqrt(2)) for side in (1, -1)
        )
        return min(math.hypot(beside, self._in_section(along, up)) for along, beside in sides)

    def _in_section(self, along: float, up: float) -> float:
        """The distance in an upright plane through the camera from the part of it that is in view."""
        if abs(up) <= _RISE * along:
            return max(math.hypot(along, up) - self.reach, 0.0)
        tilt = math.radians(30)
        edge = shapely.LineString([(0, 0), (self.reach * math.cos(tilt), self.reach * math.sin(tilt))])
        return float(edge.distance(shapely.Point(along, abs(up))))


def _at(ego: Ego) -> Floats:
    return np.array([*ego[:2], 0.0])


ORACLES: Final[dict[str, Callable[[Ego], Oracle]]] = {
    "disc": lambda ego: Flat(_disc(*ego[:2], 5)),
    "rectangle": lambda ego: Flat(_rectangle(*ego, 8, 6)),
    "sector": lambda ego: Flat(_sector(ego, 6)),
    "disc minus disc": lambda ego: Flat(_disc(*ego[:2], 6).difference(_disc(ego[0] + 1, ego[1], 2))),
    "rectangle minus rectangle": lambda ego: Flat(
        _rectangle(*ego, 10, 8).difference(_rectangle(ego[0] + 1, ego[1], 0, 2, 3))
    ),
    "polygon minus sector": lambda ego: Flat(_ROOM.difference(_sector(ego, 4))),
    "polygon and disc": lambda ego: Flat(_ROOM.intersection(_disc(*ego[:2], 6))),
    "box": lambda ego: Polytope(_placed(_box((8, 6, 5)), _at(ego), ego[2])),
    "ball": lambda ego: Ball(_at(ego), 4.5),
    "mesh": lambda ego: Polytope(_placed(_cone(), _at(ego), ego[2])),
    "box minus ball": lambda ego: WithoutBall(
        Polytope(_placed(_box((9, 9, 6)), _at(ego), ego[2])), Ball(np.add(_at(ego), (1, 0, 0)), 1.5)
    ),
    "box and box": lambda ego: Polytope(
        np.vstack(
            [
                _placed(_box((8, 6, 5)), _at(ego), ego[2]),
                _placed(_box((6, 6, 5)), np.add(_at(ego), (1, 1, 0)), 0.0),
            ]
        )
    ),
    "visibleRegion": lambda ego: View(ego, 8.0),
}
"""By the name of the region."""

__all__ = ["ORACLES", "Ego", "Floats", "Oracle", "turned"]
