"""The rules of the language without ordered choice, and what can stand at the ends of each.

A rule is a row of alternatives, each a row of items; see `scenic.compiler.syntax`. No rule is left-recursive.
"""

from collections.abc import Mapping
from enum import Enum, auto
from types import MappingProxyType
from typing import Final, TypeAlias

from scenic.compiler.generated import context_free_rules
from scenic.compiler.syntax import (
    Choice,
    Item,
    ListOf,
    Many,
    Optional,
    Row,
    RuleReference,
    TokenKind,
    Word,
    read_row,
)

__all__ = ["Edge", "EdgeFinder", "Edges", "Rules", "read_rules"]

Rules: TypeAlias = Mapping[str, tuple[Row, ...]]


class Edge(Enum):
    """The end of a token, which decides what stands between it and the next."""

    WORD = auto()
    """A letter or digit: another would belong to it."""
    SYMBOL = auto()
    GLUED = auto()
    """The text of an f-string: a blank would belong to it."""
    LINE = auto()
    """The end of a line."""


Edges: TypeAlias = frozenset[Edge]

_WORD: Final = frozenset({Edge.WORD})
_SYMBOL: Final = frozenset({Edge.SYMBOL})
_GLUED: Final = frozenset({Edge.GLUED})
_LINE: Final = frozenset({Edge.LINE})

_KIND_EDGES: Final[Mapping[str, tuple[Edges, Edges]]] = {
    "TEXT": (_WORD | _SYMBOL, _SYMBOL),
    "BARE_TEXT": (_SYMBOL, _SYMBOL),
    "BYTES": (_WORD, _SYMBOL),
    "BLUEPRINT": (_SYMBOL, _SYMBOL),
    "EMPTY_FORMATTED": (_WORD, _SYMBOL),
    "BRACES": (_GLUED, _GLUED),
    "FIELD_OPEN": (_GLUED, _SYMBOL),
    "FIELD_EQUALS": (_SYMBOL, _SYMBOL),
    "FIELD_MARK": (_SYMBOL, _GLUED),
    "CONVERSION": (_GLUED, _SYMBOL),
    "FIELD_COLON": (_SYMBOL, _GLUED),
    "FIELD_CLOSE": (_SYMBOL, _GLUED),
    "NEWLINE": (_SYMBOL, _LINE),
    "INDENT": (_LINE, _LINE),
    "DEDENT": (_LINE, _LINE),
    "ENDMARKER": (_LINE, _LINE),
}
_SUFFIX_EDGES: Final[Mapping[str, tuple[Edges, Edges]]] = {
    "START": (_WORD, _GLUED),
    "MIDDLE": (_GLUED, _GLUED),
    "FORMAT": (_GLUED, _GLUED),
    "QUOTES": (_GLUED, _GLUED),
    "END": (_GLUED, _SYMBOL),
}


def _edges_of_kind(name: str) -> tuple[Edges, Edges]:
    return _KIND_EDGES.get(name) or _SUFFIX_EDGES.get(name.rpartition("_")[2], (_WORD, _WORD))


class EdgeFinder:
    """The possible beginnings and ends of rules, rows and items."""

    def __init__(self, rules: Rules) -> None:
        self.edges: dict[str, tuple[Edges, Edges]] = dict.fromkeys(rules, (frozenset(), frozenset()))
        changed = True
        while changed:
            changed = False
            for name, rows in rules.items():
                found = self.of_rows(rows)
                if found != self.edges[name]:
                    self.edges[name] = found
                    changed = True

    def of_rows(self, rows: tuple[Row, ...]) -> tuple[Edges, Edges]:
        pairs = [self.of_row(row) for row in rows]
        return frozenset().union(*(first for first, _ in pairs)), frozenset().union(
            *(last for _, last in pairs)
        )

    def of_row(self, row: Row) -> tuple[Edges, Edges]:
        return self._end(row, 0), self._end(tuple(reversed(row)), 1)

    def _end(self, row: Row, side: int) -> Edges:
        edges: Edges = frozenset()
        for item in row:
            edges |= self.of_item(item)[side]
            if not isinstance(item, Optional):
                break
        return edges

    def of_item(self, item: Item) -> tuple[Edges, Edges]:
        match item:
            case Word():
                edges = _WORD if item.text[0].isalpha() else _SYMBOL
                return edges, edges
            case TokenKind():
                return _edges_of_kind(item.name)
            case RuleReference():
                return self.edges[item.rule]
            case Choice():
                return self.of_rows(item.rows)
            case Optional() | Many() | ListOf():
                return self.of_row(item.row)


def read_rules() -> Rules:
    """Return the rules of ``grammar/scenic.gram`` and ``grammar/demands.gram``, without left recursion and with short ladders."""
    raw = {name: tuple(map(read_row, rows)) for name, rows in context_free_rules().items()}
    loops = {name: loop for name, rows in raw.items() if (loop := _loop_of(name, rows))}
    rules = {name: (_flattened(name, loops, raw),) if name in loops else rows for name, rows in raw.items()}
    return MappingProxyType(rules)


_Loop: TypeAlias = tuple[Row, tuple[Row, ...]]
"""A step of a ladder of operators: its first operand, and operators with what follows them."""


def _loop_of(name: str, rows: tuple[Row, ...]) -> _Loop | None:
    """A step of a ladder: ``a: a operator b | b`` or ``a: b (operator b)+ | b``."""
    tails = tuple(row[1:] for row in rows if row[0] == RuleReference(name))
    bases = tuple(row for row in rows if row[0] != RuleReference(name))
    if tails:
        return bases[0] if len(bases) == 1 else (Choice(bases),), tails
    match bases:
        case ((RuleReference() as base, Many(row=tail)), (other,)) if base == other:
            return (base,), (tail,)
    return None


def _flattened(name: str, loops: Mapping[str, _Loop], raw: Rules) -> Row:
    """A step as its lowest operand, and all operators of the steps down to it, in any order.

    The text is the same: whatever the precedence, operators and operands take turns.
    """
    steps = [name]
    tails: list[Row] = []
    while True:
        base, own_tails = loops[steps[-1]]
        for tail in own_tails:
            match tail:
                case (RuleReference(rule=rule),):
                    tails += raw[rule]
                case _:
                    tails.append(tail)
        match base:
            case (RuleReference(rule=rule),) if rule in loops:
                steps.append(rule)
            case _:
                break
    lower = {RuleReference(step) for step in steps[1:]}
    if lower:
        tails = [(*tail[:-1], *base) if tail[-1] in lower else tail for tail in tails]
    return (*base, Optional((Many((Choice(tuple(tails)),)),)))
