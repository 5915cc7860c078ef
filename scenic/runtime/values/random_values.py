"""The classes of random values, with the methods that programs use."""

from typing import Any

from scenic.graph.kinds import Kind
from scenic.runtime.values.access import attribute, called, element
from scenic.runtime.values.generic import sample_of, support_of
from scenic.runtime.values.methods import Arithmetic, OrientationMethods, VectorMethods
from scenic.runtime.values.random_base import RandomBase

__all__ = ["Random", "RandomOrientation", "RandomVector"]


class Random(Arithmetic, RandomBase, kinds=[None]):
    """A value that is drawn when a scene is sampled.

    Arithmetic, indexing, calling and attribute access give further random values. Anything that needs a definite
    answer now (a truth value, a comparison, iteration) raises `RandomControlFlowError`.
    """

    __slots__ = ()
    __hash__ = object.__hash__

    # Parts

    def __getitem__(self, index: object) -> Any:
        return element(self, index)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and name.endswith("__"):
            raise AttributeError(name)
        return attribute(self, name)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return called(self, args, kwargs)

    # What scripts ask of a law

    def sample(self, subsamples: object = None) -> Any:
        """One sample, drawn now from Python's generator, independent of all scenes."""
        return sample_of(self)

    def supportInterval(self) -> tuple[float | None, float | None]:
        """Return the least and the greatest value, as far as they are known."""
        return support_of(self)


class RandomVector(VectorMethods, Random, kinds=[Kind.VECTOR]):
    """A random vector."""

    __slots__ = ()
    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        raise self._definite("comparing")


class RandomOrientation(OrientationMethods, Random, kinds=[Kind.ORIENTATION]):
    """A random orientation."""

    __slots__ = ()
    __hash__ = object.__hash__
