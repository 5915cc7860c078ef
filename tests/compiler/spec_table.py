"""The table of operators of the specification, and the readings of a text that it allows.

What is read here is ``tests/data/precedence/spec.txt``, not what the grammar says. `reading` looks for *all* trees that
the levels of that table allow for a text: nothing is decided by the order in which anything is tried. Where there
are several, the sentences of the specification that say which one is meant are applied to whole trees:

- `not visible x` is one operator if it can be;
- words are keywords if the whole text can be read so, else names;
- `is not` is one operator, as in Python;
- a temporal prefix, and the last specifier of `new`, takes all that it can;
- `left` and `right` after one of the other sides belong to it;
- closing words, from left to right, go to the innermost operator that can use them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, TypeAlias

DATA: Final = Path(__file__).parent.parent / "data" / "precedence"


@dataclass(frozen=True)
class Slot:
    """An operand: its least level; ``prefixes`` if a temporal prefix may stand there too."""

    level: int
    temporal: bool
    prefixes: bool = False


@dataclass(frozen=True)
class Row:
    """One form of the table; a part is a word, a slot, or ``None`` for what is no operand."""

    level: int
    temporal: bool
    parts: tuple[str | Slot | None, ...]
    chain: bool = False

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of the form."""
        return frozenset(part for part in self.parts if isinstance(part, str))

    @cached_property
    def operator(self) -> str:
        """The first word."""
        return next(part for part in self.parts if isinstance(part, str))

    @cached_property
    def is_prefix(self) -> bool:
        """Whether it is a temporal prefix."""
        return self.temporal and self.operator in {"always", "eventually", "next"}

    @cached_property
    def text(self) -> str:
        """The form with ``_`` for operands."""
        return " ".join(part if isinstance(part, str) else "_" for part in self.parts)

    def goes_on_as(self, row: "Row") -> bool:
        """Whether both are links of one chain."""
        return (self.level, self.temporal, self.chain) == (row.level, row.temporal, row.chain)


