"""The objects of scenes, made for many scenes of a batch at a time.

Nearly every script that looks at a scene looks at its neighbours too. One after the other, their objects cost ten times
as much to make, and then again as much to Python's search for garbage, which starts anew after every few hundred.
"""

from collections.abc import Iterable, Sequence
from itertools import repeat
from typing import Any, Final

from scenic.graph.batch import Batch
from scenic.language.garbage import no_garbage_collection
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.python.samples import Globals, Sample, reachable
from scenic.runtime.regions.presence import is_always_present
from scenic.runtime.sampling.engine import FinishedLanes
from scenic.runtime.values.instance_base import put
from scenic.runtime.values.values import as_node

_TOGETHER: Final = 4096
"""Objects made at a time, about: some milliseconds, should nobody look at the other scenes. With 512 reading takes a seventh longer."""

Inhabitants = tuple[Sample, tuple[Any, ...]]
"""The objects of a scene, and the sample that knows what else there is in it."""


class Populations:
    """Makes the objects of the scenes of a program.

    Args:
        objects: those of the program, in the order in which scenes have them.
        others: what else scenes hand out: parameters, regions.
        names: the global names that functions of the program read.

    """

    def __init__(self, objects: Sequence[Object], others: Iterable[object], names: Globals) -> None:
        self.objects = tuple(objects)
        self.names = names
        self.optional = tuple(
            (place, as_node(item.present))
            for place, item in enumerate(self.objects)
            if not is_always_present(item)
        )
        """Of the objects that may take no part in a scene their places, and whether they do."""
        self._others = tuple(others)
        self._linked: bool | None = None

    def missing(self, found: FinishedLanes, lane: int) -> frozenset[int]:
        """The places of objects that take no part in a scene."""
        return frozenset(place for place, node in self.optional if not found.batch.value(node, lane))

    def of(self, found: FinishedLanes) -> "Population":
        """Return the objects of the scenes that a round has found."""
        population: Population | None = found.shared.get(self)
        if population is None:
            population = found.shared[self] = Population(self, found.batch)
        return population

    @property
    def linked(self) -> bool:
        """Return whether something in a scene leads to an object of it, so that samples have to know the objects.

        Otherwise they do not, and scenes are freed as soon as nobody holds them: there are no circles.
        """
        if self._linked is None:
            values = [value for item in self.objects for value in item.__dict__.values()]
            values += [member for item in self.objects for member in self.names.members(type(item))]
            self._linked = any(
                isinstance(value, Point) for value in reachable([*values, *self._others], self.names)
            )
        return self._linked


class Population:
    """The objects of the scenes of one batch."""

    __slots__ = ("_batch", "_kept", "_makers", "_started")

    def __init__(self, makers: Populations, batch: Batch) -> None:
        self._makers = makers
        self._batch = batch
        self._kept: dict[int, Inhabitants] = {}
        """Instances that were made together with those of another scene, and have not been read yet."""
        self._started: set[int] = set()

    def take(self, lane: int) -> Inhabitants:
        """Return new objects for the scene in a lane."""
        inhabitants = self._kept.pop(lane, None)
        if inhabitants is not None:
            return inhabitants
        makers, batch = self._makers, self._batch
        if makers.linked:
            sample = Sample(batch, lane, makers.names, whole=True)
            return sample, tuple([sample.value(item) for item in makers.objects])
        size = max(1, _TOGETHER // max(1, len(makers.objects)))
        part = lane // size
        if part in self._started:  # a second set of objects for one scene
            return self._made(range(lane, lane + 1))[lane]
        self._started.add(part)
        self._kept |= self._made(range(part * size, min((part + 1) * size, len(batch))))
        return self._kept.pop(lane)

    def _made(self, lanes: range) -> dict[int, Inhabitants]:
        """Return the objects of the scenes in neighbouring lanes."""
        makers, batch = self._makers, self._batch
        with no_garbage_collection():
            samples = [Sample(batch, lane, makers.names, whole=True) for lane in lanes]
            columns = [self._copies(item, lanes, samples) for item in makers.objects]
            objects = zip(*columns, strict=True) if columns else repeat((), len(lanes))
            return dict(zip(lanes, zip(samples, objects, strict=True), strict=True))

    def _copies(self, item: Object, lanes: range, samples: Sequence[Sample]) -> list[Any]:
        """Return an object of the program as it is in neighbouring scenes."""
        cls = type(item)
        copies: list[Any] = [object.__new__(cls) for _ in lanes]
        attributes, nodes = self._makers.names.placement(item)
        if not nodes:
            for copy, sample in zip(copies, samples, strict=True):
                copy.__dict__.update(attributes, _source=item, _sample=sample)
            return copies
        columns = [
            column[lanes.start : lanes.stop] if len(column) > 1 else repeat(column[0], len(lanes))
            for column in self._batch.lists(nodes)
        ]
        for copy, sample, row in zip(copies, samples, zip(*columns, strict=True), strict=True):
            copy._source = item
            copy._sample = sample
            put(copy, row)
        return copies


__all__ = ["Inhabitants", "Population", "Populations"]
