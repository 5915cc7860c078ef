"""Long runs: a fixed short one of the real thing, and what becomes of failures."""

import ast
import math
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from fuzz import __main__ as command
from fuzz import corpus, workers
from fuzz.draws import RandomDraws, replayed
from fuzz.grammar import Program, make_program, programs
from fuzz.properties import OF_PROGRAMS, OF_TEXTS, Case, Property, Violation
from fuzz.session import Report, run_round
from fuzz.temporal import OF_FORMULAS
from scenic.compiler import tree as scenic
from tests.amounts import amount


def test_the_front_end_withstands_a_short_run():
    report = Report()
    run_round(report, seed_of_round=0, until=math.inf, programs=60, mutants=30)
    assert not report.failures, "\n\n".join(
        f"{failure.signature}\n{failure.text!r}\n{failure.reason}" for failure in report.failures
    )
    assert (report.programs, report.mutants, report.formulas) == (60, 30, 20)
    # Most programs are such that they reach the end of the compiler.
    assert report.sound > 0.6 * report.programs


@dataclass(frozen=True)
class _Made:
    original: str


@pytest.mark.parametrize("entry", list(corpus.entries()), ids=lambda entry: entry.path.name)
def test_what_once_failed_is_right_now(entry: corpus.Entry):
    case = Case(entry.text, None if entry.original is None else _Made(entry.original), thorough=True)
    for each in OF_PROGRAMS if entry.of_grammar else OF_TEXTS:
        each.holds(case)
    for each in OF_FORMULAS if entry.of_formulas else ():
        each.holds(case)


def division(case: Case) -> None:
    for node in ast.walk(case.result.tree):
        if isinstance(node, ast.Div):
            raise ZeroDivisionError


def compose_block(case: Case) -> None:
    for node in ast.walk(case.result.tree):
        if isinstance(node, scenic.ScenarioDef) and node.compose:
            raise Violation("there is a compose block")


def gap(case: Case) -> None:
    if any(isinstance(node, scenic.ErrorStatement) for node in ast.walk(case.result.tree)):
        raise Violation("there is a gap")


PLANTED = tuple(map(Property.of, (division, compose_block)))


@cache
def planted_run() -> Report:
    report = Report()
    run_round(
        report,
        seed_of_round=1,
        until=math.inf,
        programs=50,
        mutants=20,
        formulas=0,
        of_programs=PLANTED,
        of_texts=(Property.of(gap),),
    )
    return report


@pytest.mark.slow
def test_failures_are_shrunk_to_small_programs_and_each_is_reported_once():
    report = planted_run()
    lengths = {failure.signature.property: len(failure.text) for failure in report.failures}
    assert len(lengths) == len(report.failures)
    assert lengths["division"] <= 60
    assert lengths["compose_block"] <= 100
    assert lengths["gap"] <= 80
    assert sum(report.repeated.values()) > 0
    for failure in report.failures:
        assert failure.reason
        assert failure.seed == 1
        assert failure.of_grammar == (failure.mutant is None) == (failure.signature.property != "gap")


def test_a_run_ends_when_its_time_is_over():
    report = Report()
    run_round(report, seed_of_round=0, until=time.monotonic() - 1)
    assert report.programs == report.mutants == 0
    assert not report.failures


