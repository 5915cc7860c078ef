"""Texture coordinates of objects with an image, for files that other programs read."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from scenic.formats.mesh_coordinates import coordinates_of
from scenic.formats.poses import Triple
from scenic.formats.textures import ImageTexture

__all__ = ["image_coordinates"]


def image_coordinates(
    mesh: Any, texture: ImageTexture, size: Triple, source: Mapping[str, object]
) -> npt.NDArray[np.float64]:
    """Return texture coordinates ``(f, 3, 2)`` of the triangles of a unit mesh: those of its file, else from six sides.

    Args:
        mesh: in the unit box.
        texture: the image.
        size: of the object, metres.
        source: of its shape, as saved.

    """
    faces = np.asarray(mesh.faces)
    places = (mesh.vertices * np.asarray(size))[faces]
    cross = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    normals = np.repeat(cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-30), 3, axis=0)
    projection, _ = texture.projected(
        places.reshape(-1, 3).astype(np.float32), normals.astype(np.float32), size
    )
    coordinates = np.asarray(projection, np.float64).reshape(-1, 3, 2)
    if texture.projection == "mesh":
        file_coordinates = coordinates_of(source, mesh.vertices, faces)
        if file_coordinates is not None:
            coordinates = np.where(np.isnan(file_coordinates), coordinates, file_coordinates)
    return coordinates
