"""Time and memory of loading road maps, and how both grow with the number of roads.

    python -m benchmarks.maps town.xodr ...             each map: built, and from the cache
    python -m benchmarks.maps --grids FOLDER 3 8 16 23  grids of SUMO's, made in FOLDER with `netgenerate` and `netconvert`

The two programs come with the package `eclipse-sumo`, which is needed for grids only. A grid of n x n crossings has
some 20 n^2 roads, those within crossings included. Times are processor seconds.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np


def made_grid(folder: Path, crossings: int) -> Path:
    """A grid of roads of 100 m as an OpenDRIVE file."""
    path = folder / f"grid{crossings}.xodr"
    if not path.exists():
        generate, convert = shutil.which("netgenerate"), shutil.which("netconvert")
        if generate is None or convert is None:
            sys.exit("netgenerate and netconvert are needed: pip install eclipse-sumo")
        net = folder / f"grid{crossings}.net.xml"
        size = [f"--grid.number={crossings}", "--grid.length=100"]
        subprocess.run([generate, "--grid", *size, "-o", net], check=True, capture_output=True)
        subprocess.run([convert, "-s", net, "--opendrive-output", path], check=True, capture_output=True)
    return path


def measured(file: Path) -> tuple[int, float, float]:
    """Roads of a map, and the seconds that it takes built, and from the cache."""
    from scenic.domains.driving.loading import network_of
    from scenic.domains.driving.roads import Network

    seconds = []
    with tempfile.TemporaryDirectory() as cache:
        os.environ.update({"SCENIC_CACHE": "on", "SCENIC_CACHE_DIR": cache})
        for use in (False, True, True):
            network_of.cache_clear()
            start = time.process_time()
            network = Network.fromFile(file, useCache=use, writeCache=use)
            seconds.append(time.process_time() - start)
    return len(network.allRoads), seconds[0], seconds[2]


def main() -> None:
    """Print a line for each map, and for grids the exponent of growth."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", nargs="*")
    parser.add_argument("--grids", metavar="FOLDER", type=Path)
    arguments = parser.parse_args()
    files = [
        made_grid(arguments.grids, int(name)) if arguments.grids else Path(name) for name in arguments.maps
    ]
    rows = []
    print(f"{'map':24}{'roads':>8}{'built, s':>10}{'cached, s':>11}{'peak, MB':>10}")
    for file in files:
        roads, built, cached = measured(file)
        rows.append((roads, built))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"{file.name:24}{roads:8}{built:10.2f}{cached:11.3f}{peak:10.0f}", flush=True)
    if arguments.grids and len(rows) > 2:
        roads, seconds = np.log(np.array(rows)).T
        print(f"time grows as roads^{np.polyfit(roads, seconds, 1)[0]:.2f}")


if __name__ == "__main__":
    main()
