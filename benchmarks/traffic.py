"""Steps a second of the built-in traffic simulator: ``python -m benchmarks.traffic MAP``.

One car that follows its lane for 300 steps, and eleven for 200 steps, one of which avoids the others, from three scenes each, in
turns; the median of the turns counts. Times are processor seconds; the first, short simulation of each program is not counted. Run
by hand; nothing here is a test.
"""

import argparse
import statistics
import time
from pathlib import Path

import scenic

SCENES = 3
FOLLOW = "new Car with behavior FollowLaneBehavior()\n"
PROGRAMS = {
    "one car": (f"ego = {FOLLOW}", 300),
    "eleven cars": ("ego = new Car with behavior DriveAvoidingCollisions()\n" + 10 * FOLLOW, 200),
}


def steps_a_second(road_map: Path, text: str, steps: int, turns: int) -> float:
    """The median over turns."""
    program = f"param map = {str(road_map)!r}\nmodel scenic.simulators.newtonian.driving_model\n{text}"
    scenario = scenic.scenarioFromString(program, mode2D=True)
    scenes = scenario.sample(SCENES, seed=7)
    simulator = scenario.getSimulator()
    simulator.simulate(scenes[0], maxSteps=20)
    found = []
    for _ in range(turns):
        done, start_time = 0, time.process_time()
        for scene in scenes:
            result = simulator.simulate(scene, maxSteps=steps)
            done += 0 if result is None else result.currentTime
        found.append(done / (time.process_time() - start_time))
    return statistics.median(found)


def main() -> None:
    """Print a line for each program."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("map", type=Path)
    parser.add_argument("--turns", type=int, default=5)
    given = parser.parse_args()
    for name, (text, steps) in PROGRAMS.items():
        print(f"{name:12} {steps_a_second(given.map, text, steps, given.turns):8.0f} steps/s", flush=True)


if __name__ == "__main__":
    main()
