"""Mesh files as files of scenes name them: by a path relative to a folder, with a digest of the content."""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenic.formats.scene_protocols import ShapeSource
from scenic.language.errors import Located

__all__ = ["ChangedMeshError", "MeshPaths", "check_unchanged", "digest_of", "resolved"]


class ChangedMeshError(Located):
    """A mesh file that is another one than when scenes were written."""

    code = "SC607"


def digest_of(path: Path) -> str:
    """Return SHA-256 of a file's bytes, in hexadecimal."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


class MeshPaths:
    """Tells shapes as plain data. Each mesh file is read once for its digest.

    Args:
        folder: the folder that paths of meshes are relative to; they are absolute if there is none.

    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = None if folder is None else folder.absolute()
        self._known: dict[str, dict[str, Any]] = {}

    def told(self, source: ShapeSource) -> dict[str, Any]:
        """Return a shape as plain data; of a mesh file the path (with ``/``) and, if it can be read, ``sha256``."""
        data = source.as_dict()
        path = data.get("path")
        if path is None:
            return data
        if path not in self._known:
            self._known[path] = self._file(path)
        return {**data, **self._known[path]}

    def _file(self, path: str) -> dict[str, Any]:
        name = path
        if self._folder is not None:
            try:
                name = Path(os.path.relpath(path, self._folder)).as_posix()
            except ValueError:  # on another drive
                name = path
        try:
            return {"path": name, "sha256": digest_of(Path(path))}
        except OSError:
            return {"path": name}


def resolved(shape: object, folder: Path) -> Any:
    """Return a shape as given, with the absolute path of its mesh file; any other value unchanged."""
    if not isinstance(shape, Mapping) or shape.get("kind") != "mesh" or "path" not in shape:
        return shape
    return {**shape, "path": os.path.normpath(folder.absolute() / shape["path"])}


def check_unchanged(path: Path, sha256: str) -> None:
    """Compare a mesh file with the digest that it had.

    Raises:
        ChangedMeshError: if it has another one. A file that cannot be read is left to whoever loads it.

    """
    try:
        digest = digest_of(path)
    except OSError:
        return
    if digest != sha256:
        raise ChangedMeshError(
            f"the mesh file '{path}' has changed since the scenes were saved",
            help="put back the file that they were made with, or sample the scenes again",
        )
