"""``scenic check``: what is wrong with programs, found without running them."""

import os
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import click

from scenic.cli.batch_parts import BatchPart, check_parts
from scenic.cli.checking import Checker, CheckOutcome, CheckTask, Fixing, fault
from scenic.cli.discovery import STANDARD_INPUT, discover
from scenic.cli.file_changes import watch
from scenic.cli.options import COUNT, option
from scenic.cli.output import FINDINGS, exit_code, has_colours, show_diagnostics, summary
from scenic.cli.render import FORMATS, Report, Sources, render
from scenic.configuration.project import PLAIN, Configuration, Configurations, read_configuration
from scenic.dataclass import dataclass
from scenic.formats.files import write
from scenic.language.code_selection import EVERYTHING, is_selector, similar_selector
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import ScenicError
from scenic.language.source import Source

__all__ = ["check"]

_INPUT: Final = BatchPart("standard input", refuses=frozenset({"deep", "watching"}))
_TEXT: Final = BatchPart("--format text", frozenset({"statistics"}))
_DIFF: Final = BatchPart("--diff", refuses=frozenset({"fix", "watching", "statistics"}))
_FIX: Final = BatchPart("--fix", refuses=frozenset({"watching"}))
_NO_CONFIG: Final = BatchPart("--no-config", refuses=frozenset({"config"}))

_ALL: Final = "ALL"
_FAILING: Final = (Severity.ERROR, Severity.WARNING)

_ENOUGH_BYTES: Final = 30_000 if sys.platform == "linux" else 100_000
"""Programs of fewer bytes together are checked sooner by this process alone.

It checks some 250 kB a second; two processes need 25 ms to begin where they are forked (with what this process must
import for it), and 120 ms where they start afresh. Half the time for the programs must outweigh that.
"""

_PATIENCE: Final = 1.0
"""Seconds after which progress is shown on a terminal."""


