"""Texts in which two or three operators meet, in every way in which one can stand in another."""

from collections.abc import Iterator, Sequence

from tests.compiler.spec_table import ROWS, Row, Slot

ORDINARY = tuple(row for row in ROWS if not row.temporal)
TEMPORAL = tuple(row for row in ROWS if row.temporal)

MIXED = tuple(
    row
    for row in ORDINARY
    if row.text
    in {
        "_ if _ else _", "lambda : _", "_ or _", "not _", "_ < _", "_ not in _", "_ visible from _",
        "_ not visible from _", "_ offset along _ by _", "_ relative to _", "_ at _", "visible _", "not visible _",
        "distance from _ to _", "distance to _", "_ - _", "_ deg", "- _", "_ ** _", "await _", "new C at _", "_ ( )",
    }
)  # fmt: skip
"""Ordinary operators, some of each level, to stand beside temporal ones."""

CONTESTED = frozenset({"distance to _", "distance from _ to _", "visible _", "not visible _"})
"""Operators whose words may belong to an operator around them."""


def one_of_each_shape(rows: Sequence[Row]) -> list[Row]:
    """One row of each level and arrangement of operands, and those of `CONTESTED`."""
    found: dict[object, Row] = {}
    for row in rows:
        places = tuple(isinstance(part, Slot) for part in row.parts)
        shape = tuple(
            place
            for place, after in zip(places, [*places[1:], None], strict=True)
            if place or after is not place
        )
        found.setdefault(row.text if row.text in CONTESTED else (row.level, row.chain, shape), row)
    return list(found.values())


Pattern = tuple[str | None, ...]
"""Words, and ``None`` where an operand stands."""


def pattern(row: Row) -> Pattern:
    return tuple(None if isinstance(part, Slot) else part for part in row.parts)


def inside(outer: Pattern, inner: Pattern, place: int) -> Pattern:
    """A pattern with another one in its operand of the given index."""
    (index,) = [[at for at, part in enumerate(outer) if part is None][place]]
    return (*outer[:index], *inner, *outer[index + 1 :])


def filled(words: Pattern) -> str:
    """The text of a pattern, with names for operands."""
    names = iter("abcdefgh")
    return " ".join(next(names) if word is None else word for word in words)


def pairs(first: Sequence[Row], second: Sequence[Row]) -> Iterator[str]:
    """Every row of ``second`` in every operand of every row of ``first``."""
    for outer in map(pattern, first):
        for inner in map(pattern, second):
            for place in range(outer.count(None)):
                yield filled(inside(outer, inner, place))


def triples(first: Sequence[Row], second: Sequence[Row], third: Sequence[Row]) -> Iterator[str]:
    """Every row of ``third`` in every operand of every pair of rows of ``first`` and ``second``."""
    thirds = [pattern(row) for row in third]
    for outer in map(pattern, first):
        for inner in map(pattern, second):
            for place in range(outer.count(None)):
                both = inside(outer, inner, place)
                for words in thirds:
                    for at in range(both.count(None)):
                        yield filled(inside(both, words, at))