def read_table() -> tuple[Row, ...]:
    """All rows, in the order of the file."""
    levels: dict[str, int] = {}
    rows = []
    for line in (DATA / "spec.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("order: "):
            *names, shared = line.removeprefix("order: ").split()
            levels = {name: int(shared) - len(names) + index for index, name in enumerate(names)}
        elif line and not line.startswith("#"):
            first, *words = line.split()
            chain = words[-1] == "chain"
            parts = [_part(word, levels) for word in (words[:-1] if chain else words)]
            temporal = first in levels
            rows.append(Row(levels[first] if temporal else int(first), temporal, tuple(parts), chain))
    return tuple(rows)


def _part(word: str, levels: dict[str, int]) -> str | Slot | None:
    if word in {"NAME", "[...]"}:
        return None
    if word[0] == "<" and word[-1] == ">" and len(word) > 2:
        level, _, prefixes = word[1:-1].partition("|")
        return Slot(levels[level], True, bool(prefixes)) if level in levels else Slot(int(level), False)
    return word


TABLE: Final = read_table()
SHARED: Final = 6
"""The loosest level that the ladders share."""
ATOM: Final = 19
NAMES: Final = frozenset("abcdefgh")
SIDES: Final = ("front", "back", "left", "right", "top", "bottom")
SOFT: Final = frozenset({"visible", "always", "eventually", "next", "distance", "angle", "altitude", *SIDES})
"""First words of prefix operators, which may be names where an operand cannot start so: ``2 * visible - b``."""


def _new(*parts: str | int) -> Row:
    return Row(
        16, False, ("new", "C", *(Slot(part, False) if isinstance(part, int) else part for part in parts))
    )


ROWS: Final = (
    *(row for row in TABLE if None not in row.parts and row.parts[0] != "(" and row.parts[-1] != ")"),
    Row(1, False, ("n", ":=", Slot(2, False))),
    Row(2, False, ("lambda", ":", Slot(2, False))),
    Row(-1, True, ("lambda", ":", Slot(2, False))),
    *(Row(18, False, (Slot(18, False), *words)) for words in ((".", "m"), ("(", ")"), ("[", "0", "]"))),
    # The arguments of specifiers are whole expressions (section 3.1, level 16).
    _new(),
    _new("at", 2),
    _new("in", 2),
    _new("offset", "by", 2),
    _new("offset", "along", 2, "by", 2),
    _new("visible"),
    _new("visible", "from", 2),
    _new("not", "visible"),
    _new("not", "visible", "from", 2),
    *(
        _new(*words, 2, *by)
        for words in (("left", "of"), ("right", "of"), ("ahead", "of"), ("behind",))
        for by in ((), ("by", 2))
    ),
    _new("beyond", 2, "by", 2),
    _new("beyond", 2, "by", 2, "from", 2),
)
"""The forms of the table, with something in the places that are for no operands."""

Tree: TypeAlias = "str | Node"


@dataclass(frozen=True, slots=True)
class Node:
    """A tree: a form, its words and operands in the order of the text, the place of its first word."""

    row: Row
    parts: tuple[Tree, ...]
    start: int
    end: int

    @property
    def operands(self) -> list[Tree]:
        """The operands, in order."""
        if self.row.chain:
            return [part for part in self.parts if isinstance(part, Node) or part not in self.row.words]
        return [
            part for part, place in zip(self.parts, self.row.parts, strict=True) if isinstance(place, Slot)
        ]

    def nodes(self) -> Iterator["Node"]:
        """This node and all below it."""
        yield self
        for part in self.parts:
            if isinstance(part, Node):
                yield from part.nodes()


def parenthesised(tree: Tree) -> str:
    """The text of a tree with parentheses around every operation."""
    return tree if isinstance(tree, str) else f"( {' '.join(parenthesised(part) for part in tree.parts)} )"


def reading(text: str, *, temporal: bool = False) -> str | None:
    """What a text means, fully parenthesised; ``None`` if it is an error.

    Raises `ValueError` if the specification leaves open what is meant.
    """
    found = _Readings(text, temporal, frozenset()).trees()
    if not found and (names := SOFT & set(text.split())):
        found = _Readings(text, temporal, names).trees()
    found = [tree for tree in found if not _refused(tree) and not _gives_up(tree, text.split())]
    judges: tuple[Callable[[Tree], Any], ...] = (_keywords, _negations, _identities, _scope, _closing_words)
    for judge in judges:
        if len(found) > 1:
            best = max(map(judge, found))
            found = [tree for tree in found if judge(tree) == best]
    if len(found) > 1:
        raise ValueError(f"{text}: {' or '.join(map(parenthesised, found))}")
    return parenthesised(found[0]) if found else None


def _refused(tree: Tree) -> bool:
    """A temporal operator cannot stand under a conditional expression (section 3.4)."""
    return not isinstance(tree, str) and any(
        below.row.temporal and below.row.operator in {"always", "eventually", "next", "until", "implies"}
        for node in tree.nodes()
        if node.row.temporal and node.row.operator == "if"
        for below in node.nodes()
    )


def _gives_up(tree: Tree, words: list[str]) -> bool:
    """The words with which a specifier can go on are the specifier's, never an operator's around it (section 3.2, 6)."""
    if isinstance(tree, str):
        return False
    instances = [node for node in tree.nodes() if node.row.operator == "new" and node.end < len(words)]
    return any(
        row.parts[: len(node.row.parts)] == node.row.parts
        and row.parts[len(node.row.parts)] == words[node.end]
        for node in instances
        if len(node.row.parts) > 2 or words[node.end] in ("left", "right", "ahead", "behind")
        for row in ROWS
        if len(row.parts) > len(node.row.parts)
    )


def _keywords(tree: Tree) -> int:
    """Names that might be keywords are to be avoided."""
    if isinstance(tree, str):
        return -(tree in SOFT)
    return sum(_keywords(part) for node in tree.nodes() for part in node.operands if isinstance(part, str))


def _negations(tree: Tree) -> int:
    """Logical negations right before `visible` are to be avoided."""
    if isinstance(tree, str):
        return 0
    nodes = list(tree.nodes())
    negated = {node.start + 1 for node in nodes if node.row.text == "not _"}
    return -sum(node.row.text == "visible _" and node.start in negated for node in nodes)


def _identities(tree: Tree) -> int:
    """The uses of `is not`: as many as possible."""
    if isinstance(tree, str):
        return 0
    return sum(pair == ("is", "not") for node in tree.nodes() for pair in pairwise(node.parts))


def _scope(tree: Tree) -> int:
    """The tokens that temporal prefixes and instances take: as many as possible."""
    if isinstance(tree, str):
        return 0
    return sum(
        node.end - node.start for node in tree.nodes() if node.row.is_prefix or node.row.operator == "new"
    )


def _closing_words(tree: Tree) -> list[int]:
    """Where the operators start that own the closing words, from left to right: each is the innermost one's."""
    if isinstance(tree, str):
        return []
    owners: list[tuple[int, int]] = []
    for node in tree.nodes():
        if isinstance(node.row.parts[0], str):
            at = node.start
            for index, part in enumerate(node.parts):
                if isinstance(node.row.parts[index], str) and Slot in map(type, node.row.parts[:index]):
                    owners.append((at, node.start))
                at = part.end if isinstance(part, Node) else at + 1
    return [start for _, start in sorted(owners)]


@dataclass(frozen=True, slots=True)
class _Found:
    """A tree that starts at some token and ends before ``end``."""

    tree: Tree
    end: int
    level: int
    temporal: bool
    prefix: bool

    def fits(self, slot: Slot) -> bool:
        """Whether it can be the operand."""
        if not slot.temporal:
            return self.level >= slot.level and not self.temporal
        if slot.prefixes and self.prefix:
            return True
        return self.level >= slot.level and (self.temporal or self.level >= SHARED)


class _Readings:
    """All trees of one text that the levels allow."""

    def __init__(self, text: str, temporal: bool, names: frozenset[str]) -> None:
        self.words = text.split()
        self.names = NAMES | names
        present = set(self.words)
        rows = [row for row in ROWS if present.issuperset(row.words) and (temporal or not row.temporal)]
        self.prefixes = [row for row in rows if isinstance(row.parts[0], str)]
        self.others = [row for row in rows if isinstance(row.parts[0], Slot)]
        self.top = Slot(-1, True) if temporal else Slot(1 if ":=" in present else 2, False)
        self.found: dict[int, list[_Found]] = {}

    def trees(self) -> list[Tree]:
        """The trees of the whole text."""
        return [each.tree for each in self.starting(0) if each.end == len(self.words) and each.fits(self.top)]

    def starting(self, start: int) -> list[_Found]:
        """Everything that starts at a token, of every level."""
        if start in self.found:
            return self.found[start]
        results: list[_Found] = []
        if start < len(self.words):
            if self.words[start] in self.names:
                results.append(_Found(self.words[start], start + 1, ATOM, False, False))
            for row in self.prefixes:
                results += self.rest(row, row.parts, start, start, ())
        for left in results:  # grows meanwhile
            if left.end == len(self.words):
                continue
            for row in self.others:
                slot, *parts = row.parts
                assert isinstance(slot, Slot)
                if parts[0] in ("left", "right") and self.words[left.end - 1] in (
                    "front",
                    "back",
                    "top",
                    "bottom",
                ):
                    continue
                if left.fits(slot):
                    results += self.rest(row, parts, start, left.end, (left.tree,))
                elif row.chain and isinstance(left.tree, Node) and left.tree.row.goes_on_as(row):
                    results += self.rest(row, parts, start, left.end, left.tree.parts)
        self.found[start] = results
        return results

    def rest(
        self, row: Row, parts: Sequence[str | Slot | None], start: int, at: int, done: tuple[Tree, ...]
    ) -> list[_Found]:
        """All ways to go on with the remaining parts of a form."""
        if not parts:
            return [_Found(Node(row, done, start, at), at, row.level, row.temporal, row.is_prefix)]
        first, *others = parts
        if not isinstance(first, Slot):
            if at < len(self.words) and self.words[at] == first:
                return self.rest(row, others, start, at + 1, (*done, first))
            return []
        operands = [each for each in self.starting(at) if each.fits(first)]
        if len(operands) > 1:
            # A word is a name only where the operator cannot stand.
            operands = [each for each in operands if each.tree not in SOFT]
        return [
            found
            for operand in operands
            for found in self.rest(row, others, start, operand.end, (*done, operand.tree))
        ]
