"""Random numbers of a scenario: every draw has an address, and a source gives the number at each address.

An axis of the unit cube is named by its *address*, a 64-bit word made of the place in the program that draws and of how
often that place has drawn before (`address`). A `NumberSource` says which number each address has in each lane. The usual one
hashes: the number is a function of a lane's key and of the address alone, and the key is one of (seed, scene, attempt).
So no draw depends on which others there are, in which order they are asked for, in which batch, or by which worker.
"""

import hashlib
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Final, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass

Words = NDArray[np.uint64]
Floats = NDArray[np.float64]

_GOLDEN: Final = np.uint64(0x9E3779B97F4A7C15)
_FIRST: Final = np.uint64(0xBF58476D1CE4E5B9)
_SECOND: Final = np.uint64(0x94D049BB133111EB)
_SHIFTS: Final = (np.uint64(30), np.uint64(27), np.uint64(31))
_UNUSED_BITS: Final = np.uint64(12)


def mix(words: Words) -> Words:
    """Scramble 64-bit words by the finaliser of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014)."""
    with np.errstate(over="ignore"):
        result = words + _GOLDEN
        result ^= result >> _SHIFTS[0]
        result *= _FIRST
        result ^= result >> _SHIFTS[1]
        result *= _SECOND
        result ^= result >> _SHIFTS[2]
    return result


def address(*parts: object) -> int:
    """The 64-bit address of a draw from what names it: a place in the program, an occurrence, an agent."""
    digest = hashlib.blake2b(repr(parts).encode("utf-8", "backslashreplace"), digest_size=8).digest()
    return int.from_bytes(digest, "little")


BOX: Final = address("box of the domain")
"""Address of the draw that chooses a box where a domain has several."""


def box_addresses(parts: int) -> Words:
    """Return the addresses of which box is drawn from in each of the factors of a domain."""
    others = [address("box of the domain", number) for number in range(1, parts)]
    return np.array([BOX, *others], dtype=np.uint64)


def seed_word(seed: int) -> np.uint64:
    """Return the 64-bit word that stands for a seed, which may be any integer: ``address("seed", seed)``."""
    word: np.uint64 = seed_words([seed])[0]
    return word


def seed_words(seeds: Iterable[int]) -> Words:
    """The words ``(n,)`` of seeds, as `seed_word` gives them."""
    digests = [hashlib.blake2b(b"('seed', %d)" % seed, digest_size=8).digest() for seed in seeds]
    return np.frombuffer(b"".join(digests), dtype="<u8").astype(np.uint64)


def scene_keys(seeds: Words, scenes: NDArray[np.int64]) -> Words:
    """Return the keys ``(n,)`` of scenes: scene ``scenes[i]`` of the seed with the word ``seeds[i]``."""
    return mix(mix(seeds) + scenes.astype(np.uint64))


def attempt_keys(scene_keys: Words, attempts: NDArray[np.int64]) -> Words:
    """The keys ``(n,)`` of attempts at scenes."""
    return mix(scene_keys ^ mix(attempts.astype(np.uint64)))


def words_of(keys: Words, addresses: Words) -> Words:
    """Return the random word of each address in each lane, ``(addresses, lanes)``."""
    with np.errstate(over="ignore"):
        return mix(keys + addresses[:, np.newaxis])


def open_unit(words: Words) -> Floats:
    """Return the numbers of the open interval (0, 1) that words stand for.

    52 bits and a half: never 0 or 1, which have no image under an unbounded law (53 bits and a half round to 1).
    """
    bits: Floats = (words >> _UNUSED_BITS).astype(np.float64)
    bits += 0.5
    bits *= 2.0**-52
    return bits


