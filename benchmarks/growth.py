"""Growth of a candidate's time with the number of objects: boxes at random places of a cube, at a constant density.

python -m benchmarks.growth
"""

import math
import time

import numpy as np

from scenic.pipeline import scenarioFromString
from scenic.runtime.geometry.contact.collision import Collider
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.poses import Poses

COUNTS = (10, 30, 100, 300, 1000)
SPACE = 20.0
"""Cubic metres for each box of one cubic metre at most: some pair of a thousand nearly always collides."""

LANES = 256
SECONDS = 1.0


def candidates(count: int, seed: int = 1) -> list[Body]:
    """Turned boxes of random size over the lanes."""
    rng = np.random.default_rng(seed)
    reach = (SPACE * count) ** (1 / 3) / 2
    bodies = []
    for _ in range(count):
        orientation = rng.normal(size=(LANES, 4))
        orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
        position, size = rng.uniform(-reach, reach, (LANES, 3)), rng.uniform(0.2, 0.5, (LANES, 3))
        bodies.append(Body((primitives.box(),), None, Poses(position, orientation, size)))
    return bodies


def collisions(count: int, *, exhaustive: bool) -> float:
    """Microseconds of processor time for the collision test of a candidate."""
    bodies = candidates(count)
    cast = Collider(bodies)
    cast.test(bodies, LANES)
    begun, turns = time.process_time(), 0
    while turns < 3 or time.process_time() - begun < SECONDS:
        cast.test(bodies, LANES, exhaustive=exhaustive)
        turns += 1
    return (time.process_time() - begun) / turns / LANES * 1e6


def program(count: int) -> tuple[float, float]:
    """Seconds to load a program of a number of fixed boxes and a moving one, and microseconds for a candidate."""
    side = math.isqrt(count) + 1
    lines = [f"new Object at ({3 * (i % side)}, {3 * (i // side)}, 0)" for i in range(count)]
    lines += [f"ego = new Object at (Range(0, {3 * side}), Range(0, {3 * side}), Range(0, 2))"]
    start_time = time.process_time()
    scenario = scenarioFromString("\n".join(lines))
    loaded = time.process_time() - start_time
    scenario.sample(20, seed=2)
    start_time, attempts = time.process_time(), 0
    for result in scenario.stream(500, seed=1):
        attempts += result.attempts
    return loaded, (time.process_time() - start_time) / attempts * 1e6


def exponent(times: list[float]) -> float:
    """The slope of the line through the logarithms."""
    return float(np.polyfit(np.log(COUNTS), np.log(times), 1)[0])


def main() -> None:
    """Print a table and the exponents."""
    print("boxes   all moving: us a candidate   every pair reported   one moving: load, s   us a candidate")
    columns: list[list[float]] = []
    for count in COUNTS:
        loaded, each = program(count)
        row = [collisions(count, exhaustive=False), collisions(count, exhaustive=True), loaded, each]
        columns.append(row)
        print(f"{count:5}   {row[0]:26.1f}   {row[1]:19.1f}   {row[2]:18.2f}   {row[3]:14.1f}", flush=True)
    names = ("collision test", "every pair", "load", "candidate")
    exponents = (
        f"{name} {exponent(list(column)):.2f}"
        for name, column in zip(names, zip(*columns, strict=True), strict=True)
    )
    print("exponents: " + ", ".join(exponents))


if __name__ == "__main__":
    main()
