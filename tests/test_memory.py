"""Memory of large batches, measured in processes of their own."""

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.large_mesh import PROGRAM, write_rock

ROOT = Path(__file__).parent.parent
LIMIT = 1 << 30

MEASURE = """
import sys
import numpy as np
import scenic
from scenic.runtime.sampling.engine import Engine
from scenic.runtime.sampling.pending import SceneTask

scenario = scenic.load(sys.argv[1])
engine = Engine(scenario.outline.plan(scenario.domain))
# Batches of 512 candidates through every check, none left out.
report = engine.report(SceneTask(1, 0), 512)
assert report.candidates == 512
scenes = scenario.sample(2, seed=1, lanes=512)
with open("/proc/self/status") as status:
    (peak,) = (line.split()[1] for line in status if line.startswith("VmHWM:"))
print(int(peak) * 1024)
"""


pytestmark = pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="only Linux tells the peak of a process by itself"
)


def peak_memory(program: Path) -> int:
    """The most memory, in bytes, that a process of its own has used; unlike ``ru_maxrss``, not what its parent had."""
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, str(program)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return int(done.stdout)


@pytest.mark.slow
def test_512_lanes_of_the_furnished_room() -> None:
    assert peak_memory(ROOT / "examples" / "indoor" / "furnished_room.scenic") < LIMIT


@pytest.mark.slow
def test_512_lanes_on_a_large_mesh_of_random_width_and_tilt(tmp_path: Path) -> None:
    assert write_rock(tmp_path / "rock.ply") >= 200_000
    program = tmp_path / "rock.scenic"
    program.write_text(PROGRAM)
    assert peak_memory(program) < LIMIT
