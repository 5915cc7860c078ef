"""How diagnostics are shown: one module per output format, each with a function from diagnostics to text."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from scenic.cli.render.json_format import render_json
from scenic.cli.render.sources import Sources
from scenic.cli.render.text_format import render_text
from scenic.language.diagnostics import Diagnostic

__all__ = ["FORMATS", "Renderer", "Sources", "render_json", "render_text"]

Renderer = Callable[[Sequence[Diagnostic], Sources, bool], str]
"""From diagnostics, the source texts, and whether to use colours."""

FORMATS: Final[Mapping[str, Renderer]] = MappingProxyType({"text": render_text, "json": render_json})
"""The output formats by name."""
