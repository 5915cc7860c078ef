"""From tokens to text: the blanks, line ends and indentation between the tokens of the rules.

A grammar for text has no lexer that leaves blanks out, so they are items of its rules. Between two words stands a blank,
beside other tokens there may be one; in brackets line ends and comments are blanks, too. Hence rules come in variants:
`Variant`. A line end stands before the statement that follows it, as there its indentation is known.
"""

from collections.abc import Iterator, Mapping
from typing import Final

from scenic.compiler import syntax
from scenic.compiler.syntax import TokenKind, Word
from scenic.constrained.grammar_rules import Edge, EdgeFinder, Edges, Rules
from scenic.constrained.items import (
    Line,
    TextChoice,
    TextItem,
    TextMany,
    TextOptional,
    TextRow,
    Use,
    Variant,
    within,
)
from scenic.dataclass import dataclass

__all__ = ["Laid", "lay_out"]

_OPENERS: Final = frozenset({Word("("), Word("["), Word("{"), TokenKind("FIELD_OPEN")})
_CLOSERS: Final = frozenset({Word(")"), Word("]"), Word("}"), TokenKind("FIELD_CLOSE")})


@dataclass(frozen=True, slots=True)
class Laid:
    """The alternatives of all variants, and which of them depend on the level of indentation."""

    start: Variant
    rules: Mapping[Variant, tuple[TextRow, ...]]
    nested: frozenset[Variant]


def lay_out(rules: Rules, start: str) -> Laid:
    """Return the rules that ``start`` needs, with everything between their tokens."""
    layout = _Layout(rules)
    first = Variant(start)
    rows_of_variant: dict[Variant, tuple[TextRow, ...]] = {}
    pending = [first]
    while pending:
        variant = pending.pop()
        if variant not in rows_of_variant:
            rows_of_variant[variant] = layout.rows_of(variant)
            pending += (item.variant for item in within(rows_of_variant[variant]) if isinstance(item, Use))
    return Laid(first, rows_of_variant, _nested(rows_of_variant))


def factored(rows: tuple[TextRow, ...]) -> tuple[TextRow, ...]:
    """Join rows that begin alike: engines follow a common beginning only once."""
    groups: dict[TextItem, list[TextRow]] = {}
    for row in rows:
        rests = groups.setdefault(row[0], [])
        if row[1:] not in rests:
            rests.append(row[1:])
    return tuple((first, *_one_of(tuple(rests))) for first, rests in groups.items())


def _one_of(rows: tuple[TextRow, ...]) -> TextRow:
    """Return one of several rows, of which one may be empty."""
    present = factored(tuple(row for row in rows if row))
    row = present[0] if len(present) == 1 else (TextChoice(present),) if present else ()
    return row if len(present) == 0 or all(rows) else (TextOptional(row),)


def _nested(laid: Mapping[Variant, tuple[TextRow, ...]]) -> frozenset[Variant]:
    nested_variants: set[Variant] = set()
    size = -1
    while size != len(nested_variants):
        size = len(nested_variants)
        nested_variants |= {
            variant
            for variant, rows in laid.items()
            if any(
                isinstance(item, Line)
                or (isinstance(item, Use) and (item.deeper or item.variant in nested_variants))
                for item in within(rows)
            )
        }
    return frozenset(nested_variants)


@dataclass(slots=True)
class _Place:
    """The place of the next item of a row: after what, in how many brackets, and how much deeper."""

    before: Edges
    brackets: int
    deeper: int = 0

    def copy(self, before: Edges | None = None) -> "_Place":
        return _Place(self.before if before is None else before, self.brackets, self.deeper)


