"""Texture coordinates of mesh files, for the triangles of the meshes that were made of them.

A mesh of a program has been turned, brought to the unit box, freed of what is double, and perhaps united of several bodies. So its
triangles are found among those of the file by their places.
"""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.graph import quaternions

__all__ = ["coordinates_of"]

_Array = npt.NDArray[np.float64]

_NEAR: Final = 1e-4
"""Distance in the unit box within which places are one."""

_NEIGHBOURS: Final = 24
"""Triangles of the file among which the one is looked for of which a triangle is a part."""


def coordinates_of(
    source: Any, vertices: _Array, faces: npt.NDArray[np.int64]
) -> npt.NDArray[np.float32] | None:
    """Texture coordinates of the corners of triangles ``(f, 3, 2)``, not a number where the file has none.

    Args:
        source: where the mesh comes from, as plain data (`ShapeSource.as_dict`).
        vertices: of the mesh in the unit box, ``(v, 3)``.
        faces: its triangles, ``(f, 3)``.

    Returns:
        The coordinates; ``None`` if no triangle has any.

    """
    path = source.get("path")
    places_and_coordinates = None if path is None else _read(path, *_stamp(path))
    if places_and_coordinates is None:
        return None
    places, coordinates = places_and_coordinates
    rotation: Sequence[float] | None = source.get("initial_rotation")
    if rotation is not None:
        places = places @ quaternions.to_matrix(quaternions.from_euler(*rotation)).T
    low, high = places.min(axis=(0, 1)), places.max(axis=(0, 1))
    places = (places - (low + high) / 2) / np.where(high > low, high - low, 1)
    result = _matched(vertices[faces], places, coordinates)
    return None if np.isnan(result).all() else result.astype(np.float32)


def _matched(wanted: _Array, places: _Array, coordinates: _Array) -> _Array:
    """Return the coordinates of triangles ``(f, 3, 3)`` that are triangles of a file, or parts of them."""
    from scipy.spatial import KDTree

    tree = KDTree(places.mean(axis=1))
    result = np.full((len(wanted), 3, 2), np.nan)
    left = np.arange(len(wanted))
    for count in (1, min(_NEIGHBOURS, len(places))):
        if not len(left):
            break
        _, neighbours = tree.query(wanted[left].mean(axis=1), k=count)
        for column in np.reshape(neighbours, (len(left), -1)).T:
            free = np.isnan(result[left, 0, 0])
            weights, is_inside = _weights(wanted[left], places[column])
            mine = free & is_inside
            result[left[mine]] = np.einsum("fcw,fwu->fcu", weights[mine], coordinates[column[mine]])
        left = left[np.isnan(result[left, 0, 0])]
    return result


def _weights(inner: _Array, outer: _Array) -> tuple[_Array, npt.NDArray[np.bool_]]:
    """Weights of outer corners at inner ones ``(f, 3, 3)``, and whether each inner triangle is a part of its outer one."""
    origin = outer[:, 0]
    edges = outer[:, 1:] - origin[:, None]
    gram = np.einsum("fix,fjx->fij", edges, edges)
    determinant = gram[:, 0, 0] * gram[:, 1, 1] - gram[:, 0, 1] ** 2
    offset = inner - origin[:, None]
    along = np.einsum("fcx,fix->fci", offset, edges)
    safe = np.where(determinant > 0, determinant, 1)[:, None]
    second = (gram[:, None, 1, 1] * along[..., 0] - gram[:, None, 0, 1] * along[..., 1]) / safe
    third = (gram[:, None, 0, 0] * along[..., 1] - gram[:, None, 0, 1] * along[..., 0]) / safe
    weights = np.stack([1 - second - third, second, third], axis=-1)
    away = np.linalg.norm(inner - np.einsum("fcw,fwx->fcx", weights, outer), axis=-1).max(axis=1)
    length = np.sqrt(np.maximum(gram[:, 0, 0], gram[:, 1, 1]))
    slack = _NEAR / np.maximum(length, _NEAR)
    is_inside = (away < _NEAR) & (weights.min(axis=(1, 2)) > -slack) & (determinant > 0)
    return weights, is_inside


def _stamp(path: str) -> tuple[int, int]:
    status = Path(path).stat()
    return status.st_mtime_ns, status.st_size


@lru_cache(maxsize=64)
def _read(path: str, _stamp: int, _length: int) -> tuple[_Array, _Array] | None:
    """Return the triangles of a file ``(f, 3, 3)`` and their texture coordinates ``(f, 3, 2)``; ``None`` if it has none."""
    import trimesh

    try:
        scene: Any = trimesh.load_scene(path, process=False)
    except Exception:  # noqa: BLE001 - the mesh has been read, but trimesh raises whatever comes up in its parsers
        return None
    places, coordinates = [], []
    for name in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        uv = getattr(mesh.visual, "uv", None) if hasattr(mesh, "faces") else None
        if not hasattr(mesh, "faces"):
            continue
        corners = trimesh.transform_points(mesh.vertices, matrix)[mesh.faces]
        places.append(corners)
        coordinates.append(
            np.full((len(corners), 3, 2), np.nan) if uv is None else np.asarray(uv)[mesh.faces]
        )
    if not places or all(np.isnan(item).all() for item in coordinates):
        return None
    return np.concatenate(places).astype(np.float64), np.concatenate(coordinates).astype(np.float64)
