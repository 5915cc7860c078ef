"""Reading mesh files with trimesh.

The store keeps the finished meshes by the content of their files, so that only the first use of a file imports trimesh.
"""

import hashlib
import io
import math
import numbers
import warnings
import zlib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final
from urllib.parse import unquote

import numpy as np

from scenic.language.errors import MeshError, ScenicTypeError, ScenicValueError
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.solids import proper_volume
from scenic.runtime.geometry.meshes.topology import merge_vertices
from scenic.runtime.geometry.store import Arrays, kept
from scenic.runtime.ground.library_versions import library_version

MOST_TRIANGLES: Final = 4_000_000
"""Triangles up to which a mesh is taken: indices and tables for one as large take some gigabytes."""

_MOST_BYTES: Final = 1 << 30
"""Length of a file, unpacked, up to which it is read."""

_NO_MESHES: Final = frozenset({"bz2", "tar.bz2", "tar.gz", "zip", "dxf", "xyz"})
"""Archives, drawings and point clouds among the formats of trimesh."""


_COMMON: Final = frozenset({"obj", "stl", "ply", "glb", "gltf", "off"})
"""Formats that need not be looked up, which would import trimesh."""

_WITH_NEIGHBOURS: Final = frozenset({"gltf", "dae", "zae", "xaml", "3dxml"})
"""Formats whose files refer to others, so that one file does not decide the mesh: these are read each time."""

_KIND: Final = "mesh 1"
"""The name of finished meshes in the store; a new number whenever `proper_volume` or `merge_vertices` changes."""

METRES: Final[Mapping[str, float]] = MappingProxyType(
    {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "in": 0.0254, "ft": 0.3048}
)
"""Metres in each unit of length that a mesh file may be in."""


