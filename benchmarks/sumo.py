"""Ten vehicles for 300 steps in SUMO and in the built-in simulator: ``python -m benchmarks.sumo MAP ... [--turns N]``.

Five follow lanes, five are left to SUMO (and stand still in the built-in simulator). The table shows steps a second of processor
time; the farthest that a steered vehicle was from where the built-in simulator has it; by how much traffic exceeded a speed
limit; and collisions that SUMO counted. Run by hand on a quiet machine.
"""

import argparse
import math
import time
from pathlib import Path
from typing import Any, Final

import scenic
from scenic.simulators.sumo.library import library

STEPS: Final = 300
PROGRAM: Final = """
param map = {map!r}
model scenic.simulators.{model}
for i in range(5):
    new Car with behavior FollowLaneBehavior(target_speed=8)
for i in range(5):
    new NPCCar
"""


class Course:
    """The states of a simulation; in SUMO also by how much traffic was too fast (m/s), and collisions."""

    def __init__(self, in_sumo: bool) -> None:
        self.states: list[list[tuple[float, float]]] = []
        self.excess = -math.inf
        self.collisions = 0
        self._sumo = library() if in_sumo else None

    def see(self, simulation: Any, *_: Any) -> None:
        """Keep a state."""
        self.states.append([tuple(obj.position[:2]) for obj in simulation.objects[:5]])
        if self._sumo is None or simulation.currentTime == 0:
            return
        self.collisions += len(self._sumo.simulation.getCollisions())
        speeds = self._sumo.vehicle
        for number in range(5, 10):
            name = f"object{number}"
            self.excess = max(self.excess, speeds.getSpeed(name) - speeds.getAllowedSpeed(name))


def run(road_map: Path, model: str, seed: int) -> tuple[Course, float]:
    """The course of a simulation, and steps a second of one that nobody watches."""
    scenario = scenic.scenarioFromString(PROGRAM.format(map=str(road_map), model=model), mode2D=True)
    scene = scenario.sample(1, seed=seed)[0]
    course = Course(model.startswith("sumo"))
    with scenario.getSimulator() as simulator:
        simulator.simulate(scene, maxSteps=STEPS, key=bytes([seed]), on_state=course.see)
        begun = time.process_time()
        simulator.simulate(scene, maxSteps=STEPS, key=bytes([seed]))
        return course, STEPS / (time.process_time() - begun)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    print("| map | seed | built-in steps/s | SUMO steps/s | apart, m | too fast, m/s | collisions |")
    print("|---|---|---|---|---|---|---|")
    for road_map in options.maps:
        for seed in range(1, options.turns + 1):
            ours, our_rate = run(road_map, "newtonian.driving_model", seed)
            theirs, rate = run(road_map, "sumo.model", seed)
            apart = max(
                math.dist(left, right)
                for one, other in zip(ours.states, theirs.states, strict=True)
                for left, right in zip(one, other, strict=True)
            )
            print(
                f"| {road_map.stem} | {seed} | {our_rate:,.0f} | {rate:,.0f} | {apart:.1e} "
                f"| {max(0.0, theirs.excess):.1e} | {theirs.collisions} |"
            )


if __name__ == "__main__":
    main()
