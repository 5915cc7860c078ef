"""Output formats of diagnostics: one module each, with a function from a report to text."""

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Final

from scenic.cli.render.report import Report
from scenic.cli.render.sources import Sources
from scenic.cli.render.text_format import render_text

__all__ = ["FORMATS", "Report", "Sources", "render", "render_text"]

FORMATS: Final[Mapping[str, tuple[str, str]]] = MappingProxyType(
    {
        "text": ("scenic.cli.render.text_format", "render_report"),
        "phases": ("scenic.cli.render.phases_format", "render_phases"),
        "json": ("scenic.cli.render.json_format", "render_json"),
        "sarif": ("scenic.cli.render.sarif_format", "render_sarif"),
        "gitlab": ("scenic.cli.render.gitlab_format", "render_gitlab"),
        "junit": ("scenic.cli.render.junit_format", "render_junit"),
        "github": ("scenic.cli.render.github_format", "render_github"),
    }
)
"""The output formats by name: module, which is imported when it is wanted, and function in it."""

_STATISTICS: Final = ("scenic.cli.render.statistics_format", "render_statistics")


def render(name: str, report: Report) -> str:
    """A report in one of the formats, or as ``statistics``."""
    module, function = _STATISTICS if name == "statistics" else FORMATS[name]
    renderer: Callable[[Report], str] = getattr(import_module(module), function)
    return renderer(report)
