"""Texts in which two or three operators meet, in every way in which one can stand in another."""

from collections import Counter
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

LIKE = {
    "angle": "distance",
    "altitude": "distance",
    "minimum": "distance",
    "position": "heading",
    "apparent": "relative",
    "back": "front",
    "left": "front",
    "right": "front",
    "top": "front",
    "bottom": "front",
}
"""Words of prefix operators, with the first ones among those that are alike in all but words."""


def one_of_each(rows: Sequence[Row]) -> list[Row]:
    """The rows without those that differ from an earlier one only in words of `LIKE` or words that no other row has."""
    count = Counter(word for row in rows for word in row.words)
    found: dict[object, Row] = {}
    for row in rows:
        parts: list[object] = []
        for part in row.parts:
            if isinstance(part, str):
                like = "?" if count[part] == 1 else LIKE.get(part, part) if row.level == 11 else part
                if parts[-1:] != [like]:
                    parts.append(like)
            else:
                parts.append(part)
        found.setdefault((row.level, row.chain, tuple(parts)), row)
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
