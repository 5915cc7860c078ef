"""Findings about parts of a program, kept for the check of its next version.

The top level is divided into stretches (`scenic.compiler.scopes`), in which nothing may change but the lines on which
they stand. What a rule says of a stretch depends on its nodes, on what the names that it reads mean, on what these need in
turn, and on facts about the whole program that it asks for. If all of that is as before, so is what is said, as many
lines further down as the statements that it is said of.
"""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from scenic.compiler.scopes import Binding, Stretch
from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic, Edit, Label
from scenic.language.spans import Span

__all__ = ["Kept", "Moves", "Said", "changed_names"]


@dataclass(frozen=True, slots=True)
class Said:
    """The findings in one stretch, and the facts about the whole program that they depend on.

    ``follows_error`` is what was known of the statements before it.
    """

    found: tuple[Diagnostic, ...]
    facts: tuple[tuple[str, object], ...]
    follows_error: bool


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """The findings of each group of rules in the stretches of one version, which are known by their keys.

    ``state`` is what every rule may depend on, ``names`` what the names of the module mean.
    """

    state: Sequence[object]
    names: Mapping[str, Binding]
    stretches: Sequence[Stretch]
    said: Mapping[tuple[str, tuple[object, ...]], Said]


class _Lost(Exception):
    """A place is gone."""


class Moves:
    """A map from the statements of one version to their places in the next."""

    def __init__(self, before: Sequence[Stretch], after: Sequence[Stretch]) -> None:
        self._before = before
        self._after = after

    @cached_property
    def _lines(self) -> Sequence[int]:
        return [line for stretch in self._before for line in stretch.lines]

    @cached_property
    def _shifts(self) -> Sequence[int | None]:
        """By how much each statement has moved; ``None`` if it is gone."""
        lines = {
            key: line
            for stretch in self._after
            for key, line in zip(stretch.keys, stretch.lines, strict=True)
        }
        return [
            lines[key] - line if key in lines else None
            for stretch in self._before
            for key, line in zip(stretch.keys, stretch.lines, strict=True)
        ]

    def of(self, said: Said, filename: str) -> Said | None:
        """The kept findings at the present places of their statements; ``None`` if one of the statements is gone."""
        if not said.found:
            return said
        try:
            found = tuple(self._diagnostic(each, filename) for each in said.found)
        except _Lost:
            return None
        return said if found == said.found else replace(said, found=found)

    def _diagnostic(self, item: Diagnostic, filename: str) -> Diagnostic:
        def moved(label: Label) -> Label:
            elsewhere = label.filename is not None and label.filename != filename
            return label if elsewhere else replace(label, span=self._span(label.span))

        fix = item.fix
        if fix is not None:
            fix = replace(fix, edits=tuple(Edit(self._span(each.span), each.text) for each in fix.edits))
        span = None if item.span is None else self._span(item.span)
        return replace(item, span=span, labels=tuple(map(moved, item.labels)), fix=fix)

    def _span(self, span: Span) -> Span:
        index = bisect_right(self._lines, span.line) - 1
        by = self._shifts[index] if index >= 0 else None
        if by is None:
            raise _Lost
        return Span(span.line + by, span.column, span.end_line + by, span.end_column) if by else span


def changed_names(
    before: Mapping[str, Binding], after: Mapping[str, Binding], stretches: Iterable[Stretch]
) -> frozenset[str]:
    """The names of the module that mean something else than before, or need such names for what they mean."""
    changed = {*before.keys() ^ after.keys()}
    for name, binding in after.items():
        old = before.get(name)
        if (
            old is not None
            and old.stretches != binding.stretches
            and _statements(old) != _statements(binding)
        ):
            changed.add(name)
    if not changed:
        return frozenset()
    waiting = [item for stretch in stretches for item in stretch.needs.items()]
    grown = True
    while grown:
        met = [name for name, needed in waiting if not needed.isdisjoint(changed)]
        grown = not changed.issuperset(met)
        changed.update(met)
    return frozenset(changed)


def _statements(binding: Binding) -> frozenset[object]:
    """The keys of the statements that bind a name of the module."""
    return frozenset().union(*(each.bound_by[binding.name] for each in binding.stretches or ()))
