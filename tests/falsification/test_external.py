"""External parameters: their law where nothing searches, and what samplers make of them."""

import random
from collections import Counter
from typing import Any

import numpy as np
import pytest
from scenic.core.external_params import ExternalSampler, VerifaiSampler
from scipy.stats import qmc

import scenic
from scenic.language.errors import InvalidScenarioError, Located, RejectionException, ScenicWarning
from scenic.simulators.dummy import DummySimulator

EVERY_KIND = """
param timeBound = 3
x = VerifaiRange(2, 5)
y = VerifaiRange(0, 1, weights=[1, 0, 3])
d = VerifaiDiscreteRange(1, 4, weights=[1, 1, 0, 2])
o = VerifaiOptions({'a': 1, 'b': 2, Range(5, 6): 1})
p = VerifaiParameter.withPrior(Normal(0, 1))
q = VerifaiParameter.withPrior(Discrete({1: 2, 3: 1}))
t = TimeSeries(VerifaiRange(0, 1))
param x = x, y = y, d = d, o = o, p = p, q = q, t = t
ego = new Object at x @ y
"""


def test_scenes_of_a_seed_have_the_priors() -> None:
    scenes = scenic.scenarioFromString(EVERY_KIND).sample(3000, seed=1)
    values = {name: [scene.params[name] for scene in scenes] for name in "xydopqt"}
    assert 2 < min(values["x"]) < max(values["x"]) < 5
    buckets = np.histogram(values["y"], 3, (0, 1))[0] / 3000
    assert np.allclose(buckets, [0.25, 0, 0.75], atol=0.03)
    counts = Counter(values["d"])
    assert np.allclose([counts[k] / 3000 for k in (1, 2, 3, 4)], [0.25, 0.25, 0, 0.5], atol=0.03)
    assert abs(sum(value == "b" for value in values["o"]) / 3000 - 0.5) < 0.03
    assert abs(np.mean(values["p"])) < 0.08
    assert abs(np.std(values["p"]) - 1) < 0.04
    assert abs(values["q"].count(1) / 3000 - 2 / 3) < 0.03
    assert all(len(set(series.values)) == 3 for series in values["t"][:10])


def test_halton_gives_the_sequence_and_uniform_discrete_values() -> None:
    scenario = scenic.scenarioFromString(
        "param x = VerifaiRange(2, 5), d = VerifaiDiscreteRange(1, 4), y = VerifaiRange(0, 1)\nego = new Object"
    )
    found = [scenario.generate()[0].params for _ in range(40)]
    expected = qmc.Halton(2, scramble=False).random(41)[1:]
    assert np.abs([item["x"] for item in found] - (2 + 3 * expected[:, 0])).max() < 1e-12
    assert np.abs([item["y"] for item in found] - expected[:, 1]).max() < 1e-12
    assert {item["d"] for item in found} == {1, 2, 3, 4}
    scenario.resetExternalSampler()
    assert scenario.generate()[0].params["x"] == found[0]["x"]


def test_two_scenarios_share_nothing() -> None:
    text = "param x = VerifaiRange(0, 1)\nego = new Object"
    first, second = scenic.scenarioFromString(text), scenic.scenarioFromString(text)
    assert [first.generate()[0].params["x"], second.generate()[0].params["x"]] == [0.5, 0.5]


def test_requirements_do_not_narrow_what_a_sampler_chooses() -> None:
    scenario = scenic.scenarioFromString(
        "x = VerifaiRange(0, 1)\nparam x = x\nego = new Object at Range(0, 10) @ 0\nrequire x > 0.6\nrequire ego.position.x < x"
    )
    found = [scenario.generate() for _ in range(3)]
    points = iter(qmc.Halton(1, scramble=False).random(2000)[1:, 0])
    for scene, tried in found:
        point = [next(points) for _ in range(tried)][-1]
        assert scene.params["x"] == point > 0.6


