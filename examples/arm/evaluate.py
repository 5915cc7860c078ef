"""The share of scenes in which the arm of ``tidy.scenic`` puts the cup into the drawer, with its interval.

python -m examples.arm.evaluate [SCENES]
"""

import math
import sys
from pathlib import Path

import scenic
from scenic.simulators.mujoco import MujocoSimulator

PROGRAM = Path(__file__).with_name("tidy.scenic")


def wilson(successes: int, count: int, z: float = 1.96) -> tuple[float, float]:
    """The interval of a share (E. Wilson, 1927), by default at 95%."""
    share = successes / count
    middle = share + z * z / (2 * count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return (middle - half) / (1 + z * z / count), (middle + half) / (1 + z * z / count)


def main(count: int) -> None:
    scenario = scenic.load(PROGRAM)
    successes = 0
    for scene in scenario.sample(count, seed=1):
        run = MujocoSimulator(timestep=0.1).simulate(scene, maxSteps=400)
        tidy = run is not None and bool(run.records["tidy"])
        successes += tidy
        print(f"scene {scene.k}: {'tidy' if tidy else 'not tidy'}")
    low, high = wilson(successes, count)
    print(f"{successes} of {count} tidy: {successes / count:.0%}, 95% interval {low:.0%} to {high:.0%}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
