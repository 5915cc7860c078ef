"""Steps per second of simulations: 20 agents with 3 interrupts each, 5 temporal requirements, the dummy simulator.

Run as ``python -m benchmarks.dynamics [--steps N ...] [--reference PATH] [--memory STEPS]``; PATH runs the reference
implementation on a program with ``--simulate STEPS``. Figures are in processor time, so that other work beside it matters less.
"""

import argparse
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import scenic
from scenic.simulators.dummy import DummySimulation, DummySimulator

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


def ours(steps: int, **options: bool) -> float:
    """Seconds of the processor that a simulation takes."""
    scene = scenic.scenarioFromString(program()).sample(1, seed=0)[0]
    begun = time.process_time()
    done = DummySimulator(drift=0.01).simulate(scene, maxSteps=steps, **options)
    assert done is not None
    assert done.currentTime == steps
    return time.process_time() - begun


def of_reference(path: Path, steps: int) -> float:
    """The same, without what it takes to start and to make a scene."""
    return _processor(path, "--simulate", str(steps), "--drift", "0.01") - _processor(path)


def _processor(path: Path, *options: str) -> float:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "program.scenic")
        file.write_text(program())
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [path.resolve(), file, *options], capture_output=True, check=True, cwd=folder, env=environment
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def memory(steps: int) -> None:
    """Print the memory in use along a long simulation that keeps neither its course nor what it drew."""
    scene = scenic.scenarioFromString(program()).sample(1, seed=0)[0]
    simulation = DummySimulation(
        scene,
        drift=0.0001,
        maxSteps=steps,
        name="long",
        timestep=None,
        keep_course=False,
        enableReplay=False,
        deferred=True,
    )
    simulation.begin()
    page = resource.getpagesize()
    every = steps // 10
    while simulation.advanceOnce():
        if simulation.currentTime % every == 1:
            resident = int(Path("/proc/self/statm").read_text().split()[1]) * page / 2**20
            print(f"step {simulation.currentTime}: {resident:.1f} MB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, nargs="+", default=[200, 2000])
    parser.add_argument("--reference", type=Path, help="also measure this command")
    parser.add_argument(
        "--memory", type=int, metavar="STEPS", help="also show the memory along so many steps"
    )
    options = parser.parse_args()
    ours(200)  # warm
    for steps in options.steps:
        seconds = ours(steps)
        line = f"{steps} steps: {steps / seconds:.0f} a second"
        if options.reference:
            other = of_reference(options.reference, steps)
            line += f"; reference {steps / other:.1f}; {other / seconds:.0f} times"
        print(line)
    if options.memory:
        memory(options.memory)


if __name__ == "__main__":
    main()
