"""Microseconds of the language's operators, and of new objects, while a simulation runs.

Run as ``python -m benchmarks.eager [--profile EXPRESSION]``. Each figure is the least of several repetitions, in processor time.
"""

import argparse
import cProfile
import pstats
import time
from collections.abc import Callable
from typing import Any

import scenic
from scenic.simulators.dummy import DummySimulator

EXPRESSIONS = (
    "self.position",
    "self.position.x",
    "self.heading",
    "u + v",
    "2 * u",
    "u - other.position",
    "u.norm()",
    "u.distanceTo(v)",
    "u.rotatedBy(0.3)",
    "1 @ 2",
    "30 deg",
    "u offset by v",
    "u relative to v",
    "u offset along 0.3 by v",
    "distance from u to v",
    "distance to other",
    "angle from u to v",
    "altitude from u to v",
    "relative position of other",
    "relative heading of other",
    "apparent heading of other",
    "other offset by v",
    "front of other",
    "self.corners",
    "u in region",
    "self in region",
    "self in disc",
    "self in polygon",
    "self in box",
    "distance from u to region",
    "minimum distance from self to other",
    "minimum distance from self to round",
    "minimum distance from round to cone",
    "self intersects other",
    "self intersects region",
    "self can see other",
    "self can see hidden",
)
PROGRAM = """
region = RectangularRegion((0, 0), 0, 40, 40)
disc = CircularRegion((0, 0), 30)
polygon = PolygonalRegion([(-20, -20), (20, -20), (25, 20), (0, 3), (-20, 20)])
box = BoxRegion(dimensions=(40, 40, 10))
behavior B():
    u = Vector(1, 2, 3)
    v = Vector(-1, 4, 2)
    wait
    measure({{{expressions}}})
    wait
ego = new Object with behavior B()
other = new Object at (8, 8), facing 20 deg
wall = new Object at (0, -5), with width 10, with height 5, with length 0.1
hidden = new Object at (0, -8)
round = new Object at (-8, 9), with shape CylinderShape(), facing (30 deg, 20 deg, 0)
cone = new Object at (-12, 9), with shape ConeShape()
for i in range(8):
    new Object at (2 * i - 7, -14), with shape CylinderShape()
scenario Sub():
    setup:
        begin()
        for i in range(100):
            new Object at (3 * i, 1009)
        end('new Object at (x, y)', 100)
        begin()
        for i in range(100):
            new Object at (3 * i, 1019), facing 0.3, with width 2, with requireVisible False
        end('new Object at (x, y), facing a, with ...', 100)
        begin()
        for i in range(100):
            new Object ahead of ego by i + 2
        end('new Object ahead of ego by d', 100)
        terminate after 1 steps
scenario Main():
    compose:
        do Sub()
        do Sub()
        while True:
            wait
"""


class Meter:
    """Measures within the program, which finds its methods as names."""

    def __init__(self, profiled: str | None) -> None:
        self.found: dict[str, float] = {}
        self._profiled = profiled
        self._begun = 0.0

    def measure(self, calls: dict[str, Callable[[], Any]]) -> None:
        for name, call in calls.items():
            for _ in range(5):
                self.begin()
                for _ in range(300):
                    call()
                self.end(name, 300)
            if self._profiled == name:
                profile = cProfile.Profile()
                profile.runcall(lambda call=call: [call() for _ in range(2000)])
                pstats.Stats(profile).sort_stats("tottime").print_stats(25)

    def begin(self) -> None:
        self._begun = time.process_time()

    def end(self, name: str, count: int) -> None:
        took = 1e6 * (time.process_time() - self._begun) / count
        self.found[name] = min(took, self.found.get(name, took))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--profile", metavar="EXPRESSION", help="also show where the time of this one goes")
    options = parser.parse_args()
    meter = Meter(options.profile)
    calls = ", ".join(f"{text!r}: lambda: ({text})" for text in EXPRESSIONS)
    text = PROGRAM.format(expressions=calls)
    parameters = {"meter": meter}
    names = "\n".join(f"{name} = globalParameters.meter.{name}" for name in ("measure", "begin", "end"))
    scenario = scenic.scenarioFromString(names + text, params=parameters)
    (scene,) = scenario.sample(1, seed=0)
    DummySimulator(drift=0.01).simulate(scene, maxSteps=5, stuck_after=1000)
    for name, microseconds in meter.found.items():
        print(f"{microseconds:8.2f}  {name}")


if __name__ == "__main__":
    main()
