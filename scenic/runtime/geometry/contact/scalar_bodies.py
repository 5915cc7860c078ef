"""One body on plain floats, for running simulations, which would otherwise use arrays of one lane.

Every answer here is either certain, by more than rounding can change, or ``None``: then whoever asked looks closely, by the readings
over lanes. So an answer is the same however it was found.
"""

import math
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from scenic.runtime.geometry.contact.depth import convex_gap
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats

Triple: TypeAlias = tuple[float, float, float]
Rows: TypeAlias = tuple[Triple, Triple, Triple]

SLACK: Final = 1e-6
"""Metres, and as a share of what is measured: more than rounding and the tolerances of containers and contacts come to."""


class PlacedBody(NamedTuple):
    """A body in its place.

    ``axes`` are the unit vectors of its frame in the world, ``half`` the half extents along them; ``slack`` is how near
    a decision may be, in metres.
    """

    position: Triple
    axes: Rows
    half: Triple
    mesh: Mesh
    slack: float

    @property
    def radius(self) -> float:
        """Radius of the ball around the body's box, slightly enlarged."""
        a, b, c = self.half
        return math.sqrt(a * a + b * b + c * c) + self.slack

    def reach(self, x: float, y: float, z: float) -> float:
        """Return the distance to which its box extends from the centre along a direction of length 1."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self.axes
        a, b, c = self.half
        return (
            a * abs(x * ax + y * ay + z * az)
            + b * abs(x * bx + y * by + z * bz)
            + c * abs(x * cx + y * cy + z * cz)
        )

    def extents(self) -> Triple:
        """Return half the extents, along the global axes, of the box around the body."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self.axes
        a, b, c = self.half
        return (
            a * abs(ax) + b * abs(bx) + c * abs(cx),
            a * abs(ay) + b * abs(by) + c * abs(cy),
            a * abs(az) + b * abs(bz) + c * abs(cz),
        )

    def corners(self) -> list[Triple]:
        """Return the eight corners of its box."""
        x, y, z = self.position
        u, v, w = (
            (half * axis[0], half * axis[1], half * axis[2])
            for half, axis in zip(self.half, self.axes, strict=True)
        )
        return [
            (
                x + i * u[0] + j * v[0] + k * w[0],
                y + i * u[1] + j * v[1] + k * w[1],
                z + i * u[2] + j * v[2] + k * w[2],
            )
            for i in (-1, 1)
            for j in (-1, 1)
            for k in (-1, 1)
        ]

    def hull(self) -> Floats:
        """Return the corners of its convex hull, ``(n, 3)``."""
        frame = np.array(self.axes) * (2 * np.array(self.half)[:, np.newaxis])
        corners: Floats = self.mesh.hull.vertices @ frame + np.array(self.position)
        return corners


def placed(
    position: Triple, orientation: tuple[float, float, float, float], size: Triple, mesh: Mesh
) -> PlacedBody:
    """Return a body of a unit mesh, from its position, unit quaternion and size."""
    width, length, height = size
    scale = max(map(abs, position)) + max(size)
    half = (width / 2, length / 2, height / 2)
    return PlacedBody(position, axes_of(orientation), half, mesh, SLACK * max(1.0, scale))


def axes_of(orientation: tuple[float, float, float, float]) -> Rows:
    """Return the unit vectors of a frame in the world, from its unit quaternion."""
    x, y, z, w = orientation
    xx, yy, zz = 2 * x * x, 2 * y * y, 2 * z * z
    xy, xz, yz = 2 * x * y, 2 * x * z, 2 * y * z
    wx, wy, wz = 2 * w * x, 2 * w * y, 2 * w * z
    return (
        (1 - yy - zz, xy + wz, xz - wy),
        (xy - wz, 1 - xx - zz, yz + wx),
        (xz + wy, yz - wx, 1 - xx - yy),
    )


def is_near_way(start: Triple, end: Triple, middle: Triple, radius: float) -> bool:
    """Return whether a ball is near the straight way between two points; never wrongly no."""
    wx, wy, wz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    ox, oy, oz = middle[0] - start[0], middle[1] - start[1], middle[2] - start[2]
    length = wx * wx + wy * wy + wz * wz
    part = min(1.0, max(0.0, (ox * wx + oy * wy + oz * wz) / length)) if length else 0.0
    x, y, z = ox - part * wx, oy - part * wy, oz - part * wz
    slack = SLACK * (1 + length)
    return not x * x + y * y + z * z > radius * radius + slack


def meet(one: PlacedBody, other: PlacedBody) -> bool | None:
    """Return whether two bodies share a point; ``None`` where that takes a closer look."""
    gap, slack = _separation(one, other), one.slack + other.slack
    if gap > slack:
        return False
    if gap < -slack and one.mesh.is_box and other.mesh.is_box:
        return True
    return None


def gap(one: PlacedBody, other: PlacedBody) -> float | None:
    """The least distance between points of two convex bodies, in metres, equal to that over lanes but for rounding.

    ``None`` where they may touch, or one is not convex.
    """
    if not (one.mesh.is_convex and other.mesh.is_convex):
        return None
    if meet(one, other):
        return 0.0
    distance = convex_gap(one.hull(), other.hull())
    return distance if distance > one.slack + other.slack else None


def overlap(one: PlacedBody, other: PlacedBody) -> float:
    """Return the distance, in metres, by which one of two boxes that meet has to be moved until they only touch; 0 if they are apart.

    Exact for boxes: the least way out of a body that is the sum of two boxes is across one of its faces, whose normals are the
    axes of the separation.
    """
    return max(0.0, -_separation(one, other))


def _separation(one: PlacedBody, other: PlacedBody) -> float:
    """Return the largest gap between the boxes' projections on an axis that may separate them; negative if they overlap on all.

    Axes: those of both boxes, and the products of two (Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996).
    """
    dx, dy, dz = (b - a for a, b in zip(one.position, other.position, strict=True))
    ex, ey, ez = one.extents()
    fx, fy, fz = other.extents()
    # The global axes first: they tell most pairs apart, and cost least.
    widest = max(abs(dx) - ex - fx, abs(dy) - ey - fy, abs(dz) - ez - fz)
    if widest > one.slack + other.slack:
        return widest
    widest = float("-inf")
    for axis in (*one.axes, *other.axes):
        x, y, z = axis
        gap = abs(x * dx + y * dy + z * dz) - one.reach(x, y, z) - other.reach(x, y, z)
        widest = max(widest, gap)
    for ax, ay, az in one.axes:
        for bx, by, bz in other.axes:
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            length = (x * x + y * y + z * z) ** 0.5
            if length > SLACK:  # of parallel edges the faces tell enough
                gap = abs(x * dx + y * dy + z * dz) - one.reach(x, y, z) - other.reach(x, y, z)
                widest = max(widest, gap / length)
    return widest
