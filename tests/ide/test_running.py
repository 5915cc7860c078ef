"""Programs that are run for an editor: what is quoted, and what they cannot do."""

import os
import sys
import time
from pathlib import Path

import pytest

from scenic.ide import running
from scenic.ide.running import RunError, sample_page

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are those of POSIX")


def problem(text: str, folder: Path) -> str:
    with pytest.raises(RunError) as found:
        sample_page(text, str(folder / "room.scenic"))
    return str(found.value)


def test_the_text_in_the_editor_is_quoted(tmp_path: Path) -> None:
    (tmp_path / "room.scenic").write_text("the = file\non = the\ndisk = 1\n")
    told = problem("ego = new Object\nx = Range(1, 2)\nrequire ego.width < {}[1]\n", tmp_path)
    assert "require ego.width < {}[1]" in told
    assert "disk" not in told


def test_a_program_that_ends_the_process_has_no_scene(tmp_path: Path) -> None:
    assert "ended the process" in problem("import os\nos._exit(0)\n", tmp_path)


def test_endless_output_and_children_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "_LARGEST", 1 << 20)
    noted = tmp_path / "child"
    program = (
        "import subprocess\nchild = subprocess.Popen(['sleep', '100'])\n"
        f"open({str(noted)!r}, 'w').write(str(child.pid))\nwhile True:\n    print('x' * 10000)\n"
    )
    assert "writes more than 1 MB" in problem(program, tmp_path)
    for _ in range(100):
        state = Path(f"/proc/{noted.read_text()}/stat")
        if not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z":
            break
        time.sleep(0.05)
    else:
        os.kill(int(noted.read_text()), 9)
        pytest.fail("the child goes on")