def factor_of(unit: object, scale: object, what: str) -> float:
    """Return the factor that turns the numbers of a mesh file into metres.

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
    data, file_type = _read(file, name)

    def finished() -> Arrays:
        mesh = _finished(_loaded(data, file_type, file, name), name, unify=unify, volume=volume)
        return {"vertices": mesh.vertices, "faces": mesh.faces}

    if file_type in _WITH_NEIGHBOURS:
        arrays = finished()
    else:
        # Who reads and who repairs the mesh decides its content, too.
        libraries = [library_version(library) for library in ("trimesh", "manifold3d")]
        choices = f"{file_type} {unify} {volume} {libraries}\0".encode()
        arrays = kept(_KIND, hashlib.sha256(choices + data).digest(), finished)
    return Mesh(arrays["vertices"], arrays["faces"])


def _finished(loaded: Any, name: str, *, unify: bool, volume: bool) -> Mesh:
    """Return the mesh of what trimesh has read, checked and repaired."""
    vertices = np.asarray(loaded.vertices, dtype=np.float64)
    faces = np.asarray(loaded.faces, dtype=np.intp)
    if not len(faces):
        raise MeshError(f"{name} holds no triangles")
    if len(faces) > MOST_TRIANGLES:
        raise MeshError(
            f"{name} has {len(faces)} triangles, more than {MOST_TRIANGLES}",
            help="simplify it in a mesh editor; bodies rarely need more than some thousand triangles",
        )
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise MeshError(f"{name} has a vertex without three coordinates")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"{name} has a face with a vertex outside 1 to {len(vertices)}")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{name} has a coordinate that is not finite")
    if volume:
        return proper_volume(Mesh(vertices, faces), unify=unify, name=name)
    vertices, faces = merge_vertices(vertices, faces)
    if not len(faces):
        raise MeshError(f"{name} has no triangles with an area")
    return Mesh(vertices, faces)


def _read(file: Path, name: str) -> tuple[bytes, str]:
    """The unpacked content of a file, and its format."""
    suffixes = [suffix.lower() for suffix in file.suffixes[-2:]]
    packing = suffixes.pop() if suffixes and suffixes[-1] in (".bz2", ".gz") else None
    file_type = suffixes[-1][1:] if suffixes else ""
    try:
        data = _limited(file.open("rb"), name)
    except FileNotFoundError:
        raise MeshError(
            f"{name} does not exist", help="relative paths start from the current directory; see `localPath`"
        ) from None
    except OSError as error:
        raise MeshError(f"{name} cannot be read: {error.strerror or error}") from None
    if file_type not in _COMMON:
        _check_format(file_type, name)
    if packing is not None:
        try:
            data = _limited(_unpacked(data, packing), name)
        except (OSError, EOFError, zlib.error) as error:
            raise MeshError(f"{name} cannot be unpacked: {error}") from None
    return data, file_type


def _unpacked(data: bytes, packing: str) -> Any:
    """Return a stream of the content of a packed file."""
    if packing == ".gz":
        import gzip  # few programs read packed meshes

        return gzip.GzipFile(fileobj=io.BytesIO(data))
    import bz2

    return bz2.BZ2File(io.BytesIO(data))


def _limited(stream: Any, name: str) -> bytes:
    """Return all of a stream, unless it is too long."""
    with stream:
        data: bytes = stream.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise MeshError(
            f"{name} is longer than {_MOST_BYTES >> 20} MiB", help="simplify the mesh in a mesh editor"
        )
    return data


def _check_format(file_type: str, name: str) -> None:
    import trimesh

    formats = set(trimesh.available_formats()) - _NO_MESHES
    if file_type not in formats:
        raise MeshError(
            f"{name} is of an unknown format{f' `.{file_type}`' if file_type else ''}",
            help=f"known formats: {', '.join(sorted(formats))}; each also packed as .bz2 or .gz",
        )


def _loaded(data: bytes, file_type: str, file: Path, name: str) -> Any:
    """Read a mesh file with trimesh."""
    import logging  # takes a fortieth of a start, and few files are read by that library

    import trimesh

    logger = logging.getLogger("trimesh")
    was_disabled = logger.disabled
    logger.disabled = True  # what goes wrong is said by the error below
    try:
        if file_type == "obj" and b"-" in data:
            data = _absolute(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(
                io.BytesIO(data),
                file_type=file_type,
                resolver=_beside(file, name),
                process=False,
                skip_materials=True,
            )
            mesh = scene.to_mesh()
    except MeshError:
        raise
    except Exception as error:  # noqa: BLE001  # readers raise whatever their format's parser raises
        reason = str(error).strip() or type(error).__name__
        raise MeshError(f"{name} cannot be read as {file_type}: {reason}") from None
    finally:
        logger.disabled = was_disabled
    if not isinstance(mesh, trimesh.Trimesh):
        raise MeshError(f"{name} holds no triangles")
    return mesh


def _beside(file: Path, mesh: str) -> Any:
    """Return the resolver of files that a mesh file refers to: they lie beside it, packed or not, and their names are parts of URLs."""
    from trimesh.resolvers import FilePathResolver

    class Beside(FilePathResolver):
        def get(self, name: str) -> Any:
            try:
                return super().get(unquote(name))
            except (OSError, ValueError) as error:
                raise MeshError(f"{mesh} names a file that cannot be read: {error}") from None

    return Beside(str(file))


def _absolute(data: bytes) -> bytes:
    """Return an OBJ text whose faces have positive vertex numbers alone.

    Negative numbers count back from the vertices before the face; trimesh counts them back from the end of the file.
    """
    vertices = 0
    lines = data.splitlines()
    for index, line in enumerate(lines):
        if line.startswith((b"v ", b"v\t")):
            vertices += 1
        elif line.startswith(b"f") and b"-" in line:
            corners = [int(corner.partition(b"/")[0]) for corner in line.split()[1:]]
            if 0 in corners:
                raise ValueError("a face has the vertex number 0")
            lines[index] = b"f " + b" ".join(
                b"%d" % (corner + vertices + 1 if corner < 0 else corner) for corner in corners
            )
    return b"\n".join(lines)
