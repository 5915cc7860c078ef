"""Scenes whose draws a sampler chooses, without a search's rows and files."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from scenic.falsification.objectives import Objective
from scenic.falsification.samplers import make_sampler
from scenic.falsification.samplers.search_sampler import NoMorePointsError as NoMorePoints
from scenic.falsification.space import decides, space_of
from scenic.language.errors import InvalidScenarioError
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scene import Scene

if TYPE_CHECKING:
    from scenic.runtime.scenes.scenario import Scenario

__all__ = ["sampled_by"]

_TOGETHER: Final = 64
"""Number of points requested at a time, if the sampler has no preference."""
_ATTEMPTS: Final = 1000


def sampled_by(
    scenario: "Scenario", name: str, count: int, *, seed: int, objective: Objective | None = None
) -> Iterator[Scene | Exhausted]:
    """Scenes of the points that a sampler chooses: of the external parameters, if there are any, else of all draws.

    Scenes that break a requirement are reported as `Exhausted`; draws that are not chosen are tried again up to a thousand times.

    Args:
        scenario: the scenario.
        name: the name of the sampler.
        count: how many scenes, or fewer where the sampler has no more points.
        seed: of the sampler and of all other draws.
        objective: the number that samplers which learn make small; without it they are told only which points were rejected.

    """
    space = space_of(scenario, "external" if scenario.externals else "scene")
    if not len(space):
        raise InvalidScenarioError(
            "there is nothing that a sampler could choose: nothing in the program is random",
            help="draw something by `Range`, or `VerifaiRange`",
        )
    sampler = make_sampler(name, space, seed)
    attempts = 1 if decides(space, scenario) else _ATTEMPTS
    scene_count = 0
    while scene_count < count:
        try:
            points = sampler.ask(sampler.batch or _TOGETHER)[: count - scene_count]
        except NoMorePoints:
            return
        numbers = space.numbers(points)
        columns = {item.address: numbers[:, place] for place, item in enumerate(space.coordinates)}
        values = np.full(len(points), np.nan)
        results = scenario.chosen(columns, len(points), seed=seed, first=scene_count, max_attempts=attempts)
        for place, result in enumerate(results):
            if not isinstance(result, Exhausted):
                values[place] = 0.0 if objective is None else objective.of_scene(result)
            yield result
        sampler.tell(points, values)
        scene_count += len(points)
