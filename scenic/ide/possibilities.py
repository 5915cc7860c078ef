"""Completions, as plain data."""

from enum import StrEnum

from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.dataclass import dataclass
from scenic.language.spans import Span

__all__ = ["Completion", "CompletionKind", "Completions", "kind_of_symbol"]


class CompletionKind(StrEnum):
    """The kinds of completions that editors distinguish."""

    KEYWORD = "keyword"
    SPECIFIER = "specifier"
    OPERATOR = "operator"
    SNIPPET = "snippet"
    CLASS = "class"
    FUNCTION = "function"
    METHOD = "method"
    BEHAVIOR = "behavior"
    MONITOR = "monitor"
    SCENARIO = "scenario"
    PROPERTY = "property"
    ATTRIBUTE = "attribute"
    VARIABLE = "variable"
    PARAMETER = "parameter"
    MODULE = "module"
    CONSTANT = "constant"


@dataclass(frozen=True, slots=True)
class Completion:
    """One possibility.

    ``text`` is what takes the place of the word that is begun; ``snippet`` the same with places to fill in, as the
    protocol writes them (``${1:name}``), if there are any. ``rank`` orders possibilities, the smallest first. ``key``
    says to `document` what it is about.
    """

    label: str
    kind: CompletionKind
    text: str
    rank: int
    detail: str = ""
    snippet: str | None = None
    key: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Completions:
    """The possibilities, and the word that they replace."""

    span: Span
    items: tuple[Completion, ...]


def kind_of_symbol(symbol: Symbol) -> CompletionKind:
    """Return the kind under which a symbol of the project is offered."""
    return {
        SymbolKind.CLASS: CompletionKind.CLASS,
        SymbolKind.FUNCTION: CompletionKind.FUNCTION,
        SymbolKind.METHOD: CompletionKind.METHOD,
        SymbolKind.BEHAVIOR: CompletionKind.BEHAVIOR,
        SymbolKind.MONITOR: CompletionKind.MONITOR,
        SymbolKind.SCENARIO: CompletionKind.SCENARIO,
        SymbolKind.MODULE: CompletionKind.MODULE,
        SymbolKind.PROPERTY: CompletionKind.PROPERTY,
        SymbolKind.ATTRIBUTE: CompletionKind.ATTRIBUTE,
        SymbolKind.PARAMETER: CompletionKind.PARAMETER,
    }.get(symbol.kind, CompletionKind.VARIABLE)
