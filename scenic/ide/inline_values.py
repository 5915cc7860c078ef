"""Values that a debugger shows in the text while a program is stopped: of which names, and how to ask for them.

A debugger of Python stops in programs of Scenic, since generated code knows their lines. It finds most names by themselves;
those of a behavior, monitor or scenario are attributes of the running instance.
"""

import ast
from collections.abc import Iterator
from typing import Final

from scenic.compiler.lowering.instance_names import instance_name, is_kept
from scenic.compiler.scopes import BindingKind, Scope
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Modules
from scenic.dataclass import dataclass
from scenic.ide.snapshot import Snapshot
from scenic.language.generated_code import PRELUDE
from scenic.language.names import TRACKED
from scenic.language.spans import Span

__all__ = ["InlineValue", "inline_values"]

_SHOWN: Final = frozenset(
    {BindingKind.VARIABLE, BindingKind.PARAMETER, BindingKind.CAPTURE, BindingKind.EXCEPTION}
)


@dataclass(frozen=True, slots=True)
class InlineValue:
    """A name whose value is shown; ``expression`` gives the value where that is not the variable of this name."""

    span: Span
    name: str
    expression: str | None = None


def inline_values(
    modules: Modules, snapshot: Snapshot, span: Span, stopped: tuple[int, int]
) -> tuple[InlineValue, ...]:
    """The names in a stretch of the text that have a value where the program has stopped: each but once in a line."""
    around = tuple(snapshot.scope_at(*stopped).ancestors())
    values_by_place: dict[tuple[int, str], InlineValue] = {}
    for node, value in _values(snapshot.model(modules), around):
        place = snapshot.source.span(node)
        if span.line <= place.line <= min(span.end_line, stopped[0]):
            earlier = values_by_place.get((place.line, node.id))
            if earlier is None or place < earlier.span:
                values_by_place[place.line, node.id] = InlineValue(place, node.id, value)
    return tuple(sorted(values_by_place.values(), key=lambda each: each.span))


def _values(model: Model, around: tuple[Scope, ...]) -> Iterator[tuple[ast.Name, str | None]]:
    for node in model.names():
        binding = model.binding(node)
        if node.id in TRACKED:
            yield node, f"{PRELUDE}.{node.id}"
        elif binding is not None and binding.scope in around and binding.kinds & _SHOWN:
            yield node, f"{instance_name(binding.scope)}.{node.id}" if is_kept(binding) else None
