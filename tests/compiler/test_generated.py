"""The generated modules are made again when the grammar has changed, by several processes at once if need be."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scenic.compiler import generated
from scenic.compiler.generated import ensure_fresh

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of what a checkout needs for parsing, without generated modules."""
    ignored = shutil.ignore_patterns("_generated")
    shutil.copytree(ROOT / "grammar", tmp_path / "grammar", ignore=ignored)
    shutil.copytree(ROOT / "scenic" / "compiler", tmp_path / "scenic" / "compiler", ignore=ignored)
    shutil.copytree(ROOT / "scenic" / "language", tmp_path / "scenic" / "language", ignore=ignored)
    # A regular package, lest an installed one be found in its place.
    for name in ("__init__.py", "dataclass.py"):
        shutil.copy(ROOT / "scenic" / name, tmp_path / "scenic")
    return tmp_path


def add_modules(checkout: Path) -> None:
    """Put the generated modules into a copy: making them takes a second."""
    shutil.copytree(
        ROOT / "scenic" / "compiler" / "_generated", checkout / "scenic" / "compiler" / "_generated"
    )


def start(checkout: Path, code: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", code]
    return subprocess.Popen(
        command,
        cwd=checkout,
        env={"PYTHONPATH": str(checkout)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


PARSE = "from scenic.compiler.parser import parse; print(len(parse('ego = new Object\\n').tree.body))"


def run(checkout: Path, code: str = PARSE) -> str:
    process = start(checkout, code)
    output, errors = process.communicate()
    return output + errors


def test_stale_modules_are_made_again(checkout: Path) -> None:
    add_modules(checkout)
    folder = checkout / "scenic" / "compiler" / "_generated"
    first = (folder / "tables.py").read_text()
    time = (folder / "parser.py").stat().st_mtime_ns
    assert run(checkout) == "1\n"
    assert (folder / "parser.py").stat().st_mtime_ns == time
    grammar = checkout / "grammar" / "scenic.gram"
    grammar.write_text(grammar.read_text().replace('"abort" {', '"abandon" {'))
    words = "from scenic.compiler.generated import WORDS; print('abort' in WORDS, 'abandon' in WORDS)"
    assert "False True" in run(checkout, words)
    assert (folder / "tables.py").read_text() != first


def test_several_processes_make_missing_modules(checkout: Path) -> None:
    processes = [start(checkout, PARSE) for _ in range(2)]
    assert [process.communicate() for process in processes] == [("1\n", "")] * 2


def test_without_the_generator_the_message_says_what_to_do(checkout: Path) -> None:
    code = f"import sys; sys.modules['pegen'] = None; {PARSE}"
    output = run(checkout, code)
    assert "ImportError" in output
    assert "make generate" in output
    add_modules(checkout)
    # What is fresh needs no generator.
    assert run(checkout, code) == "1\n"


def test_an_installed_package_has_no_grammar(checkout: Path) -> None:
    add_modules(checkout)
    shutil.rmtree(checkout / "grammar")
    assert run(checkout) == "1\n"
    assert ensure_fresh(checkout, checkout / "anywhere") is False


def test_the_tables_belong_together() -> None:
    assert set(generated.WORDS) == {*generated.HARD_KEYWORDS, *generated.SOFT_KEYWORDS, *generated.OPERATORS}
    assert len(set(generated.WORDS.values())) == len(generated.WORDS)
    assert all(16 <= kind < 256 for kind in generated.HARD_KEYWORDS.values())
    assert all(16 <= kind < 256 for kind in generated.OPERATORS.values())
    assert all(kind > 256 for kind in generated.SOFT_KEYWORDS.values())
    assert {"require", "if", "behavior", "take"} <= generated.STATEMENT_STARTERS
    assert not {"to", "else", "front", "lambda"} & generated.STATEMENT_STARTERS
