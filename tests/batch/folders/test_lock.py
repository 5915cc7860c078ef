"""Locks of folders and files: one holder, named to others, none after its process has been killed."""

import errno
import json
import os
import platform
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from scenic.batch.folders import lock
from scenic.batch.folders.lock import BusyError, Lock, lock_beside
from scenic.language.errors import ScenicWarning

HOLDER = """
import os, sys, time
from pathlib import Path
from scenic.batch.folders.lock import Lock
with Lock(Path(sys.argv[1]), Path("target")):
    if os.fork() == 0:
        print("held", flush=True)
        time.sleep(60)  # a worker that outlives its parent
        os._exit(0)
    time.sleep(60)
"""


def test_a_second_holder_is_told_who_the_first_is(tmp_path: Path) -> None:
    with Lock(tmp_path / "lock", tmp_path):
        holder = json.loads((tmp_path / "lock").read_text())
        assert holder["process"] == os.getpid()
        with pytest.raises(BusyError, match=f"process {os.getpid()} on .*, since {holder['started'][:10]}"):
            Lock(tmp_path / "lock", tmp_path).__enter__()
    assert not (tmp_path / "lock").exists()
    with Lock(tmp_path / "lock", tmp_path):
        pass


def test_names_of_one_file_share_a_lock(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "scenes.jsonl")
    with lock_beside(tmp_path / "scenes.jsonl"), pytest.raises(BusyError):
        lock_beside(tmp_path / "link").__enter__()


def test_an_old_file_of_a_holder_locks_nothing(tmp_path: Path) -> None:
    (tmp_path / "lock").write_text('{"host": "elsewhere", "process": 1, "started": "2020"}')
    with Lock(tmp_path / "lock", tmp_path):
        assert json.loads((tmp_path / "lock").read_text())["process"] == os.getpid()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_killed_process_leaves_no_lock_though_its_children_live(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path / "lock")], stdout=subprocess.PIPE, start_new_session=True
    )
    assert process.stdout is not None
    try:
        process.stdout.readline()
        with pytest.raises(BusyError, match=f"process {process.pid} "):
            Lock(tmp_path / "lock", tmp_path).__enter__()
        process.kill()
        process.wait()
        with Lock(tmp_path / "lock", tmp_path):
            pass
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.stdout.close()


def test_another_machine_that_holds_the_lock_is_named(tmp_path: Path) -> None:
    """A network file system refuses the lock, and shows the file that the other machine has written."""
    with Lock(tmp_path / "lock", tmp_path / "target"):
        (tmp_path / "lock").write_text('{"host": "node7", "process": 12, "started": "2026-11-29T01:02:03"}')
        with pytest.raises(BusyError, match="process 12 on node7, since 2026-11-29T01:02:03") as refusal:
            Lock(tmp_path / "lock", tmp_path / "target").__enter__()
        assert "go on by --resume; or name another place" in str(refusal.value.help)


@pytest.mark.parametrize(
    ("host", "is_alive", "is_refused"), [("node7", False, True), (None, True, True), (None, False, False)]
)
def test_without_locks_the_file_decides(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, host: str | None, is_alive: bool, is_refused: bool
) -> None:
    """A holder on another machine counts as alive until the file is removed; one on this machine is looked for."""

    def no_lock(_descriptor: int) -> None:
        raise OSError(errno.ENOLCK, "no locks available")

    monkeypatch.setattr(lock, "_lock", no_lock)
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    holder: dict[str, Any] = {"host": host or platform.node(), "started": "2026-11-29T01:02:03"}
    holder["process"] = os.getppid() if is_alive else ended.pid
    (tmp_path / "lock").write_text(json.dumps(holder))
    if not is_refused:
        with pytest.warns(ScenicWarning, match="has no locks"), Lock(tmp_path / "lock", tmp_path):
            pass
        return
    with pytest.raises(BusyError, match=f"process {holder['process']} on {holder['host']}") as refusal:
        Lock(tmp_path / "lock", tmp_path).__enter__()
    remedy = str(refusal.value.help).rpartition("remove ")[2].strip("'")
    Path(remedy).unlink()
    with pytest.warns(ScenicWarning, match="has no locks"), Lock(tmp_path / "lock", tmp_path):
        pass
