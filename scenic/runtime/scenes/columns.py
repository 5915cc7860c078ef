"""Scenes in columns: one value of many scenes at a time, as arrays where the graph has arrays."""

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.graph.kinds import Kind
from scenic.runtime.instances.objects import Object
from scenic.runtime.python.samples import dependencies
from scenic.runtime.sampling.engine import FinishedLanes
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Origin, Scene
from scenic.runtime.values.choices import options_of
from scenic.runtime.values.random_values import Random

__all__ = ["PLACES", "ObjectColumns", "SceneColumns", "ValueColumn"]

PLACES = frozenset({"position", "orientation", "heading", "width", "length", "height", "shape"})
"""Properties of an object's position, orientation and shape."""


@dataclass(frozen=True, slots=True)
class ValueColumn:
    """One value of the program in many scenes.

    Args:
        value: the value as the program has it, definite or random.
        read: reads it from a scene, where no array has it.

    """

    value: Any
    read: Callable[[Scene], Any]

    @property
    def is_fixed(self) -> bool:
        """Return whether the value is the same in all scenes."""
        return not dependencies([self.value])

    @property
    def kind(self) -> Kind | None:
        """The kind of its array; ``None`` where values are Python objects."""
        if isinstance(self.value, Random) and not self.value.node.kind.is_boxed:
            return self.value.node.kind
        return None

    @property
    def options(self) -> tuple[Any, ...]:
        """The options of a random choice among constants; empty for other values."""
        options = options_of(self.value)
        return () if dependencies(options) else options

    def array(self, scenes: Sequence[Scene]) -> NDArray[Any]:
        """Return the values in scenes, ``(n,)``, ``(n, 3)`` or ``(n, 4)`` by kind; only where there is a `kind`."""
        node = self.value.node
        parts = []
        for found, lanes in _lanes(scenes):
            column = found.batch.column(node)
            parts.append(column[lanes] if len(column) > 1 else np.repeat(column, len(lanes), axis=0))
        return np.concatenate(parts) if parts else np.empty((0, *node.kind.trailing))

    def values(self, scenes: Sequence[Scene]) -> list[Any]:
        """Return the values in scenes, as Python objects."""
        if self.is_fixed:
            return [self.value] * len(scenes)
        return [self.read(scene) for scene in scenes]


@dataclass(frozen=True, slots=True)
class ObjectColumns:
    """An object of the program in many scenes: its class, its variable, and its properties by name.

    ``given`` are the names of the properties that the program gives, without those of `PLACES`, sorted; ``present`` tells in which
    scenes it takes part.
    """

    cls: str
    name: str | None
    given: tuple[str, ...]
    properties: dict[str, ValueColumn]
    present: ValueColumn


class SceneColumns:
    """The objects and parameters of a scenario's scenes, value by value."""

    def __init__(self, scenario: Scenario) -> None:
        self.params = {
            str(name): ValueColumn(value, _Parameter(name)) for name, value in scenario.params.items()
        }
        self.objects = tuple(
            _columns_of(thing, index, scenario.variable(thing))
            for index, thing in enumerate(scenario.objects)
        )


def _columns_of(thing: Object, index: int, name: str | None) -> ObjectColumns:
    origin = Origin.of(thing)
    properties = {key: ValueColumn(thing.__dict__.get(key), _Property(index, key)) for key in origin.names}
    given = tuple(key for key in origin.given if key not in PLACES)
    present = ValueColumn(thing.present, _Property(index, "present"))
    return ObjectColumns(type(thing).__name__, name, given, properties, present)


@dataclass(frozen=True, slots=True)
class _Parameter:
    name: str

    def __call__(self, scene: Scene) -> Any:
        return scene.params[self.name]


@dataclass(frozen=True, slots=True)
class _Property:
    index: int
    name: str

    def __call__(self, scene: Scene) -> Any:
        return getattr(scene.cast[self.index], self.name)


def _lanes(scenes: Sequence[Scene]) -> Iterator[tuple[FinishedLanes, list[int]]]:
    """Yield consecutive scenes of one batch, and their lanes in it."""
    for _, group in groupby(scenes, key=lambda scene: id(scene.found)):
        some = list(group)
        yield some[0].found, [scene.lane for scene in some]
