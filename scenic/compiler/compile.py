"""From text to a compiled Python module: parsing, resolution, lowering and Python's own compiler in one step."""

import ast
import warnings
from dataclasses import dataclass
from types import CodeType

from scenic.compiler.checks import lint
from scenic.compiler.lowering import lower
from scenic.compiler.parser import DEEPEST, parse, recursion_limit
from scenic.compiler.resolver import resolve_within
from scenic.compiler.surroundings import SurroundingsOf
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["Compiled", "Lowered", "compile_text", "lower_text"]


@dataclass(frozen=True, slots=True)
class Lowered:
    """A program as the tree of a Python module; ``module`` is ``None`` if there are errors."""

    module: ast.Module | None
    diagnostics: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class Compiled:
    """A program as Python code; ``code`` is ``None`` if there are errors."""

    code: CodeType | None
    diagnostics: tuple[Diagnostic, ...]


def lower_text(
    text: str, *, filename: str, thorough: bool = False, surroundings_of: SurroundingsOf | None = None
) -> Lowered:
    """Parses, checks and lowers a program. Whatever is wrong with it is in the diagnostics.

    If ``thorough``, so is what is legal but hardly meant, and what will fail once it is reached. ``surroundings_of``
    finds out about the modules that the program imports.
    """
    source = Source(text, filename)
    parsed = parse(source.text, filename=filename)
    found = list(parsed.diagnostics)
    try:
        with recursion_limit(DEEPEST):
            resolution, surroundings = resolve_within(parsed.tree, source, surroundings_of)
            hints = lint(parsed.tree, source, resolution, surroundings) if thorough else ()
            found = list(dict.fromkeys([*found, *resolution.diagnostics, *hints]))
            module = None if _has_errors(found) else lower(parsed.tree, resolution)
    except RecursionError:
        return Lowered(None, (*found, _too_deep(source)))
    return Lowered(module, tuple(found))


def compile_text(
    text: str, *, filename: str, thorough: bool = False, surroundings_of: SurroundingsOf | None = None
) -> Compiled:
    """Compiles a program; ``filename`` is what tracebacks will name, the rest as in `lower_text`.

    Python's own complaints about the program become diagnostics at their place.
    """
    lowered = lower_text(text, filename=filename, thorough=thorough, surroundings_of=surroundings_of)
    if lowered.module is None:
        return Compiled(None, lowered.diagnostics)
    source = Source(text, filename)
    code: CodeType | None = None
    found = list(lowered.diagnostics)
    with warnings.catch_warnings(record=True) as noted:
        warnings.simplefilter("always")
        try:
            code = compile(lowered.module, filename, "exec", dont_inherit=True)
        except SyntaxError as error:
            found.append(_python_error(error, source))
        except RecursionError:
            found.append(_too_deep(source))
    seen: set[tuple[int, str]] = set()
    for warning in noted:
        key = (warning.lineno, str(warning.message))
        # A condition is compiled twice, so it may be warned about twice.
        if key not in seen:
            seen.add(key)
            found.append(_python_warning(*key, source))
    return Compiled(code, tuple(found))


def _has_errors(diagnostics: list[Diagnostic]) -> bool:
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)


def _too_deep(source: Source) -> Diagnostic:
    return Diagnostic(
        "SC112",
        "the program is nested too deeply",
        Span(1, 0, 1, 0),
        Severity.ERROR,
        source.filename,
        "split the longest expressions and the deepest blocks",
    )


def _python_error(error: SyntaxError, source: Source) -> Diagnostic:
    message = error.msg
    if "duplicate argument" in message:
        code = "SC210"
    elif "outside" in message or "inside async" in message or "at module level" in message:
        code = "SC201"
    else:
        code = "SC110"
    return Diagnostic(code, message, _python_span(error, source), Severity.ERROR, source.filename)


def _python_span(error: SyntaxError, source: Source) -> Span | None:
    """The place of an error of Python's compiler, whose columns count UTF-8 bytes from 1."""
    if error.lineno is None or not 1 <= error.lineno <= len(source.lines):
        return None
    start = ast.Pass(
        lineno=error.lineno,
        col_offset=max(0, (error.offset or 1) - 1),
        end_lineno=error.end_lineno or error.lineno,
        end_col_offset=max(0, (error.end_offset or 0) - 1),
    )
    return source.span(start)


def _python_warning(line: int, message: str, source: Source) -> Diagnostic:
    text = source.line(line)
    end = len(text.rstrip())
    span = Span(line, min(end, len(text) - len(text.lstrip())), line, end) if line >= 1 else None
    return Diagnostic(
        "SC307",
        message,
        span,
        Severity.WARNING,
        source.filename,
        "Python would warn of this: write what is meant",
    )
