"""Answers of ``scenic try``, for people."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from scenic.language.diagnostics import Diagnostic, Label, Severity
from scenic.language.spans import Span

__all__ = ["diagnostics_of", "render_trial"]


def diagnostics_of(answer: Mapping[str, Any]) -> list[Diagnostic]:
    """The diagnostics of an answer."""
    return [
        Diagnostic(
            each["code"],
            each["message"],
            _span(each["span"]),
            Severity(each["severity"]),
            each["filename"],
            each["help"],
            tuple(
                Label(span, label["text"], label.get("filename"))
                for label in each["labels"]
                if (span := _span(label["span"])) is not None
            ),
        )
        for each in answer["diagnostics"]
    ]


def _span(data: Mapping[str, int] | None) -> Span | None:
    if data is None:
        return None
    return Span(data["line"], data["column"] - 1, data["end_line"], data["end_column"] - 1)


def render_trial(answer: Mapping[str, Any], name: str, console: Console) -> None:
    """Print the phase that a program reaches, what rejected its candidates, and the outcome of its simulation."""
    rejections = answer["rejections"]
    if rejections is not None and rejections["requirements"]:
        table = Table(title=f"What rejects, of {rejections['candidates']} candidates", title_justify="left")
        table.add_column("requirement", overflow="fold")
        for column in ("line", "rejects", "alone rejects"):
            table.add_column(column, justify="right")
        for row in rejections["requirements"]:
            line = "" if row["span"] is None else str(row["span"]["line"])
            table.add_row(Text(row["label"]), line, f"{row['rejects']:.1%}", f"{row['alone']:.1%}")
        console.print(table)
    simulation = answer["simulation"]
    if simulation is not None:
        console.print(Text(f"simulation: {simulation['steps']} steps, {simulation['reason']}"))
        for item in simulation["requirements"]:
            console.print(Text(f"  {item['label']}: {item['verdict']}"))
    if answer.get("output"):
        console.print(Text("the program printed:", style="dim"))
        console.print(Text(answer["output"].rstrip()))
    times = ", ".join(f"{phase} {seconds:.2g} s" for phase, seconds in answer["time"].items())
    if answer["ok"]:
        console.print(
            Text(f"{name}: {answer['phase']} succeeds ({times})", style="bold green"), soft_wrap=True
        )
    else:
        console.print(Text(f"{name}: {answer['phase']} fails ({times})", style="bold red"), soft_wrap=True)
