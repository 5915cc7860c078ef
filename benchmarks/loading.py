"""The cost of analysis at load: ``python -m benchmarks.loading [--turns N] [PROGRAM ...]``.

Each program of ``examples/``, ``breadth/``, ``loops/``, ``regions/`` and this folder is loaded in turns with analysis and without,
after one load of each kind that is not counted. Printed are processor seconds of the least of the turns, of the analysis
alone and of the rehearsal, and the share of the cube that is left. Programs of which nothing is removed are summed up.
"""

import argparse
import statistics
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import scenic
from scenic import narrowing
from scenic.language.errors import Located, ScenicError

HERE: Final = Path(__file__).parent
FOLDERS: Final = (HERE.parent / "examples", HERE / "breadth", HERE / "loops", HERE / "regions")
NOTHING: Final = 0.999
"""The share of the cube that counts as all of it."""


@dataclass(frozen=True, slots=True)
class Row:
    """Processor seconds that loads of a program take, and the share of the cube that analysis leaves."""

    name: str
    without: float
    whole: float
    analysis: float
    left: float

    @property
    def ratio(self) -> float:
        """The load over that without analysis."""
        return self.whole / self.without


class _Stopwatch:
    """The processor seconds that the analysis of a program takes."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._narrowed = narrowing._narrowed

    def __call__(self, *arguments: Any) -> Any:
        begun = time.process_time()
        result = self._narrowed(*arguments)
        self.seconds = time.process_time() - begun
        return result


def measured(path: Path, turns: int) -> Row:
    """The seconds that loads of a program take."""
    watch = _Stopwatch()
    module: Any = narrowing
    module._narrowed = watch
    seconds: dict[bool, list[float]] = {True: [], False: []}
    analysis, left = [], 1.0
    try:
        for turn in range(turns + 1):
            for prune in (True, False):
                start_time = time.process_time()
                scenario = scenic.load(path, prune=prune)
                if turn:
                    seconds[prune].append(time.process_time() - start_time)
                if prune:
                    left = scenario.domain.volume
                    analysis += [watch.seconds] if turn else []
    finally:
        module._narrowed = watch._narrowed
    return Row(path.stem, min(seconds[False]), min(seconds[True]), min(analysis), left)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--turns", type=int, default=3, help="counted turns of each program (default 3)")
    parser.add_argument("programs", nargs="*", type=Path, help="in place of all")
    arguments = parser.parse_args()
    paths = arguments.programs or sorted(
        [path for folder in FOLDERS for path in folder.rglob("*.scenic")] + list(HERE.glob("*.scenic"))
    )
    rows = []
    print(f"{'program':28}{'without':>9}{'with':>8}{'ratio':>7}{'analysis':>10}{'left':>10}")
    for path in paths:
        try:
            row = measured(path, arguments.turns)
        except (ScenicError, Located, ImportError) as error:
            print(f"{path.stem:28}not loaded: {str(error).splitlines()[0][:60]}", flush=True)
            continue
        rows.append(row)
        print(
            f"{row.name:28}{row.without:9.3f}{row.whole:8.3f}{row.ratio:7.2f}{row.analysis:10.4f}{row.left:10.3g}",
            flush=True,
        )
    idle = [row for row in rows if row.left > NOTHING]
    if idle:
        more = [row.whole - row.without for row in idle]
        print(
            f"{len(idle)} programs of which nothing is removed: ratio {statistics.median(row.ratio for row in idle):.2f} at the median, "
            f"{sum(row.whole for row in idle) / sum(row.without for row in idle):.2f} of the sums, at most {max(more):.3f} s more"
        )


if __name__ == "__main__":
    main()
