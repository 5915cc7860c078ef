"""Files that scenes of a folder share: meshes and images, each once, named after its content."""

import hashlib
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.image_coordinates import image_coordinates
from scenic.formats.robotics.solids import Solid
from scenic.formats.textures import ImageTexture

__all__ = ["FOLDER", "hull", "image_file", "mesh_file", "mesh_name", "obj_text"]

FOLDER: Final = "assets"
"""The folder of shared files, beside the files of scenes."""

_DIGITS: Final = 12
"""Digits of the digests in names."""


def mesh_name(mesh: Any) -> str:
    """The name of a unit mesh, after its content."""
    return f"mesh_{mesh.digest.hex()[:_DIGITS]}"


def mesh_file(solid: Solid) -> tuple[str, bytes]:
    """The name and the content of the Wavefront file of a solid's unit mesh, with texture coordinates where it has an image."""
    mesh = solid.mesh
    if solid.texture is None:
        return f"{FOLDER}/{mesh_name(mesh)}.obj", mesh.derived(_plain_text)
    coordinates = texture_coordinates(solid)
    text = obj_text(mesh.vertices, np.asarray(mesh.faces), coordinates)
    return f"{FOLDER}/mesh_{hashlib.sha256(text).hexdigest()[:_DIGITS]}.obj", text


def texture_coordinates(solid: Solid) -> npt.NDArray[np.float64]:
    """Return the texture coordinates ``(f, 3, 2)`` of the triangles of a solid with an image."""
    assert solid.texture is not None
    return image_coordinates(solid.mesh, solid.texture, solid.size, solid.thing.shape.source.as_dict())


def image_file(texture: ImageTexture) -> tuple[str, bytes]:
    """The name and the content of an image that objects have as texture."""
    digest = texture.digest()  # raises where it cannot be read
    return f"{FOLDER}/image_{digest[:_DIGITS]}{texture.path.suffix.lower()}", texture.path.read_bytes()


def hull(points: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Corners ``(v, 3)`` and triangles ``(f, 3)``, anticlockwise from outside, of the convex hull of points."""
    from scipy.spatial import ConvexHull  # slow to import

    convex_hull = ConvexHull(points)
    corner_numbers = np.unique(convex_hull.simplices)
    vertices = points[corner_numbers]
    faces = np.searchsorted(corner_numbers, convex_hull.simplices)
    corners = vertices[faces]
    outside = np.einsum(
        "fx,fx->f",
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
        convex_hull.equations[:, :3],
    )
    faces[outside < 0] = faces[outside < 0][:, ::-1]
    return vertices, faces


def obj_text(
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[Any],
    coordinates: npt.NDArray[np.float64] | None = None,
) -> bytes:
    """Return a mesh as Wavefront OBJ, with every digit of its coordinates."""
    return ("\n".join(_lines(vertices, faces, coordinates)) + "\n").encode()


def _lines(
    vertices: npt.NDArray[np.float64], faces: npt.NDArray[Any], coordinates: npt.NDArray[np.float64] | None
) -> Iterator[str]:
    yield from (f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist())
    if coordinates is None:
        yield from (f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist())
        return
    yield from (f"vt {u:.7g} {v:.7g}" for u, v in coordinates.reshape(-1, 2).tolist())
    for number, (a, b, c) in enumerate((faces + 1).tolist()):
        first = 3 * number + 1
        yield f"f {a}/{first} {b}/{first + 1} {c}/{first + 2}"


def _plain_text(mesh: Any) -> bytes:
    return obj_text(mesh.vertices, np.asarray(mesh.faces))
