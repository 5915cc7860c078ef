"""Bounds that programs tell of their own functions and distributions."""

import pytest

from scenic.language.errors import InvalidScenarioError
from tests.runtime.programs import scenario

PROGRAM = """\
from scenic import bounded
@distributionFunction
@bounded(lambda speed, friction: (speed[0] ** 2 / (20 * friction[1]), speed[1] ** 2 / (20 * friction[0])))
def stopping(speed, friction):
    return speed ** 2 / (20 * friction)
speed, friction, gap = Range(0, 40), Range(0.5, 1), Range(0, 1000)
far, near = stopping(speed, friction), stopping(speed, 0.5)
require far > 120
require gap < near / 10
param v = (speed, friction, gap)
"""


def test_a_function_of_the_program_prunes() -> None:
    program = scenario(PROGRAM)
    assert program.domain.volume < 0.005
    scenes = program.sample(200, seed=0)
    assert sum(scene.attempts for scene in scenes) < 3 * 200
    for scene in scenes:
        speed, friction, gap = scene.params["v"]
        assert speed**2 / (20 * friction) > 120
        assert gap < speed**2 / 100
    # No scene of the whole cube lies outside of what is left.
    whole = scenario(PROGRAM.replace("@bounded(", "@(lambda reading: lambda function: function)("))
    assert whole.domain.is_whole
    for scene in whole.sample(100, seed=0):
        speed, friction, gap = scene.params["v"]
        assert speed > 34.5


def test_vectors_and_what_is_not_known() -> None:
    program = scenario(
        "from scenic import bounded\nseen = []\ndef reading(place, name, scale):\n    seen.append((place, name, scale))\n"
        "    return (place[0][0], place[0][1])\n@distributionFunction\n@bounded(reading)\ndef east(place, name, scale): return place.x\n"
        "ego = new Object at (Range(-5, 5), 3)\nx = east(ego.position, Uniform('a', 'b'), 2)\nrequire x > 4\nparam v = seen\n"
    )
    assert program.domain.volume == pytest.approx(0.1, abs=0.01)
    place, name, scale = program.params["v"][0]
    assert place[1] == pytest.approx((3, 3))
    assert name == (-float("inf"), float("inf"))
    assert scale == (2, 2)
    with pytest.raises(InvalidScenarioError, match="no interval"):
        scenario(PROGRAM.replace("(speed[0] ** 2 / (20 * friction[1]), ", "(1e9, "))


def test_the_support_of_a_distribution_prunes() -> None:
    text = (
        "from scenic.core.distributions import Distribution\nimport random\nclass Peak(Distribution):\n    def __init__(self): super().__init__(valueType=float)\n"
        "    def sampleGiven(self, value): return random.triangular(2, 5, 3)\n    def supportInterval(self): {}\n"
        "x, y = Range(0, 100), Peak()\nrequire x < y\nparam v = (x, y)\n"
    )
    assert scenario(text.format("return (2, 5)")).domain.volume == pytest.approx(0.05)
    assert scenario(text.format("return (2, None)")).domain.is_whole
    assert scenario(text.format("return 1 / 0")).domain.is_whole
    never = scenario(text.format("return (2, 5)") + "require y > 6 as high\n")
    assert "high" in never.impossible
