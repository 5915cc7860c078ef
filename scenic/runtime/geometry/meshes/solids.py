"""Making a proper volume of a mesh as files hold them: merged vertices, outward normals, no overlapping bodies."""

from typing import Final

import numpy as np

from scenic.language.errors import MeshError
from scenic.runtime.geometry.meshes import booleans, topology
from scenic.runtime.geometry.meshes.inside import contains_points
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Floats, Indices

_MERGE_TOLERANCE: Final = 1e-8
"""Part of the largest extent within which vertices are taken for one if the surface is open otherwise."""

_HELP: Final = "repair the mesh, so that closed surfaces with normals pointing outwards bound its solid"


def proper_volume(mesh: Mesh, *, unify: bool = True, name: str = "the mesh") -> Mesh:
    """Return the solid bounded by ``mesh``.

    Equal vertices are merged, bodies with inverted normals turned outwards (a body inside another one with
    normals inwards is a cavity and stays one), and overlapping bodies united if ``unify``.

    Raises:
        MeshError: the faces bound no volume; the message says why.

    """
    vertices, faces = topology.merge_vertices(mesh.vertices, mesh.faces)
    if len(faces) and topology.edge_census(faces).open_edges:
        tolerance = _MERGE_TOLERANCE * float(mesh.extents.max())
        if tolerance > 0:
            vertices, faces = topology.merge_vertices(vertices, faces, tolerance=tolerance)
    _check_closed(faces, name)
    bodies = _bodies(vertices, faces)
    solids = _oriented(bodies, name)
    if unify and len(solids) > 1 and _any_overlap(solids):
        union = booleans.union(solids)
        if union is None:
            raise MeshError(
                f"the overlapping bodies of {name} could not be united",
                help="unite the bodies in a mesh editor, or load with `unify=False`",
            )
        return union
    if not bodies.turned:
        return Mesh(vertices, faces)
    return _joined(solids)


def _check_closed(faces: Indices, name: str) -> None:
    if not len(faces):
        raise MeshError(f"{name} is not a volume: it has no triangles with an area", help=_HELP)
    census = topology.edge_census(faces)
    if census.open_edges:
        plural = "edge is" if census.open_edges == 1 else "edges are"
        raise MeshError(
            f"{name} is not a volume: its surface has holes ({census.open_edges} {plural} open)", help=_HELP
        )
    if census.inconsistent_edges:
        raise MeshError(
            f"{name} is not a volume: the winding of its triangles is inconsistent "
            f"(at {census.inconsistent_edges} edge{'s' * (census.inconsistent_edges > 1)})",
            help=_HELP,
        )


class _Bodies:
    """The connected surfaces of a mesh, and whether any was turned inside out to face outwards."""

    def __init__(self, parts: list[Mesh]) -> None:
        self.parts = parts
        self.turned = False


def _bodies(vertices: Floats, faces: Indices) -> _Bodies:
    components = topology.face_components(faces, len(vertices))
    count = int(components.max()) + 1
    if count == 1:
        return _Bodies([Mesh(vertices, faces)])
    order = np.argsort(components, kind="stable")
    groups = np.split(faces[order], np.flatnonzero(np.diff(components[order])) + 1)
    return _Bodies([Mesh(*topology.without_unused(vertices, group)) for group in groups])


def _oriented(bodies: _Bodies, name: str) -> list[Mesh]:
    """Return the solids, each an outer surface with its cavities."""
    outer = [part for part in bodies.parts if part.volume > 0]
    cavities: dict[int, list[Mesh]] = {}
    for part in bodies.parts:
        scale = float(np.prod(np.maximum(part.extents, 1e-300)))
        if part.volume == 0 or abs(part.volume) <= 1e-12 * scale:
            raise MeshError(f"{name} is not a volume: a part of it encloses nothing", help=_HELP)
        if part.volume > 0:
            continue
        around = [
            (solid.volume, index)
            for index, solid in enumerate(outer)
            if (solid.bounds[0] <= part.bounds[0]).all()
            and (part.bounds[1] <= solid.bounds[1]).all()
            and bool(contains_points(solid, part.component_vertices[:1])[0])
        ]
        if around:
            cavities.setdefault(min(around)[1], []).append(part)
        else:
            bodies.turned = True
            outer.append(Mesh(part.vertices, part.faces[:, ::-1]))
    return [_joined([solid, *cavities.get(index, ())]) for index, solid in enumerate(outer)]


def _joined(parts: list[Mesh]) -> Mesh:
    if len(parts) == 1:
        return parts[0]
    offsets = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    return Mesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + offset for part, offset in zip(parts, offsets, strict=True)]),
    )


def _any_overlap(solids: list[Mesh]) -> bool:
    """Return whether the bounding boxes of two solids meet; sorted along x, so that many solids are quick."""
    lower = np.array([solid.bounds[0] for solid in solids])
    upper = np.array([solid.bounds[1] for solid in solids])
    order = np.argsort(lower[:, 0], kind="stable")
    lower, upper = lower[order], upper[order]
    for index in range(len(order) - 1):
        end = int(np.searchsorted(lower[:, 0], upper[index, 0], side="right"))
        later = slice(index + 1, end)
        if ((lower[later] <= upper[index]) & (lower[index] <= upper[later])).all(axis=1).any():
            return True
    return False
