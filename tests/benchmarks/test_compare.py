import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.compare import CASES

ROOT = Path(__file__).parents[2]
FAKE = """
import json, sys
count = int(sys.argv[sys.argv.index("-n") + 1])
for k in range(count):
    print(json.dumps({"iterations": 10 if k else 99, "seconds": 0.5 if k else 99, "x": 1}))
print(json.dumps({"import_s": 1}))
"""


@pytest.mark.slow
def test_the_table_compares_medians_without_the_first_scene(tmp_path: Path) -> None:
    (tmp_path / "fake.py").write_text(FAKE)
    arguments = ["--program", "overtaking", "--our-scenes", "2", "--repeats", "2"]
    result = subprocess.run(
        [
            sys.executable,
            "-m",
            "benchmarks.compare",
            "--reference",
            f"{sys.executable} {tmp_path / 'fake.py'}",
            *arguments,
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    rows = [line.split() for line in result.stdout.splitlines()]
    (ours,) = (row for row in rows if row[:2] == ["overtaking", "ours"])
    (theirs,) = (row for row in rows if row[:1] == ["reference"])
    (ratio,) = (row for row in rows if row[:1] == ["ratio"])
    assert ours[2] == "4"
    assert theirs[1:] == [str(2 * CASES["overtaking"].scenes), "10.0", "0.5", "20"]
    assert float(ratio[1].rstrip("x")) == pytest.approx(0.5 / float(ours[4]), rel=0.02, abs=1)
