"""Scenic in notebooks: ``%load_ext scenic`` shows values of Scenic, explains mistakes, and adds the cell magic ``%%scenic``.

```
%%scenic room -n 5 --seed 1
ego = new Object at (Range(0, 1), 0)
```

compiles the cell, keeps the scenario as ``room``, samples five scenes, keeps them as ``scenes``, and shows them.
"""

import argparse
import html as markup
import shlex
import time
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from typing import Any, Final

from scenic.batch.simulations import SimulationRow
from scenic.formats.embedding import embedded_courses, embedded_scenes, embedded_simulation, table
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import ParseCompileError, ScenicError
from scenic.pipeline import scenarioFromString
from scenic.runtime.sampling.rejection_report import Exhausted
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene
from scenic.simulators.simulation import Simulation

__all__ = ["load_ipython_extension", "sampled"]

_REFRESH: Final = 0.2
"""Seconds between two states of a progress bar."""


def load_ipython_extension(shell: Any) -> None:
    """Register formatters, the handler of errors, and ``%%scenic`` with a shell of IPython (which has no types here)."""
    formatter = shell.display_formatter.formatters["text/html"]
    formatter.for_type(SimulationRow, _row_html)
    formatter.for_type(Simulation, embedded_simulation)
    formatter.for_type(Exhausted, _exhausted_html)
    formatter.for_type(Diagnostic, lambda diagnostic: _diagnostics_html([diagnostic]))
    shell.set_custom_exc((ScenicError, ParseCompileError), _explain)
    shell.register_magic_function(lambda line, cell: _run_cell(shell, line, cell), "cell", "scenic")


def sampled(scenario: Scenario, n: int = 1, *, seed: int | None = None, **limits: Any) -> list[Scene]:
    """Return the scenes that `Scenario.sample` gives, with a progress bar while they are looked for.

    Scenes that are not found within the limits are shown as their report, and left out.
    """
    results = scenario.stream(n, seed=0 if seed is None else seed, **limits)
    scenes: list[Scene] = []
    for result in _followed(results, n):
        if isinstance(result, Exhausted):
            _display(_exhausted_html(result))
        else:
            scenes.append(result)
    return scenes


def _followed(results: Iterator[Any], n: int) -> Iterator[Any]:
    """Results as they come, with a bar that tells how many there are."""
    update = _display(_bar(0, n), changing=True)
    last = time.monotonic()
    for number, result in enumerate(results, 1):
        yield result
        if time.monotonic() - last > _REFRESH:
            update(_bar(number, n))
            last = time.monotonic()
    update("")


def _bar(done: int, n: int) -> str:
    return f'<progress value="{done}" max="{n}"></progress> {done} of {n} scenes'


def _display(text: str, *, changing: bool = False) -> Callable[[str], None]:
    """Show HTML; gives a function that replaces it."""
    shown: Any = import_module("IPython.display")  # has no types
    handle = shown.display(shown.HTML(text), display_id=changing or None)
    return lambda text: None if handle is None else handle.update(shown.HTML(text))


def _options(line: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="%%scenic", exit_on_error=False)
    parser.add_argument("name", nargs="?", default="scenario", help="variable that keeps the scenario")
    parser.add_argument("-n", type=int, default=1, help="scenes to sample and show; 0 for none")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--2d", dest="flat", action="store_true", help="the 2D mode")
    return parser.parse_args(shlex.split(line))


def _run_cell(shell: Any, line: str, cell: str) -> None:
    """Compile a cell, keep the scenario, and show scenes of it."""
    options = _options(line)
    scenario = scenarioFromString(cell, filename="<cell>", mode2D=options.flat)
    shell.user_ns[options.name] = scenario
    if options.n:
        scenes = sampled(scenario, options.n, seed=options.seed)
        shell.user_ns["scenes"] = scenes
        if scenes:
            _display(embedded_scenes(scenes, options.name))


def _row_html(row: SimulationRow) -> str:
    """Return a simulation: played, if it was made for that, with its end and the verdicts of its requirements."""
    if row.about is None:
        text = row.missing or (row.error.message if row.error else "")
        why = "" if row.exhausted is None else _exhausted_html(row.exhausted)
        return f"<p>simulation {row.k}: {markup.escape(text)}</p>{why}"
    head = f"<p>simulation {row.k}: {row.about['steps']} steps, {markup.escape(row.about['reason'])}</p>"
    verdicts = [
        (item["label"], item["verdict"].lower().replace("_", " "), _brief(item["robustness"]))
        for item in row.about["requirements"]
    ]
    film = embedded_courses([row.page], f"simulation {row.k}") if row.page else ""
    return head + (table(("requirement", "verdict", "robustness"), verdicts) if verdicts else "") + film


def _brief(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else "" if value is None else str(value)


def _exhausted_html(missing: Exhausted) -> str:
    """Return an HTML table of why a scene was not found: the share of each requirement in the rejections."""
    rows = [
        (row.label, "" if row.span is None else row.span.line, f"{row.rejected:.1%}", f"{row.alone:.1%}")
        for row in sorted(missing.report.rows, key=lambda row: (-row.rejected, -row.alone))
    ]
    head = f"<p>scene {missing.k} was not found in {missing.attempts} candidates</p>"
    return head + (table(("requirement", "line", "rejects", "alone rejects"), rows) if rows else "")


def _diagnostics_html(diagnostics: Sequence[Diagnostic]) -> str:
    """Diagnostics with their places and what to do."""
    return "".join(
        f"<p><b>{item.severity} {item.code}</b>"
        f"{f', line {item.span.line}' if item.span else ''}: {markup.escape(item.message)}"
        f"{f'<br/><i>help:</i> {markup.escape(item.help)}' if item.help else ''}</p>"
        for item in diagnostics
    )


def _explain(
    shell: Any, kind: type, error: Exception, traceback: object, tb_offset: int | None = None
) -> None:
    """Show the diagnostics of an error of Scenic in place of a traceback."""
    if isinstance(error, ParseCompileError):
        diagnostics: Sequence[Diagnostic] = error.diagnostics
    else:
        diagnose = getattr(error, "diagnostic", None)
        if diagnose is None:
            shell.showtraceback((kind, error, traceback), tb_offset=tb_offset)
            return
        diagnostics = [diagnose()]
    lines = _diagnostics_text(diagnostics)
    display: Any = import_module("IPython.display")  # has no types
    display.display({"text/html": _diagnostics_html(diagnostics), "text/plain": "\n".join(lines)}, raw=True)
    # Tools that run notebooks take the error of a cell from here.
    shell._showtraceback(kind, error, lines)


def _diagnostics_text(diagnostics: Sequence[Diagnostic]) -> list[str]:
    """Return diagnostics as lines of text."""
    lines = []
    for item in diagnostics:
        place = f", line {item.span.line}" if item.span else ""
        lines.append(f"{item.severity}[{item.code}]{place}: {item.message}")
        lines += [f"  help: {item.help}"] if item.help else []
    return lines
