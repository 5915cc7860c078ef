"""``python -m fuzz.faults``: plant faults in copies of the project, and see whether fuzzing finds them.

Every fault of `fuzz.planted` gets a copy of its own in a temporary folder, in which ``python -m fuzz`` runs until it has
found something or its time is over. The checkout stays as it is, except for the table in ``docs/explanation/fuzzing.md`` with
``--write-docs``. First of all the same is done without any fault: nothing may be found then.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import cache_from_source
from pathlib import Path
from typing import Final

from fuzz import corpus
from fuzz.planted import FAULTS, Change, Fault
from grammar.generator import modules, read_grammar

__all__ = ["Result", "copied", "main", "plant", "table", "try_fault", "write_table"]

ROOT: Final = Path(__file__).resolve().parents[1]
PAGE: Final = ROOT / "docs" / "explanation" / "fuzzing.md"
BEGIN: Final = "<!-- faults: written by `python -m fuzz.faults --write-docs` -->"
END: Final = "<!-- end of faults -->"

_FOLDERS: Final = ("scenic", "grammar", "fuzz")
_SECONDS: Final = 60.0
_SEED: Final = 1
_REQUIRED: Final = 0.95
"""This share of the faults has to be found."""
_SHRINKING: Final = 180.0
"""So much longer than its time a run may take: to start, and to shrink what it found at the last moment."""
_HASH: Final = re.compile(r'GRAMMAR_HASH = "\w+"')
_FOUND: Final = re.compile(r"^(?:FAILED \w+ \(seed \d+\)|DIED) after (\d+\.\d) s:", re.MULTILINE)
_NO_FAULT: Final = Fault("none", "", "nothing is wrong", ())
_LONGEST: Final = 60
"""Longer programs are cut in the table."""


@dataclass(frozen=True, slots=True)
class Result:
    """The result of a planted fault: the seconds until it was found (without shrinking), the failed property
    and the shrunk program.

    ``found_by`` is ``None`` if nothing was found. ``error`` is what the run said if it came to an end of another kind.
    """

    fault: Fault
    seconds: float
    found_by: str | None = None
    program: str = ""
    error: str = ""


def plant(root: Path, fault: Fault) -> None:
    """Make the changes of a fault in the copy of the project at ``root``; raises `LookupError` if one does not fit."""
    of_grammar = [change for change in fault.changes if change.path.startswith("grammar/")]
    if of_grammar:
        _generate_wrongly(root, of_grammar, fault.generated)
    for change in fault.changes:
        if change not in of_grammar:
            change.apply(root)
            # A cached module of the same size and second would be taken for the new one.
            Path(cache_from_source(str(root / change.path))).unlink(missing_ok=True)


def _generate_wrongly(root: Path, changes: Iterable[Change], names: Sequence[str]) -> None:
    """Generate modules from a changed grammar that look as if they were made from the unchanged one."""
    grammar = root / "grammar" / "scenic.gram"
    before = grammar.read_text(encoding="utf-8")
    right = read_grammar(grammar)
    for change in changes:
        if root / change.path != grammar:
            raise LookupError(f"only the grammar can be changed here, not {change.path}")
        change.apply(root)
    try:
        texts = modules(read_grammar(grammar))
    finally:
        grammar.write_text(before, encoding="utf-8")
    folder = root / "scenic" / "compiler" / "_generated"
    for name in names:
        path = folder / f"{name}.py"
        path.write_text(_HASH.sub(f'GRAMMAR_HASH = "{right.digest}"', texts[name], count=1), encoding="utf-8")
        Path(cache_from_source(str(path))).unlink(missing_ok=True)


@contextmanager
def copied(project: Path = ROOT) -> Iterator[Path]:
    """A copy of what fuzzing needs of a project; it is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="scenic-fault-") as folder:
        root = Path(folder)
        for name in _FOLDERS:
            shutil.copytree(project / name, root / name, ignore=shutil.ignore_patterns("corpus", ".*.tmp"))
        yield root


