"""The static check of a program: all diagnostics that need no run of the program.

This one function is what ``scenic check`` and the language server show.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace

from scenic.compiler.compile import check_parsed
from scenic.compiler.parser import ParseResult, parse
from scenic.compiler.scopes import Resolution
from scenic.compiler.suppression_comments import apply_ignores
from scenic.compiler.surroundings import SurroundingsOf
from scenic.language.diagnostics import UNSUPPORTED, Diagnostic, Severity
from scenic.language.garbage import no_garbage_collection
from scenic.language.source import Source

__all__ = ["check_text", "check_tree", "in_order"]


def check_text(
    text: str, *, filename: str, surroundings_of: SurroundingsOf | None = None, typing: bool = False
) -> tuple[Diagnostic, ...]:
    """The findings of the lexer, the parser, the resolver and the compiler, in order of place.

    Without what comments of the program silence, and with what is wrong with these comments. ``surroundings_of`` finds
    out about the modules that the program imports (`scenic.project.surroundings`); without it, nothing is known of them.
    ``typing`` says that somebody is writing the program: what a half-typed line may still bind is then not missed.
    """
    # Nearly all that is made of a text is gone when this returns: only then it is time to look for garbage.
    with no_garbage_collection():
        source = Source(text, filename)
        result = parse(source.text, filename=filename)
        return check_tree(result, source, surroundings_of=surroundings_of, typing=typing)


def check_tree(
    parsed: ParseResult,
    source: Source,
    *,
    resolution: Resolution | None = None,
    surroundings_of: SurroundingsOf | None = None,
    go_on: Callable[[], None] = lambda: None,
    typing: bool = False,
) -> tuple[Diagnostic, ...]:
    """Return the findings of `check_text` in a program that is parsed already; ``resolution`` are its names, if they are bound."""
    diagnostics = check_parsed(
        parsed, source, resolution=resolution, surroundings_of=surroundings_of, go_on=go_on, typing=typing
    )
    diagnostics = in_order(map(_as_shown, diagnostics), filename=source.filename)
    remaining = apply_ignores(source.text, diagnostics, filename=source.filename)
    return in_order(remaining, filename=source.filename)


def _as_shown(diagnostic: Diagnostic) -> Diagnostic:
    """Lower an "unsupported" diagnostic to an information: the program is correct, and only running it fails."""
    return (
        replace(diagnostic, severity=Severity.INFORMATION) if diagnostic.code == UNSUPPORTED else diagnostic
    )


def in_order(diagnostics: Iterable[Diagnostic], *, filename: str) -> tuple[Diagnostic, ...]:
    """Sorted by place and each but once; those without a filename get this one."""
    named = (item if item.filename else replace(item, filename=filename) for item in diagnostics)
    return tuple(sorted(dict.fromkeys(named), key=_place))


def _place(diagnostic: Diagnostic) -> tuple[str, int, int, str]:
    span = diagnostic.span
    line, column = (0, 0) if span is None else (span.line, span.column)
    return diagnostic.filename or "", line, column, diagnostic.code
