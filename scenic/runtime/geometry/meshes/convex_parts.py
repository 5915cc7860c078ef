"""Solids as convex parts, since physics knows contacts of convex things only."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.language.extras import installation
from scenic.runtime.geometry.meshes.exact_parts import exact_parts
from scenic.runtime.geometry.store import Arrays, is_kept, kept, store_folder
from scenic.runtime.ground.context import warn

__all__ = ["convex_parts", "lacks_parts"]

_APPROXIMATE: Final = "convex parts 1"
_MOST: Final = 96
"""Parts of an exact division, at most."""
_NEARLY: Final = 0.98
"""A solid that fills so much of its convex hull is left to it."""
_CONCAVITY: Final = 0.1
"""By how much a part may differ from its hull, where the whole is two units long."""
_SEARCH: Final = {"mcts_iterations": 40, "resolution": 1000, "seed": 0}
"""A tenth of the library's own effort, which gives parts nearly as few."""
_MANY_FACES: Final = 3000
"""A finer mesh is made coarser first: the search takes time by its faces."""
_FLAT: Final = 1e-7
"""Of the parts of a mesh in its unit box, those of less volume are left out."""


def convex_parts(mesh: Any) -> tuple[npt.NDArray[np.float64], ...]:
    """Return the vertices ``(n, 3)`` of convex parts that make up a solid; nothing if its hull is as good.

    Solids of few plane faces, such as furniture, are divided exactly, others approximately, which takes seconds. Parts of a mesh serve all its
    sizes, and are kept on disk.

    Args:
        mesh: a `scenic.runtime.geometry.meshes.mesh.Mesh` in its unit box.

    """
    if _is_whole(mesh):
        return ()
    parts = _exact(mesh)
    if not len(parts["ends"]):
        library = _library()
        if library is None:
            return ()
        parts = kept(_APPROXIMATE, mesh.digest, lambda: _approximate(mesh, library))
    # The hulls may reach out of the solid a little, but never below what it stands on.
    vertices = np.clip(parts["vertices"], mesh.vertices.min(axis=0), mesh.vertices.max(axis=0))
    return tuple(part for part in np.split(vertices, parts["ends"][:-1]) if _volume(part) > _FLAT)


def lacks_parts(mesh: Any) -> bool:
    """Return whether parts of a mesh are still to be searched for, which takes seconds, and would be kept on disk."""
    if store_folder() is None or _is_whole(mesh) or len(_exact(mesh)["ends"]):
        return False
    return not is_kept(_APPROXIMATE, mesh.digest)


def _is_whole(mesh: Any) -> bool:
    """Return whether a mesh needs no parts."""
    return not mesh.is_volume or mesh.is_convex or mesh.volume >= _NEARLY * mesh.hull.volume


def _exact(mesh: Any) -> Arrays:
    return kept("exact parts 1", mesh.digest, lambda: _stored(exact_parts(mesh.vertices, mesh.faces, _MOST)))


def _approximate(mesh: Any, library: Any) -> Arrays:
    """Return the parts of a solid as CoACD finds them."""
    detail = {"preprocess_mode": "on" if len(mesh.faces) > _MANY_FACES else "off"}
    library.set_log_level("error")
    solid = library.Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int32))
    results = library.run_coacd(solid, threshold=_CONCAVITY, **detail, **_SEARCH)
    return _stored([np.asarray(vertices, np.float64) for vertices, _ in results])


def _stored(parts: Sequence[npt.NDArray[np.float64]] | None) -> Arrays:
    """Return the parts in the form in which the store keeps them."""
    vertices = np.concatenate(parts) if parts else np.empty((0, 3))
    return {"vertices": vertices, "ends": np.cumsum([len(part) for part in parts or ()], dtype=np.int64)}


def _library() -> Any:
    """Return the package ``coacd``, if it is there. It has no types, hence ``Any``."""
    try:
        import coacd  # optional, and slow to import
    except ImportError:
        warn(
            "meshes that are not convex touch with their convex hulls, since the package coacd is missing",
            help=f"install it: {installation('mujoco')}",
        )
        return None
    return coacd


def _volume(points: npt.NDArray[np.float64]) -> float:
    """Of the convex hull of points."""
    from scipy.spatial import ConvexHull, QhullError  # slow to import

    try:
        return float(ConvexHull(points).volume)
    except QhullError:  # they lie in a plane
        return 0.0
