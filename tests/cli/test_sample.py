import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import pytest
from click.testing import CliRunner, Result
from hypothesis import given
from hypothesis import strategies as st

from scenic.cli.options import parameter_value
from scenic.cli.sample import sample
from scenic.cli.sinks import OutputChoiceError
from scenic.formats.files import OutputError
from scenic.language.errors import Located
from scenic.language.spans import Span
from scenic.runtime.sampling.rejection_report import Exhausted, RejectionReport, RejectionRow
from tests.formats.stand_ins import Object, Scene

ROWS = (
    RejectionRow("requirement on line 9", Span(9, 0, 9, 5), 0.25, 0.125),
    RejectionRow("collision of a and b", None, 1.0, 0.75),
)


def test_a_small_program_imports_only_what_it_uses(tmp_path: Path) -> None:
    program = tmp_path / "small.scenic"
    program.write_text(
        "ego = new Object at (Range(0, 1), 0), facing 30 deg\nnew Object at (5, Range(5, 6))\n"
    )
    code = (
        "import sys; from scenic.cli.main import scenic\n"
        "scenic.main(['sample', sys.argv[1], '-n', '1', '--seed', '1'], standalone_mode=False)\n"
        "print(*sys.modules, file=sys.stderr)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, str(program)], capture_output=True, text=True, check=True
    )
    loaded = set(result.stderr.split())
    assert len(json.loads(result.stdout)["objects"]) == 2
    assert "scenic.pipeline" in loaded
    for libraries in (
        {"scipy", "shapely", "trimesh", "manifold3d", "embreex", "fcl", "networkx", "PIL", "rich", "z3"},
        {"numpy.ma", "numpy.f2py", "numpy.testing"},
        {"asyncio", "concurrent.futures.process", "email", "logging", "multiprocessing", "tempfile", "bz2"},
        {"scenic.batch.datasets", "scenic.formats.render", "scenic.runtime.sampling.approximate"},
    ):
        assert not loaded & libraries


class Stub:
    """A pipeline whose scenes are made by hand; records what it was asked for."""

    def __init__(self) -> None:
        self.options: dict[str, Any] = {}
        self.digest = "0123"
        self.filename = "room.scenic"
        self.objects: list[Any] = []
        self.missing: set[int] = set()
        self.reason = "attempts"
        self.sampled = 0
        self.interrupt_at = -1
        self.approximation = None
        record = SimpleNamespace(files={}, imports={})
        tally = SimpleNamespace(scenes=0)
        self.program = SimpleNamespace(
            context=SimpleNamespace(record=record), settling=SimpleNamespace(tally=tally)
        )
        self.interrupt: Callable[[], None] = lambda: None

    def load(self, path: Path, **options: Any) -> "Stub":
        self.options.update(options, path=path)
        return self

    def stream(self, n: int, **options: Any) -> Iterator[Scene | Exhausted]:
        self.options.update(options)
        for k in range(n):
            self.sampled += 1
            if k == self.interrupt_at:
                self.interrupt()
            if k in self.missing:
                yield Exhausted(options["seed"], k, 1000, self.reason, RejectionReport(200, ROWS))
            else:
                yield Scene([Object()], seed=options["seed"], k=k)


@pytest.fixture
def stub(monkeypatch: pytest.MonkeyPatch) -> Stub:
    made = Stub()
    monkeypatch.setitem(sys.modules, "scenic.pipeline", SimpleNamespace(load=made.load))
    return made


def run(*arguments: object) -> Result:
    return CliRunner().invoke(sample, ["room.scenic", *map(str, arguments)], standalone_mode=False)


def lines(text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in text.splitlines()]


def test_scenes_go_to_standard_output(stub: Stub) -> None:
    result = run("-n", 3, "--seed", 5)
    assert result.return_value == 0
    assert [(row["seed"], row["k"]) for row in lines(result.stdout)] == [(5, 0), (5, 1), (5, 2)]
    assert result.stderr == ""


def test_options_reach_the_pipeline(stub: Stub) -> None:
    given = (
        "--seed -3 -p a=5 -p b=x=y --param c= --scenario Main --model m.n --2d --no-prune --max-attempts 7"
    )
    run(*given.split(), "--time-limit", "2.5")
    # The limit covers loading the program too.
    assert 1.5 < stub.options.pop("time_limit") <= 2.5
    assert stub.options == {
        "path": Path("room.scenic"),
        "first": 0,
        "seed": -3,
        "params": {"a": 5, "b": "x=y", "c": ""},
        "approximate": None,
        "scenario": "Main",
        "model": "m.n",
        "mode2D": True,
        "prune": False,
        "extra_params": False,
        "settle": None,
        "settle_tolerance": 0.01,
        "settle_keep": False,
        "max_attempts": 7,
        "source": None,
    }


