"""The formats of mesh files that are read here, by the ending of a file's name; other formats are left to trimesh."""

import bz2
import gzip
import io
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.runtime.geometry.meshes.reading.gltf import Neighbour, read_glb, read_gltf
from scenic.runtime.geometry.meshes.reading.obj import read_obj
from scenic.runtime.geometry.meshes.reading.ply import read_ply
from scenic.runtime.geometry.meshes.reading.soup import Soup
from scenic.runtime.geometry.meshes.reading.stl import read_stl

__all__ = ["PACKINGS", "READERS"]

PACKINGS: Final[Mapping[str, Callable[[io.BytesIO], Any]]] = MappingProxyType(
    {".bz2": bz2.BZ2File, ".gz": lambda stream: gzip.GzipFile(fileobj=stream)}
)
READERS: Final[Mapping[str, Callable[[bytes, Neighbour], Soup]]] = MappingProxyType(
    {
        "obj": lambda data, _: read_obj(data),
        "stl": lambda data, _: read_stl(data),
        "ply": lambda data, _: read_ply(data),
        "glb": read_glb,
        "gltf": read_gltf,
    }
)
