"""Rectangles of the plane."""

import math
from typing import Any

import numpy as np

from scenic.graph.bounds import Bounds
from scenic.graph.kinds import Column
from scenic.graph.operations.functions import length_bounds
from scenic.runtime.geometry.contact.collision import Body
from scenic.runtime.geometry.containment import body_containment as containment
from scenic.runtime.geometry.flat.outlines import Geometries
from scenic.runtime.geometry.flat.rectangles import Rectangles
from scenic.runtime.regions.base import Mask, Points
from scenic.runtime.regions.circular import disc_extent
from scenic.runtime.regions.planar import PlanarRegion, positive
from scenic.runtime.regions.scalar_regions import Rectangle, Single
from scenic.runtime.values.values import (
    is_number,
    operate,
    to_heading,
    to_vector,
    uniform,
    vector,
)


class RectangularRegion(PlanarRegion):
    """A rectangle turned by a heading.

    Args:
        position: its centre.
        heading: radians, anticlockwise.
        width: extent across the heading, metres.
        length: extent along the heading, metres.

    """

    parameter_names = ("position", "heading", "width", "length")
    draws = 2

    def __init__(
        self, position: object, heading: object, width: object, length: object, *, name: str | None = None
    ) -> None:
        self.position = to_vector(position, "`RectangularRegion` position")
        self.heading = to_heading(heading, "`RectangularRegion` heading")
        self.width = positive(width, "`RectangularRegion` width")
        self.length = positive(length, "`RectangularRegion` length")
        super().__init__(self.position, self.heading, self.width, self.length, name=name)

    @property
    def height(self) -> Any:
        return self.position.z

    @property
    def hw(self) -> Any:
        """Half the width, in metres."""
        return operate("divide", self.width, 2)

    @property
    def hl(self) -> Any:
        """Half the length, in metres."""
        return operate("divide", self.length, 2)

    @property
    def radius(self) -> Any:
        """Half the diagonal, in metres."""
        return operate("norm", vector(self.hw, self.hl, 0))

    @property
    def circumcircle(self) -> tuple[Any, Any]:
        return self.position, self.radius

    @property
    def inradius(self) -> Any:
        """The radius of the largest disc about the middle that it holds, in metres."""
        return operate("minimum", self.hw, self.hl)

    def uniform_placement(self) -> tuple[Any, Any]:
        x = operate("multiply", operate("subtract", uniform(), 0.5), self.width)
        y = operate("multiply", operate("subtract", uniform(), 0.5), self.length)
        frame = operate("from euler", self.heading, 0.0, 0.0)
        offset = vector(x, y, 0)
        if not is_number(self.heading) or self.heading != 0:
            offset = operate("rotate", frame, offset)
        point = operate("add", self.position, offset)
        return point, self.orientation_at(point)

    def draw_points(self, uniforms: Column, keys: Column, *columns: Column) -> tuple[Points, Mask | None]:
        position, heading, width, length = columns
        across, along = (uniforms[0] - 0.5) * width, (uniforms[1] - 0.5) * length
        cos, sin = np.cos(heading), np.sin(heading)
        offsets = [across * cos - along * sin, across * sin + along * cos, np.zeros_like(across)]
        return position + np.stack(offsets, axis=-1), None

    def heights(self, *columns: Column) -> Column:
        return columns[0][:, 2]

    @property
    def corners(self) -> tuple[Any, ...]:
        """The corners, anticlockwise from that ahead on the right."""
        turn = operate("from euler", self.heading, 0.0, 0.0)
        return tuple(
            operate(
                "add",
                self.position,
                operate(
                    "rotate",
                    turn,
                    vector(operate("multiply", x, self.width), operate("multiply", y, self.length), 0),
                ),
            )
            for x, y in ((0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5))
        )

    def polygons_now(self) -> Any:
        import shapely

        x, y = self.width / 2, self.length / 2
        box = shapely.Polygon(
            [(x, y), (-x, y), (-x, -y), (x, -y)]
        )  # from the corner with which `corners` begin
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return shapely.affinity.affine_transform(box, [cos, -sin, sin, cos, self.position.x, self.position.y])

    def box(self, *columns: Column) -> tuple[Points, Points]:
        position, heading, width, length = columns
        cos, sin = np.abs(np.cos(heading)), np.abs(np.sin(heading))
        x, y = (width * cos + length * sin) / 2, (width * sin + length * cos) / 2
        reach = np.stack([x, y, np.zeros_like(x)], axis=-1)
        return position - reach, position + reach

    def extent(self, *parameters: Bounds | None) -> Bounds | None:
        position, _, width, length = parameters
        found = super().extent(*parameters)
        if found is not None or width is None or length is None:
            return found
        diagonal = length_bounds([width, length])
        return disc_extent(position, Bounds(diagonal.lower / 2, diagonal.upper / 2))

    def sizes(self, *columns: Column) -> Column:
        return np.asarray(columns[2] * columns[3])

    def single(self) -> Single | None:
        cos, sin = float(np.cos(self.heading)), float(np.sin(self.heading))
        return Rectangle(self.position.row, cos, sin, self.width, self.length)

    def contains_points(self, points: Points, *columns: Column) -> Mask:
        across, along = self._local(points, *columns)
        inside: Mask = (np.abs(across) <= columns[2] / 2) & (np.abs(along) <= columns[3] / 2)
        return inside

    def beside(self, points: Points, *columns: Column) -> Column:
        across, along = self._local(points, *columns)
        return np.hypot(
            np.maximum(np.abs(across) - columns[2] / 2, 0), np.maximum(np.abs(along) - columns[3] / 2, 0)
        )

    def depths(self, points: Points, *columns: Column) -> Column:
        across, along = self._local(points, *columns)
        inside = np.minimum(columns[2] / 2 - np.abs(across), columns[3] / 2 - np.abs(along))
        return np.asarray(np.maximum(inside, 0))

    def _local(
        self, points: Points, position: Column, heading: Column, *_size: Column
    ) -> tuple[Column, Column]:
        """Coordinates of points across and along the heading, from the centre."""
        dx, dy = points[:, 0] - position[:, 0], points[:, 1] - position[:, 1]
        cos, sin = np.cos(heading), np.sin(heading)
        return dx * cos + dy * sin, dy * cos - dx * sin

    def nearest(self, points: Points, *columns: Column) -> Points:
        across, along = self._local(points, *columns)
        position, heading, width, length = columns
        x, y = np.clip(across, -width / 2, width / 2), np.clip(along, -length / 2, length / 2)
        cos, sin = np.cos(heading), np.sin(heading)
        found = np.array(points)
        inside = (x == across) & (y == along)
        found[:, 0] = np.where(inside, points[:, 0], position[:, 0] + (x * cos - y * sin))
        found[:, 1] = np.where(inside, points[:, 1], position[:, 1] + (x * sin + y * cos))
        return found

    def meets_rectangles(self, rectangles: Rectangles, *columns: Column) -> tuple[Mask, Mask]:
        position, heading, width, length = columns
        axis = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        half = np.stack(np.broadcast_arrays(width, length), axis=-1) / 2
        return Rectangles(position[:, :2], axis, half).meet(rectangles), np.zeros(1, dtype=np.bool_)

    def geometries(self, *columns: Column) -> Geometries:
        import shapely

        return np.asarray(shapely.polygons(self._corners(*columns)), dtype=np.object_)

    def contains_bodies(self, body: Body, lanes: int, *columns: Column) -> Mask:
        return containment.in_convex_polygon(body, self._corners(*columns), lanes)

    @staticmethod
    def _corners(*columns: Column) -> Column:
        """Return the corners ``(n | 1, 4, 2)``, anticlockwise."""
        position, heading, width, length = columns
        cos, sin = np.cos(heading), np.sin(heading)
        corners = np.empty((max(map(len, columns)), 4, 2))
        for corner, (x, y) in enumerate(((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))):
            corners[:, corner, 0] = position[:, 0] + (x * width * cos - y * length * sin)
            corners[:, corner, 1] = position[:, 1] + (x * width * sin + y * length * cos)
        return corners
