"""Convex parts of the meshes of a program, searched for before it is simulated: several at once, with progress."""

import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib.util import find_spec
from multiprocessing import get_context
from typing import Any

import numpy as np
import numpy.typing as npt

from scenic.runtime.geometry.meshes.convex_parts import convex_parts, lacks_parts
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.shapes.shapes import Shape
from scenic.runtime.values.values import options_of

__all__ = ["meshes_without_parts", "search_parts"]


def meshes_without_parts(scenario: Scenario) -> list[Mesh]:
    """Return the meshes of a program's objects of which no run has found the convex parts so far, each once."""
    if find_spec("coacd") is None:
        return []
    shapes: dict[Any, None] = {}
    for thing in scenario.objects:
        if getattr(thing, "collides", True) is not False:
            shapes |= dict.fromkeys(options_of(thing.shape) or (thing.shape,))
    meshes = dict.fromkeys(shape.mesh for shape in shapes if isinstance(shape, Shape))
    return [mesh for mesh in meshes if lacks_parts(mesh)]


def search_parts(meshes: list[Mesh], advance: Callable[[int, int], object]) -> None:
    """Find the convex parts of meshes in all processors, and keep them on disk.

    Args:
        meshes: as from `meshes_without_parts`.
        advance: called with 1 and 0 after each.

    """
    workers = min(len(meshes), os.cpu_count() or 1)
    if workers < 2:
        for mesh in meshes:
            mesh.derived(convex_parts)
            advance(1, 0)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        pending = [pool.submit(_search, np.asarray(mesh.vertices), np.asarray(mesh.faces)) for mesh in meshes]
        for future in as_completed(pending):
            future.result()
            advance(1, 0)


def _search(vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.int64]) -> None:
    convex_parts(Mesh(vertices, faces))
