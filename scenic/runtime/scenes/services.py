"""Services of a scenario that layers above the runtime compute, handed to it when it is made."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from scenic.dataclass import dataclass
from scenic.runtime.scenes.external_candidates import ExternalPoints
from scenic.runtime.scenes.scene import Scene

__all__ = ["Services"]


@dataclass(frozen=True, slots=True)
class Services:
    """Services of a scenario that are computed above the runtime."""

    view: Callable[[Scene], Any] | None = None
    """Shows a scene (`Scene.show`)."""
    bundle: Callable[[Scene], Mapping[str, str]] | None = None
    """A scene by type of media, for notebooks."""
    export: Callable[[Scene, Path], bool] | None = None
    """Writes a scene as a world of Webots (`Scene.save` with the ending ``.wbt``)."""
    recipe: tuple[Any, ...] | None = None
    """Compiles the program once more, as ``__reduce__`` returns it."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """The keyword arguments of `scenic.load` with which the program was compiled."""
    sample: Callable[..., Iterator[Scene]] | None = None
    """Samples in several processes: ``(scenario, n, processes=, **limits)``."""
    simulate: Callable[..., Any] | None = None
    """Simulates scenes: ``(scenario, n, **options)``."""
    external_points: Callable[[Any], ExternalPoints] | None = None
    """The points of the program's external parameters, by the sampler that it names."""
    given: Callable[[Mapping[str, Any]], Any] | None = None
    """Compiles the program once more with values of global parameters."""
    settled: Callable[[tuple[float, float, bool]], Any] | None = None
    """Compiles the program once more, to simulate scenes: seconds, tolerance (metres), whether settled poses are kept."""
