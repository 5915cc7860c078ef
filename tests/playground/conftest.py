"""A playground in a process of its own, as the command starts it."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from scenic.playground.server import is_built


@pytest.fixture(scope="session")
def playground() -> Callable[..., object]:
    if not is_built():
        pytest.skip("the page is not built: run `make playground`, which needs npm")

    @contextmanager
    def start(*arguments: str | Path) -> Iterator[str]:
        command = [
            sys.executable,
            "-m",
            "scenic.cli.main",
            "playground",
            "--no-browser",
            *map(str, arguments),
        ]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"}
        ) as process:
            try:
                assert process.stdout is not None
                yield process.stdout.readline().split()[1]
            finally:
                process.terminate()
                process.wait(20)

    return start
