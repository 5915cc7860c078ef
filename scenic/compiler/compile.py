"""From text to a compiled Python module: parsing, resolution, lowering and Python's own compiler in one step."""

import ast
import re
import warnings
from collections.abc import Callable
from types import CodeType
from typing import Final

from scenic.compiler.checks import lint
from scenic.compiler.lowering import lower
from scenic.compiler.old_dialect import as_old_dialect
from scenic.compiler.parser import ParseResult, deep_recursion, parse
from scenic.compiler.python_warnings import suspects
from scenic.compiler.resolver import resolve_within
from scenic.compiler.scopes import Resolution
from scenic.compiler.surroundings import SurroundingsOf
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["Compiled", "Lowered", "check_parsed", "compile_text", "lower_text"]


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


def lower_text(text: str, *, filename: str) -> Lowered:
    """Parses, checks and lowers a program. Whatever is wrong with it is in the diagnostics."""
    source = Source(text, filename)
    syntax = parse(source.text, filename=filename)
    diagnostics, resolution = _checked(syntax, source)
    if resolution is None:
        return Lowered(None, diagnostics)
    try:
        with deep_recursion():
            return Lowered(lower(syntax.tree, resolution), diagnostics)
    except RecursionError:
        return Lowered(None, (*diagnostics, _too_deep(source)))


def compile_text(text: str, *, filename: str) -> Compiled:
    """Compiles a program; ``filename`` is what tracebacks will name.

    Python's own complaints about the program become diagnostics at their place.
    """
    lowering = lower_text(text, filename=filename)
    if lowering.module is None:
        return Compiled(None, lowering.diagnostics)
    source = Source(text, filename)
    code, error, python_warnings = _compiled(lowering.module, source)
    diagnostics = list(lowering.diagnostics)
    if error is not None:
        diagnostics.append(error)
    diagnostics += [_python_warning(line, message, source) for line, message in python_warnings]
    return Compiled(code, tuple(diagnostics))


def check_parsed(
    parsed: ParseResult,
    source: Source,
    *,
    resolution: Resolution | None = None,
    surroundings_of: SurroundingsOf | None = None,
    go_on: Callable[[], None] = lambda: None,
    typing: bool = False,
) -> tuple[Diagnostic, ...]:
    """Return the findings about a program without running any of it.

    They are all that `compile_text` reports, and what is legal but hardly meant, or will fail once it is reached. Only
    the statements that Python may complain about are compiled. ``surroundings_of`` finds out about the modules that the
    program imports. ``resolution`` are its names, if they are bound already. ``go_on`` is called now and then,
    and may raise to stop. ``typing`` says that somebody is writing the program.
    """
    diagnostics, names = _checked(parsed, source, True, surroundings_of, resolution, go_on, typing)
    if names is None:
        return diagnostics
    go_on()
    statements = suspects(parsed.tree, names, source, longest_line=parsed.longest_line)
    if not statements:
        return diagnostics
    error, python_warnings = _complaints(statements, names, source)
    errors = () if error is None else (error,)
    return (
        *diagnostics,
        *errors,
        *(_python_warning(line, message, source) for line, message in python_warnings),
    )


def _checked(
    parsed: ParseResult,
    source: Source,
    thorough: bool = False,
    surroundings_of: SurroundingsOf | None = None,
    bound: Resolution | None = None,
    go_on: Callable[[], None] = lambda: None,
    typing: bool = False,
) -> tuple[tuple[Diagnostic, ...], Resolution | None]:
    """Check a parsed program; return its diagnostics, and its names if it has no errors."""
    diagnostics = list(parsed.diagnostics)
    try:
        with deep_recursion():
            resolution, context = resolve_within(parsed.tree, source, surroundings_of, bound, go_on, typing)
            hints = lint(context, go_on) if thorough else ()
    except RecursionError:
        return (*diagnostics, _too_deep(source)), None
    diagnostics = as_old_dialect(list(dict.fromkeys([*diagnostics, *resolution.diagnostics, *hints])), source)
    return tuple(diagnostics), None if _has_errors(diagnostics) else resolution


def _complaints(
    statements: list[ast.stmt], resolution: Resolution, source: Source
) -> tuple[Diagnostic | None, list[tuple[int, str]]]:
    """Return Python's complaints about statements of a program: an error or ``None``, and warnings by line."""
    tree = ast.Module(body=statements, type_ignores=[])
    try:
        with deep_recursion():
            module = lower(tree, resolution)
    except RecursionError:
        return _too_deep(source), []
    return _compiled(module, source)[1:]


def _compiled(
    module: ast.Module, source: Source
) -> tuple[CodeType | None, Diagnostic | None, list[tuple[int, str]]]:
    """Return the code of a lowered program, the error that Python stopped at, and what it warned of: lines and messages."""
    code: CodeType | None = None
    error: Diagnostic | None = None
    with warnings.catch_warnings(record=True) as caught_warnings:
        warnings.simplefilter("always")
        try:
            with deep_recursion():
                code = compile(module, source.filename, "exec", dont_inherit=True)
        except SyntaxError as problem:
            error = _python_error(problem, source)
        except RecursionError:
            error = _too_deep(source)
    # A condition is compiled twice, so it may be warned about twice.
    return (
        code,
        error,
        list(dict.fromkeys((warning.lineno, str(warning.message)) for warning in caught_warnings)),
    )


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


_LITERAL: Final = re.compile(r"with '\w+' literal")
"""Later versions of Python say which; in all of them the message is to be the same."""


def _python_warning(line: int, message: str, source: Source) -> Diagnostic:
    text = source.line(line)
    end = len(text.rstrip())
    span = Span(line, min(end, len(text) - len(text.lstrip())), line, end) if line >= 1 else None
    return Diagnostic(
        "SC307",
        _LITERAL.sub("with a literal", message),
        span,
        Severity.WARNING,
        source.filename,
        "Python would warn of this: write what is meant",
    )
