"""Steps in which a selection grows: a word, the expressions around it, statements, blocks, the document."""

from typing import Final

from scenic.ide.name_places import span_of
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span

__all__ = ["selections"]

_MOST: Final = 100
"""The largest number of steps: answers nest as deeply, and readers of JSON commonly allow 128 levels."""


def selections(snapshot: Snapshot, line: int, column: int) -> tuple[Span, ...]:
    """The spans around a place, each within the next, the smallest first: at most 100, the last one the document."""
    lines = snapshot.source.lines
    whole = Span(1, 0, len(lines), len(lines[-1]))
    line = min(max(line, 1), len(lines))
    column = min(column, len(lines[line - 1]))
    spans = [whole]
    for node in snapshot.path_to(line, column)[1:]:
        _grow(spans, span_of(snapshot, node))
    token = snapshot.token_at(line, column)
    if token is not None:
        _grow(spans, snapshot.span_of_token(token))
    if len(spans) > _MOST:
        del spans[1 : len(spans) - _MOST + 1]
    return tuple(reversed(spans))


def _grow(found: list[Span], span: Span) -> None:
    """Add a span within the last one, if it is smaller."""
    if found[-1] != span and found[-1].contains(span):
        found.append(span)
