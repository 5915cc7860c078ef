"""The samplers of external parameters, as `Scenario.generate` calls them."""

import math
import random
import warnings
from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from scenic.falsification.samplers import RESTORABLE, SEQUENCES, make_sampler
from scenic.falsification.samplers.search_sampler import NoMorePointsError, SearchSampler
from scenic.falsification.space import Coordinate, Floats, Space, space_of
from scenic.language.errors import InvalidScenarioError, ScenicWarning
from scenic.runtime.python.random_state import preserved
from scenic.runtime.scenes.external_candidates import ExternalPoints

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["ExternalSampler", "VerifaiSampler", "external_points"]

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

    def __init__(self, params: Sequence[Coordinate], globalParams: Mapping[str, object]) -> None:
        self.params = tuple(params)
        self.globalParams = dict(globalParams)
        self.rejectionFeedback = self.globalParams.get(
            "externalSamplerRejectionFeedback", self.rejectionFeedback
        )
        self.cachedSample: Any = None

    def sample(self, feedback: object) -> None:
        """Take the next sample; ``feedback`` is about the one before."""
        self.cachedSample = self.nextSample(feedback)

    def nextSample(self, feedback: object) -> Any:
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

    def __init__(self, params: Sequence[Coordinate], globalParams: Mapping[str, object]) -> None:
        super().__init__(params, globalParams)
        seed = random.getrandbits(63)
        with preserved():  # libraries draw while they are imported
            self.sampler: SearchSampler = make_sampler(
                str(self.globalParams.get("verifaiSamplerType", "halton")),
                Space(self.params),
                seed,
                self.globalParams.get("verifaiSamplerParams"),
            )
        self._told = False
        self._warned = False

    def nextSample(self, feedback: object) -> Floats:
        """The next point ``(1, d)``."""
        with preserved():
            if self.cachedSample is not None:
                self.sampler.tell(self.cachedSample, np.array([self.value_of(feedback)]))
            found = self.sampler.ask(1)
        if not len(found):
            raise NoMorePointsError("the sampler has no more points")
        return found

    def value_of(self, feedback: Any) -> float:
        """Return feedback as the value of a point; NaN for none."""
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
        return _columns(Space(self.params), self.cachedSample)


class _OneByOne:
    """The points of a sampler of the program's own, or of a library, which is asked for one at a time."""

    answerless = False

    def __init__(self, sampler: ExternalSampler) -> None:
        self.sampler = sampler

    def ahead(self, feedback: object, count: int) -> dict[int, Floats]:
        """See `ExternalPoints.ahead`."""
        self.sampler.sample(feedback)
        return self.sampler.numbers()

    def use(self, count: int) -> None:
        """Nothing to do: the point is the sampler's present sample."""


class _Queue:
    """The points of a sampler that does not learn; those taken ahead and not used stay first."""

    answerless = True

    def __init__(self, sampler: VerifaiSampler) -> None:
        self.sampler = sampler
        self._space = Space(sampler.params)
        self._points = np.zeros((0, len(self._space)))

    def ahead(self, feedback: object, count: int) -> dict[int, Floats]:
        """See `ExternalPoints.ahead`."""
        self.sampler.value_of(feedback)
        missing = count - len(self._points)
        if missing > 0:
            try:
                self._points = np.concatenate([self._points, self.sampler.sampler.ask(missing)])
            except NoMorePointsError:
                if not len(self._points):
                    raise
        return _columns(self._space, self._points[:count])

    def use(self, count: int) -> None:
        """See `ExternalPoints.use`."""
        if count:
            self.sampler.cachedSample = self._points[count - 1 : count]
            self._points = self._points[count:]


class _Supposed:
    """The points of a sampler that learns, each supposing that those before it are rejected; where one was not, it is set back."""

    answerless = False

    def __init__(self, sampler: VerifaiSampler) -> None:
        self.sampler = sampler
        self._space = Space(sampler.params)
        self._before: SearchSampler = sampler.sampler
        self._points = np.zeros((0, len(self._space)))

    def ahead(self, feedback: object, count: int) -> dict[int, Floats]:
        """See `ExternalPoints.ahead`."""
        outer = self.sampler
        if outer.cachedSample is not None:
            outer.sampler.tell(outer.cachedSample, np.array([outer.value_of(feedback)]))
            outer.cachedSample = None
        self._before = deepcopy(outer.sampler)
        self._points = self._taken(count)
        return _columns(self._space, self._points)

    def use(self, count: int) -> None:
        """See `ExternalPoints.use`."""
        if count < len(self._points):
            self.sampler.sampler = self._before
            self._taken(count)
        if count:
            self.sampler.cachedSample = self._points[count - 1 : count]

    def _taken(self, count: int) -> Floats:
        sampler = self.sampler.sampler
        rejected = np.array([self.sampler.value_of(self.sampler.rejectionFeedback)])
        points: list[Floats] = []
        while len(points) < count:
            if points:
                sampler.tell(points[-1], rejected)
            points.append(sampler.ask(1))
        return np.concatenate(points) if points else np.zeros((0, len(self._space)))


def _columns(space: Space, points: Floats) -> dict[int, Floats]:
    """The numbers of points ``(n, d)``, by address."""
    numbers = space.numbers(points)
    return {item.address: numbers[:, place] for place, item in enumerate(space.coordinates)}


def external_points(scenario: "Scenario") -> ExternalPoints:
    """The points of the sampler that a program selects.

    Raises `InvalidScenarioError` if ``externalSampler`` is no class of samplers.
    """
    parameters = scenario.params
    sampler_class = parameters.get("externalSampler", VerifaiSampler)
    if not (isinstance(sampler_class, type) and issubclass(sampler_class, ExternalSampler)):
        raise InvalidScenarioError(
            f"the parameter `externalSampler` is {sampler_class!r}, which is no class of samplers",
            help="derive a class from `scenic.core.external_params.ExternalSampler`",
        )
    sampler = sampler_class(space_of(scenario, "external").coordinates, parameters)
    if type(sampler) is VerifaiSampler:
        if isinstance(sampler.sampler, SEQUENCES):
            return _Queue(sampler)
        if isinstance(sampler.sampler, RESTORABLE):
            return _Supposed(sampler)
    return _OneByOne(sampler)
