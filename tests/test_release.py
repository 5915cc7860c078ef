"""Wheel and source distribution: complete, right by twine, and usable when installed elsewhere."""

import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from scenic.playground.server import is_built

ROOT = Path(__file__).parents[1]

SCRIPT = """
import sys
sys.path.insert(0, sys.argv[1])
import scenic
assert scenic.__file__.startswith(sys.argv[1]), scenic.__file__
sys.argv = ["scenic", *sys.argv[2:]]
from scenic.cli.main import main
main()
"""


@pytest.mark.slow
def test_distributions_are_right_and_work_where_they_are_installed(tmp_path: Path) -> None:
    def run(*arguments: object, folder: Path = ROOT) -> str:
        command = [sys.executable, *map(str, arguments)]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    made, installed = tmp_path / "dist", tmp_path / "installed"
    run("-m", "build", "--no-isolation", "--outdir", made, ROOT)
    (wheel,), (source,) = made.glob("*.whl"), made.glob("*.tar.gz")
    run("-m", "twine", "check", "--strict", wheel, source)
    run("-m", "pip", "install", "-q", "--no-compile", "--no-deps", "--no-index", "--target", installed, wheel)
    script = tmp_path / "command.py"
    script.write_text(SCRIPT)
    run(script, installed, "new", "started", folder=tmp_path)
    program = tmp_path / "started" / "scene.scenic"
    lines = run(script, installed, "sample", program, "-n", 2, "--seed", 1, folder=tmp_path).splitlines()
    assert len(lines) == 2
    assert "# SC202" in run(script, installed, "explain", "SC202", folder=tmp_path)
    if is_built():  # by npm, which may be missing here
        assert (installed / "scenic" / "playground" / "static" / "page.js").is_file()
        with tarfile.open(source) as files:
            assert any(name.endswith("/scenic/playground/static/page.js") for name in files.getnames())
