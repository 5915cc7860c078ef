"""Mutators, which add noise to mutated instances (section 10.5 of the specification)."""

from collections.abc import Iterable, Mapping
from typing import Any

from scenic.language.errors import ScenicTypeError
from scenic.runtime.ground.context import here
from scenic.runtime.instances.properties import update
from scenic.runtime.values.describing import describe
from scenic.runtime.values.distributions import Normal
from scenic.runtime.values.values import Vector, is_number, operate, to_scalar, to_vector, vector


class Mutator:
    """Adds noise to instances. Derive from it, and give the instances of a class one by ``mutator[additive]: ...``."""

    def appliedTo(self, instance: object) -> tuple[Any, bool]:
        """The instance with noise, and whether the mutators of the class's bases shall follow.

        ``instance`` is that of one sample; it may be changed in place.
        """
        raise NotImplementedError(f"{type(self).__name__} does not say what it does (`appliedTo`)")


def applied(mutator: Any, instance: object) -> tuple[Any, bool]:
    """The result of a mutator for an instance; raises `ScenicTypeError` where it gives something else."""
    result = mutator.appliedTo(instance)
    if isinstance(result, tuple) and len(result) == 2:
        return result
    raise ScenicTypeError(
        f"`{type(mutator).__name__}.appliedTo` gives an instance and whether other mutators follow, not {describe(result)}",
        span=here(),
        help="end it with `return instance, True`, if those of the bases shall follow",
    )


class _NormalNoise(Mutator):
    """Normal noise on three numbers of an instance; equal deviations make equal mutators."""

    def __init__(self, stddevs: object) -> None:
        self.stddevs = to_vector(stddevs, f"`{type(self).__name__}`")

    def appliedTo(self, instance: object) -> tuple[Any, bool]:
        return _sampled_noise(self, instance)

    def random_parts(self) -> list[Any]:
        """Return the deviations, for sampling."""
        return [self.stddevs]

    def sampled(self, sample: Any) -> "_NormalNoise":
        """Return the mutator with sampled deviations."""
        return type(self)(sample.value(self.stddevs))

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.stddevs == getattr(other, "stddevs", None)

    def __hash__(self) -> int:
        return hash((type(self), self.stddevs))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.stddevs!r})"


class PositionMutator(_NormalNoise):
    """Normal noise on the position; ``stddevs`` per axis, in metres, for a scale of 1."""

    def noisy(self, instance: Any, scale: object) -> Mapping[str, Any]:
        """Return the properties that change."""
        return {"position": operate("add", instance.position, vector(*_noise(self.stddevs, scale)))}


class OrientationMutator(_NormalNoise):
    """Normal noise on yaw, pitch and roll; ``stddevs`` of each, in radians, for a scale of 1."""

    def noisy(self, instance: object, scale: object) -> Mapping[str, Any]:
        """Return the properties that change."""
        noise = _noise(self.stddevs, scale)
        names = ("yaw", "pitch", "roll")
        return {
            name: operate("add", to_scalar(getattr(instance, name)), part)
            for name, part in zip(names, noise, strict=True)
        }


BUILT_IN = (PositionMutator, OrientationMutator)
"""Mutators whose noise is part of the value graph."""
KEPT = frozenset({"shape", "behavior", "sensors", "mutator", "regionContainedIn", "lastActions", "present"})
"""Properties that mutation leaves alone: the graph needs to know them."""


def active(instance: object) -> list[Any]:
    """The mutators of an instance, in order."""
    given = instance.__dict__.get("mutator")  # what a side of an object is made of has none
    return [item for item in (given if isinstance(given, tuple | list) else (given,)) if item is not None]


def is_built_in(mutators: Iterable[object]) -> bool:
    """Return whether all mutators are those of the language."""
    return all(type(mutator) in BUILT_IN for mutator in mutators)


def _noise(deviations: Any, scale: object) -> list[Any]:
    """Return normal noise for each of three axes; none is drawn where there is certainly none."""
    noise = []
    for deviation in deviations:
        spread = operate("multiply", deviation, to_scalar(scale))
        noise.append(0.0 if is_number(spread) and spread == 0 else Normal(0, spread))
    return noise


def _sampled_noise(mutator: Any, instance: Any) -> tuple[Any, bool]:
    """A built-in mutator at work among those of the program, on a sample: with Python's generator."""
    import random

    deviations = [random.gauss(0, abs(part * instance.mutationScale)) for part in mutator.stddevs]
    if isinstance(mutator, PositionMutator):
        changes: dict[str, Any] = {"position": instance.position + Vector(*deviations)}
    else:
        names = ("yaw", "pitch", "roll")
        changes = {
            name: getattr(instance, name) + noise for name, noise in zip(names, deviations, strict=True)
        }
    update(instance, changes)
    return instance, True


__all__ = [
    "BUILT_IN",
    "KEPT",
    "Mutator",
    "OrientationMutator",
    "PositionMutator",
    "active",
    "applied",
    "is_built_in",
]
