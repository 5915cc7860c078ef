"""Running a program at its user's request: in a process of its own, within limits on time and size."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import IO, Final

from scenic.ide.remarks import Remarks

__all__ = ["RunError", "analysis_text", "run_remarks", "sample_page", "simulation_page"]

TIME_LIMIT: Final = 20.0
"""Seconds in which scenes must be found."""
_START: Final = 15.0
"""Seconds that the process may take besides, to begin and to write."""
_LARGEST: Final = 64 << 20
_LONGEST: Final = 1 << 20
"""Bytes of a message that are shown."""
_INTERVAL: Final = 0.02
_PARTIAL: Final = 3
"""The exit code of commands that did not find all scenes."""


class RunError(Exception):
    """The reason why there is no page: the errors of the program, or the limit that it exceeded.

    ``is_rejected`` tells that the program is right, but no scene was found within the limits.
    """

    def __init__(self, reason: str, *, is_rejected: bool = False) -> None:
        super().__init__(reason)
        self.is_rejected = is_rejected


def sample_page(
    text: str,
    filename: str,
    *,
    scenario: str | None = None,
    seed: int = 0,
    count: int = 1,
    go_on: Callable[[], None] = lambda: None,
) -> str:
    """Return a page that shows scenes of a program. **Runs the program.**

    ``text`` is the program as it stands in the editor, ``filename`` where it belongs: modules are found beside it.
    ``go_on`` is called now and then, and may raise to give up. Raises `RunError` if there is no scene to show.
    """
    command = ["preview", "--filename", filename, "--seed", str(seed), "-n", str(count)]
    command += ["--time-limit", str(TIME_LIMIT), *_chosen(scenario)]
    return _run(command, text, os.path.dirname(filename), None, go_on)


def simulation_page(
    filename: str,
    *,
    scenario: str | None = None,
    seed: int = 0,
    steps: int = 100,
    go_on: Callable[[], None] = lambda: None,
) -> str:
    """Return a page that plays a simulation of the program in a file. **Runs the program**, as it stands on the disk.

    The rest is as for `sample_page`.
    """
    with tempfile.TemporaryDirectory() as folder:
        view = os.path.join(folder, "simulation.html")
        command = ["simulate", filename, "--view", view, "--seed", str(seed), "--time", str(steps)]
        return _run([*command, *_chosen(scenario)], "", os.path.dirname(filename), view, go_on)


def run_remarks(
    text: str, filename: str, *, scenario: str | None = None, go_on: Callable[[], None] = lambda: None
) -> Remarks:
    """Shares of requirements and narrowed ranges of a program. **Runs the program.** Arguments and errors as for `sample_page`."""
    command = ["preview", "--filename", filename, "--time-limit", str(TIME_LIMIT), "--remarks"]
    written = _run([*command, *_chosen(scenario)], text, os.path.dirname(filename), None, go_on)
    return Remarks(text, scenario, json.loads(written))


def analysis_text(filename: str, *, go_on: Callable[[], None] = lambda: None) -> str:
    """Describe what the program in a file costs to sample, and what rejects its candidates. **Runs the program.**

    Raises `RunError` as `sample_page` does.
    """
    return _run(["analyze", filename], "", os.path.dirname(filename), None, go_on)


def _chosen(scenario: str | None) -> list[str]:
    return [] if scenario is None else ["--scenario", scenario]


def _run(arguments: list[str], text: str, folder: str, view: str | None, go_on: Callable[[], None]) -> str:
    """Return the page that a command writes, to standard output or to the file ``view``."""
    # -P: a module in the present folder must not take the place of one of ours.
    command = [sys.executable, "-P", "-m", "scenic.cli.main", *arguments]
    with (
        tempfile.TemporaryFile() as input_file,
        tempfile.TemporaryFile() as page,
        tempfile.TemporaryFile() as error_file,
    ):
        input_file.write(text.encode("utf-8", "surrogatepass"))
        input_file.seek(0)
        process = subprocess.Popen(
            command,
            stdin=input_file,
            stdout=page,
            stderr=error_file,
            cwd=folder if os.path.isdir(folder) else None,
            start_new_session=True,
        )
        try:
            code = _wait(process, (page, error_file), go_on)
        finally:
            _end(process)
        if code == 0 and view is not None and os.path.exists(view):
            with open(view, "rb") as stream:
                return stream.read(_LARGEST).decode()
        if code != 0 or view is not None:
            error_file.seek(0)
            reason = error_file.read(_LONGEST).decode(errors="replace").strip()
            raise RunError(reason or f"the program ended with code {code}", is_rejected=code == _PARTIAL)
        page.seek(0)
        text_of_page = page.read(_LARGEST).decode()
        if not text_of_page.strip():
            raise RunError("the program ended the process before there was anything to show")
        return text_of_page


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a process with all that it has started."""
    if sys.platform == "win32":
        process.kill()
    else:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _wait(process: "subprocess.Popen[bytes]", outputs: Sequence[IO[bytes]], go_on: Callable[[], None]) -> int:
    end = time.monotonic() + TIME_LIMIT + _START
    while (code := process.poll()) is None:
        go_on()
        if any(os.fstat(each.fileno()).st_size > _LARGEST for each in outputs):
            raise RunError(f"the program writes more than {_LARGEST >> 20} MB")
        if time.monotonic() > end:
            raise RunError(f"the program took longer than {TIME_LIMIT + _START:.0f} seconds")
        time.sleep(_INTERVAL)
    return code