def test_without_options(stub: Stub) -> None:
    run()
    assert (stub.options["prune"], stub.options["mode2D"], stub.options["params"]) == (True, False, {})
    assert (stub.options["max_attempts"], stub.options["time_limit"]) == (None, None)


def test_a_drawn_seed_is_shown(stub: Stub) -> None:
    first, second = run(), run()
    (scene,) = lines(first.stdout)
    assert f"--seed {scene['seed']}" in first.stderr
    assert first.stderr != second.stderr


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", 5),
        ("-12", -12),
        ("+3", 3),
        ("0.5", 0.5),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e3", 1000.0),
        ("-2.5E-1", -0.25),
        ("true", True),
        ("False", False),
        ("", ""),
        ("five", "five"),
        ("1_000", "1_000"),
        (" 5", " 5"),
        ("nan", "nan"),
        ("5 m", "5 m"),
        ("٣", 3),
        ('"5"', "5"),
        ('"a', '"a'),
        ('"', '"'),
        ('"a"b"', '"a"b"'),
        ("None", "None"),
    ],
)
def test_parameter_values(text: str, value: object) -> None:
    found = parameter_value(text)
    assert (found, type(found)) == (value, type(value))


@given(st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.booleans())
def test_parameter_values_of_python_come_back(value: object) -> None:
    assert parameter_value(str(value)) == value


@given(st.text())
def test_any_text_is_a_parameter_value(text: str) -> None:
    assert parameter_value(json.dumps(text)) == text
    assert isinstance(parameter_value(text), int | float | str)


@pytest.mark.parametrize(
    "arguments",
    [
        ["-n", "0"],
        ["-n", "-1"],
        ["-n", "many"],
        ["--max-attempts", "0"],
        ["--time-limit", "0"],
        ["--time-limit", "nan"],
        ["--time-limit", "inf"],
        ["-p", "novalue"],
        ["-p", "=5"],
        ["--seed", "x"],
        ["--unknown"],
    ],
)
def test_wrong_usage(stub: Stub, arguments: list[str]) -> None:
    result = CliRunner().invoke(sample, ["room.scenic", *arguments])
    assert result.exit_code == 2
    assert stub.sampled == 0
    assert result.stdout == ""


def test_json_lines_to_a_file(stub: Stub, tmp_path: Path) -> None:
    result = run("-n", 2, "-o", tmp_path / "out.jsonl", "--seed", 1)
    assert result.stdout == ""
    assert [row["k"] for row in lines((tmp_path / "out.jsonl").read_text())] == [0, 1]


@pytest.mark.parametrize(
    ("options", "last"),
    [
        (("-n", 3, "-o", "{}/room.glb"), "room-002.glb"),
        (("-n", 3, "--first", 8, "-o", "{}/room.obj"), "room-010.obj"),
        (("-n", 2, "--png", "{}/room.png"), "room-001.png"),
        (("-n", 2, "--first", 1, "--png", "{}"), "room-002.png"),
        (("-n", 1, "--first", 5, "--png", "{}"), "room.png"),
    ],
)
def test_the_last_of_several_files_is_looked_at_before_anything_is_sampled(
    stub: Stub, tmp_path: Path, options: tuple[object, ...], last: str
) -> None:
    (tmp_path / last).mkdir()
    result = run(*(str(option).format(tmp_path) for option in options))
    assert isinstance(result.exception, OutputError)
    assert last in str(result.exception)
    assert stub.sampled == 0
    assert os.listdir(tmp_path) == [last]


def test_one_glb_or_several(stub: Stub, tmp_path: Path) -> None:
    run("-o", tmp_path / "room.glb")
    run("-n", 2, "-o", tmp_path / "rooms.GLB")
    assert sorted(os.listdir(tmp_path)) == ["room.glb", "rooms-000.GLB", "rooms-001.GLB"]
    assert (tmp_path / "room.glb").read_bytes()[:4] == b"glTF"


