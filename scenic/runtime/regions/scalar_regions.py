"""Regions on plain floats: tests, for running simulations, of whether a fixed region contains or meets a point or a body.

Answers are certain, by more than rounding can change, or ``None``: then the readings over lanes decide. Regions of other kinds
have no such readings.
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from scenic.graph import quaternions
from scenic.runtime.geometry.contact.scalar_bodies import SLACK, PlacedBody, Triple, meet
from scenic.runtime.geometry.flat.polygons import Polygons

__all__ = ["Ball", "Disc", "Polygon", "Rectangle", "Single", "SingleBox"]


class Single(Protocol):
    """The questions to a region about one point or body."""

    def holds_point(self, point: Triple) -> bool | None:
        """Return whether it holds a point."""

    def holds_body(self, body: PlacedBody) -> bool | None:
        """Return whether it holds the whole of a body."""

    def meets_body(self, body: PlacedBody) -> bool | None:
        """Return whether it shares a point with a body."""

    def distance(self, point: Triple) -> float | None:
        """The distance of a point, in metres; 0 inside. Equal in every bit to that over lanes."""


class SingleFlat:
    """A region of the plane at some height; its containment ignores heights."""

    def __init__(self, height: float, box: tuple[float, float, float, float]) -> None:
        self._height = height
        self._box = box

    def holds_point(self, point: Triple) -> bool | None:
        """Return whether it holds what is above or below it, or in it."""
        raise NotImplementedError

    def distance(self, point: Triple) -> float | None:
        """See `Single`."""
        beside = self.beside(point)
        return None if beside is None else float(np.hypot(beside, point[2] - self._height))

    def beside(self, point: Triple) -> float | None:
        """Return the distance seen from above."""
        return None

    def meets_body(self, body: PlacedBody) -> bool | None:
        """Return whether a body certainly meets the region or is certainly apart from it, ``None`` if neither shows.

        A body meets it only within the height of the plane and over the region's box.
        """
        x, y, z = body.position
        dx, dy, dz = body.extents()
        low_x, low_y, high_x, high_y = self._box
        off = max(
            low_x - x - dx, x - dx - high_x, low_y - y - dy, y - dy - high_y, abs(z - self._height) - dz
        )
        if off > body.slack:
            return False
        # The point of the body at that height above or below its middle, where the box certainly has one.
        (_, _, up_x), (_, _, up_y), (_, _, up_z) = body.axes
        rise = self._height - z
        for part, half in zip((up_x, up_y, up_z), body.half, strict=True):
            if abs(rise * part) > half - body.slack:
                return None
        return True if body.mesh.is_box and self.holds_point((x, y, self._height)) else None


class Disc(SingleFlat):
    """A disc, or for bodies a polygon inscribed in it."""

    def __init__(self, center: Triple, radius: float, corners: int) -> None:
        x, y, z = center
        super().__init__(z, (x - radius, y - radius, x + radius, y + radius))
        self._x, self._y, self._radius = x, y, radius
        self._inner = radius * math.cos(math.pi / corners)

    def holds_point(self, point: Triple) -> bool | None:
        """See `Single`."""
        dx, dy = point[0] - self._x, point[1] - self._y
        return dx * dx + dy * dy <= self._radius * self._radius

    def beside(self, point: Triple) -> float | None:
        """See `SingleFlat`."""
        return max(float(np.hypot(point[0] - self._x, point[1] - self._y)) - self._radius, 0.0)

    def holds_body(self, body: PlacedBody) -> bool | None:
        """Decide by the corners of the body's box."""
        farthest = max(math.hypot(x - self._x, y - self._y) for x, y, _ in body.corners())
        if farthest < self._inner - body.slack:
            return True
        return False if body.mesh.is_box and farthest > self._radius + body.slack else None


class ConvexOutline:
    """The edges of a convex polygon, anticlockwise."""

    def __init__(self, corners: Sequence[tuple[float, float]]) -> None:
        ends = zip(corners, [*corners[1:], corners[0]], strict=True)
        edges = [(x, y, other_x - x, other_y - y) for (x, y), (other_x, other_y) in ends]
        # Edges as inward unit normals; those without a length bound nothing.
        self._edges = [
            (x, y, -dy / length, dx / length) for x, y, dx, dy in edges if (length := math.hypot(dx, dy)) > 0
        ]

    def holds(self, body: PlacedBody) -> bool | None:
        """Return whether the column above and below it holds a body."""
        if len(self._edges) < 3:
            return None
        least = math.inf
        x, y, _ = body.position
        for at_x, at_y, nx, ny in self._edges:
            depth, reach = nx * (x - at_x) + ny * (y - at_y), body.reach(nx, ny, 0.0)
            margin = depth - reach
            if margin < -body.slack:
                return False if body.mesh.is_box or depth + reach < -body.slack else None
            least = min(least, margin)
        return True if least > body.slack else None


