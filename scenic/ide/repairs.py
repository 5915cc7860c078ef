"""The repairs that an editor offers: those of the diagnostics at a place, and all that can be made at once."""

from collections.abc import Sequence

from scenic.compiler.fixes import repair
from scenic.ide.snapshot import Snapshot
from scenic.language.code_selection import Rules, is_lasting
from scenic.language.diagnostics import Diagnostic, Edit, Severity
from scenic.language.spans import Span
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["can_repair_all", "difference", "ignoring", "repair_all", "repairs", "touch"]


def repairs(found: Sequence[Diagnostic], span: Span) -> tuple[Diagnostic, ...]:
    """Return the diagnostics that have a repair and that touch ``span``, themselves or with the repair."""
    return tuple(
        item
        for item in found
        if item.fix is not None
        and any(each is not None and touch(each, span) for each in (item.span, *_of_fix(item)))
    )


def ignoring(
    snapshot: Snapshot, found: Sequence[Diagnostic], span: Span
) -> tuple[tuple[Diagnostic, Edit], ...]:
    """Return the diagnostics that touch ``span`` and that a comment on their line may silence, each with the comment."""
    comments = {line: (column, text) for line, column, text in snapshot.tokens.comments}
    result = []
    for item in found:
        if (
            item.span is None
            or not touch(item.span, span)
            or is_lasting(item)
            or item.severity is Severity.ERROR
        ):
            continue
        line = item.span.line
        if line in comments:
            continue  # What the comment says must not become a part of another one.
        if any(
            first < line <= last
            for first, last in zip(snapshot.tokens.lines, snapshot.tokens.end_lines, strict=True)
            if first != last
        ):
            continue  # The line begins in a string.
        end = len(snapshot.source.line(line).rstrip())
        edit = Edit(
            Span(line, end, line, len(snapshot.source.line(line))), f"  # scenic: ignore[{item.code}]"
        )
        result.append((item, edit))
    return tuple(result)


def can_repair_all(found: Sequence[Diagnostic]) -> bool:
    """Return whether `repair_all` may have something to do in a document with these diagnostics."""
    return any(item.fix is not None and item.fix.certain for item in found)


def repair_all(
    text: str, *, filename: str, rules: Rules | None = None, project: Project | None = None
) -> Edit | None:
    r"""All repairs that do no harm, as one edit of the part that they change; ``None`` if there are none.

    ``text`` has ``\n`` at each line end, and no byte order mark. Without a ``project``, nothing is known of the modules
    that it imports.
    """
    surroundings_of = None if project is None else surroundings_in(project)
    select = (rules or Rules()).apply
    result = repair(text, filename=filename, shown=select, surroundings_of=surroundings_of)
    if not result.count:
        return None
    return difference(text, result.text)


def difference(text: str, changed: str) -> Edit | None:
    """Return the edit of one part that makes one text of another; ``None`` if they are the same."""
    if text == changed:
        return None
    before = _common(text, changed)
    after = _common(text[before:][::-1], changed[before:][::-1])
    end = len(text) - after
    return Edit(Span(*_place(text, before), *_place(text, end)), changed[before : len(changed) - after])


def _common(one: str, other: str) -> int:
    """Return the length of the common beginning."""
    differ = (index for index, (left, right) in enumerate(zip(one, other, strict=False)) if left != right)
    return next(differ, min(len(one), len(other)))


def _place(text: str, offset: int) -> tuple[int, int]:
    return text.count("\n", 0, offset) + 1, offset - (text.rfind("\n", 0, offset) + 1)


def _of_fix(item: Diagnostic) -> list[Span]:
    return [] if item.fix is None else [edit.span for edit in item.fix.edits]


def touch(one: Span, other: Span) -> bool:
    """Return whether two places have a point in common."""
    return _start(one) <= _end(other) and _start(other) <= _end(one)


def _start(span: Span) -> tuple[int, int]:
    return span.line, span.column


def _end(span: Span) -> tuple[int, int]:
    return span.end_line, span.end_column
