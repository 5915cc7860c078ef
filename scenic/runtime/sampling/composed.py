"""Draws of lanes that are put together from those of several attempts."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.graph.draws import Source, Words
from scenic.runtime.geometry.ragged import distinct

__all__ = ["Composed"]


class Composed:
    """The source whose draws come from one of several, by their addresses.

    Args:
        sources: of as many lanes each.
        owner: the number of the source of a draw, by address; others come from the first one.
        first: the number of the first source.

    """

    def __init__(self, sources: Sequence[Source], owner: Mapping[int, int], first: int = 0) -> None:
        self._sources = sources
        self._owner = owner
        self._first = first

    def __len__(self) -> int:
        return len(self._sources[0])

    def take(self, lanes: NDArray[np.intp]) -> "Composed":
        return Composed([source.take(lanes) for source in self._sources], self._owner, self._first)

    def uniforms(self, addresses: Words) -> NDArray[np.float64]:
        result = np.empty((len(addresses), len(self)))
        for number, rows in self._parts(addresses):
            result[rows] = self._sources[number].uniforms(addresses[rows])
        return result

    def uniform_each(self, addresses: Words) -> NDArray[np.float64]:
        result = np.empty(len(addresses))
        for number, lanes in self._parts(addresses):
            result[lanes] = self._sources[number].take(lanes).uniform_each(addresses[lanes])
        return result

    def words(self, addresses: Words) -> Words:
        result = np.empty((len(addresses), len(self)), dtype=np.uint64)
        for number, rows in self._parts(addresses):
            result[rows] = self._sources[number].words(addresses[rows])
        return result

    def _parts(self, addresses: Words) -> Iterator[tuple[int, NDArray[np.intp]]]:
        if len(self._sources) == 1:
            yield 0, np.arange(len(addresses))
            return
        first = self._first
        owners = np.array(
            [self._owner.get(place, first) - first for place in addresses.tolist()], dtype=np.intp
        )
        for number in distinct(owners).tolist():
            yield number, np.flatnonzero(owners == number)