class _Layout:
    """Lays out rows of tokens."""

    def __init__(self, rules: Rules) -> None:
        self._rules = rules
        self._edges = EdgeFinder(rules)

    def rows_of(self, variant: Variant) -> tuple[TextRow, ...]:
        rows = self._rules[variant.rule]
        start = _Place(frozenset(), int(variant.inside))
        if variant.bare:
            rows = tuple(bare for row in rows for bare in self._bare_rows(row))
        return factored(tuple(self._row(row, start.copy(), bare=variant.bare) for row in rows))

    def _bare_rows(self, row: syntax.Row) -> Iterator[syntax.Row]:
        """Yield the rows that a row stands for if it has to begin with a symbol; the first item of each is a token or a rule."""
        first, rest = row[0], row[1:]
        match first:
            case syntax.Optional():
                yield from ((*bare, *rest) for bare in self._bare_rows(first.row))
                if rest:
                    yield from self._bare_rows(rest)
            case syntax.Many():
                yield from ((*bare, syntax.Optional((first,)), *rest) for bare in self._bare_rows(first.row))
            case syntax.ListOf():
                again = syntax.Optional((syntax.Many((*first.separator, *first.row)),))
                yield from ((*bare, again, *rest) for bare in self._bare_rows(first.row))
            case syntax.Choice():
                yield from ((*bare, *rest) for each in first.rows for bare in self._bare_rows(each))
            case _:
                if Edge.SYMBOL in self._edges.of_item(first)[0]:
                    yield row

    def _row(self, row: syntax.Row, place: _Place, *, bare: bool = False) -> TextRow:
        if isinstance(row[0], syntax.Optional) and len(row) > 1 and not place.before:
            # Whether a blank comes before the second item depends on the first one.
            ways = ((*row[0].row, *row[1:]), row[1:])
            return _one_of(tuple(self._row(each, place.copy()) for each in ways))
        items: list[TextItem] = []
        for item in row:
            items += self._placed(item, place, bare=bare)
            last = self._edges.of_item(item)[1]
            place.before = place.before | last if isinstance(item, syntax.Optional) else last
            bare = False
        return tuple(items)

    def _placed(self, item: syntax.Item, place: _Place, *, bare: bool) -> TextRow:
        """Return an item after what is before it."""
        match item:
            case syntax.Optional():
                return (TextOptional(self._row(item.row, place.copy())),)
            case syntax.Many():
                return self._repeated(item.row, item.row, place)
            case syntax.ListOf():
                return self._repeated(item.row, (*item.separator, *item.row), place)
            case syntax.Choice():
                return _one_of(tuple(self._row(each, place.copy()) for each in item.rows))
            case TokenKind("NEWLINE" | "ENDMARKER"):
                return ()
            case TokenKind("INDENT"):
                place.deeper += 1
                return ()
            case TokenKind("DEDENT"):
                place.deeper -= 1
                return ()
        items = self._spaced(item, place, bare=bare)
        if item in _OPENERS:
            place.brackets += 1
        elif item in _CLOSERS:
            place.brackets -= 1
        return items

    def _repeated(self, row: syntax.Row, further: syntax.Row, place: _Place) -> TextRow:
        once = self._row(row, place.copy())
        _, last = self._edges.of_row(row)
        again = self._row(further, place.copy(last))
        return (TextMany(once),) if again == once else (*once, TextOptional((TextMany(again),)))

    def _spaced(self, item: syntax.Item, place: _Place, *, bare: bool) -> TextRow:
        """Return a token or a rule after a blank, if there has to be one."""
        first, before = self._edges.of_item(item)[0], place.before
        here = self._use(item, place, bare=bare)
        if not before or Edge.GLUED in before | first:
            return (here,)
        if Edge.LINE in before:
            return (Line(place.deeper), here)
        blank = TokenKind("SPACE" if place.brackets else "BLANKS")
        if not (Edge.WORD in before and Edge.WORD in first):
            return (TextOptional((blank,)), here)
        if Edge.SYMBOL in first:
            return (TextChoice(((blank, here), (self._use(item, place, bare=True),))),)
        return (blank, here)

    @staticmethod
    def _use(item: syntax.Item, place: _Place, *, bare: bool) -> TextItem:
        match item:
            case syntax.RuleReference():
                return Use(Variant(item.rule, place.brackets > 0, bare), place.deeper)
            case TokenKind("TEXT") if bare:
                return TokenKind("BARE_TEXT")
            case Word() | TokenKind():
                return item
        raise AssertionError(item)