def test_a_sampler_gets_feedback() -> None:
    told: list[Any] = []

    class Mine(ExternalSampler):
        rejectionFeedback = "rejected"

        def nextSample(self, feedback: Any) -> int:
            told.append(feedback)
            return len(told)

        def valueFor(self, param: Any) -> float:
            return self.cachedSample / 10

    scenario = scenic.scenarioFromString(
        "x = VerifaiRange(0, 1)\nparam x = x\nego = new Object\nrequire x > 0.25",
        params={"externalSampler": Mine},
    )
    assert scenario.generate(feedback=7)[0].params["x"] == pytest.approx(0.3)
    assert scenario.generate(feedback=8)[0].params["x"] == pytest.approx(0.4)
    assert told == [7, "rejected", "rejected", 8]


def test_feedback_that_is_no_number_counts_as_rejected_and_is_told_once() -> None:
    scenario = scenic.scenarioFromString(
        "param verifaiSamplerType = 'ce'\nparam x = VerifaiRange(0, 1)\nego = new Object"
    )
    scenario.generate()
    with pytest.warns(ScenicWarning, match="no finite number"):
        scenario.generate(feedback=float("nan"))
    sampler = scenario.externalSampler
    assert isinstance(sampler, VerifaiSampler)
    assert np.allclose(sampler.sampler.distributions[0], 0.2)  # type: ignore[attr-defined]


SERIES = """
param timeBound = 4
x = TimeSeries(VerifaiRange(0, 1))
behavior B():
    while True:
        {}
        wait
ego = new Object with behavior B()
record x.values[simulation().currentTime] as wanted
"""


def test_a_series_has_one_value_a_step() -> None:
    scenario = scenic.scenarioFromString(
        SERIES.format("self.width = x.getSample()") + "record ego.width as got"
    )
    (scene,) = scenario.sample(1, seed=3)
    done = [DummySimulator().simulate(scene, maxSteps=3) for _ in range(2)]
    for simulation in done:  # a fresh simulation starts afresh
        assert simulation is not None
        assert simulation.result is not None
    alone = scenic.scenarioFromString(
        "param timeBound = 2\nparam x = TimeSeries(VerifaiRange(0, 1))\nego = new Object"
    )
    series = alone.sample(1, seed=0)[0].params["x"]
    with pytest.raises(InvalidScenarioError, match="outside of a simulation"):
        series.getSample()


@pytest.mark.parametrize("use", ["x.getSample(); x.getSample()"])
def test_a_series_is_asked_once_a_step(use: str) -> None:
    (scene,) = scenic.scenarioFromString(SERIES.format(use)).sample(1, seed=3)
    with pytest.raises(InvalidScenarioError, match="twice in one step"):
        DummySimulator().simulate(scene, maxSteps=3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = VerifaiRange(0, Range(1, 2))", "fixed, finite numbers"),
        ("x = VerifaiRange(0, 1, buckets=2, weights=[1, 2, 3])", "2 buckets and 3 weights"),
        ("x = VerifaiRange(0, 1, weights=[0, 0])", "nothing to choose"),
        ("x = VerifaiDiscreteRange(3, 1)", "the lower first"),
        ("x = VerifaiDiscreteRange(1, 3, weights=[1])", "needs 3 weights"),
        ("x = VerifaiOptions([])", "nothing to choose"),
        ("x = VerifaiOptions(3)", "takes a dictionary"),
        ("x = VerifaiParameter.withPrior(Range(0, 1) + 1)", "primitive"),
        ("x = VerifaiParameter(3)", "no values of its own"),
        ("x = TimeSeries(3)", "takes an external parameter"),
        ("x = TimeSeries(VerifaiRange(0, 1))", "needs the parameter `timeBound`"),
    ],
)
def test_mistakes_have_a_place(text: str, words: str) -> None:
    with pytest.raises(Located, match=words) as caught:
        scenic.scenarioFromString(f"ego = new Object\n{text}\n")
    assert getattr(caught.value, "span", None) is not None


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"verifaiSamplerType": "hulton"}, "did you mean `halton`"),
        ({"verifaiSamplerParams": {"speed": 3}}, "sample_index, bases_skipped"),
        ({"externalSampler": 3}, "derive a class"),
    ],
)
def test_bad_samplers(params: dict[str, Any], words: str) -> None:
    scenario = scenic.scenarioFromString("param x = VerifaiRange(0, 1)\nego = new Object", params=params)
    with pytest.raises(Exception) as caught:  # noqa: PT011 - of several classes
        scenario.generate()
    assert words in str(getattr(caught.value, "help", ""))


