"""The facade over trimesh: reading mesh files."""

import bz2
import gzip
import io
import logging
import warnings
import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np

from scenic.language.errors import MeshError
from scenic.runtime.geometry.mesh import Mesh
from scenic.runtime.geometry.solids import proper_volume
from scenic.runtime.geometry.topology import merge_vertices

_PACKINGS: Final = {".bz2": bz2.decompress, ".gz": gzip.decompress}
_NO_MESHES: Final = frozenset({"bz2", "tar.bz2", "tar.gz", "zip", "dxf", "xyz"})
"""Archives, drawings and point clouds among the formats of trimesh."""


def load_mesh(path: str | Path, *, unify: bool = True, volume: bool = True) -> Mesh:
    """The mesh in a file of any format that trimesh reads, perhaps packed with bzip2 or gzip.

    The name of the file tells its format (``chair.obj``, ``chair.obj.bz2``). All bodies of a scene are taken
    together, placed as the file says.

    Args:
        path: the file.
        unify: whether overlapping bodies are united; only for volumes.
        volume: whether the mesh must bound a solid.

    Raises:
        MeshError: the file is missing, unreadable or empty, or its mesh is not a volume.

    """
    file = Path(path)
    name = f"the mesh `{path}`"
    vertices, faces = _read(file, name)
    if volume:
        return proper_volume(Mesh(vertices, faces), unify=unify, name=name)
    vertices, faces = merge_vertices(vertices, faces)
    if not len(faces):
        raise MeshError(f"{name} has no triangles with an area")
    return Mesh(vertices, faces)


def _read(
    file: Path, name: str
) -> tuple[np.ndarray[Any, np.dtype[np.float64]], np.ndarray[Any, np.dtype[np.intp]]]:
    import trimesh

    formats = set(trimesh.available_formats())
    suffixes = [suffix.lower() for suffix in file.suffixes[-2:]]
    unpack = _PACKINGS.get(suffixes[-1]) if suffixes else None
    if unpack is not None:
        suffixes = suffixes[:-1]
    file_type = suffixes[-1][1:] if suffixes else ""
    try:
        data = file.read_bytes()
    except FileNotFoundError:
        raise MeshError(
            f"{name} does not exist", help="relative paths start from the current directory; see `localPath`"
        ) from None
    except OSError as error:
        raise MeshError(f"{name} cannot be read: {error.strerror or error}") from None
    if file_type not in formats - _NO_MESHES:
        raise MeshError(
            f"{name} is of an unknown format{f' `.{file_type}`' if file_type else ''}",
            help=f"known formats: {', '.join(sorted(formats - _NO_MESHES))}; each also packed as .bz2 or .gz",
        )
    if unpack is not None:
        try:
            data = unpack(data)
        except (OSError, EOFError, ValueError, zlib.error) as error:
            raise MeshError(f"{name} cannot be unpacked: {error}") from None
    loaded = _loaded(data, file_type, file, name, packed=unpack is not None)
    if not isinstance(loaded, trimesh.Trimesh) or not len(loaded.faces):
        raise MeshError(f"{name} holds no triangles")
    return np.asarray(loaded.vertices, dtype=np.float64), np.asarray(loaded.faces, dtype=np.intp)


def _loaded(
    data: bytes, file_type: str, file: Path, name: str, *, packed: bool
) -> Any:  # trimesh has no types
    import trimesh

    logger = logging.getLogger("trimesh")
    disabled = logger.disabled
    logger.disabled = True  # what goes wrong is said by the error below
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # Formats that refer to neighbouring files (a .gltf to its .bin) find them beside an unpacked file.
            resolver = None if packed else trimesh.resolvers.FilePathResolver(str(file))
            scene = trimesh.load_scene(
                io.BytesIO(data),
                file_type=file_type,
                resolver=resolver,
                process=False,
                skip_materials=True,
            )
            return scene.to_mesh()
    except Exception as error:  # noqa: BLE001  # readers raise whatever their format's parser raises
        reason = str(error).strip() or type(error).__name__
        raise MeshError(f"{name} cannot be read as {file_type}: {reason}") from None
    finally:
        logger.disabled = disabled
