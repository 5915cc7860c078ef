"""Draws of lanes that are put together from those of several attempts."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from scenic.graph.draws import Counter, NumberSource, Words, mix, open_unit
from scenic.runtime.geometry.ragged import distinct

__all__ = ["Composed"]


class Composed:
    """The source whose draws come from one of several, by their addresses.

    Args:
        sources: of as many lanes each.
        owner: the number of the source of a draw, by address; others come from the first one.
        first: the number of the first source.

    """

    def __init__(self, sources: Sequence[NumberSource], owner: Mapping[int, int], first: int = 0) -> None:
        self._sources = sources
        self._owner = owner
        self._first = first
        self._stacked: Words | None = None

    def __len__(self) -> int:
        return len(self._sources[0])

    def take(self, lanes: NDArray[np.intp]) -> "Composed":
        return Composed([source.take(lanes) for source in self._sources], self._owner, self._first)

    def _keys(self, addresses: Words) -> Words | None:
        """Return the keys of addresses in all lanes where all sources hash, ``(addresses, lanes)``."""
        if len(self._sources) == 1 or not all(type(source) is Counter for source in self._sources):
            return None
        if self._stacked is None:
            self._stacked = np.stack([source.keys for source in self._sources if isinstance(source, Counter)])
        return np.asarray(self._stacked[self._owners(addresses)])

    def _owners(self, addresses: Words) -> NDArray[np.intp]:
        owner, first = self._owner, self._first
        found = np.array([owner.get(place, first) - first for place in addresses.tolist()], dtype=np.intp)
        # Draws of other parts are asked for together with these, and not read.
        return np.where((found >= 0) & (found < len(self._sources)), found, 0)

    def uniforms(self, addresses: Words) -> NDArray[np.float64]:
        keys = self._keys(addresses)
        if keys is not None:
            with np.errstate(over="ignore"):
                return open_unit(mix(keys + addresses[:, np.newaxis]))
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
        owners = self._owners(addresses)
        for number in distinct(owners).tolist():
            yield number, np.flatnonzero(owners == number)
