"""The samplers by name."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.falsification.samplers.annealing import Annealing
from scenic.falsification.samplers.bayesian import Bayesian
from scenic.falsification.samplers.buckets import Bandit, CrossEntropy, EpsilonGreedy
from scenic.falsification.samplers.evolution import Evolution
from scenic.falsification.samplers.parzen import Parzen
from scenic.falsification.samplers.search_sampler import SamplerError, SearchSampler
from scenic.falsification.samplers.space_filling import Grid, Halton, RandomSampler, SobolSampler
from scenic.falsification.space import Space
from scenic.language.spelling import nearest_option

__all__ = ["RESTORABLE", "SAMPLERS", "SEQUENCES", "make_sampler"]

SAMPLERS: Final[Mapping[str, Callable[[Space, int, Any], SearchSampler]]] = MappingProxyType(
    {
        "random": RandomSampler,
        "halton": Halton,
        "sobol": SobolSampler,
        "grid": Grid,
        "ce": CrossEntropy,
        "mab": Bandit,
        "eg": EpsilonGreedy,
        "sa": Annealing,
        "bo": Bayesian,
        "cma": Evolution,
        "tpe": Parzen,
    }
)
"""Functions that make samplers from a space, a seed and options."""

SEQUENCES: Final = (RandomSampler, Halton, SobolSampler, Grid)
"""Samplers that do not learn."""

RESTORABLE: Final = (CrossEntropy, Bandit, EpsilonGreedy, Annealing)
"""Samplers that learn, and can be set back: a copy goes on as they do."""


def make_sampler(name: str, space: Space, seed: int, given: object = None) -> SearchSampler:
    """The sampler of a name; raises `SamplerError` if there is none, or its library is missing."""
    if name not in SAMPLERS:
        near = nearest_option(name, SAMPLERS)
        raise SamplerError(
            f"there is no sampler {name!r}",
            help=(f"did you mean `{near}`? " if near else "") + f"the samplers: {', '.join(SAMPLERS)}",
        )
    return SAMPLERS[name](space, seed, given)
