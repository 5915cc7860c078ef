"""What coverage-guided fuzzing runs, without that which guides it."""

import importlib.util
import re
import time

import pytest

from fuzz import guided
from fuzz.guided import Progress
from fuzz.properties import Case, Property, Violation
from fuzz.target import Finding, Mutator, Target, dictionary, seeds, text_of
from scenic.compiler.generated import WORDS


def test_any_bytes_are_tried():
    found: list[Finding] = []
    run = Target(found.append)
    for data in (
        b"",
        b"x = 1\n",
        b"\xff\xfe\0(",
        "\ud800 é".encode("utf-8", "surrogatepass"),
        b"new C at\r\n x [",
    ):
        run(data)
    assert not found
    assert run.tried == 5
    assert run.checks >= 5


def test_bytes_are_read_as_those_of_the_corpus():
    assert text_of("\ud800 é\n".encode("utf-8", "surrogatepass")) == "\ud800 é\n"
    assert text_of(b"a\xff") == "a\ufffd"


def no_lambda(case: Case) -> None:
    if "lambda" in case.text:
        raise Violation("there is a lambda")


def no_division(case: Case) -> None:
    if "/" in case.text:
        raise ZeroDivisionError


def test_failures_are_shrunk_and_told_once():
    found: list[Finding] = []
    run = Target(found.append, (Property.of(no_lambda), Property.of(no_division)))
    # What is not about parsing is tried on some texts only, so there have to be many.
    for number in range(100):
        run(f"a = {number}\nx = lambda: 0\n".encode())
        run(f"b = {number} / 2; lambda: 0\n".encode())
    assert sorted((each.signature.property, each.text) for each in found) == [
        ("no_division", "/"),
        ("no_lambda", "lambda"),
    ]
    assert all(each.reason for each in found)


def test_slow_texts_are_findings(monkeypatch: pytest.MonkeyPatch):
    found: list[Finding] = []
    run = Target(found.append, ())
    clock = iter((0.0, 100.0, 200.0, 300.0))
    monkeypatch.setattr(time, "process_time", lambda: next(clock))
    run(b"x\n")
    run(b"y\n")
    assert [(each.signature.property, each.text) for each in found] == [("answers_in_time", "x\n")]


def test_mutations_of_tokens_and_of_bytes_take_turns():
    texts = ["require always x implies y\n", "ego = new Object at 1 @ 2, facing 3 deg\n"]
    asked: list[tuple[bytes, int]] = []

    def of_bytes(data: bytes, greatest: int) -> bytes:
        asked.append((data, greatest))
        return b"!"

    mutate = Mutator(of_bytes, texts)
    made = {mutate(texts[0].encode(), 40, seed) for seed in range(200)}
    assert 50 < len(asked) < 150
    assert set(asked) == {(texts[0].encode(), 40)}
    assert len(made) > 50
    assert all(len(each) <= 40 for each in made)
    assert mutate(texts[0].encode(), 40, 3) == mutate(texts[0].encode(), 40, 3)


def test_there_is_something_to_begin_with():
    texts = list(seeds())
    assert len(texts) > 20
    assert any("new " in text for text in texts)
    assert all(len(text) <= 100_000 for text in texts)


def test_the_dictionary_has_all_words():
    lines = dictionary().splitlines()
    assert all(re.fullmatch(r'"[^"\\]+"', line) for line in lines)
    assert {line[1:-1] for line in lines} == set(WORDS)


def test_only_the_compiler_is_instrumented():
    excluded = set(guided.not_compiler())
    assert {"scenic", "scenic.lsp.convert", "scenic.language.spans"} <= excluded
    assert not any(name.startswith("scenic.compiler") for name in excluded)


def test_progress_is_read():
    progress = Progress()
    assert not progress.note("INFO: Seed: 1\n")
    for line in (
        "#32\tpulse  cov: 4206 ft: 12844 corp: 30/6973b exec/s: 8 rss: 99Mb\n",
        "#85\tINITED cov: 6278 ft: 25552 corp: 84/86Kb exec/s: 4 rss: 99Mb\n",
        "#684\tDONE   cov: 6741 ft: 25459 corp: 364/141Kb lim: 1500 exec/s: 7 rss: 98Mb\n",
    ):
        assert progress.note(line)
    assert str(progress) == "684 texts; 6278 places reached at the beginning, 6741 at the end; 364 texts kept"


def test_without_atheris_there_is_advice(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert guided.main(["--minutes", "1"]) == 2
    assert "pip install -e '.[fuzz]'" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("atheris") is None, reason="atheris is an extra")
def test_a_short_run(capfd: pytest.CaptureFixture[str]):
    assert guided.main(["--minutes", "0.3", "--no-save"]) == 0
    assert "0 failures" in capfd.readouterr().out
