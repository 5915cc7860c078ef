"""Hypothesis strategies for sentences of the grammar: programs, and the text of any rule.

A sentence is made from left to right. Each expansion of a rule draws one number, which chooses among the options that
still fit into the depth left, the shortest first: so that generation ends, and shrinking leads to short sentences.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import accumulate
from typing import Final, NamedTuple

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from fuzz.derivations import AlternativeId, Derivations, Option, load
from fuzz.layout import lay_out
from fuzz.terminals import FIXED, Piece, Pools, Shape, pools
from grammar.generator.model import Gather, Item, Optional, Reference, Repeat, Token, TokenChoice

__all__ = ["Limits", "Program", "derivations", "from_grammar", "programs"]


@dataclass(frozen=True, slots=True)
class Limits:
    """How large a sentence may get.

    ``depth`` is the number of expansions within each other, not counting what a rule needs at least;
    ``expansions`` how many there are before only the shortest ones are used.
    """

    depth: int = 10
    expansions: int = 60


@dataclass(frozen=True, slots=True)
class Program:
    """A sentence: its text, its tokens before they were laid out, and the alternatives that it uses."""

    text: str
    pieces: tuple[Piece, ...] = field(repr=False)
    alternatives: frozenset[AlternativeId] = field(repr=False)


class Ban(NamedTuple):
    """What must not be chosen within a rule: names, and options that begin with a word."""

    names: frozenset[str]
    starts: frozenset[str]


_NOTHING: Final = Ban(frozenset(), frozenset())
_BANS: Final[Mapping[str, Ban]] = {
    # Temporal operators where a name was meant; and the operands of a specifier reach as far as possible,
    # so that in `new C at x and always y` the word `always` would be a name.
    "require_statement": Ban(frozenset({"always", "eventually", "next"}), frozenset({"new"})),
    # `record final x every 2 seconds` has no `every`.
    "record_statement": Ban(frozenset({"initial", "final"}), frozenset()),
    # `match [final]:` begins like a property.
    "subject": Ban(frozenset({"additive", "dynamic", "final"}), frozenset()),
}

_LEAVES: Final = 0.4
"""The probability of the lowest expressions, if higher ones fit."""
_FAR: Final = 1 << 20
_SCALE: Final = 1 << 12
_NUMBER: Final = st.integers(0, _SCALE - 1)
_BIT: Final = st.integers(0, 1)
_TWO_BITS: Final = st.integers(0, 3)
_LAYOUT: Final = st.integers(0, (1 << 16) - 1)


def from_grammar(rule: str = "file", *, limits: Limits = Limits()) -> SearchStrategy[str]:
    """Texts that ``rule`` of the grammar derives; those of the rule ``file`` are programs.

    Raises `KeyError` if there is no such rule.
    """
    return programs(rule, limits=limits).map(lambda program: program.text)


def programs(
    rule: str = "file", *, limits: Limits = Limits(), aims: Sequence[AlternativeId] | None = None
) -> SearchStrategy[Program]:
    """As `from_grammar`, with what the text was made of.

    Three of four programs are led to one of the alternatives ``aims`` each, by default one of all.
    """
    if rule not in derivations().grammar.rules:
        raise KeyError(f"the grammar has no rule {rule!r}")
    generator = _generator(limits)
    if aims is None:
        aims = sorted(derivations().countable)
    chosen_aim = st.integers(0, 4 * len(aims) - 1)

    @st.composite
    def sentence(draw: DrawFn) -> Program:
        number = draw(chosen_aim)
        aim = aims[number // 4] if number % 4 else None
        pieces, alternatives = generator.sentence(draw, rule, aim)
        seed = draw(_LAYOUT)
        return Program(lay_out(pieces, seed=seed), tuple(pieces), frozenset(alternatives))

    return sentence()


@cache
def derivations() -> Derivations:
    """Those of ``grammar/scenic.gram``, read once."""
    return load()


@cache
def _generator(limits: Limits) -> "_Generator":
    return _Generator(derivations(), limits)


@dataclass(frozen=True, slots=True)
class _Aim:
    """An alternative that a sentence has to use, and how far it is from each rule."""

    alternative: AlternativeId
    distances: Mapping[str, int]

    def way(self, option: Option) -> tuple[int, int | None]:
        """How far it is from an option, -1 if this is it, and through which of its items."""
        if self.alternative in option.counts_as:
            return -1, None
        distances = self.distances
        return min(
            ((distances[rule], index) for rule, index in option.leads_to if rule in distances),
            default=(_FAR, None),
        )


@dataclass(slots=True)
class _State:
    """A sentence that is being made."""

    depth: int
    remaining: int
    pieces: list[Piece] = field(default_factory=list)
    alternatives: set[AlternativeId] = field(default_factory=set)
    brackets: int = 0
    fields: list[int] = field(default_factory=list)
    """The depth of brackets at the start of each open replacement field."""
    quotes: list[str] = field(default_factory=list)
    """The closing quotes of the open f-strings."""
    bans: list[Ban] = field(default_factory=list)
    aim: _Aim | None = None
    """What the item to be made next has to lead to."""
    specified: bool = False
    """Whether a specifier list stands before in this line, which a comma and a fitting word would continue."""


class _Generator:
    """Makes sentences. One strategy for each rule, so that Hypothesis knows the parts of a sentence."""

    def __init__(self, derivations: Derivations, limits: Limits) -> None:
        self._derivations = derivations
        self._limits = limits
        self._options = derivations.options
        self._pools: Pools = pools(frozenset(derivations.grammar.vocabulary.soft_keywords))
        self._indices = {kind: st.integers(0, len(row) - 1) for kind, row in self._pools.rows.items()}
        self._specifier_starts = frozenset(
            option.start for option in self._options["specifier"] if option.start and option.start.isalpha()
        )
        self._strategies = {rule: self._strategy(rule) for rule in self._options}
        self._tables: dict[tuple[str, int], list[int]] = {}
        self._aims: dict[AlternativeId, _Aim] = {}
        # Replaced at the start of each sentence; the strategies above find their state here.
        self._state = _State(0, 0)

    def sentence(
        self, draw: DrawFn, rule: str, aim: AlternativeId | None
    ) -> tuple[list[Piece], set[AlternativeId]]:
        """Make a sentence of ``rule`` that uses the alternative ``aim`` if it can."""
        limits = self._limits
        self._state = _State(self._derivations.height(rule) + limits.depth, limits.expansions)
        if aim is not None:
            if aim not in self._aims:
                self._aims[aim] = _Aim(aim, self._derivations.distances(aim))
            self._state.aim = self._aims[aim]
        self._expand(draw, rule)
        return self._state.pieces, self._state.alternatives

    def _strategy(self, rule: str) -> SearchStrategy[None]:
        @st.composite
        def expansion(draw: DrawFn) -> None:
            self._expand(draw, rule)

        return expansion()

    # Rules.

    def _expand(self, draw: DrawFn, rule: str) -> None:
        state = self._state
        depth = state.depth
        state.remaining -= 1
        if state.remaining < 0:
            depth = min(depth, self._derivations.height(rule))
        aim, state.aim = state.aim, None
        option, way = (None, None) if aim is None else self._nearest(draw, rule, aim)
        if option is None:
            option = self._choose(draw, rule, depth)
        state.alternatives.update(option.counts_as)
        bans = len(state.bans)
        state.bans += [_BANS[each.rule] for each in option.counts_as if each.rule in _BANS]
        for index, item in enumerate(option.items):
            state.depth = depth - 1
            state.aim = aim if index == way else None
            self._emit(draw, item)
        state.aim = None
        state.depth = depth
        del state.bans[bans:]
        if option.rule == "specifier":
            state.specified = True

    def _nearest(self, draw: DrawFn, rule: str, aim: "_Aim") -> tuple[Option | None, int | None]:
        """An option on a shortest way to what is aimed at, and the item where the way goes on."""
        best: list[tuple[Option, int | None]] = []
        # Every step has to lead nearer, or there would be no end.
        least = aim.distances.get(rule, 0) - 1
        for option in self._options[rule]:
            distance, way = aim.way(option)
            if distance <= least and not self._is_banned(option):
                if distance < least:
                    best, least = [], distance
                best.append((option, way))
        if len(best) < 2:
            return best[0] if best else (None, None)
        return best[draw(_NUMBER) * len(best) // _SCALE]

    def _choose(self, draw: DrawFn, rule: str, depth: int) -> Option:
        options = self._options[rule]
        if len(options) == 1:
            return options[0]
        table = self._table(rule, depth)
        option = options[bisect_right(table, draw(_NUMBER) * table[-1] // _SCALE)]
        if self._is_banned(option):
            return next((each for each in options if not self._is_banned(each)), option)
        return option

    def _table(self, rule: str, depth: int) -> list[int]:
        """The accumulated weights of the options of ``rule`` that fit into ``depth``."""
        options = self._options[rule]
        lowest = options[0].height
        depth = max(lowest, min(depth, options[-1].height))
        table = self._tables.get((rule, depth))
        if table is None:
            fitting = [option for option in options if option.height <= depth]
            leaves = sum(option.weight for option in fitting if option.height == lowest)
            others = sum(option.weight for option in fitting) - leaves
            share = max(1.0, others * _LEAVES / (1 - _LEAVES) / leaves)
            if not any(option.rule == "atom" for option in fitting):
                share = 1.0
            weights = [option.weight * (share if option.height == lowest else 1) for option in fitting]
            total = sum(weights)
            table = [max(1, round(_SCALE * 16 * weight / total)) for weight in weights]
            table = self._tables[rule, depth] = list(accumulate(table))
        return table

    def _is_banned(self, option: Option) -> bool:
        state = self._state
        start = option.start
        if state.fields and state.fields[-1] == state.brackets and option.has_colon:
            # A colon that is not in brackets ends the expression of a replacement field.
            return option.rule != "format_specification"
        if start is None:
            return False
        if state.specified and option.rule != "specifier":
            word = option.second if start == "not" else start
            if word in self._specifier_starts:
                return True
        return any(start in ban.starts for ban in state.bans)

    # Items.

    def _emit(self, draw: DrawFn, item: Item) -> None:
        state = self._state
        match item:
            case Token(literal=True):
                self._literal(item.text)
            case Token():
                self._terminal(draw, item.text)
            case Reference():
                if item.rule in self._strategies:
                    draw(self._strategies[item.rule])
                else:
                    self._terminal(draw, item.rule)
            case TokenChoice():
                self._literal(item.tokens[draw(st.integers(0, len(item.tokens) - 1))].text)
            case Optional():
                if state.aim is not None or (draw(_BIT) and self._fits(item.item)):
                    self._emit(draw, item.item)
            case Repeat():
                self._repeat(draw, item.item, None, at_least_one=item.at_least_one)
            case Gather():
                self._repeat(draw, item.item, item.separator, at_least_one=True)
            case _:
                raise AssertionError(f"lookaheads and cuts are left out, but this is {item}")

    def _fits(self, item: Item) -> bool:
        state = self._state
        return state.remaining > 0 and self._derivations.item_height(item) <= state.depth

    def _repeat(self, draw: DrawFn, item: Item, separator: Item | None, *, at_least_one: bool) -> None:
        state = self._state
        depth = state.depth
        # Statements go on with a probability of 3/4, all else with one of 1/2.
        more = _TWO_BITS if isinstance(item, Reference) and "statement" in item.rule else _BIT
        started = False
        while True:
            if (started or not at_least_one) and state.aim is None:
                state.depth = depth
                # Drawn in any case: shrinking deletes parts, and what comes after them must not need more draws.
                if not (draw(more) and self._fits(item)):
                    return
                if started and separator is not None:
                    self._emit(draw, separator)
            state.depth = depth
            self._emit(draw, item)
            started = True

    # Tokens.

    def _literal(self, text: str) -> None:
        state = self._state
        if text in ("(", "[", "{"):
            state.brackets += 1
        elif text in (")", "]", "}"):
            state.brackets -= 1
        state.pieces.append(Piece(text, Shape.WORD if text.isidentifier() else Shape.OPERATOR))

    def _terminal(self, draw: DrawFn, kind: str) -> None:
        state = self._state
        if kind == "ENDMARKER":
            return
        if kind == "FSTRING_END":
            state.pieces.append(Piece(state.quotes.pop(), Shape.FORMATTED_END))
            return
        piece = FIXED.get(kind)
        if piece is None:
            row = self._pools.rows[kind]
            piece = row[draw(self._indices[kind])]
            if piece.shape is Shape.WORD and self._is_banned_name(piece.text):
                piece = row[0]
        state.pieces.append(piece)
        match piece.shape:
            case Shape.NEWLINE:
                state.specified = False
            case Shape.FORMATTED_START:
                state.quotes.append(piece.text.lstrip("fFrR"))
            case Shape.FIELD_OPEN:
                state.brackets += 1
                state.fields.append(state.brackets)
            case Shape.FIELD_CLOSE:
                state.brackets -= 1
                state.fields.pop()
            case _:
                pass

    def _is_banned_name(self, name: str) -> bool:
        state = self._state
        return (state.specified and name in self._specifier_starts) or any(
            name in ban.names for ban in state.bans
        )