def _selectors(_context: click.Context, option: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:
    codes = tuple(code for each in given for part in each.split(",") if (code := part.strip()))
    if option.name == "select" and _ALL in codes:
        return EVERYTHING
    for code in codes:
        if not is_selector(code):
            meant = similar_selector(code)
            advice = f"Did you mean {meant!r}?" if meant else "'scenic explain' lists all codes."
            raise click.BadParameter(f"there is no code {code!r}. {advice}")
    return codes


@click.command()
@click.argument("paths", nargs=-1, metavar="[PATH]...", type=click.Path())
@option("--format output_format", "Format of the output.", list(FORMATS), default="text")
@option(
    "--select CODES",
    "Show these codes only: SC304, SC3 for all codes that begin with it, or ALL; separated by commas, or "
    "repeated.",
    multiple=True,
    callback=_selectors,
)
@option("--ignore CODES", "Do not show these codes.", multiple=True, callback=_selectors)
@option("--fix", "Make the repairs that are certain, in the files.")
@option("--diff", "Show these repairs as a patch instead, and change nothing.")
@option("--deep", "Run the programs, and add what analysis proves about them.")
@option(
    "--2d mode_2d",
    "Run them in the 2D compatibility mode; without --deep they are not run, and it changes nothing.",
)
@option("--strict", "Report problems of a part of a road map as errors, not warnings.")
@option("--config FILE", "Read [tool.scenic] from this file, for all programs.")
@option("--no-config", "Read no configuration.")
@option("--stdin-filename NAME", "Name of standard input, which also selects the configuration.")
@option("-j --jobs N", "Use up to N processes.  [default: usable CPUs]", COUNT)
@option("-v --verbose", "Report also imports whose names cannot be known.")
@option("--exit-zero", "Exit with 0 even if there are findings.")
@option("--statistics", "Show only the number of findings for each code.")
@option("-o --output-file FILE", "Write the report to this file.", click.Path(path_type=Path, dir_okay=False))
@option("-w --watch watching", "Check again whenever a file changes.")
def check(paths: tuple[str, ...], **options: Any) -> int:
    """Report mistakes in programs and road maps (.xodr).

    Each PATH is a file, a folder that is searched for *.scenic and *.sc, or - for standard input; by default the
    current folder is searched. The command runs no code of the programs, unless --deep is given.

    Exit codes: 0 clean, 1 findings (errors or warnings; with --diff: something to repair), 2 wrong usage, or a file
    that cannot be read, 70 an internal error, 130 interrupted.
    """
    request = _Options(**options)
    parts = {_INPUT: STANDARD_INPUT in paths, _TEXT: request.output_format == "text"}
    parts |= {_DIFF: request.diff, _FIX: request.fix, _NO_CONFIG: request.no_config}
    check_parts([part for part, is_chosen in parts.items() if is_chosen], [_TEXT])
    if request.watching:
        context = click.get_current_context()
        watch(paths, lambda: context.invoke(context.command, **{**context.params, "watching": False}))
    return _checked(paths, request)


@dataclass(frozen=True, slots=True)
class _Options:
    """The options of the command, by their names."""

    output_format: str
    select: tuple[str, ...]
    ignore: tuple[str, ...]
    fix: bool
    diff: bool
    deep: bool
    mode_2d: bool
    strict: bool
    config: str | None
    no_config: bool
    stdin_filename: str | None
    jobs: int | None
    verbose: bool
    exit_zero: bool
    statistics: bool
    output_file: Path | None
    watching: bool

    @property
    def configuration(self) -> Configuration | None:
        """The configuration of all files; ``None`` if each file has that of its project."""
        return PLAIN if self.no_config else None if self.config is None else read_configuration(self.config)

    @property
    def fixing(self) -> Fixing:
        """The use of repairs."""
        return Fixing.MAKE if self.fix else Fixing.SHOW if self.diff else Fixing.NONE


def _checked(paths: tuple[str, ...], options: _Options) -> int:
    """Check the files under some paths and report about them; returns the exit code."""
    configurations = Configurations(options.configuration)
    discovery = discover(paths, configurations)
    sources = Sources()
    problems = list(discovery.problems)
    tasks = list(_tasks(discovery.files, configurations, options, sources, problems))
    problems = [*configurations.problems, *problems]
    if not discovery.files and not problems:
        click.echo("warning: there are no Scenic files under the given paths", err=True)
    outcomes = _outcomes(tasks, options.jobs)
    for outcome in outcomes:
        sys.stderr.write(outcome.trace)
    diagnostics = [*problems, *(item for outcome in outcomes for item in outcome.diagnostics)]
    repair_count = sum(outcome.fixed for outcome in outcomes)
    if options.diff:
        return _show_diff(outcomes, diagnostics, repair_count)
    code = exit_code(diagnostics, failing=_FAILING)
    if options.exit_zero and code == FINDINGS:
        code = 0
    tasks_with_texts = [
        (task, outcome.text)
        for task, outcome in zip(tasks, outcomes, strict=True)
        if outcome.text is not None
    ]
    for task, text in tasks_with_texts:
        # Standard output is for the repaired text; what is left to say goes beside it.
        sources.add(Source(text, task.filename))
        sys.stdout.write(text)
    if tasks_with_texts:
        show_diagnostics(diagnostics, sources)
        return code
    colours = options.output_file is None and has_colours(sys.stdout)
    names = [task.filename for task in tasks]
    report = Report(diagnostics, sources, len(tasks), repair_count, code, colours, names)
    _write_report(report, "statistics" if options.statistics else options.output_format, options.output_file)
    return code


def _tasks(
    files: Sequence[str],
    configurations: Configurations,
    options: _Options,
    sources: Sources,
    problems: list[Diagnostic],
) -> Iterator[CheckTask]:
    """Yield the files to check, with the rules for each; standard input is read, and added to ``sources`` or ``problems``."""
    for file in files:
        name, text = file, None
        if file == STANDARD_INPUT:
            name = options.stdin_filename or "<stdin>"
            try:
                text = _standard_input(name)
            except ScenicError as error:
                problems.append(error.diagnostic())
                continue
            sources.add(Source(text, name))
        project = configurations.of_file(name)
        rules, root = project.rules_for(name, options.select, options.ignore), project.folder or None
        python_path, fixing = project.python_path, options.fixing
        yield CheckTask(
            name,
            rules,
            root,
            python_path,
            options.verbose,
            options.deep,
            fixing,
            text,
            options.strict,
            options.mode_2d,
        )


def _write_report(report: Report, output_format: str, file: Path | None) -> None:
    """Write a report to a file or to standard output, and its conclusion to the error stream."""
    text = render(output_format, report)
    if file is None:
        sys.stdout.write(text)
    else:
        write(file, text.encode("utf-8", "backslashreplace"))
    has_content = report.diagnostics or report.fixed or sys.stderr.isatty()
    if output_format in ("text", "statistics") and has_content:
        sys.stdout.flush()
        sys.stderr.write(_conclusion(report))


def _standard_input(name: str) -> str:
    """The text of standard input, with its byte order mark; raises ``ScenicError`` if it is not text."""
    data = sys.stdin.buffer.read()
    Source.decode(data, name)
    return data.decode()


def _conclusion(report: Report) -> str:
    files = f"{report.files} file{'' if report.files == 1 else 's'}"
    text = f"{summary(report.diagnostics)} in {files}"
    repairable = sum(item.fix is not None and item.fix.certain for item in report.diagnostics)
    if report.fixed:
        text += f"; {_repairs(report.fixed)} made"
    elif repairable:
        text += f"; {repairable} can be repaired with --fix"
    first = next((item.code for item in report.diagnostics if item.severity is Severity.ERROR), None)
    if first is not None:
        text += f"\nfor more about an error: scenic explain {first}"
    return f"{text}\n"


def _repairs(count: int) -> str:
    return f"{count} repair{'' if count == 1 else 's'}"


def _show_diff(outcomes: Sequence[CheckOutcome], diagnostics: Sequence[Diagnostic], fixed: int) -> int:
    """Show the repairs; of the diagnostics, only those that kept a file from being looked at."""
    sys.stdout.write("".join(outcome.diff for outcome in outcomes))
    sys.stdout.flush()
    show_diagnostics(diagnostics)
    changed = sum(bool(outcome.diff) for outcome in outcomes)
    if changed:
        sys.stderr.write(f"{_repairs(fixed)} would be made in {changed} file{'' if changed == 1 else 's'}\n")
    return exit_code(diagnostics, failing=_FAILING) or (FINDINGS if changed else 0)


def _outcomes(tasks: Sequence[CheckTask], jobs: int | None) -> list[CheckOutcome]:
    """Run the tasks; return their outcomes in the same order."""
    outcomes: dict[int, CheckOutcome] = {}
    with _progress(len(tasks)) as advance:
        for index, outcome in _results(tasks, jobs):
            outcomes[index] = outcome
            advance(len(outcomes))
    return [outcomes[index] for index in range(len(tasks))]


def _results(tasks: Sequence[CheckTask], jobs: int | None) -> Iterator[tuple[int, CheckOutcome]]:
    if jobs == 1 or len(tasks) < 2 or not _pays(tasks):
        checker = Checker()
        yield from ((index, checker(task)) for index, task in enumerate(tasks))
        return
    from scenic.batch.workers import run, usable_cpus  # takes a while to import

    yield from run(Checker(), tasks, jobs=jobs or usable_cpus(), lost=_lost)


def _pays(tasks: Sequence[CheckTask]) -> bool:
    """Return whether the tasks take longer than to start other processes."""
    total = 0
    for task in tasks:
        try:
            total += os.stat(task.filename).st_size if task.text is None else len(task.text)
        except OSError:
            continue
        if task.deep or total > _ENOUGH_BYTES:
            return True
    return False


def _lost(task: CheckTask, code: int) -> CheckOutcome:
    """Return the outcome for a file whose check ended its process."""
    how = f"by signal {-code}" if code < 0 else f"with code {code}"
    return CheckOutcome((fault(task.filename, f"the process that checked this file ended {how}"),))


@contextmanager
def _progress(count: int) -> "Iterator[_Advance]":
    """Show a line of progress on the error stream, if this is a terminal and the check takes long."""
    advance = _Advance(count)
    try:
        yield advance
    finally:
        advance.clear()


class _Advance:
    """Shows how many files are checked."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._next = time.monotonic() + _PATIENCE
        self._on = sys.stderr.isatty()
        self._shown = False

    def __call__(self, done: int) -> None:
        now = time.monotonic()
        if self._on and now >= self._next:
            self._next, self._shown = now + 0.1, True
            sys.stderr.write(f"\rchecked {done} of {self._count} files")
            sys.stderr.flush()

    def clear(self) -> None:
        if self._shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