def try_fault(fault: Fault, *, project: Path = ROOT, seconds: float, seed: int) -> Result:
    """Fuzz a copy of a project with a fault in it, in a process of its own."""
    with copied(project) as root:
        plant(root, fault)
        command = [sys.executable, "-m", "fuzz", "--seconds", f"{seconds:g}", "--seed", str(seed)]
        start = time.monotonic()
        try:
            process = subprocess.run(
                [*command, "--jobs", "1", "--first"],
                cwd=root,
                env={**os.environ, "PYTHONPATH": str(root)},
                capture_output=True,
                text=True,
                errors="backslashreplace",
                check=False,
                timeout=seconds + _SHRINKING,
            )
        except subprocess.TimeoutExpired:
            return Result(fault, time.monotonic() - start, error="the run did not end")
        elapsed = time.monotonic() - start
        entries = list(corpus.entries(root / "fuzz" / "corpus"))
        if entries:
            statement = _FOUND.search(process.stdout)
            seconds = float(statement[1]) if statement else elapsed
            return Result(fault, seconds, entries[0].path.stem.split("-")[1], entries[0].text)
        if process.returncode == 0:
            return Result(fault, elapsed)
        return Result(fault, elapsed, error=(process.stderr or process.stdout).strip()[-2000:])


def main(arguments: list[str] | None = None) -> int:
    """Try the faults; return 1 if too few of them were found, or something without any."""
    options = _options().parse_args(arguments)
    faults = FAULTS if not options.only else [each for each in FAULTS if each.name in options.only]
    if options.list:
        for fault in faults:
            print(f"{fault.name:26} {fault.place:10} {fault.what}")
        return 0
    unknown_names = set(options.only) - {fault.name for fault in FAULTS}
    if unknown_names:
        print(f"there is no fault {', '.join(sorted(unknown_names))}; see --list", file=sys.stderr)
        return 2
    print(f"{len(faults)} faults, {options.seconds:g} s each, with seed {options.seed}", flush=True)
    clean = True
    results = []
    # All are made from one copy, so that nothing depends on what is changed in the checkout meanwhile.
    with copied() as project:
        if not options.only or options.write_docs:
            result = try_fault(_NO_FAULT, project=project, seconds=options.seconds, seed=options.seed)
            _show(result)
            clean = result.found_by is None and not result.error
        for fault in faults:
            results.append(try_fault(fault, project=project, seconds=options.seconds, seed=options.seed))
            _show(results[-1])
    found_count = sum(result.found_by is not None for result in results)
    print(f"{found_count} of {len(results)} found")
    if options.write_docs:
        write_table(PAGE, table(results, seconds=options.seconds, seed=options.seed))
    return 0 if clean and found_count >= _REQUIRED * len(results) else 1


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m fuzz.faults", description=__doc__)
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="try these faults only")
    parser.add_argument(
        "--seconds", type=float, default=_SECONDS, help=f"how long to look for each (default: {_SECONDS:g})"
    )
    parser.add_argument("--seed", type=int, default=_SEED, help=f"the seed of every run (default: {_SEED})")
    parser.add_argument("--list", action="store_true", help="only say what the faults are")
    parser.add_argument(
        "--write-docs", action="store_true", help="put the results into docs/explanation/fuzzing.md"
    )
    return parser


def _show(result: Result) -> None:
    outcome = f"found by {result.found_by}: {result.program!r}" if result.found_by else "nothing found"
    if result.error:
        outcome = f"ERROR: {result.error}"
    print(f"{result.fault.name:26} {result.seconds:6.1f} s  {outcome}", flush=True)


def table(results: Sequence[Result], *, seconds: float, seed: int) -> str:
    """The results as a table in Markdown."""
    found_count = sum(result.found_by is not None for result in results)
    lines = [
        f"{found_count} of {len(results)} found, with {seconds:g} seconds for each, one worker, and seed {seed}.",
        "",
        "| fault | in | what is wrong | found by | seconds | shrunk program |",
        "|---|---|---|---|---|---|",
    ]
    for result in results:
        fault = result.fault
        program = _code(result.program) if result.found_by else ""
        by = f"`{result.found_by}`" if result.found_by else "not found"
        cells = (fault.name, fault.place, _cell(fault.what), by, f"{result.seconds:.0f}", program)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _code(program: str) -> str:
    """A program as it can stand in a cell: its literal, in as many backticks as it needs."""
    literal = repr(program if len(program) <= _LONGEST else f"{program[:_LONGEST]}...")
    longest = max((len(run) for run in re.findall("`+", literal)), default=0)
    ticks = "`" * (longest + 1)
    return f"{ticks} {_cell(literal)} {ticks}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def write_table(page: Path, text: str) -> None:
    """Put a table between the marks of a page; raises `LookupError` if it has none."""
    content = page.read_text(encoding="utf-8")
    before, begin, rest = content.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise LookupError(f"{page} has no place for the table: {BEGIN}")
    page.write_text(f"{before}{begin}\n\n{text}\n\n{end}{after}", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
