"""A parser by precedence climbing, driven by nothing but the table of `scenic.compiler.precedence`.

It shares no code with the generated parser and knows no operator by name; its tokens stand between blanks. What it
makes of a text is the text with parentheses around every operation, or ``None`` if it refuses it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, TypeAlias

from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.compiler.precedence import (
    ATOM,
    FORMS,
    LADDERS,
    Associativity,
    Content,
    Form,
    Ladder,
    Slot,
    Word,
)

__all__ = ["TABLE", "Climber", "Table", "Tree", "climb"]

RESERVED: Final = frozenset({*HARD_KEYWORDS, "NEWLINE"})
"""Words that are not names, and the mark after the last token."""

_DIRECTIONS: Final = frozenset({"_ left of _", "_ right of _"})
_CORNERS: Final = frozenset({"front", "back", "top", "bottom"})
"""Words that belong to the ``left`` or ``right`` after them: ``front left of x`` is a corner, or a mistake."""


@dataclass(frozen=True)
class Table:
    """A table of precedence: forms in the order in which they are tried."""

    forms: tuple[Form, ...]

    @cached_property
    def starting(self) -> Mapping[Ladder, list[Form]]:
        """The forms that start with a word, by ladder."""
        return {
            ladder: [form for form in self.forms if form.ladder is ladder and isinstance(form.parts[0], Word)]
            for ladder in _BOTH
        }

    @cached_property
    def going_on(self) -> Mapping[Ladder, list[Form]]:
        """The forms that start with an operand, by ladder, those with more words first."""
        return {
            ladder: sorted(
                (
                    form
                    for form in self.forms
                    if form.ladder is ladder and not isinstance(form.parts[0], Word)
                ),
                key=lambda form: -len(form.words),
            )
            for ladder in _BOTH
        }


_BOTH: Final = (Ladder.ORDINARY, Ladder.TEMPORAL)

SHARED: Final = 1 + max(LADDERS[Ladder.TEMPORAL].values())
"""Level at which the temporal ladder continues as the ordinary ladder."""

TABLE: Final = Table(FORMS)
"""The table that the generator read from the grammar."""

Tree: TypeAlias = "str | tuple[Form, tuple[Tree, ...]]"


@dataclass(frozen=True, slots=True)
class Parsed:
    """An operand: its tree, the form that it was written in (``None``: an atom), and where it ends."""

    tree: Tree
    form: Form | None
    end: int

    @property
    def level(self) -> int:
        return ATOM if self.form is None else self.form.level


class Climber:
    """Parses one text."""

    def __init__(self, text: str, table: Table = TABLE) -> None:
        self.words = [*text.split(), "NEWLINE"]
        self._table = table
        self._memo: dict[tuple[int, Ladder, int, tuple[str, ...]], Parsed | None] = {}

    def whole(self, ladder: Ladder) -> "Tree | None":
        """Return the tree of the whole text as an operand of the loosest level."""
        top = Slot(ladder, min(LADDERS[ladder].values()), (), None)
        found = self.operand(0, top)
        return found.tree if found is not None and self.words[found.end] == "NEWLINE" else None

    def operand(self, at: int, slot: Slot) -> Parsed | None:
        """Return the operand that starts at a token."""
        key = (at, slot.ladder, slot.level, slot.also)
        if key not in self._memo:
            self._memo[key] = self._operand(at, slot)
        return self._memo[key]

    def _operand(self, at: int, slot: Slot) -> Parsed | None:
        operand = self._start(at, slot)
        if operand is None:
            return None
        ladders = [slot.ladder] if slot.ladder is Ladder.ORDINARY else [Ladder.ORDINARY, Ladder.TEMPORAL]
        while True:
            for ladder in ladders:
                longer = self._longer(operand, slot, ladder)
                if longer is not None:
                    operand = longer
                    break
            else:
                return operand

    def _start(self, at: int, slot: Slot) -> Parsed | None:
        """Parse the beginning of an operand: an operator before its operand, an expression in brackets, or a name."""
        temporal = slot.ladder is Ladder.TEMPORAL
        starting = self._table.starting
        forms = [*(starting[Ladder.TEMPORAL] if temporal else ()), *starting[Ladder.ORDINARY]]
        for form in forms:
            if not slot.accepts(form):
                continue
            if form.yields_to and tuple(self.words[at : at + len(form.yields_to)]) == form.yields_to:
                tighter = self.operand(at, Slot(Ladder.ORDINARY, form.level + 1, (), None))
                if tighter is not None:
                    return tighter
            for end, parts in self._parts(form, 0, at, ()):
                if form.followed_by and self.words[end] not in form.followed_by:
                    continue
                if form.node == "":
                    return Parsed(parts[1], None, end)
                return Parsed((form, parts), form, end)
        if self.words[at].isalnum() and self.words[at] not in RESERVED:
            # A word that might be an operator is none in parentheses.
            word = self.words[at]
            return Parsed(f"( {word} )" if word in SOFT_KEYWORDS else word, None, at + 1)
        return None

    def _longer(self, left: Parsed, slot: Slot, ladder: Ladder) -> Parsed | None:
        """Extend the expression ``left`` by an operator after it, and the operator's other operands."""
        for form in self._table.going_on[ladder]:
            first = form.parts[0]
            if ladder is Ladder.ORDINARY and slot.ladder is Ladder.TEMPORAL:
                if form.level < SHARED:
                    continue
            elif form.level < slot.level:
                continue
            if not isinstance(first, Slot):
                continue
            if form.text in _DIRECTIONS and self.words[left.end - 1] in _CORNERS:
                continue
            links: tuple[Tree, ...] = (left.tree,)
            if left.form is not None and not first.accepts(left.form):
                if not (
                    form.associativity is Associativity.CHAINED
                    and left.form.associativity is Associativity.CHAINED
                    and (left.form.ladder, left.form.level) == (form.ladder, form.level)
                    and isinstance(left.tree, tuple)
                ):
                    continue
                links = left.tree[1]
            for end, parts in self._parts(form, 1, left.end, links):
                return Parsed((form, parts), form, end)
        return None

    def _parts(
        self, form: Form, index: int, at: int, done: tuple[Tree, ...]
    ) -> Iterator[tuple[int, tuple[Tree, ...]]]:
        """The first way to continue with the rest of a form, or ``None``."""
        if index == len(form.parts):
            yield at, done
            return
        part = form.parts[index]
        match part:
            case Word():
                if self.words[at] == part.text:
                    yield from self._parts(form, index + 1, at + 1, (*done, part.text))
            case Slot():
                operand = self.operand(at, part)
                if operand is not None:
                    yield from self._parts(form, index + 1, operand.end, (*done, operand.tree))
            case Content():
                if part.optional:
                    yield from self._parts(form, index + 1, at, done)
                for content in self._contents(part, at):
                    yield from self._parts(form, index + 1, content.end, (*done, content.tree))

    def _contents(self, content: Content, at: int) -> Iterator[Parsed]:
        """A name, or one expression, stands for whatever may be there."""
        if content.rule in {"arguments", "subscripts"}:
            operand = self.operand(at, Slot(Ladder.ORDINARY, 1, (), None))
            if operand is not None:
                yield operand
        elif self.words[at].isidentifier() and self.words[at] not in RESERVED:
            yield Parsed(self.words[at], None, at + 1)


def climb(text: str, *, temporal: bool = False, table: Table = TABLE) -> str | None:
    """Return a text fully parenthesised, as it is understood; ``None`` if it is refused."""
    tree = Climber(text, table).whole(Ladder.TEMPORAL if temporal else Ladder.ORDINARY)
    return None if tree is None or (temporal and _misplaced(tree)) else _parenthesised(tree)


def _misplaced(tree: Tree) -> bool:
    """Return whether a temporal operator is called, or lies within a conditional expression: the table of
    levels does not cover this.
    """
    if isinstance(tree, str):
        return False
    form, parts = tree
    if form.node == "IfExp" and any(map(_has_temporal, parts)):
        return True
    if form.node == "Call" and parts[0] in {"( always )", "( eventually )", "( next )"}:
        return True
    return any(map(_misplaced, parts))


def _has_temporal(tree: Tree) -> bool:
    return not isinstance(tree, str) and (tree[0].node == "Temporal" or any(map(_has_temporal, tree[1])))


def _parenthesised(tree: Tree) -> str:
    return tree if isinstance(tree, str) else f"( {' '.join(map(_parenthesised, tree[1]))} )"
