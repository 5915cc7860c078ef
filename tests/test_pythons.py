"""The front end in later versions of CPython, which Node runs as WebAssembly: what `make pythons` installs."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.amounts import LONG, amount

HERE = Path(__file__).parent / "pythons"


@pytest.mark.slow
@pytest.mark.parametrize("version", ["3.12", "3.13", "3.14"] if LONG else ["3.12", "3.14"])
def test_the_front_end_in_later_pythons(version: str) -> None:
    """See `front_end.py` there."""
    node = shutil.which("node")
    if node is None or not (HERE / "node_modules" / f"python-{version}").exists():
        pytest.skip("`make pythons` installs what this takes")
    done = subprocess.run(
        [node, "--stack-size=4000", "run.mjs", version, "front_end.py", str(amount(9_000, 40_000))],
        cwd=HERE,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["version"].startswith(version)
    assert found["problems"] == []
    assert min(found["counts"]["equal"], found["counts"]["formatted"]) > amount(150, 400)
    assert found["counts"]["compiled"] >= 10