def test_generate_depends_on_the_state_of_random_alone() -> None:
    def run() -> list[float]:
        random.seed(4)
        scenario = scenic.scenarioFromString(EVERY_KIND, params={"verifaiSamplerType": "random"})
        return [scenario.generate()[0].params["x"] for _ in range(4)]

    assert run() == run()


class OneByOne(VerifaiSampler):
    """The same samplers, each of whose points waits for the answer about the one before."""


CHOICES = """
param x = VerifaiRange(0, 1), d = VerifaiDiscreteRange(1, 4), y = VerifaiRange(0, 1)
ego = new Object at Range(0, 10) @ 0
require (globalParameters.x + globalParameters.y) % 0.5 > 0.3
require ego.position.x < 5
"""


@pytest.mark.parametrize("feedback", [None, -0.5], ids=["silent", "told"])
@pytest.mark.parametrize(
    "kind", ["random", "halton", "sobol", "grid", "ce", "mab", "eg", "sa", "bo", "cma", "tpe"]
)
def test_candidates_of_batches_are_those_of_one_at_a_time(kind: str, feedback: float | None) -> None:
    if library := {"bo": "sklearn", "cma": "cma", "tpe": "optuna"}.get(kind):
        pytest.importorskip(library)
    outcomes = []
    for given in ({}, {"externalSampler": OneByOne}):
        random.seed(6)
        scenario = scenic.scenarioFromString(CHOICES, params={"verifaiSamplerType": kind, **given})
        drawn = [scenario.generate(feedback=feedback) for _ in range(5)]
        outcomes.append(
            [(*(scene.params[key] for key in "xdy"), scene.egoObject.x, tried) for scene, tried in drawn]
        )
    assert outcomes[0] == outcomes[1]
    assert any(tried > 1 for *_, tried in outcomes[0])


def test_no_candidate_is_evaluated_twice() -> None:
    seen: list[float] = []
    scenario = scenic.scenarioFromString(
        "param x = VerifaiRange(0, 1)\nego = new Object\nx = globalParameters.x\nseen = globalParameters.seen\n"
        "require seen(x) or x < 0.3",
        params={"seen": seen.append},
    )
    tried = [scenario.generate()[1] for _ in range(20)]
    expected = qmc.Halton(1, scramble=False).random(len(seen) + 1)[1:, 0]
    assert sum(tried) <= len(seen)
    assert seen == expected.tolist()


def test_points_that_were_not_used_come_first() -> None:
    scenario = scenic.scenarioFromString(
        "param x = VerifaiRange(0, 1)\nego = new Object\nrequire globalParameters.x < 0.3"
    )
    points = iter(qmc.Halton(1, scramble=False).random(200)[1:, 0].tolist())
    for turn in range(12):
        if turn % 3 == 0:
            random.random()  # other seeds follow, so that what is evaluated ahead is given up
        if turn == 7:
            with pytest.raises(RejectionException):
                scenario.generate(maxIterations=1)
            assert next(points) >= 0.3
        scene, tried = scenario.generate()
        assert scene.params["x"] == [next(points) for _ in range(tried)][-1] < 0.3


def test_an_error_ahead_waits_for_its_candidate() -> None:
    scenario = scenic.scenarioFromString(
        "x = VerifaiRange(0, 1)\nparam x = x\nego = new Object with width 1 / max(0, 0.8 - x)"
    )
    points = qmc.Halton(1, scramble=False).random(40)[1:, 0].tolist()
    for point in points[:9]:
        if point < 0.8:
            assert scenario.generate()[0].params["x"] == point
        else:
            with pytest.raises(Exception, match=r"width|zero"):
                scenario.generate()