class NumberSource(Protocol):
    """The random numbers of a number of lanes, by address."""

    def __len__(self) -> int:
        """The number of lanes."""

    def take(self, lanes: NDArray[np.intp]) -> "NumberSource":
        """Return the source of some of the lanes."""

    def uniforms(self, addresses: Words) -> Floats:
        """Numbers of the open unit interval, ``(addresses, lanes)``."""

    def uniform_each(self, addresses: Words) -> Floats:
        """Numbers ``(n,)`` of one address in each lane, those of `uniforms`."""

    def words(self, addresses: Words) -> Words:
        """Return words ``(addresses, lanes)`` that key further draws: of nodes that retry, and of opaque calls."""


@dataclass(frozen=True, slots=True)
class LaneOwners:
    """The owners of the numbers of some lanes: attempts ``(n,)`` at scenes ``(n,)`` of seeds ``(n,)``.

    ``seeds`` are words (`seed_word`), ``keys`` (`attempt_keys`) what the hash gives for all three.
    """

    seeds: Words
    scenes: NDArray[np.int64]
    attempts: NDArray[np.int64]
    keys: Words

    @classmethod
    def of(cls, seed: int, scene: int, attempt: int) -> Self:
        """Return one lane."""
        seeds, scenes = np.array([seed_word(seed)]), np.array([scene], dtype=np.int64)
        attempts = np.array([attempt], dtype=np.int64)
        return cls(seeds, scenes, attempts, attempt_keys(scene_keys(seeds, scenes), attempts))

    def take(self, lanes: NDArray[np.intp]) -> "LaneOwners":
        """Return some of the lanes."""
        return LaneOwners(self.seeds[lanes], self.scenes[lanes], self.attempts[lanes], self.keys[lanes])


class Counter:
    """The source that hashes: lane ``i`` has the key ``keys[i]``."""

    __slots__ = ("keys",)

    def __init__(self, keys: Words) -> None:
        self.keys = keys

    def __len__(self) -> int:
        return len(self.keys)

    def take(self, lanes: NDArray[np.intp]) -> "Counter":
        return Counter(self.keys[lanes])

    def uniforms(self, addresses: Words) -> Floats:
        return open_unit(words_of(self.keys, addresses))

    def uniform_each(self, addresses: Words) -> Floats:
        with np.errstate(over="ignore"):
            return open_unit(mix(self.keys + addresses))

    def words(self, addresses: Words) -> Words:
        return words_of(self.keys, addresses)


class Points:
    """The source of given points of the cube: the numbers of some addresses, the rest from another source.

    Args:
        values: numbers ``(n,)`` of the open unit interval by address.
        rest: where the numbers and words of all other addresses come from.
        words: words ``(n,)`` by address.

    """

    def __init__(
        self,
        values: Mapping[int, Floats],
        rest: NumberSource,
        words: Mapping[int, Words] = MappingProxyType({}),
    ) -> None:
        self._values = values
        self._rest = rest
        self._words = words

    def __len__(self) -> int:
        return len(self._rest)

    def take(self, lanes: NDArray[np.intp]) -> "Points":
        return Points(
            {name: column[lanes] for name, column in self._values.items()},
            self._rest.take(lanes),
            {name: column[lanes] for name, column in self._words.items()},
        )

    def uniforms(self, addresses: Words) -> Floats:
        result = self._rest.uniforms(addresses)
        for row, name in enumerate(addresses.tolist()):
            if name in self._values:
                result[row] = self._values[name]
        return result

    def uniform_each(self, addresses: Words) -> Floats:
        return each_of_distinct(self, addresses)

    def words(self, addresses: Words) -> Words:
        result = self._rest.words(addresses)
        for row, name in enumerate(addresses.tolist()):
            if name in self._words:
                result[row] = self._words[name]
        return result


def each_of_distinct(source: NumberSource, addresses: Words) -> Floats:
    """The numbers of `NumberSource.uniform_each`, by way of all lanes' numbers of all those addresses."""
    distinct, which = np.unique(addresses, return_inverse=True)
    numbers: Floats = source.uniforms(distinct)[which, np.arange(len(addresses))]
    return numbers
