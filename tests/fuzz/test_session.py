"""Long runs: a fixed short one of the real thing, and what becomes of failures."""

import math
import time
from pathlib import Path

import pytest

from fuzz import __main__ as command
from fuzz import corpus
from fuzz.grammar import Program, derivations, programs
from fuzz.properties import OF_PROGRAMS, OF_TEXTS, Case, Property, Violation
from fuzz.session import Report, run_round, search

ROUNDS = 4


def test_the_front_end_withstands_a_short_run():
    report = Report()
    for number in range(ROUNDS):
        run_round(report, seed_of_round=number, until=math.inf, examples=100)
    assert not report.failures, "\n\n".join(
        f"{failure.signature}\n{failure.text!r}\n{failure.reason}" for failure in report.failures
    )
    assert report.programs + report.mutants >= ROUNDS * 120
    assert len(report.missing) <= 0.35 * len(derivations().countable), report.missing


@pytest.mark.parametrize("entry", list(corpus.entries()), ids=lambda entry: entry.path.name)
def test_what_once_failed_is_right_now(entry: corpus.Entry):
    case = Case(entry.text)
    for each in OF_PROGRAMS if entry.of_grammar else OF_TEXTS:
        each.holds(case)


def no_lambda(case: Case) -> None:
    if "lambda" in case.text:
        raise Violation("there is a lambda")


def no_division(case: Case) -> None:
    if " / " in case.text:
        raise ZeroDivisionError


PLANTED = (Property("no_lambda", no_lambda), Property("no_division", no_division))


def search_planted(report: Report, seed: int, *, until: float = math.inf) -> None:
    def note(program: Program) -> str:
        report.programs += 1
        return program.text

    search(report, programs(), note, PLANTED, seed, until, 200)


def test_failures_are_shrunk_and_each_is_reported_once():
    report = Report()
    for seed in range(3):
        search_planted(report, seed)
    assert sorted(failure.signature[:2] for failure in report.failures) == [
        ("no_division", "ZeroDivisionError"),
        ("no_lambda", "Violation"),
    ]
    assert all(len(failure.text) <= 60 for failure in report.failures)
    assert all(failure.of_grammar and failure.reason for failure in report.failures)
    assert sum(report.repeated.values()) > 0


def test_a_run_ends_when_its_time_is_over():
    report = Report()
    search_planted(report, 0, until=time.monotonic() - 1)
    assert report.programs == 0
    assert not report.failures


def test_the_command_reports_and_succeeds(capsys: pytest.CaptureFixture[str]):
    assert command.main(["--seconds", "0.3", "--seed", "5"]) == 0
    output = capsys.readouterr().out
    assert "with seed 5" in output
    assert "alternatives of the grammar" in output
    assert "0 failures; seed 5" in output


def test_the_command_shows_failures_and_saves_them(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    def one_round(report: Report, *, seed_of_round: int, **_options: object) -> None:
        search_planted(report, seed_of_round)

    monkeypatch.setattr(command, "run_round", one_round)
    monkeypatch.setattr(command.corpus, "FOLDER", tmp_path)
    assert command.main(["--seed", "0", "--rounds", "1"]) == 1
    output = capsys.readouterr().out
    assert "FAILED no_" in output
    assert "(seed 0)" in output
    [entry] = corpus.entries(tmp_path)
    assert f"    | {entry.text.strip()}\n" in output
    assert entry.of_grammar


def saved(folder: Path, text: str, name: str, of_grammar: bool) -> Path:
    return corpus.save(text, name, of_grammar=of_grammar, folder=folder)


def test_the_corpus_holds_any_text(tmp_path: Path):
    texts = ["x\r\n\0", "\ud800", "é\n"]
    for text in texts:
        saved(tmp_path, text, "some_property", False)
    assert sorted(entry.text for entry in corpus.entries(tmp_path)) == sorted(texts)
    assert all(
        not entry.of_grammar and entry.path.name.startswith("text-some_property-")
        for entry in corpus.entries(tmp_path)
    )