@pytest.mark.parametrize("seed", range(amount(4, 8)))
def test_what_was_made_from_random_numbers_is_made_again_from_them(seed: int):
    draws = RandomDraws(seed)
    program = make_program(draws)
    texts: list[str] = []

    @settings(
        database=replayed(draws.choices),
        phases=(Phase.reuse,),
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(programs())
    def check(again: Program) -> None:
        texts.append(again.text)

    check()
    assert texts == [program.text]


def test_the_command_reports_and_succeeds(capsys: pytest.CaptureFixture[str]):
    assert command.main(["--programs", "30", "--mutants", "11", "--seed", "5", "--jobs", "0"]) == 0
    output = capsys.readouterr().out
    assert "with seed 5" in output
    assert "30 programs" in output
    assert ", 11 mutants and 20 formulas" in output
    assert "alternatives of Scenic's rules" in output
    assert "0 failures; seed 5" in output


def test_too_little_coverage_can_be_a_failure(capsys: pytest.CaptureFixture[str]):
    assert command.main(["--programs", "3", "--seed", "5", "--jobs", "0", "--require-coverage"]) == 1
    assert "the coverage falls short" in capsys.readouterr().out


@pytest.mark.slow
def test_the_command_shows_failures_and_saves_them(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    def one_round(report: Report, **_options: object) -> None:
        report.failures += planted_run().failures

    monkeypatch.setattr(workers, "run_round", one_round)
    monkeypatch.setattr(command.corpus, "FOLDER", tmp_path)
    assert command.main(["--seed", "0", "--programs", "1", "--jobs", "0"]) == 1
    output = capsys.readouterr().out
    monkeypatch.setattr(command, "_property_names", lambda text: frozenset(text.split(",")))
    tolerant = ["--tolerate", ",".join({failure.signature.property for failure in planted_run().failures})]
    assert command.main(["--seed", "0", "--programs", "1", "--jobs", "0", *tolerant]) == 0
    assert "FAILED gap" in output
    assert "(seed 1)" in output
    found = list(corpus.entries(tmp_path))
    assert sum(entry.of_grammar for entry in found) == len(found) - 1 >= 2
    for entry in found:
        assert f"    | {entry.text.splitlines()[0]}\n" in output


@pytest.mark.slow
def test_workers_share_the_work(capsys: pytest.CaptureFixture[str]):
    assert command.main(["--programs", "6", "--mutants", "4", "--seed", "5", "--jobs", "2", "--no-save"]) == 0
    output = capsys.readouterr().out
    assert "2 workers" in output
    assert "6 programs" in output
    assert " 4 mutants" in output


def test_properties_can_be_chosen(capsys: pytest.CaptureFixture[str]):
    chosen = ["--only", "parsing_gives_a_tree,programs_are_accepted"]
    assert command.main(["--programs", "3", "--mutants", "2", "--seed", "5", "--jobs", "0", *chosen]) == 0
    output = capsys.readouterr().out
    assert "parsing_gives_a_tree" in output
    assert "formatted_texts_read_the_same" not in output
    assert " 0 formulas" in output
    with pytest.raises(SystemExit):
        command.main(["--only", "parsing"])
    assert "there is no property 'parsing'" in capsys.readouterr().err


def test_a_budget_is_shared_among_the_rounds():
    budget = workers.Budget(seed=0, programs=450, mutants=10)
    sizes = [budget.round(number) for number in range(4)]
    assert sizes == [(150, 3), (150, 3), (150, 4), None]
    assert workers.Budget(seed=0).round(10**6) is not None


def saved(folder: Path, text: str, name: str, of_grammar: bool) -> Path:
    return corpus.save(text, name, of_grammar=of_grammar, folder=folder)


def test_the_corpus_holds_the_program_that_a_text_was_made_from(tmp_path: Path):
    path = corpus.save("x +", "some_property", of_grammar=False, original="x + \ud800", folder=tmp_path)
    assert list(corpus.entries(tmp_path)) == [corpus.Entry(path, "x +", False, False, "x + \ud800")]


def test_the_corpus_holds_any_text(tmp_path: Path):
    texts = ["x\r\n\0", "\ud800", "é\n"]
    for text in texts:
        saved(tmp_path, text, "some_property", False)
    assert sorted(entry.text for entry in corpus.entries(tmp_path)) == sorted(texts)
    assert all(
        not entry.of_grammar and entry.path.name.startswith("text-some_property-")
        for entry in corpus.entries(tmp_path)
    )


def test_there_cannot_be_fewer_workers_than_none(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as ended:
        command.main(["--jobs", "-1"])
    assert ended.value.code == 2
    assert "it cannot be negative" in capsys.readouterr().err
