"""The samplers of external parameters, as `Scenario.generate` calls them."""

import math
import random
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from scenic.falsification.samplers import make_sampler
from scenic.falsification.samplers.protocol import Exhausted, Sampler
from scenic.falsification.space import Coordinate, Floats, Space, space_of
from scenic.language.errors import InvalidScenarioError, ScenicWarning

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["ExternalSampler", "VerifaiSampler", "external_sampler"]

_REJECTED: Final = 1.0
"""Feedback on a rejected candidate."""


class ExternalSampler:
    """Gives the values of external parameters. Users derive their own from it, and name it as ``param externalSampler``.

    Args:
        params: the parameters, `Coordinate`, in the order in which the program makes them.
        globalParams: the global parameters of the program.

    """

    rejectionFeedback: Any = None
    """The feedback after a candidate that was rejected."""

    def __init__(self, params: Sequence[Coordinate], globalParams: Mapping[str, Any]) -> None:
        self.params = tuple(params)
        self.globalParams = dict(globalParams)
        self.rejectionFeedback = self.globalParams.get(
            "externalSamplerRejectionFeedback", self.rejectionFeedback
        )
        self.cachedSample: Any = None

    def sample(self, feedback: Any) -> None:
        """Take the next sample; ``feedback`` is about the one before."""
        self.cachedSample = self.nextSample(feedback)

    def nextSample(self, feedback: Any) -> Any:
        """The next sample, in whatever form `valueFor` reads."""
        raise NotImplementedError("a class derived from `ExternalSampler` defines `nextSample`")

    def valueFor(self, param: Coordinate) -> Any:
        """The value of a parameter in the present sample; of options the place of one."""
        raise NotImplementedError("a class derived from `ExternalSampler` defines `valueFor`")

    def numbers(self) -> dict[int, Floats]:
        """The numbers of the parameters' draws ``(1,)``, by address."""
        return {item.address: item.number(np.array([self._place(item)])) for item in self.params}

    def _place(self, item: Coordinate) -> float:
        value = self.valueFor(item)
        try:
            return item.coordinate(float(value))
        except (TypeError, ValueError):
            raise InvalidScenarioError(
                f"the external sampler gives {value!r} for `{item.label}`",
                help=f"its values lie between {item.low:g} and {item.high:g}, and have no weight of zero",
            ) from None


class VerifaiSampler(ExternalSampler):
    """The sampler that the parameters ``verifaiSamplerType`` and ``verifaiSamplerParams`` of a program name."""

    rejectionFeedback = _REJECTED

    def __init__(self, params: Sequence[Coordinate], globalParams: Mapping[str, Any]) -> None:
        super().__init__(params, globalParams)
        self.sampler: Sampler = make_sampler(
            str(self.globalParams.get("verifaiSamplerType", "halton")),
            Space(self.params),
            random.getrandbits(63),
            self.globalParams.get("verifaiSamplerParams"),
        )
        self._told = False
        self._warned = False

    def nextSample(self, feedback: Any) -> Floats:
        """The next point ``(1, d)``."""
        if self.cachedSample is not None:
            self.sampler.tell(self.cachedSample, np.array([self._value(feedback)]))
        found = self.sampler.ask(1)
        if not len(found):
            raise Exhausted("the sampler has no more points")
        return found

    def _value(self, feedback: Any) -> float:
        if feedback is None:
            return math.nan
        try:
            value = float(feedback)
        except (TypeError, ValueError):
            value = math.nan
        if not math.isfinite(value):
            if not self._warned:
                self._warned = True
                warnings.warn(
                    ScenicWarning(
                        f"the feedback {feedback!r} is no finite number, and counts as a rejection",
                        code="SC407",
                        help="give the robustness of the scene, smaller being better",
                    ),
                    stacklevel=2,
                )
            value = float(self.rejectionFeedback if self.rejectionFeedback is not None else _REJECTED)
        return value

    def valueFor(self, param: Coordinate) -> float:
        """The value of a parameter in the present sample."""
        place = next(k for k, item in enumerate(self.params) if item.address == param.address)
        return param.value(float(self.cachedSample[0, place]))

    def numbers(self) -> dict[int, Floats]:
        """The numbers of the parameters' draws ``(1,)``, by address."""
        found = Space(self.params).numbers(self.cachedSample)
        return {item.address: found[:, place] for place, item in enumerate(self.params)}


def external_sampler(scenario: "Scenario") -> ExternalSampler:
    """The sampler that a program selects.

    Raises `InvalidScenarioError` if ``externalSampler`` is no class of samplers.
    """
    parameters = scenario.params
    wanted = parameters.get("externalSampler", VerifaiSampler)
    if not (isinstance(wanted, type) and issubclass(wanted, ExternalSampler)):
        raise InvalidScenarioError(
            f"the parameter `externalSampler` is {wanted!r}, which is no class of samplers",
            help="derive a class from `scenic.core.external_params.ExternalSampler`",
        )
    return wanted(space_of(scenario, "external").coordinates, parameters)
