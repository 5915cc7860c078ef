"""Bounds that programs tell of their own functions and distributions."""

import numpy as np
import pytest

from scenic.language.errors import InvalidScenarioError, UnsupportedError
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


RING = """\
import numpy as np
from scenic import bounded
@bounded(lambda inner, outer: ((-outer[1], outer[1]), (-outer[1], outer[1]), (0, 0)))
class Ring(Region):
    dimension, draws, parameter_names = 2, 2, ("inner", "outer")
    def __init__(self, inner, outer):
        super().__init__(inner, outer)
        self.inner, self.outer = inner, outer
    def contains_points(self, points, inner, outer):
        radius = np.hypot(points[:, 0], points[:, 1])
        return (inner <= radius) & (radius <= outer)
    def draw_points(self, uniforms, keys, inner, outer):
        radius = np.sqrt(inner**2 + uniforms[0] * (outer**2 - inner**2))
        angle = 2 * np.pi * uniforms[1]
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * radius], axis=1), None
ring = Ring(2, {})
ego = new Object at (Range(-50, 50), Range(-50, 50))
other = new Point in ring
require ego.position in ring
require other.x > {}
"""


@pytest.mark.parametrize("outer", ["6", "Range(4, 6)"])
def test_a_region_of_the_program_prunes(outer: str) -> None:
    program = scenario(RING.format(outer, 1))
    assert program.domain.volume < 0.0145
    for scene in program.sample(50, seed=0):
        assert 2 <= float(np.hypot(*scene.objects[0].position[:2])) <= 6
    never = scenario(RING.format(outer, 6.5))
    assert never.impossible
    with pytest.raises(InvalidScenarioError, match="no interval"):
        scenario(RING.format(outer, 1).replace(", (0, 0)))", "))"))
    with pytest.raises(UnsupportedError, match="containment of objects"):
        scenario(RING.format(outer, 1) + "require ring.containsObject(ego)\n").sample(1, seed=0)


def test_ways_along_a_field_of_polygons_are_no_longer_than_they_are() -> None:
    program = scenario(
        "strip = PolygonalRegion([(0, 0), (100, 0), (100, 10), (0, 10)])\n"
        "flow = PolygonalVectorField('flow', [(strip, 30 deg)])\n"
        "ego = new Object in strip\n"
        "other = new Object following flow from ego for Range(2, 5)\nrequire other.x > 80\n"
    )
    assert program.domain.volume < 0.42
    for scene in program.sample(50, seed=0):
        assert scene.objects[1].position.x > 80
