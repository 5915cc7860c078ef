"""Narrowed domains in the store on disk: a program that has not changed is not analysed again.

What is kept is found by a digest of all that narrowing reads (`scenic.analysis.identity`), and used only if the code and the libraries that
made it are those that would make it now. So scenes are the same with the store and without.
"""

import hashlib
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.analysis.contraction import Pruning, contract, nodes_below
from scenic.analysis.facts import Fact
from scenic.analysis.identity import identity
from scenic.graph.domain import Domain
from scenic.graph.node import Graph, Node
from scenic.runtime.geometry.store import Arrays, find, keep, store_folder
from scenic.runtime.ground.library_versions import library_version

__all__ = ["contract_once"]

_KIND: Final = "narrowed domain"

_WORTH: Final = 0.02
"""Seconds of narrowing from which on its result is kept."""

_FOLDERS: Final = ("analysis", "graph", "runtime")
"""Packages whose modules decide the result."""

_LIBRARIES: Final = ("scipy", "shapely", "manifold3d")
"""Libraries, besides NumPy, that readings of bounds call."""


def contract_once(graph: Graph, conditions: Sequence[Fact], met: Mapping[Node, NDArray[np.bool_]]) -> Pruning:
    """The result of `contract`, from the store where an earlier run left it."""
    nodes = [condition.node for condition in conditions]
    worth = bool(nodes) and store_folder() is not None
    key = identity(graph, nodes_below(nodes), nodes, met) if worth else None
    if key is None:
        return contract(graph, conditions, met)
    arrays = find(_KIND, key)
    if arrays is not None:
        pruning = _unpacked(arrays, graph.dimension, conditions)
        if pruning is not None:
            return pruning
    start_time = time.perf_counter()
    pruning = contract(graph, conditions, met)
    if time.perf_counter() - start_time >= _WORTH:
        keep(_KIND, key, _packed(pruning, conditions))
    return pruning


def _packed(pruning: Pruning, conditions: Sequence[Fact]) -> Arrays:
    """Return the axes that each part narrows, with the corners of its boxes along these."""
    numbers = [conditions.index(fact) for fact in pruning.impossible]
    arrays: dict[str, NDArray[Any]] = {"made by": _makers(), "impossible": np.array(numbers, dtype=np.int64)}
    for number, part in enumerate(pruning.domain.parts):
        axes = np.flatnonzero(((part.lower > 0) | (part.upper < 1)).any(axis=0))
        arrays[f"axes {number}"] = axes
        arrays[f"lower {number}"], arrays[f"upper {number}"] = part.lower[:, axes], part.upper[:, axes]
    return arrays


def _unpacked(arrays: Arrays, dimension: int, conditions: Sequence[Fact]) -> Pruning | None:
    """The result that `_packed` describes; ``None`` where other code made it, or it is none."""
    try:
        if not np.array_equal(arrays["made by"], _makers()):
            return None
        parts = [
            _part(arrays, number, dimension)
            for number in range(sum(name.startswith("axes ") for name in arrays))
        ]
        domain = Domain(parts[0].lower, parts[0].upper, tuple(parts[1:]))
        return Pruning(domain, tuple(conditions[number] for number in arrays["impossible"].tolist()))
    except (LookupError, TypeError, ValueError):
        # The file is whole, but not one that this version wrote.
        return None


def _part(arrays: Arrays, number: int, dimension: int) -> Domain:
    axes, some_lower, some_upper = (arrays[f"{name} {number}"] for name in ("axes", "lower", "upper"))
    lower, upper = np.zeros((len(some_lower), dimension)), np.ones((len(some_lower), dimension))
    lower[:, axes], upper[:, axes] = some_lower, some_upper
    return Domain(lower, upper)


def _makers() -> NDArray[np.uint8]:
    """The digest of the code and the versions that decide the result."""
    digest = hashlib.sha256(f"{sys.version} {sys.platform} {sys.byteorder} {np.__version__}".encode())
    here = Path(__file__).parent
    for file in sorted(file for folder in _FOLDERS for file in (here / folder).rglob("*.py")):
        digest.update(file.relative_to(here).as_posix().encode() + b"\0")
        digest.update(file.read_bytes())
    for library in _LIBRARIES:
        digest.update(library_version(library).encode())
    return np.frombuffer(digest.digest(), dtype=np.uint8)