def test_a_page_and_images(stub: Stub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenic.formats.png.png", lambda scene, *_: b"image %d" % scene.k)
    result = run(
        "-n", 2, "--view", tmp_path / "page.html", "--png", tmp_path / "images", "-o", "-", "--seed", 1
    )
    assert len(lines(result.stdout)) == 2
    assert "<title>room.scenic</title>" in (tmp_path / "page.html").read_text()
    assert sorted(os.listdir(tmp_path / "images")) == ["room-000.png", "room-001.png"]
    run("--png", tmp_path / "one.png")
    assert (tmp_path / "one.png").read_bytes() == b"image 0"
    assert run("--png", tmp_path / "one.png").stdout == ""


@pytest.mark.parametrize("option", ["-o", "--view", "--png"])
def test_outputs_are_checked_before_sampling(stub: Stub, tmp_path: Path, option: str) -> None:
    result = run(option, tmp_path / "missing" / "folder" / ("out.jsonl" if option == "-o" else "out.x"))
    assert isinstance(result.exception, OutputError)
    assert stub.options == {}
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "help"),
    [("a.xyz", ".jsonl"), ("a.png", "--png"), ("a.html", "--view"), ("a.gltf", ".glb"), ("a.STL", ".glb")],
)
def test_other_formats_are_refused(stub: Stub, tmp_path: Path, name: str, help: str) -> None:
    result = run("-o", tmp_path / name)
    assert isinstance(result.exception, Located)
    assert result.exception.code == "SC604"
    assert help in (result.exception.help or "")
    assert stub.options == {}


@pytest.mark.parametrize("name", ["a.png", "a.PNG", "a.jsonl", "a.glb"])
def test_a_page_is_no_other_format(stub: Stub, tmp_path: Path, name: str) -> None:
    result = run("--view", tmp_path / name)
    assert isinstance(result.exception, OutputChoiceError)
    assert "ends in .html" in (result.exception.help or "")
    assert stub.options == {}
    assert os.listdir(tmp_path) == []


def test_scenes_not_found_are_reported_and_the_others_written(stub: Stub, tmp_path: Path) -> None:
    stub.missing = {1, 3, 4}
    result = run("-n", 6, "--seed", 1, "--view", tmp_path / "page.html", "-o", "-")
    assert result.return_value == 3
    assert [row["k"] for row in lines(result.stdout)] == [0, 2, 5]
    assert (
        "3 scenes were not found (k = 1, 3-4): none of 1000 candidates met every requirement" in result.stderr
    )
    assert "collision of a and b rejected every candidate" in result.stderr
    table = [line for line in result.stderr.splitlines() if "%" in line]
    assert [part in line for line in table for part in ("100.0%", "75.0%")] == [True, True, False, False]
    assert "requirement on line 9" in table[1]
    assert (tmp_path / "page.html").exists()


def test_no_page_without_a_scene(stub: Stub, tmp_path: Path) -> None:
    stub.missing, stub.reason = {0}, "time"
    result = run("--view", tmp_path / "page.html", "--seed", 1)
    assert result.return_value == 3
    assert "scene 0 was not found: the time limit was reached" in result.stderr
    assert os.listdir(tmp_path) == []


def raise_interrupt() -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("interrupt", [raise_interrupt, lambda: os.kill(os.getpid(), signal.SIGTERM)])
@pytest.mark.parametrize("is_new", [False, True])
def test_an_interrupted_run_keeps_its_whole_lines(
    stub: Stub, tmp_path: Path, interrupt: Callable[[], None], is_new: bool
) -> None:
    before = signal.getsignal(signal.SIGTERM)
    if not is_new:
        (tmp_path / "out.jsonl").write_text("old")
    stub.interrupt_at, stub.interrupt = 2, interrupt
    result = run("-n", 5, "-o", tmp_path / "out.jsonl", "--view", tmp_path / "page.html")
    assert isinstance(result.exception, click.Abort | SystemExit)
    if interrupt is raise_interrupt:
        assert "2 of 5 kept" in result.stderr
        assert "continue with --resume" in result.stderr
    kept = tmp_path / "out.jsonl.part"
    assert [row["k"] for row in lines(kept.read_text())] == [0, 1]
    if not is_new:
        # What was there before is replaced only by a run that is complete.
        assert (tmp_path / "out.jsonl").read_text() == "old"
    assert len(os.listdir(tmp_path)) == 2 - is_new
    assert signal.getsignal(signal.SIGTERM) is before


def test_an_interrupt_before_the_first_scene_leaves_nothing(stub: Stub, tmp_path: Path) -> None:
    stub.interrupt_at, stub.interrupt = 0, raise_interrupt
    run("-n", 5, "-o", tmp_path / "out.jsonl")
    assert os.listdir(tmp_path) == []


def test_what_was_streamed_before_an_interrupt_stays(stub: Stub) -> None:
    stub.interrupt_at, stub.interrupt = 2, raise_interrupt
    assert [row["k"] for row in lines(run("-n", 5, "--seed", 1).stdout)] == [0, 1]


def test_help_names_the_exit_codes() -> None:
    text = CliRunner().invoke(sample, ["--help"]).stdout
    for code in ("0 success", "2 wrong usage", "3 some scenes", "130 interrupted"):
        assert code in " ".join(text.split())
