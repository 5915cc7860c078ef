"""Programs made from the grammar: sentences of any rule, as Hypothesis strategies or from plain random numbers.

A sentence is made from left to right. Each expansion of a rule takes one number, which chooses among the options that
still fit into the depth left, the shortest first: so that generation ends, and shrinking leads to short sentences.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import accumulate
from typing import Final

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from fuzz.derivations import AlternativeId, Derivations, Option, load
from fuzz.draws import Draws, HypothesisDraws
from fuzz.layout import lay_out
from fuzz.names import SCALE, SCOPES, Names, Role
from fuzz.places import Step, Surroundings, enter
from fuzz.plans import Ban, Plan, count_names, plans_of
from fuzz.terminals import FIXED, NAMES_WITHOUT, ROWS, Piece, Shape
from grammar.generator.model import Gather, Item, Optional, Reference, Repeat, Token, TokenChoice
from scenic.language.statements import Place

__all__ = ["Limits", "Program", "derivations", "from_grammar", "make_program", "programs"]


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits on the size of a sentence.

    ``depth`` is the number of expansions within each other, not counting what a rule needs at least;
    ``expansions`` how many there are before only the shortest ones are used.
    """

    depth: int = 10
    expansions: int = 50


@dataclass(frozen=True, slots=True)
class Program:
    """A sentence: its text, its tokens before they were laid out, and the alternatives that it uses.

    ``wild`` tells whether names and statements may stand where they make no sense.
    """

    text: str
    pieces: tuple[Piece, ...] = field(repr=False)
    alternatives: frozenset[AlternativeId] = field(repr=False)
    wild: bool = False


_LEAVES: Final = 0.5
"""The probability of the lowest expressions, if higher ones fit."""
_FAR: Final = 1 << 20
_SCALE: Final = SCALE
_LAYOUTS: Final = 1 << 16
_WILD: Final = 5
"""Number of programs among which one is wild."""
_TRIES: Final = 8
_ASYNC: Final = Token("async", literal=True)
_HARMLESS: Final = "Range"
"""A name that begins no operator, and that every program can read."""
_LINES: Final = frozenset({"statement", "class_item", "simple_statements", "open_statement"})
"""Rules that begin where what stands before is done."""


def from_grammar(rule: str = "file", *, limits: Limits = Limits()) -> SearchStrategy[str]:
    """Return a strategy for texts that ``rule`` of the grammar derives; those of the rule ``file`` are programs.

    Raises `KeyError` if there is no such rule.
    """
    return programs(rule, limits=limits).map(lambda program: program.text)


def programs(
    rule: str = "file", *, limits: Limits = Limits(), aims: Sequence[AlternativeId] | None = None
) -> SearchStrategy[Program]:
    """Return a strategy for the texts of `from_grammar` together with what they were made of.

    Three of four programs are led to one of the alternatives ``aims`` each, by default one of all.
    """
    if rule not in derivations().grammar.rules:
        raise KeyError(f"the grammar has no rule {rule!r}")

    @st.composite
    def sentence(draw: DrawFn) -> Program:
        return make_program(HypothesisDraws(draw), rule, limits=limits, aims=aims)

    return sentence()


