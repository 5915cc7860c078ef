"""The unit meshes of the primitive shapes.

Sections and subdivisions are part of the language's meaning (a cylinder is the prism over a regular
polygon), so they are fixed here. Each mesh is made once.
"""

from functools import cache
from typing import Final

import numpy as np

from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Indices

CYLINDER_SECTIONS: Final = 24
CONE_SECTIONS: Final = 32
SPHEROID_SUBDIVISIONS: Final = 3


@cache
def box() -> Mesh:
    """Return the unit cube: 8 vertices, 12 faces."""
    vertices = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [
        *((0, 1, 3), (0, 3, 2)),  # left
        *((4, 6, 7), (4, 7, 5)),  # right
        *((0, 4, 5), (0, 5, 1)),  # back
        *((2, 3, 7), (2, 7, 6)),  # front
        *((0, 2, 6), (0, 6, 4)),  # bottom
        *((1, 5, 7), (1, 7, 3)),  # top
    ]
    return Mesh(vertices, np.array(faces))


@cache
def cylinder(sections: int = CYLINDER_SECTIONS) -> Mesh:
    """Return the prism along Z over a regular polygon, the first vertex at +X; ends as fans about the axis."""
    rim = _circle(sections)
    count = sections
    vertices = np.concatenate([_at(rim, -0.5), _at(rim, 0.5), [(0, 0, -0.5), (0, 0, 0.5)]])
    here = np.arange(count)
    after = (here + 1) % count
    bottom, top = np.full(count, 2 * count), np.full(count, 2 * count + 1)
    faces = np.concatenate(
        [
            np.stack([here, after, after + count], axis=1),
            np.stack([here, after + count, here + count], axis=1),
            np.stack([bottom, after, here], axis=1),
            np.stack([top, here + count, after + count], axis=1),
        ]
    )
    return _unit(vertices, faces)


@cache
def cone() -> Mesh:
    """Return the pyramid along Z over a regular polygon, its apex up; the base as a fan about the axis."""
    count = CONE_SECTIONS
    vertices = np.concatenate([_at(_circle(count), -0.5), [(0, 0, -0.5), (0, 0, 0.5)]])
    here = np.arange(count)
    after = (here + 1) % count
    faces = np.concatenate(
        [
            np.stack([np.full(count, count), after, here], axis=1),
            np.stack([np.full(count, count + 1), here, after], axis=1),
        ]
    )
    return _unit(vertices, faces)


def round_share(mesh: Mesh) -> float:
    """The width of the widest round cylinder or cone that lies within a unit prism or pyramid, as part of its width."""
    planes = mesh.hull.planes
    across = np.hypot(planes[:, 0], planes[:, 1])
    sides = across > 1e-9
    # Distances from the axis at the bottom.
    return float(2 * ((0.5 * planes[sides, 2] - planes[sides, 3]) / across[sides]).min())


@cache
def spheroid() -> Mesh:
    """Return the icosahedron subdivided three times onto the sphere: 642 vertices, 1280 faces."""
    golden = (1 + np.sqrt(5)) / 2
    corners = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)]
    vertices = np.array([np.roll(corner, shift) for shift in range(3) for corner in corners])
    vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    faces = _icosahedron_faces(vertices)
    for _ in range(SPHEROID_SUBDIVISIONS):
        vertices, faces = _subdivided(vertices, faces)
    return _unit(vertices / 2, faces)


def _icosahedron_faces(vertices: Floats) -> Indices:
    """Return the triples of mutually nearest vertices, wound to face outwards."""
    near = np.linalg.norm(vertices[:, None] - vertices, axis=2) < 1.2
    faces = [
        (a, b, c) if np.dot(np.cross(vertices[a], vertices[b]), vertices[c]) > 0 else (a, c, b)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if near[a, b] and near[b, c] and near[a, c]
    ]
    return np.array(faces, dtype=np.intp)


def _subdivided(vertices: Floats, faces: Indices) -> tuple[Floats, Indices]:
    """Each face cut into four at the middles of its edges, which move out to the unit sphere."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[unique[:, 0]] + vertices[unique[:, 1]]
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    ab, bc, ca = inverse.reshape(3, -1) + len(vertices)
    a, b, c = faces.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([vertices, middles]), np.concatenate([np.stack(part, axis=1) for part in parts])


def _circle(sections: int) -> Floats:
    """Return vertices ``(sections, 2)`` on the circle of diameter 1, exact where they lie on the axes."""
    angles = np.arange(sections) * (2 * np.pi / sections)
    points = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.where(np.abs(points) < 1e-15, 0.0, points)


def _at(rim: Floats, z: float) -> Floats:
    return np.column_stack([rim, np.full(len(rim), z)])


def _unit(vertices: Floats, faces: Indices) -> Mesh:
    return Mesh(vertices, faces).normalized()[0]
