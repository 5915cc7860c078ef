"""Reading mesh files: the common formats by our own readers, all others by trimesh."""

import io
import math
import numbers
import warnings
import zlib
from collections.abc import Collection, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from scenic.language.errors import MeshError, ScenicTypeError, ScenicValueError
from scenic.language.garbage import no_garbage_collection
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.reading.soup import NotCoveredError, Soup
from scenic.runtime.geometry.meshes.solids import proper_volume
from scenic.runtime.geometry.meshes.topology import merge_vertices

MOST_TRIANGLES: Final = 4_000_000
"""Triangles up to which a mesh is taken: indices and tables for one as large take some gigabytes."""

_MOST_BYTES: Final = 1 << 30
"""Length of a file, unpacked, up to which it is read."""

_NO_MESHES: Final = frozenset({"bz2", "tar.bz2", "tar.gz", "zip", "dxf", "xyz"})
"""Archives, drawings and point clouds among the formats of trimesh."""


METRES: Final[Mapping[str, float]] = MappingProxyType(
    {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}
)
"""Metres in each unit of length that a mesh file may be in."""


def factor_of(unit: Any, scale: Any, what: str) -> float:
    """The factor that turns the numbers of a mesh file into metres.

    Args:
        unit: the unit of length of the file, one of `METRES`.
        scale: a further factor.
        what: what is made of the mesh, for messages.

    Raises:
        ScenicValueError: for an unknown unit, or a factor that is not positive.
        ScenicTypeError: for a factor that is not a fixed number.

    """
    if not isinstance(unit, str) or unit not in METRES:
        raise ScenicValueError(
            f"{what} knows no unit of length {unit!r}", help=f"give one of {', '.join(map(repr, METRES))}"
        )
    if not isinstance(scale, numbers.Real):
        raise ScenicTypeError(f"{what} needs a fixed number as `scale`, not {scale!r}")
    factor = float(scale)
    if not (factor > 0 and math.isfinite(factor)):
        raise ScenicValueError(f"{what} needs a positive number as `scale`, not {factor:g}")
    return METRES[unit] * factor


def load_mesh(path: str | Path, *, unify: bool = True, volume: bool = True) -> Mesh:
    """The mesh in a file of any format that trimesh reads, perhaps packed with bzip2 or gzip.

    The name of the file tells its format (``chair.obj``, ``chair.obj.bz2``). All bodies of a scene are taken
    together, placed as the file says.

    Args:
        path: the file.
        unify: whether overlapping bodies are united; only for volumes.
        volume: whether the mesh must bound a solid.

    Raises:
        MeshError: the file is missing, unreadable, empty or too large, or its mesh is not a volume.

    """
    file = Path(path)
    name = f"the mesh `{path}`"
    vertices, faces = _read(file, name)
    if not len(faces):
        raise MeshError(f"{name} holds no triangles")
    if len(faces) > MOST_TRIANGLES:
        raise MeshError(
            f"{name} has {len(faces)} triangles, more than {MOST_TRIANGLES}",
            help="simplify it in a mesh editor; bodies rarely need more than some thousand triangles",
        )
    if not np.isfinite(vertices).all():
        raise MeshError(f"{name} has a coordinate that is not finite")
    if volume:
        return proper_volume(Mesh(vertices, faces), unify=unify, name=name)
    vertices, faces = merge_vertices(vertices, faces)
    if not len(faces):
        raise MeshError(f"{name} has no triangles with an area")
    return Mesh(vertices, faces)


def _read(file: Path, name: str) -> Soup:
    from scenic.runtime.geometry.meshes.reading.formats import PACKINGS, READERS  # few programs read meshes

    suffixes = [suffix.lower() for suffix in file.suffixes[-2:]]
    unpack = PACKINGS.get(suffixes[-1]) if suffixes else None
    if unpack is not None:
        suffixes = suffixes[:-1]
    file_type = suffixes[-1][1:] if suffixes else ""
    try:
        data = _limited(file.open("rb"), name)
    except FileNotFoundError:
        raise MeshError(
            f"{name} does not exist", help="relative paths start from the current directory; see `localPath`"
        ) from None
    except OSError as error:
        raise MeshError(f"{name} cannot be read: {error.strerror or error}") from None
    if file_type not in READERS:
        _check_format(file_type, READERS.keys(), name)
    if unpack is not None:
        try:
            data = _limited(unpack(io.BytesIO(data)), name)
        except (OSError, EOFError, zlib.error) as error:
            raise MeshError(f"{name} cannot be unpacked: {error}") from None
    if file_type in READERS:
        try:
            with no_garbage_collection():  # text is split into lists by the ten thousand
                return READERS[file_type](data, lambda beside: (file.parent / beside).read_bytes())
        except NotCoveredError:
            pass
        except OSError as error:
            raise MeshError(f"{name} names a file that cannot be read: {error}") from None
        except (ValueError, OverflowError, RecursionError) as error:
            raise MeshError(f"{name} cannot be read as {file_type}: {error}") from None
    return _loaded(data, file_type, file, name, packed=unpack is not None)


def _limited(stream: Any, name: str) -> bytes:
    """All of a stream, unless it is too long."""
    with stream:
        data: bytes = stream.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise MeshError(
            f"{name} is longer than {_MOST_BYTES >> 20} MiB", help="simplify the mesh in a mesh editor"
        )
    return data


def _check_format(file_type: str, read_here: Collection[str], name: str) -> None:
    import trimesh

    formats = (set(trimesh.available_formats()) | set(read_here)) - _NO_MESHES
    if file_type not in formats:
        raise MeshError(
            f"{name} is of an unknown format{f' `.{file_type}`' if file_type else ''}",
            help=f"known formats: {', '.join(sorted(formats))}; each also packed as .bz2 or .gz",
        )


def _loaded(data: bytes, file_type: str, file: Path, name: str, *, packed: bool) -> Soup:
    """Read a mesh file with trimesh."""
    import logging  # takes a fortieth of a start, and few files are read by that library

    import trimesh

    logger = logging.getLogger("trimesh")
    disabled = logger.disabled
    logger.disabled = True  # what goes wrong is said by the error below
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # Formats that refer to neighbouring files find them beside an unpacked file.
            resolver = None if packed else trimesh.resolvers.FilePathResolver(str(file))
            scene = trimesh.load_scene(
                io.BytesIO(data),
                file_type=file_type,
                resolver=resolver,
                process=False,
                skip_materials=True,
            )
            loaded = scene.to_mesh()
    except Exception as error:  # noqa: BLE001  # readers raise whatever their format's parser raises
        reason = str(error).strip() or type(error).__name__
        raise MeshError(f"{name} cannot be read as {file_type}: {reason}") from None
    finally:
        logger.disabled = disabled
    if not isinstance(loaded, trimesh.Trimesh):
        raise MeshError(f"{name} holds no triangles")
    return Soup(np.asarray(loaded.vertices, dtype=np.float64), np.asarray(loaded.faces, dtype=np.intp))