def make_program(
    draws: Draws,
    rule: str = "file",
    *,
    limits: Limits = Limits(),
    aims: Sequence[AlternativeId] | None = None,
) -> Program:
    """A sentence made from the numbers of ``draws``; see `programs`."""
    if aims is None:
        aims = _all_aims()
    number = draws.number(4 * len(aims))
    aim = aims[number // 4] if number % 4 else None
    wild = draws.number(_WILD) == _WILD - 1
    pieces, alternatives = _generator(limits).sentence(draws, rule, aim, wild=wild)
    seed = draws.number(_LAYOUTS)
    return Program(lay_out(pieces, seed=seed), tuple(pieces), frozenset(alternatives), wild)


@cache
def derivations() -> Derivations:
    """Return the derivations of ``grammar/scenic.gram``, read once."""
    return load()


@cache
def _all_aims() -> tuple[AlternativeId, ...]:
    return tuple(sorted(derivations().countable))


@cache
def _generator(limits: Limits) -> "_Generator":
    return _Generator(derivations(), limits)


@dataclass(frozen=True, slots=True)
class _Aim:
    """An alternative that a sentence has to use, and how far it is from each rule."""

    alternative: AlternativeId
    distances: Mapping[str, int]

    def way(self, option: Option) -> tuple[int, int | None]:
        """Return the distance from an option, -1 for the option itself, and the item of it that leads here."""
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

    draws: Draws
    names: Names
    wild: bool
    depth: int
    remaining: int
    around: Surroundings = field(default_factory=Surroundings)
    pieces: list[Piece] = field(default_factory=list)
    alternatives: set[AlternativeId] = field(default_factory=set)
    brackets: int = 0
    fields: list[int] = field(default_factory=list)
    """The depth of brackets at the start of each open replacement field."""
    quotes: list[str] = field(default_factory=list)
    """The closing quotes of the open f-strings."""
    bans: list[Ban] = field(default_factory=list)
    aim: _Aim | None = None
    """The aim to which the next item has to lead."""
    specified: bool = False
    """True if a specifier list comes before in this line, which a comma and a fitting word would continue."""
    role: Role = Role.ANY
    """The role of the next name."""
    given: Role | None = None
    """The role that the next rule's names have where it is referred to."""
    stars: int = 0
    """Number of starred items that may still come in the row of targets or patterns."""
    claimed: set[str] = field(default_factory=set)
    """The properties that the specifiers so far give."""
    read: int = 0
    """Number of tokens at the last name that is read."""
    in_lines: int = 0
    """In how many statements whose specifiers stand on lines of their own."""
    generous: bool = False
    """True if the next item belongs to the aim, and so should have all its parts."""
    sees: int = 0
    """After how many tokens the specifier `visible` ended last."""
    alone: bool = False
    """True if the next row has to consist of one item."""


class _Generator:
    """Makes sentences, one at a time."""

    def __init__(self, derivations: Derivations, limits: Limits) -> None:
        self._derivations = derivations
        self._limits = limits
        self._options = plans_of(derivations)
        self._soft_keywords = tuple(sorted(derivations.grammar.vocabulary.soft_keywords))
        self._specifier_starts = frozenset(
            plan.option.start
            for plan in self._options["specifier"]
            if plan.option.start and plan.option.start.isalpha()
        )
        self._operator_starts = frozenset(
            (plan.option.start, plan.option.second)
            for plan in self._options["prefix_operation"]
            if plan.option.start and plan.option.second
        )
        self._tables: dict[tuple[str, int], list[int]] = {}
        self._aims: dict[AlternativeId, _Aim] = {}
        self._state: _State

    def sentence(
        self, draws: Draws, rule: str, aim: AlternativeId | None, *, wild: bool
    ) -> tuple[list[Piece], set[AlternativeId]]:
        """Make a sentence of ``rule`` that uses the alternative ``aim`` if it can."""
        limits = self._limits
        names = Names(self._soft_keywords, wild=wild)
        depth = self._derivations.height(rule) + limits.depth
        self._state = _State(draws, names, wild, depth, limits.expansions)
        if aim is not None:
            if aim not in self._aims:
                self._aims[aim] = _Aim(aim, self._derivations.distances(aim))
            self._state.aim = self._aims[aim]
        self._expand(rule)
        return self._state.pieces, self._state.alternatives

    # Rules.

    def _expand(self, rule: str) -> None:
        state = self._state
        depth = state.depth
        state.remaining -= 1
        if rule in _LINES:
            state.names.end_line()
        if state.remaining < 0:
            depth = min(depth, self._derivations.height(rule))
        aim, state.aim = state.aim, None
        plan, way = (None, None) if aim is None else self._nearest(rule, aim)
        if plan is None:
            plan = self._choose(rule, depth)
        option = plan.option
        state.alternatives.update(option.counts_as)
        bans = len(state.bans)
        state.bans += plan.bans
        stars = state.stars
        if plan.row:
            state.stars = int(len(option.items) > 1)
        elif plan.starred:
            stars -= 1
        role_before, state.given = state.given, None
        if plan.first_specifier:
            state.claimed = set()
        properties_before = state.claimed
        properties_before |= plan.properties
        if plan.has_parameters:
            state.names.open_signature()
        state.in_lines += plan.has_lines
        generous = aim is not None and aim.alternative in option.counts_as
        roles = iter(plan.roles)
        for index, item in enumerate(option.items):
            state.depth = depth - 1
            state.aim = aim if index == way else None
            state.alone = plan.one_target and not state.wild and state.around.place is not Place.COMPOSE
            state.role = next(roles, Role.ANY) if count_names(item) else Role.ANY
            if role_before is not None and state.role is not Role.ANY:
                state.role, role_before = role_before, None
            state.given = plan.given[index]
            state.generous = generous
            step = plan.steps[index]
            if step is None:
                self._emit(item)
            else:
                self._inside(step, item)
        if plan.has_parameters:
            state.names.close_signature()
        state.in_lines -= plan.has_lines
        state.aim = None
        state.depth = depth
        state.stars = stars
        del state.bans[bans:]
        if option.rule == "specifier":
            state.specified = True
            state.claimed = properties_before
            if state.pieces[-1].text == "visible":
                state.sees = len(state.pieces)

    def _inside(self, step: Step, item: Item) -> None:
        """Emit an item within a scope or block of its own."""
        state = self._state
        around = state.around
        state.around = enter(around, step)
        if step in SCOPES:
            state.names.open(step)
            self._emit(item)
            state.names.close()
        else:
            state.names.end_line()
            self._emit(item)
        state.around = around

    def _nearest(self, rule: str, aim: _Aim) -> tuple[Plan | None, int | None]:
        """An option on a shortest path to the aim, and the item where the path continues."""
        best: list[tuple[Plan, int | None]] = []
        # Every step has to lead nearer, or there would be no end.
        least = aim.distances.get(rule, 0) - 1
        for plan in self._options[rule]:
            distance, way = aim.way(plan.option)
            if distance <= least and not self._is_banned(plan):
                if distance < least:
                    best, least = [], distance
                best.append((plan, way))
        if len(best) < 2:
            return best[0] if best else (None, None)
        return best[self._state.draws.number(len(best))]

    def _choose(self, rule: str, depth: int) -> Plan:
        plans = self._options[rule]
        if len(plans) == 1:
            return plans[0]
        table = self._table(rule, depth)
        number = self._state.draws.number(_SCALE)
        for _ in range(_TRIES):
            plan = plans[bisect_right(table, number * table[-1] // _SCALE)]
            if not self._is_banned(plan):
                return plan
            # Other numbers that follow from the first, which is all that there is to shrink.
            number = (number * 1597 + 51749) % _SCALE
        return next((each for each in plans if not self._is_banned(each)), plan)

    def _table(self, rule: str, depth: int) -> list[int]:
        """The accumulated weights of the options of ``rule`` that fit into ``depth``."""
        options = self._derivations.options[rule]
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

    def _is_banned(self, plan: Plan) -> bool:
        state = self._state
        option = plan.option
        if not state.wild:
            if plan.demand is not None and not plan.demand(state.around):
                return True
            if (plan.starred and not state.stars) or (plan.outer and not state.names.has_outer()):
                return True
            if plan.reads_ego and not state.names.has_ego():
                return True
            if not state.claimed.isdisjoint(plan.properties):
                return True
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

    def _emit(self, item: Item) -> None:
        state = self._state
        match item:
            case Token(literal=True):
                self._literal(item.text)
            case Token():
                self._terminal(item.text)
            case Reference():
                state.generous = False
                if item.rule in self._options:
                    state.draws.part(self._expand, item.rule)
                else:
                    self._terminal(item.rule)
            case TokenChoice():
                self._literal(item.tokens[state.draws.number(len(item.tokens))].text)
            case Optional():
                generous, state.generous = state.generous, False
                if state.aim is not None or (
                    state.draws.number(4 if generous else 2)
                    and (generous or self._fits(item.item))
                    and self._may_stand(item.item)
                ):
                    self._emit(item.item)
            case Repeat():
                self._repeat(item.item, None, at_least_one=item.at_least_one)
            case Gather():
                self._repeat(item.item, item.separator, at_least_one=True)
            case _:
                raise AssertionError(f"lookaheads and cuts are left out, but this is {item}")

    def _fits(self, item: Item) -> bool:
        state = self._state
        return state.remaining > 0 and self._derivations.item_height(item) <= state.depth

    def _may_stand(self, item: Item) -> bool:
        # The only optional word that asks something of the place.
        state = self._state
        return state.wild or item != _ASYNC or state.around.function == "async def"

    def _repeat(self, item: Item, separator: Item | None, *, at_least_one: bool) -> None:
        state = self._state
        depth, role_before, alone = state.depth, state.given, state.alone
        generous, state.generous = state.generous, False
        # Statements go on with a probability of 3/4, all else with one of 1/2.
        more = 4 if isinstance(item, Reference) and "statement" in item.rule else 2
        has_items = False
        while True:
            if (has_items or not at_least_one) and state.aim is None:
                state.depth = depth
                # Drawn in any case: shrinking deletes parts, and what comes after them must not need more draws.
                enough = state.draws.number(4 if generous else more) == 0
                if enough or (has_items and alone) or not (generous or self._fits(item)):
                    return
                # Once is enough to have several.
                generous = generous and not has_items
                if has_items and separator is not None:
                    self._emit(separator)
            state.depth = depth
            state.given = role_before
            self._emit(item)
            has_items = True

    # Tokens.

    def _literal(self, text: str) -> None:
        state = self._state
        if text in ("(", "[", "{"):
            state.brackets += 1
        elif text in (")", "]", "}"):
            state.brackets -= 1
        if 0 < state.read == len(state.pieces) and (state.pieces[-1].text, text) in self._operator_starts:
            # The name `distance` before `to` would begin an operator: see docs/explanation/fuzzing.md.
            state.pieces[-1] = Piece(_HARMLESS, Shape.WORD)
        if text == "from" and 0 < state.sees == len(state.pieces):
            # The specifier `visible` would take the word: it gets one of its own.
            state.pieces += Piece(text, Shape.WORD), Piece(_HARMLESS, Shape.WORD)
        state.pieces.append(Piece(text, Shape.WORD if text.isidentifier() else Shape.OPERATOR))

    def _terminal(self, kind: str) -> None:
        state = self._state
        if kind == "ENDMARKER":
            return
        if kind == "FSTRING_END":
            state.pieces.append(Piece(state.quotes.pop(), Shape.FORMATTED_END))
            return
        if kind in NAMES_WITHOUT:
            state.pieces.append(self._name(NAMES_WITHOUT[kind]))
            return
        piece = FIXED.get(kind)
        if piece is None:
            row = ROWS[kind]
            piece = row[state.draws.number(len(row))]
        state.pieces.append(piece)
        match piece.shape:
            case Shape.NEWLINE:
                state.specified = False
                if not state.in_lines:
                    state.names.end_line()
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

    def _name(self, without: frozenset[str]) -> Piece:
        state = self._state

        def fits(name: str) -> bool:
            return not (
                name in without
                or (state.role is Role.PROPERTY and name in state.claimed)
                or (state.specified and name in self._specifier_starts)
                or any(name in ban.names for ban in state.bans)
            )

        name = state.names.choose(state.role, state.draws.number(_SCALE), fits)
        if state.role is Role.IMPORTED:
            # `import a.b` binds the first name alone.
            state.role = Role.MODULE
        elif state.role is Role.PROPERTY:
            state.claimed.add(name)
        elif state.role is Role.READ:
            state.read = len(state.pieces) + 1
        return Piece(name, Shape.WORD)
