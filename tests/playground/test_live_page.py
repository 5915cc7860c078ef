"""The page that follows a program: what it serves, and when it runs the program."""

import json
import os
import time
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import pytest

from scenic.ide.running import RunError
from scenic.playground import live_page
from scenic.playground.live_page import WatchedProgram, served


def fetched(address: str, *, post: bool = False) -> str:
    request = urllib.request.Request(address, data=b"" if post else None)
    with urllib.request.urlopen(request, timeout=20) as answer:
        return str(answer.read().decode())


def settled(address: str, seed: int, *, after: int = 0) -> dict[str, Any]:
    """The state once the program has run."""
    for _ in range(400):
        state: dict[str, Any] = json.loads(fetched(f"{address}state"))
        if not state["busy"] and state["seed"] == seed and state["version"] > after:
            return state
        time.sleep(0.05)
    raise AssertionError("the program was never run")


def test_scenes_and_report_follow_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def sampled(text: str, filename: str, *, seed: int, count: int, go_on: Any) -> str:
        if "wrong" in text:
            raise RunError("error[SC202]: wrong")
        return f"{text} of seed {seed}, {count} scenes"

    monkeypatch.setattr(live_page, "sample_page", sampled)
    monkeypatch.setattr(live_page, "analysis_text", lambda filename, go_on: "what it costs")
    program = tmp_path / "room.scenic"
    program.write_text("first")
    with served(WatchedProgram(program, count=3)) as address:
        first = settled(address, 0)
        assert (first["problem"], first["report"], first["program"]) == ("", "what it costs", "room.scenic")
        assert fetched(f"{address}scenes") == "first of seed 0, 3 scenes"
        assert "<iframe" in fetched(address)
        fetched(f"{address}again", post=True)
        again = settled(address, 1)
        assert fetched(f"{address}scenes") == "first of seed 1, 3 scenes"
        program.write_text("wrong")
        os.utime(program, ns=(1, 1))
        wrong = settled(address, 1, after=again["version"])
        assert wrong["problem"] == "error[SC202]: wrong"
        assert fetched(f"{address}scenes") == "first of seed 1, 3 scenes"  # the last ones stay
        (tmp_path / "module.py").write_text("x = 1")
        assert settled(address, 1, after=wrong["version"])["problem"]
        for other in (address.rsplit("/", 2)[0] + "/state", f"{address}secret"):
            with pytest.raises(urllib.error.HTTPError):
                fetched(other)


def test_a_real_program_is_run(tmp_path: Path) -> None:
    program = tmp_path / "room.scenic"
    program.write_text("ego = new Object at (Range(0, 1), 0)\nrequire ego.position.x ** 2 > 0.5\n")
    watch = WatchedProgram(program, count=2)
    watch.refresh()
    assert watch.view.problem == ""
    assert "<title>room.scenic</title>" in watch.page
    assert "candidates a scene" in watch.view.report
