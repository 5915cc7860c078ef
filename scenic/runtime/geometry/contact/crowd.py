"""Many bodies over many lanes as a few flat arrays, so that work on them needs no loop over bodies."""

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Booleans, Floats, Indices, Poses

_ELONGATED: Final = 2.5
"""Ratio of largest to smallest extent above which a body's sphere is too poor a bound of it."""


@dataclass(frozen=True, slots=True)
class PropertyRows:
    """One property of many bodies: the rows of all of them one after the other.

    Attributes:
        values: the rows, ``(t, ...)``.
        base: where the rows of each body begin, ``(m,)``.
        stride: 1 for bodies with a row for each lane, 0 for those with a single row, ``(m,)``.

    """

    values: npt.NDArray[Any]
    base: Indices
    stride: Indices

    @classmethod
    def of(cls, parts: Sequence[npt.NDArray[Any]]) -> "PropertyRows":
        """Return the rows ``(n | 1, ...)`` of some bodies."""
        lengths = np.array([len(part) for part in parts], dtype=np.intp)
        return cls(
            np.concatenate(parts) if len(parts) else np.empty((0, 3)),
            np.cumsum(lengths) - lengths,
            (lengths > 1).astype(np.intp),
        )

    @classmethod
    def stacked(cls, values: npt.NDArray[Any], bodies: int) -> "PropertyRows":
        """Return the rows of several bodies that come one body after the other already: ``(bodies * lanes, ...)``, or
        ``(bodies, ...)`` where they are the same in all lanes, or ``(1, ...)`` where also in all bodies.
        """
        each = len(values) // bodies
        return cls(values, np.arange(bodies) * each, np.full(bodies, each > 1, dtype=np.intp))

    def at(self, body: Indices, lane: Indices) -> npt.NDArray[Any]:
        """Return the rows of these bodies in these lanes, which broadcast."""
        return self.values[self.base[body] + self.stride[body] * lane]

    def over(self, bodies: Indices, lanes: slice) -> npt.NDArray[Any]:
        """Return the rows of these bodies in consecutive lanes, ``(bodies, lanes, ...)`` or, if all are single, ``(bodies, 1, ...)``."""
        base = self.base[bodies]
        if not self.stride[bodies].any():
            return self.values[base[:, None]]
        neighbours = len(bodies) > 1 and bool((np.diff(bodies) == 1).all())
        if neighbours and self.stride[bodies].all():
            length = int(base[1] - base[0])
            whole = self.values[base[0] : base[0] + len(base) * length]
            return whole.reshape(len(base), length, *self.values.shape[1:])[:, lanes]
        return self.at(bodies[:, None], np.arange(lanes.start, lanes.stop))

    def mapped(self, function: Callable[[npt.NDArray[Any]], npt.NDArray[Any]]) -> "PropertyRows":
        """Return the rows with ``function`` applied to the values of all of them."""
        return PropertyRows(function(self.values), self.base, self.stride)

    def followed_by(self, others: "PropertyRows") -> "PropertyRows":
        """Return the rows of these bodies, then those of the others."""
        return PropertyRows(
            np.concatenate([self.values, others.values]),
            np.concatenate([self.base, others.base + len(self.values)]),
            np.concatenate([self.stride, others.stride]),
        )


