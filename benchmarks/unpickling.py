"""Scenes that other processes send: ``python -m benchmarks.unpickling [--scenes N] [PROGRAM ...]``.

Milliseconds of processor time for each scene of a program: to pickle it, to unpickle it and read position and orientation of all its
objects, and to evaluate it again from its draws, as `Scenario.sceneFromBytes` does. The program is compiled before. Where PyTorch is
installed, the last columns are scenes a second that a loader gives without workers and with two, by the clock.
"""

import argparse
import pickle
import time
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import scenic

EXAMPLES = Path(__file__).parents[1] / "examples"
PROGRAMS = [
    str(EXAMPLES / name)
    for name in ("basics/relative_objects.scenic", "indoor/desk.scenic", "driving/queue.scenic")
]


def milliseconds(make: Callable[[Any], object], items: Iterable[Any]) -> tuple[list[Any], float]:
    """Return the results, and the processor time of one after the first."""
    first, *others = items
    results: list[Any] = [make(first)]
    begun = time.process_time()
    results += [make(item) for item in others]
    return results, 1e3 * (time.process_time() - begun) / len(others)


def read(scene: Any) -> Any:
    """Look at all objects of a scene."""
    return [(item.position, item.orientation) for item in scene.objects]


def loaded_in_a_second(scenario: Any, count: int, workers: int) -> float:
    """Return the number of scenes that a loader of PyTorch gives in a second, each of which is looked at."""
    from torch.utils.data import DataLoader

    from scenic.torch import SceneStream

    loader = iter(
        DataLoader(SceneStream(scenario, seed=1, count=count), batch_size=None, num_workers=workers)
    )
    read(next(loader))
    start_time = time.perf_counter()
    number = sum(1 for scene in loader if read(scene))
    return number / (time.perf_counter() - start_time)


def main() -> None:
    """Print a line for each program."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("programs", nargs="*", default=PROGRAMS)
    options = parser.parse_args()
    for program in options.programs:
        scenario = scenic.load(program)
        scenes = scenario.sample(options.scenes, seed=1)
        pickled, dumped = milliseconds(pickle.dumps, scenes)
        _, looked = milliseconds(lambda data: read(pickle.loads(data)), pickled)
        saved = [(scenario, scenario.sceneToBytes(scene)) for scene in scenes]
        _, evaluated = milliseconds(lambda pair: read(pair[0].sceneFromBytes(pair[1])), saved)
        line = f"{Path(program).name:24} pickle {dumped:.3f} ms, unpickle and look {looked:.3f} ms, evaluate {evaluated:.3f} ms"
        if find_spec("torch") is not None:
            alone, two = (loaded_in_a_second(scenario, 10 * options.scenes, count) for count in (0, 2))
            line += f"; PyTorch {alone:,.0f} scenes/s alone, {two:,.0f} with two workers"
        print(line)


if __name__ == "__main__":
    main()
