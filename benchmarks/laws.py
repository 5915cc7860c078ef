"""Compares pruned and unpruned samples: ``python -m benchmarks.laws [NAME ...] [--scenes N] [--kept N]``.

Two questions about each program of `benchmarks.law_programs` that at least a thousandth of samples meets:

- Do scenes made with analysis and without it have one law? Kolmogorov and Smirnov's test of each number that scenes show, and of a
  mixture of them; p below 0.001 over the number of tests counts as a difference.
- Does what analysis keeps hold every scene that is found without analysis? Of so many as ``--kept`` says, or as are found in ``--seconds``.

Takes a CPU-hour or two; nothing here is a test.
"""

import argparse
import time
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

import scenic
from benchmarks.law_programs import Program, programs
from scenic.graph.domain import Domain
from scenic.graph.draws import Counter, attempt_keys, scene_keys, seed_word
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

RAREST = 1e-3
"""Programs that fewer samples meet are left out: without analysis they would take too long."""

BLOCK = 2000
"""Scenes looked for at a time."""


def loaded(program: Program) -> Scenario:
    """The scenario of a program."""
    return scenic.scenarioFromString(program.text, filename=program.filename, mode2D=program.mode_2d)


def rows_of(scenes: Iterable[Scene]) -> NDArray[np.float64]:
    """The numbers that scenes show, a row each."""
    rows = []
    for scene in scenes:
        values: list[Any] = [
            part
            for item in scene.objects
            for part in (*item.position, item.yaw, item.pitch, item.roll, item.width, item.length)
        ]
        for value in scene.params.values():
            values += value if isinstance(value, list | tuple) else [value]
        rows.append([float(value) for value in values if isinstance(value, int | float)])
    return np.array(rows)


def outside(engine: Engine, kept: Domain, wanted: int, seconds: float) -> tuple[int, int]:
    """Count the scenes of a plan over the whole cube that lie outside of another domain, and all of them.

    Args:
        engine: finds the scenes.
        kept: the other domain.
        wanted: scenes looked for.
        seconds: processor time after which no more are looked for.

    """
    graph = engine.plan.graph
    addresses = np.array([graph.address(axis) for axis in graph.axes], dtype=np.uint64)
    start_time, loss_count, count = time.process_time(), 0, 0
    while count < wanted and time.process_time() - start_time < seconds:
        tasks = [(4, k) for k in range(count, min(wanted, count + BLOCK))]
        deadline = time.monotonic() + 2 * seconds
        rows = [
            (item[0].numbers[item[1]], item[0].attempts[item[1]])
            for item in engine.scenes(tasks, max_attempts=10**7, deadline=deadline)
            if not isinstance(item, Exhausted)
        ]
        if not rows:
            break
        count += len(rows)
        if not len(addresses):
            continue
        numbers, attempts = np.array(rows, dtype=np.int64).T
        keys = attempt_keys(scene_keys(np.repeat(seed_word(4), len(numbers)), numbers), attempts - 1)
        points = Counter(keys).uniforms(addresses).T
        loss_count += int(np.count_nonzero(~kept.contains(points)))
        if len(rows) < len(tasks):
            break
    return loss_count, count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="some of the programs")
    parser.add_argument("--scenes", type=int, default=1000, help="of each program, with analysis and without")
    parser.add_argument(
        "--kept", type=int, default=100_000, help="scenes without analysis that must lie in what is kept"
    )
    parser.add_argument("--seconds", type=float, default=60, help="processor time for these, of each program")
    arguments = parser.parse_args()
    everything = programs()
    tests, found, loss_count, compared, complete = 0, [], 0, 0, 0
    for name in arguments.names or everything:
        pruned = loaded(everything[name])
        estimates = pruned.estimates(seed=0, candidates=2000)
        share = pruned.domain.volume * float(np.prod([part.acceptance for part in estimates]))
        if share < RAREST:
            continue
        plain = loaded(everything[name])
        engine = Engine(plain.outline.plan(Domain.whole(plain.outline.graph.dimension)))
        plain._sampler._finder = plain._sampler.engine = engine
        ours, theirs = (
            rows_of(some.sample(arguments.scenes, seed=seed)) for seed, some in enumerate((pruned, plain), 1)
        )
        mixture = np.arange(1, ours.shape[1] + 1)[:, np.newaxis] % 7 - 2.6
        columns = zip((*ours.T, *(ours @ mixture).T), (*theirs.T, *(theirs @ mixture).T), strict=True)
        values = [float(stats.ks_2samp(one, other).pvalue) for one, other in columns]
        out, count = outside(engine, pruned.domain, arguments.kept, arguments.seconds)
        tests, loss_count, compared, complete = (
            tests + len(values),
            loss_count + out,
            compared + count,
            complete + (count >= arguments.kept),
        )
        found.append((min(values), name))
        print(
            f"{name:26} kept {pruned.domain.volume:9.3g}, acceptance before {share:9.3g}, "
            f"{len(values):3} tests, least p {min(values):.4f}; {out} of {count} outside",
            flush=True,
        )
    differing = [name for value, name in found if value < 1e-3 / tests]
    print(f"{len(found)} programs, {tests} tests: {len(differing)} differ {differing}")
    print(
        f"{loss_count} of {compared} scenes found without analysis lie outside of what it keeps; "
        f"{complete} programs with {arguments.kept} scenes each"
    )


if __name__ == "__main__":
    main()
