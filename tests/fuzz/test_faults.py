"""Planted faults: all can be planted, and what becomes of the ones that are found."""

import os
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import pytest

from fuzz import faults
from fuzz.faults import Result, copied, plant, table, try_fault, write_table
from fuzz.planted import FAULTS, Change, Fault
from scenic.compiler.generated import GRAMMAR_HASH


@pytest.fixture(scope="module")
def project():
    with copied() as root:
        yield root


def test_faults_have_names_of_their_own():
    assert len({fault.name for fault in FAULTS}) == len(FAULTS) >= 20
    assert {fault.place for fault in FAULTS} >= {
        "parser",
        "formatter",
        "lowering",
        "resolver",
        "lexer",
        "recovery",
    }


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_every_change_fits_the_code(fault: Fault, project: Path):
    assert fault.changes
    for change in fault.changes:
        before = (project / change.path).read_text(encoding="utf-8")
        assert before.count(change.old) == 1, f"{change.path} has changed: {change.old!r}"
        assert change.old != change.new


def test_a_change_that_does_not_fit_is_an_error(tmp_path: Path):
    (tmp_path / "a.py").write_text("x = 1\nx = 1\n")
    for old in ("y", "x = 1"):
        with pytest.raises(LookupError, match="occurs"):
            Change("a.py", old, "").apply(tmp_path)
    Change("a.py", "x = 1\nx", "z").apply(tmp_path)
    assert (tmp_path / "a.py").read_text() == "z = 1\n"


def run(root: Path, code: str) -> str:
    """What Python says with the copy of the project at ``root``."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=root,
        env={**os.environ, "PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def fault(name: str) -> Fault:
    return next(each for each in FAULTS if each.name == name)


@pytest.mark.slow
def test_a_fault_in_the_grammar_is_one_of_the_parser_alone(project: Path):
    with copied(project) as root:
        plant(root, fault("dropped-statement"))
        grammar = Path("grammar", "scenic.gram")
        assert (root / grammar).read_text() == (project / grammar).read_text()
        said = run(
            root,
            "from scenic.compiler import check, generated\n"
            "print(check.__file__)\n"
            "print(generated.GRAMMAR_HASH)\n"
            "print([each.code for each in check.check_text('terminate after 3 seconds\\n', filename='x')])\n",
        )
        path, digest, codes = said.splitlines()
        assert Path(path).is_relative_to(root.resolve())
        # So it is not made again when it is imported.
        assert digest == GRAMMAR_HASH
        assert codes != "[]"


@pytest.mark.slow
def test_a_fault_is_found_and_nothing_else(project: Path):
    found = try_fault(fault("long-words"), project=project, seconds=30, seed=1)
    assert found.found_by in {"tokens_are_where_they_are_written", "nodes_lie_in_the_text"}, found
    assert found.program
    assert len(found.program) < 100
    assert 0 < found.seconds <= 30
    (project / "fuzz" / "corpus").mkdir(exist_ok=True)
    assert not list((project / "fuzz" / "corpus").iterdir())


def test_a_run_that_ends_otherwise_is_told(monkeypatch: pytest.MonkeyPatch, project: Path):
    broken = Fault(
        "broken",
        "fuzz",
        "nothing works",
        (Change("fuzz/__main__.py", "import argparse\n", "import nowhere\n"),),
    )
    result = try_fault(broken, project=project, seconds=1, seed=1)
    assert result.found_by is None
    assert "nowhere" in result.error
    monkeypatch.setattr(faults, "FAULTS", (broken,))
    monkeypatch.setattr(faults, "try_fault", lambda _fault, **_options: result)
    monkeypatch.setattr(faults, "copied", nullcontext)
    assert faults.main(["--only", "broken", "--seconds", "1"]) == 1


RESULTS = (
    Result(FAULTS[0], 3.4, "programs_are_accepted", "x = a | `b`\n"),
    Result(FAULTS[1], 60.0),
    Result(FAULTS[2], 1.0, "p", "y" * 100),
)


def test_results_become_a_table():
    first, _, _, _, found, missed, long = table(RESULTS, seconds=60, seed=7).split("\n")
    assert first == "2 of 3 found, with 60 seconds for each, one worker, and seed 7."
    assert found.endswith("| `programs_are_accepted` | 3 | `` 'x = a \\| `b`\\n' `` |")
    assert missed.endswith("| not found | 60 |  |")
    assert len(long) < 250


def test_the_table_goes_between_its_marks(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{faults.BEGIN}\nold\n{faults.END}\nafter\n")
    write_table(page, "new")
    assert page.read_text() == f"before\n{faults.BEGIN}\n\nnew\n\n{faults.END}\nafter\n"
    page.write_text("nothing\n")
    with pytest.raises(LookupError, match="no place"):
        write_table(page, "new")


def test_the_page_lists_every_fault():
    text = faults.PAGE.read_text(encoding="utf-8")
    assert faults.BEGIN in text
    for each in FAULTS:
        assert f"| {each.name} | {each.place} | " in text, "run `python -m fuzz.faults --write-docs`"


def test_the_command_lists_faults(capsys: pytest.CaptureFixture[str]):
    assert faults.main(["--list"]) == 0
    assert capsys.readouterr().out.count("\n") == len(FAULTS)
    assert faults.main(["--only", "nothing-such"]) == 2
    assert "no fault nothing-such" in capsys.readouterr().err


def test_too_few_found_is_a_failure(monkeypatch: pytest.MonkeyPatch):
    outcomes: dict[str, str | None] = {}

    def tried(planted: Fault, **_options: object) -> Result:
        return Result(planted, 1.0, outcomes.get(planted.name, "p"), "x")

    monkeypatch.setattr(faults, "try_fault", tried)
    monkeypatch.setattr(faults, "copied", nullcontext)
    assert faults.main([]) == 1, "something is found without a fault"
    outcomes["none"] = None
    assert faults.main([]) == 0
    outcomes[FAULTS[0].name] = None
    assert faults.main([]) == 0
    outcomes.update((each.name, None) for each in FAULTS[:3])
    assert faults.main([]) == 1