class Rectangle(SingleFlat):
    """A rectangle turned by a heading."""

    def __init__(self, position: Triple, cos: float, sin: float, width: float, length: float) -> None:
        x, y, z = position
        across, along = width / 2, length / 2
        corners = [
            (x + i * across * cos - j * along * sin, y + i * across * sin + j * along * cos)
            for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        easts, norths = zip(*corners, strict=True)
        super().__init__(z, (min(easts), min(norths), max(easts), max(norths)))
        self._x, self._y, self._cos, self._sin = x, y, cos, sin
        self._across, self._along = across, along
        self._outline = ConvexOutline(corners)

    def holds_point(self, point: Triple) -> bool | None:
        """See `Single`."""
        across, along = self._local(point)
        return abs(across) <= self._across and abs(along) <= self._along

    def beside(self, point: Triple) -> float | None:
        """See `SingleFlat`."""
        across, along = self._local(point)
        return float(np.hypot(max(abs(across) - self._across, 0.0), max(abs(along) - self._along, 0.0)))

    def _local(self, point: Triple) -> tuple[float, float]:
        dx, dy = point[0] - self._x, point[1] - self._y
        return dx * self._cos + dy * self._sin, dy * self._cos - dx * self._sin

    def holds_body(self, body: PlacedBody) -> bool | None:
        """Decide by the region's edges."""
        return self._outline.holds(body)


class Polygon(SingleFlat):
    """A polygon, or several, with holes."""

    def __init__(self, polygons: Polygons, height: float) -> None:
        super().__init__(height, polygons.polygon.bounds)
        self._polygons = polygons
        corners = polygons.convex_corners
        self._outline = None if corners is None else ConvexOutline(list(map(tuple, corners.tolist())))

    def holds_point(self, point: Triple) -> bool | None:
        """See `Single`."""
        return self._polygons.holds_point(point[0], point[1])

    def beside(self, point: Triple) -> float | None:
        """See `SingleFlat`."""
        return self._polygons.distance(point[0], point[1])

    def holds_body(self, body: PlacedBody) -> bool | None:
        """Decide by the region's edges if it is convex; else by a disc about the body."""
        if self._outline is not None:
            return self._outline.holds(body)
        x, y, _ = body.position
        dx, dy, _ = body.extents()
        return True if self._polygons.holds_disc(x, y, math.hypot(dx, dy) + body.slack) else None


class SingleBox:
    """A solid box."""

    def __init__(self, body: PlacedBody, rotation: tuple[float, float, float, float], size: Triple) -> None:
        self._body = body
        x, y, z, w = rotation
        self._inverse = (-x, -y, -z, w)
        self._size = size

    def holds_point(self, point: Triple) -> bool | None:
        """See `Single`."""
        x, y, z = self._local(point)
        return abs(x) <= 0.5 and abs(y) <= 0.5 and abs(z) <= 0.5

    def distance(self, point: Triple) -> float | None:
        """See `Single`."""
        parts = zip(self._local(point), self._size, strict=True)
        x, y, z = (max((abs(part) - 0.5) * size, 0.0) for part, size in parts)
        return math.sqrt(x * x + y * y + z * z)

    def _local(self, point: Triple) -> Triple:
        """The point in the frame of the box of unit size."""
        px, py, pz = self._body.position
        x, y, z = quaternions.turned(self._inverse, (point[0] - px, point[1] - py, point[2] - pz))
        width, length, height = self._size
        return x / width, y / length, z / height

    def holds_body(self, body: PlacedBody) -> bool | None:
        """Decide by the body's extents along the axes of the region."""
        reach = [body.reach(*axis) for axis in self._body.axes]
        held = self._within(body.position, (reach[0], reach[1], reach[2]), body.slack)
        return held if held or body.mesh.is_box else None

    def _within(self, point: Triple, reach: Triple, more: float = 0.0) -> bool | None:
        body = self._body
        x, y, z = (at - centre for at, centre in zip(point, body.position, strict=True))
        slack = body.slack + more + SLACK * (abs(x) + abs(y) + abs(z))
        certain = True
        for (ax, ay, az), half, extent in zip(body.axes, body.half, reach, strict=True):
            margin = half - extent - abs(x * ax + y * ay + z * az)
            if margin < -slack:
                return False
            certain = certain and margin > slack
        return True if certain else None

    def meets_body(self, body: PlacedBody) -> bool | None:
        """As two bodies meet."""
        return meet(self._body, body)


class Ball:
    """A solid ellipsoid."""

    def __init__(self, body: PlacedBody) -> None:
        self._body = body

    def holds_point(self, point: Triple) -> bool | None:
        """Decide by the distance from the middle when it is scaled to a ball, unless that is near the border."""
        share = self._share(point)
        slack = SLACK + self._body.slack / min(self._body.half)
        return None if abs(share - 1) < slack else share < 1

    def holds_body(self, body: PlacedBody) -> bool | None:
        """Decide by the corners of the body's box."""
        farthest = max(map(self._share, body.corners()))
        slack = SLACK + (self._body.slack + body.slack) / min(self._body.half)
        if farthest < 1 - slack:
            return True
        return False if body.mesh.is_box and farthest > 1 + slack else None

    def meets_body(self, body: PlacedBody) -> bool | None:
        """Only whether its box is apart from the body's."""
        return False if meet(self._body, body) is False else None

    def distance(self, point: Triple) -> float | None:
        """Return ``None``: the distance takes a root, which is not computed on plain numbers."""
        return None

    def _share(self, point: Triple) -> float:
        body = self._body
        x, y, z = (at - centre for at, centre in zip(point, body.position, strict=True))
        return math.sqrt(
            sum(
                ((x * ax + y * ay + z * az) / half) ** 2
                for (ax, ay, az), half in zip(body.axes, body.half, strict=True)
            )
        )
