"""Steps per second of simulations: 20 agents with 3 interrupts each, 5 temporal requirements, the dummy simulator.

Run as ``python -m benchmarks.dynamics [--steps N ...] [--reference PATH]``; PATH runs the reference implementation on a program
with ``--simulate STEPS --time``.
"""

import argparse
import json
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import scenic
from scenic.simulators.dummy import DummySimulator

AGENTS = 20
HEAD = """
behavior B():
    try:
        while True:
            take 1
    interrupt when self.position.x > 1000:
        take 2
    interrupt when (distance from self to ego) > 5000:
        take 3
    interrupt when simulation().currentTime % 50 == 7:
        take 4
ego = new Object with behavior B
"""
REQUIREMENTS = """
require always ego.position.x < 100
require eventually ego.position.y >= 0
require always (ego.position.x > 50 implies eventually ego.position.x < 50)
require ego.position.x < 10 until ego.position.y > 1
require always eventually ego.position.y > -1
"""


def program() -> str:
    others = (f"new Object at ({10 * place}, 0), with behavior B\n" for place in range(1, AGENTS))
    return HEAD + "".join(others) + REQUIREMENTS


def ours(steps: int) -> float:
    scene = scenic.scenarioFromString(program()).sample(1, seed=0)[0]
    begun = time.perf_counter()
    DummySimulator(drift=0.01).simulate(scene, maxSteps=steps, maxIterations=1)
    return time.perf_counter() - begun


def of_reference(path: str, steps: int) -> float:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "program.scenic")
        file.write_text(program())
        command = [path, str(file), "--simulate", str(steps), "--drift", "0.01", "--time"]
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        result = subprocess.run(
            command, capture_output=True, text=True, check=True, cwd=folder, env=environment
        )
    return float(json.loads(result.stdout.splitlines()[0])["simulation_s"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, nargs="+", default=[200, 2000])
    parser.add_argument("--reference", help="also measure this")
    options = parser.parse_args()
    ours(20)  # warm
    for steps in options.steps:
        seconds = ours(steps)
        line = f"{steps} steps: {steps / seconds:.0f} a second"
        if options.reference:
            other = of_reference(options.reference, steps)
            line += f"; reference {steps / other:.1f}; {other / seconds:.0f} times"
        print(line)
    print(f"largest memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024} MB")


if __name__ == "__main__":
    main()
