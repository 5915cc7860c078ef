"""Workers: what becomes of one whose interpreter crashes."""

import os

import pytest

from fuzz import __main__ as command
from fuzz import corpus, workers
from fuzz.workers import Budget, Slate, WorkerDied


@pytest.mark.parametrize("text", ["", "x\0y\n", "\ud800", "𝐱" * 10])
def test_a_slate_holds_any_text(text: str):
    slate = Slate(bytearray(1 << 10))
    slate.write("before " * 20)
    slate.write(text)
    assert slate.read() == text


def test_a_slate_holds_the_beginning_of_a_long_text():
    slate = Slate(bytearray(1 << 10))
    slate.write("𝐱" * 1000)
    assert set(slate.read()) == {"𝐱"}


def test_a_dead_worker_is_shown_and_its_text_saved(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: os.PathLike[str]
):
    dead = WorkerDied(1, -6, 77, text="terminate after x seconds\n", again=True)
    gone = WorkerDied(0, -9, 78, text="pass\n")
    monkeypatch.setattr(command.corpus, "FOLDER", tmp_path)
    monkeypatch.setattr(command, "run", lambda *_, **__: (workers.Report(), (dead, gone)))
    assert command.main(["--programs", "1", "--seed", "0"]) == 1
    output = capsys.readouterr().out
    assert ": worker 1 died with exit code -6 in the round with seed 77" in output
    assert "    | terminate after x seconds\n" in output
    assert "2 failures; seed 0" in output
    # The other one was ended from outside, perhaps: its text does no harm.
    assert [entry.text for entry in corpus.entries(tmp_path)] == ["terminate after x seconds\n"]


@pytest.mark.slow
def test_one_worker_does_what_none_does():
    budget = Budget(seed=3, programs=4, mutants=2)
    reports = []
    for jobs in (0, 1):
        report, died = workers.run(budget, jobs=jobs, on_failure=lambda _failure: None)
        assert not died
        reports.append(report)
    alone, other = reports
    assert (alone.programs, alone.mutants, alone.formulas) == (other.programs, other.mutants, other.formulas)
    assert (alone.tokens, alone.coverage.covered) == (other.tokens, other.coverage.covered)
