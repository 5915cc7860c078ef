"""The protocol of samplers: ask for points, tell the values of their runs."""

from collections.abc import Mapping
from typing import Any, Protocol

from scenic.falsification.space import Floats
from scenic.language.errors import InvalidScenarioError, Located

__all__ = ["NoMorePointsError", "SamplerError", "SearchSampler", "options"]


class SamplerError(Located):
    """A sampler that cannot be had, or whose options make no sense."""

    code = "SC604"


class NoMorePointsError(InvalidScenarioError):
    """A sampler has no more points."""


class SearchSampler(Protocol):
    """Chooses the points of a search."""

    @property
    def batch(self) -> int | None:
        """Number of points that the sampler prefers to give at a time; ``None`` if that does not matter."""

    def ask(self, count: int) -> Floats:
        """The next points ``(count, d)``; raises `NoMorePointsError` if there are none."""

    def tell(self, points: Floats, values: Floats) -> None:
        """Take the values of points ``(n, d)``: ``(n,)``, smaller ones better, NaN where a point was rejected."""


def options(given: object, defaults: Mapping[str, object], name: str) -> dict[str, Any]:
    """Return the options of a sampler, from a mapping or from the attributes of an object.

    Raises `SamplerError` for an option that the sampler does not have.
    """
    if given is None:
        return dict(defaults)
    plain = (
        dict(given)
        if isinstance(given, Mapping)
        else {k: v for k, v in vars(given).items() if not k.startswith("_")}
    )
    unknown_keys = [key for key in plain if key not in defaults]
    if unknown_keys:
        raise SamplerError(
            f"the sampler {name!r} has no option {unknown_keys[0]!r}",
            help=f"its options: {', '.join(defaults)}" if defaults else "it has none",
        )
    return {**defaults, **plain}