@dataclass(frozen=True, slots=True)
class Crowd:
    """Bodies over lanes.

    Attributes:
        meshes: all the meshes that one of them may have.
        position: metres.
        orientation: quaternions.
        size: metres.
        mesh: indices into ``meshes``.
        allow: whether a body may collide.
        lower: lower corners of the world boxes of the bodies in ``bounded``, in their order.
        upper: the upper corners.
        bounded: for each body its number among those whose world boxes are known, or -1, ``(m,)``.

    """

    meshes: tuple[Mesh, ...]
    position: PropertyRows
    orientation: PropertyRows
    size: PropertyRows
    mesh: PropertyRows
    allow: PropertyRows
    lower: PropertyRows
    upper: PropertyRows
    bounded: Indices

    def __len__(self) -> int:
        return len(self.bounded)

    @classmethod
    def of(cls, bodies: Sequence[Body]) -> "Crowd":
        """Return the crowd of one or more bodies."""
        meshes = tuple(dict.fromkeys(mesh for body in bodies for mesh in body.meshes))
        number = {mesh: index for index, mesh in enumerate(meshes)}
        pose_parts = [
            np.array([number[mesh] for mesh in body.meshes])[[0] if body.choice is None else body.choice]
            for body in bodies
        ]
        poses = [body.poses for body in bodies]
        has_bounds = np.array([item.knows_bounds for item in poses])
        corners = [item.bounds() for item in poses if item.knows_bounds]
        lower, upper = zip(*corners, strict=True) if corners else ((), ())
        return cls(
            meshes,
            PropertyRows.of([item.position for item in poses]),
            PropertyRows.of([item.orientation for item in poses]),
            PropertyRows.of([item.size for item in poses]),
            PropertyRows.of(pose_parts),
            PropertyRows.of([body.allow for body in bodies]),
            PropertyRows.of(lower),
            PropertyRows.of(upper),
            np.where(has_bounds, np.cumsum(has_bounds) - 1, -1),
        )

    @classmethod
    def stacked(
        cls,
        bodies: int,
        meshes: tuple[Mesh, ...],
        position: Floats,
        orientation: Floats,
        size: Floats,
        mesh: Indices,
        allow: Booleans,
    ) -> "Crowd":
        """Return the crowd of bodies whose columns are stacked already; each column is as `PropertyRows.stacked` takes it.

        Args:
            bodies: their number.
            meshes: the meshes that they may have.
            position: metres, ``(..., 3)``.
            orientation: quaternions, ``(..., 4)``.
            size: metres, ``(..., 3)``.
            mesh: indices into ``meshes``.
            allow: whether a body may collide.

        """
        return cls(
            meshes,
            PropertyRows.stacked(position, bodies),
            PropertyRows.stacked(orientation, bodies),
            PropertyRows.stacked(size, bodies),
            PropertyRows.stacked(mesh, bodies),
            PropertyRows.stacked(allow, bodies),
            PropertyRows.of(()),
            PropertyRows.of(()),
            np.full(bodies, -1),
        )

    def followed_by(self, others: "Crowd") -> "Crowd":
        """Return the crowd of these bodies, then the others."""
        meshes = tuple(dict.fromkeys(self.meshes + others.meshes))
        number = {mesh: index for index, mesh in enumerate(meshes)}
        renumber = np.array([number[mesh] for mesh in others.meshes])
        bounded_count = int((self.bounded >= 0).sum())
        return Crowd(
            meshes,
            self.position.followed_by(others.position),
            self.orientation.followed_by(others.orientation),
            self.size.followed_by(others.size),
            self.mesh.followed_by(others.mesh.mapped(renumber.__getitem__)),
            self.allow.followed_by(others.allow),
            self.lower.followed_by(others.lower),
            self.upper.followed_by(others.upper),
            np.concatenate([self.bounded, np.where(others.bounded >= 0, others.bounded + bounded_count, -1)]),
        )

    def poses(self, body: Indices, lane: Indices) -> Poses:
        """Return the poses of ``(e,)`` combinations of body and lane."""
        return Poses(self.position.at(body, lane), self.orientation.at(body, lane), self.size.at(body, lane))

    def radius(self) -> PropertyRows:
        """Return the radii of spheres around the bodies."""
        return self.size.mapped(_half_diagonal)

    def boxes(self, lanes: slice) -> tuple[Floats, Floats]:
        """Lower and upper corners ``(m, lanes, 3)`` of world boxes that hold the bodies.

        They are tight where that is cheap or pays: where world boxes are known, or orientations are constant, or
        extents differ much; otherwise they are those of the spheres, which need no rotation matrices.
        """
        lower = np.empty((len(self), lanes.stop - lanes.start, 3))
        upper = np.empty_like(lower)
        bounded_numbers = np.flatnonzero(self.bounded >= 0)
        if len(bounded_numbers):
            number = self.bounded[bounded_numbers]
            lower[bounded_numbers], upper[bounded_numbers] = (
                self.lower.over(number, lanes),
                self.upper.over(number, lanes),
            )
        first = self.size.values[self.size.base]
        is_elongated = first.max(axis=1) > _ELONGATED * first.min(axis=1)
        is_turning = self.orientation.stride > 0
        is_unbounded = self.bounded < 0
        # Groups in which orientations and sizes are the same everywhere come out in a single row.
        for mask, tight in (
            (is_unbounded & is_turning & ~is_elongated, False),
            (is_unbounded & is_turning & is_elongated, True),
            (is_unbounded & ~is_turning & (self.size.stride > 0), True),
            (is_unbounded & ~is_turning & (self.size.stride == 0), True),
        ):
            members = np.flatnonzero(mask)
            if len(members):
                size, position = self.size.over(members, lanes), self.position.over(members, lanes)
                reach = _half_diagonal(size)[..., None]
                if tight:
                    reach = _reach(self.orientation.over(members, lanes), size)
                lower[members], upper[members] = position - reach, position + reach
        return lower, upper


def _reach(orientation: Floats, size: Floats) -> Floats:
    """Return half the extents of the world boxes."""
    matrix = np.abs(quaternions.to_matrix(orientation))
    half = 0.5 * size
    x, y, z = half[..., 0], half[..., 1], half[..., 2]
    return np.stack(
        [matrix[..., i, 0] * x + matrix[..., i, 1] * y + matrix[..., i, 2] * z for i in range(3)], axis=-1
    )


def _half_diagonal(size: npt.NDArray[Any]) -> Floats:
    x, y, z = size[..., 0], size[..., 1], size[..., 2]
    return np.asarray(0.5 * np.sqrt(x * x + y * y + z * z))
