"""A page that draws new scenes whenever a program is saved, with what rejects candidates beside them.

The page is served to this machine alone, at an address with a secret. **The program runs whenever it changes**: in a
process of its own, within the limits of `scenic.ide.running`.
"""

import json
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from pathlib import Path
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.ide.running import RunError, analysis_text, sample_page

__all__ = ["PageState", "WatchedProgram", "served"]

_INTERVAL: Final = 0.3
"""Seconds between two looks at the files."""


@dataclass(frozen=True, slots=True)
class PageState:
    """State of the page besides the scenes; ``version`` grows whenever a part of it changes."""

    program: str
    version: int = 0
    seed: int = 0
    busy: bool = True
    problem: str = ""
    report: str = ""


class WatchedProgram:
    """Follows a program, and samples it again when it or a module beside it is saved.

    Args:
        path: the program.
        count: how many scenes are shown.
        seed: of the first scenes; `draw_again` takes the next ones.

    """

    def __init__(self, path: Path, *, count: int = 4, seed: int = 0) -> None:
        self._path = path
        self._count = count
        self._seen = self._stamp()
        self._wanted = threading.Event()
        self._ended = threading.Event()
        self.view = PageState(path.name, seed=seed)
        self.page = ""

    def _stamp(self) -> tuple[tuple[str, int], ...]:
        """Names and times of the program and of modules beside it."""
        found = []
        for path in sorted(self._path.parent.iterdir()):
            if path.suffix in {".scenic", ".sc", ".py"}:
                try:
                    found.append((path.name, path.stat().st_mtime_ns))
                except OSError:
                    continue  # it is being replaced
        return tuple(found)

    def draw_again(self) -> None:
        """Draw scenes of the next seed."""
        self._wanted.set()

    def end(self) -> None:
        """Let `follow` return."""
        self._ended.set()
        self._wanted.set()

    def follow(self) -> None:
        """Sample at once, and again after each change, until `end`."""
        self.refresh()
        while not self._ended.is_set():
            self._wanted.wait(_INTERVAL)
            stamp = self._stamp()
            is_requested = self._wanted.is_set()
            if (stamp != self._seen or is_requested) and not self._ended.is_set():
                self._wanted.clear()
                self._seen = stamp
                self.refresh(seed=self.view.seed + is_requested)

    def refresh(self, seed: int | None = None) -> None:
        """Run the program: first its scenes, then the report of what it costs. Only one thread may do this."""
        self._set(busy=True, seed=self.view.seed if seed is None else seed)
        problem = report = ""
        try:
            text = self._path.read_text(encoding="utf-8")
            self.page = sample_page(
                text, str(self._path), seed=self.view.seed, count=self._count, go_on=self._go_on
            )
        except (OSError, UnicodeDecodeError) as error:
            problem = f"the program cannot be read: {error}"
        except RunError as error:
            problem = str(error)
        self._set(busy=True, problem=problem)
        if not self._ended.is_set():
            try:
                report = analysis_text(str(self._path), go_on=self._go_on)
            except RunError:
                report = ""  # what is wrong has been told of
        self._set(busy=False, report=report)

    def _go_on(self) -> None:
        if self._ended.is_set():
            raise RunError("ended")

    def _set(self, **changes: Any) -> None:
        self.view = PageState(**{**asdict(self.view), **changes, "version": self.view.version + 1})


@contextmanager
def served(watch: WatchedProgram, port: int = 0) -> Iterator[str]:
    """Serve the page of a watch, and follow its program, while the context lasts; gives the address."""
    secret = secrets.token_urlsafe(16)
    server = ThreadingHTTPServer(("127.0.0.1", port), _handler(watch, f"/{secret}/"))
    threads = [
        threading.Thread(target=server.serve_forever, daemon=True),
        threading.Thread(target=watch.follow, daemon=True),
    ]
    for thread in threads:
        thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}/{secret}/"
    finally:
        watch.end()
        server.shutdown()
        server.server_close()
        threads[1].join()


def _handler(watch: WatchedProgram, root: str) -> type[BaseHTTPRequestHandler]:
    frame = resources.files("scenic.playground").joinpath("watch.html").read_text(encoding="utf-8")

    class Handler(BaseHTTPRequestHandler):
        """Answers requests below the secret address."""

        def do_GET(self) -> None:
            """The page, its state, or the scenes."""
            match self.path.partition("?")[0].removeprefix(root) if self.path.startswith(root) else None:
                case "":
                    self._answer("text/html", frame)
                case "state":
                    self._answer("application/json", json.dumps(asdict(watch.view)))
                case "scenes":
                    self._answer("text/html", watch.page)
                case _:
                    self.send_error(404)

        def do_POST(self) -> None:
            """Draw again."""
            if self.path != f"{root}again":
                self.send_error(404)
                return
            watch.draw_again()
            self._answer("application/json", "{}")

        def _answer(self, kind: str, text: str) -> None:
            content = text.encode()
            self.send_response(200)
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(content)))
            self.send_header("Cache-Control", "no-store")
            self.send_header("Referrer-Policy", "no-referrer")
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, format: str, *args: Any) -> None:
            """Say nothing on the terminal."""

    return Handler
