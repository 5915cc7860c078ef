"""Facts about a grammar: first tokens, left recursion, the ladder of operators, what has to be memoised."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from grammar.generator.model import (
    KINDS,
    LAYOUT,
    NAME,
    Alternative,
    BlockEnded,
    Cut,
    Gather,
    Grammar,
    GrammarError,
    Item,
    Look,
    Named,
    Optional,
    Reference,
    Repeat,
    Rule,
    Token,
    TokenChoice,
)

Found: TypeAlias = Mapping[str, frozenset[int]]


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a ladder of operators: a rule made of the next one and of operators over it.

    ``prefixes`` are the alternatives that start otherwise than with an operand, ``tails`` those that go on after
    one, without it. ``repeated`` is true of left-recursive steps.
    """

    rule: str
    operand: str
    prefixes: tuple[Alternative, ...]
    tails: tuple[Alternative, ...]
    variable: str
    repeated: bool


class Analysis:
    """Facts about a grammar that the generator needs, computed on demand."""

    def __init__(self, grammar: Grammar) -> None:
        self.grammar = grammar
        self.rules = grammar.rules
        self.soft_kinds = frozenset(grammar.vocabulary.soft_keywords.values())
        self._check_references()
        self.first = self._fixed_point(self._first_of_alternative)
        self.last = self._fixed_point(self._last_of_alternative)
        for name, kinds in self.first.items():
            if not kinds and name != grammar.start:
                raise GrammarError(f"rule {name!r} can match nothing, or never ends its recursion")

    # Tokens.

    def kinds_of(self, item: Token | TokenChoice) -> frozenset[int]:
        """Return the kinds that a token item matches; ``NAME`` matches soft keywords too."""
        if isinstance(item, TokenChoice):
            return frozenset().union(*(self.kinds_of(token) for token in item.tokens))
        kind = self.grammar.vocabulary.kind(item)
        return self.soft_kinds | {NAME} if kind == NAME else frozenset({kind})

    def items_of(self, alternative: Alternative) -> Iterator[Item]:
        """Yield the items of an alternative and all items within them."""
        stack = [entry.item for entry in reversed(alternative.items)]
        while stack:
            item = stack.pop()
            yield item
            match item:
                case Optional() | Repeat() | Look():
                    stack.append(item.item)
                case Gather():
                    stack += [item.item, item.separator]
                case _:
                    pass

    def _check_references(self) -> None:
        if self.grammar.start not in self.rules:
            raise GrammarError(f"the start rule {self.grammar.start!r} is not defined")
        for rule in self.rules.values():
            for alternative in rule.alternatives:
                for item in self.items_of(alternative):
                    if isinstance(item, Reference) and item.rule not in self.rules:
                        raise GrammarError(f"rule {rule.name!r} uses {item.rule!r}, which is not defined")

    # First and last tokens.

    def _fixed_point(
        self, of_alternative: Callable[[Sequence[Named], Found], frozenset[int]]
    ) -> dict[str, frozenset[int]]:
        kinds_of_rule: dict[str, frozenset[int]] = dict.fromkeys(self.rules, frozenset())
        is_changing = True
        while is_changing:
            is_changing = False
            for rule in self.rules.values():
                kinds = frozenset().union(
                    *(of_alternative(each.items, kinds_of_rule) for each in rule.alternatives)
                )
                if kinds != kinds_of_rule[rule.name]:
                    kinds_of_rule[rule.name] = kinds
                    is_changing = True
        return kinds_of_rule

    def _first_of_item(self, item: Item, found: Found) -> frozenset[int]:
        match item:
            case Token() | TokenChoice():
                return self.kinds_of(item)
            case Reference():
                return found[item.rule]
            case Optional() | Repeat() | Gather():
                return self._first_of_item(item.item, found)
            case _:
                return frozenset()

    @staticmethod
    def may_be_empty(item: Item) -> bool:
        """Return whether an item can match nothing."""
        return isinstance(item, Optional | Look | Cut | BlockEnded) or (
            isinstance(item, Repeat) and not item.at_least_one
        )

    def _first_of_alternative(self, items: Sequence[Named], found: Found) -> frozenset[int]:
        kinds: frozenset[int] = frozenset()
        admissible: frozenset[int] | None = None
        for entry in items:
            item = entry.item
            if isinstance(item, Look) and item.positive and not kinds:
                lookahead = self._first_of_item(item.item, found)
                admissible = lookahead if admissible is None else admissible & lookahead
            kinds |= self._first_of_item(item, found)
            if not self.may_be_empty(item):
                break
        return kinds if admissible is None else kinds & admissible

    def _last_of_alternative(self, items: Sequence[Named], found: Found) -> frozenset[int]:
        kinds: frozenset[int] = frozenset()
        for entry in reversed(items):
            item = entry.item
            match item:
                case Look() | Cut():
                    continue
                case BlockEnded():
                    kinds |= LAYOUT
                case Gather():
                    kinds |= self._last_of_item(item.item, found)
                case Optional() | Repeat():
                    kinds |= self._last_of_item(item.item, found)
                case _:
                    kinds |= self._last_of_item(item, found)
            if not self.may_be_empty(item):
                break
        return kinds

    def _last_of_item(self, item: Item, found: Found) -> frozenset[int]:
        match item:
            case Token() | TokenChoice():
                return self.kinds_of(item)
            case Reference():
                return found[item.rule]
            case _:
                return self._last_of_alternative((Named(item, None),), found)

    def first_of(self, items: Sequence[Named]) -> frozenset[int]:
        """Return the kinds with which a row of items can start; all of it may be optional."""
        return self._first_of_alternative(items, self.first)

    def is_nullable(self, items: Sequence[Named]) -> bool:
        """Return whether a row of items can match nothing."""
        return all(self.may_be_empty(named.item) for named in items)

    def ends_with_layout(self, items: Sequence[Named]) -> bool:
        """Return whether the last token of a row of items can be a line end or the end of a block."""
        return bool(self._last_of_alternative(items, self.last) & LAYOUT)

    # Left recursion.

    def is_left_recursive(self, rule: Rule) -> bool:
        """Return whether an alternative of the rule starts with the rule itself."""
        return any(
            alternative.items and alternative.items[0].item == Reference(rule.name)
            for alternative in rule.alternatives
        )

    def leftmost(self, rule: Rule) -> set[str]:
        """Return the rules that may be tried at the place where ``rule`` is tried."""
        names: set[str] = set()
        for alternative in rule.alternatives:
            for entry in alternative.items:
                for item in self.items_of(Alternative((entry,), None)):
                    if isinstance(item, Reference):
                        names.add(item.rule)
                if not self.may_be_empty(entry.item):
                    break
        return names

    # The ladder.

    @cached_property
    def steps(self) -> dict[str, Step]:
        """All rules that have the form of a step; see `Step`."""
        found = {}
        for rule in self.rules.values():
            step = self._step(rule)
            if step is not None:
                found[rule.name] = step
        # A step counts only if its operands end, step by step, in a left-recursive rule: those are operators'.
        return {name: step for name, step in found.items() if self._bottom(name, found) is not None}

    def _step(self, rule: Rule) -> Step | None:
        units = [
            alternative.items[0].item.rule
            for alternative in rule.alternatives
            if len(alternative.items) == 1
            and isinstance(alternative.items[0].item, Reference)
            and (alternative.action is None or alternative.action == alternative.items[0].name)
        ]
        if not units or rule.memo:
            return None
        recursive = self.is_left_recursive(rule)
        starts = {
            alternative.items[0].item.rule
            for alternative in rule.alternatives
            if len(alternative.items) > 1 and isinstance(alternative.items[0].item, Reference)
        } - {rule.name}
        operand = next((unit for unit in units if unit in starts), units[-1])
        head = rule.name if recursive else operand
        prefixes, tails, variables = [], [], set()
        for alternative in rule.alternatives:
            first = alternative.items[0]
            if first.item == Reference(head) and len(alternative.items) > 1:
                tails.append(Alternative(alternative.items[1:], alternative.action))
                variables.add(first.name)
            elif not (len(alternative.items) == 1 and first.item == Reference(operand)):
                prefixes.append(alternative)
        if recursive and prefixes:
            return None
        # The prefixes are tried first; one that stands after the operand must not be able to hide it.
        place = next(
            index for index, each in enumerate(rule.alternatives) if each.items[0].item == Reference(operand)
        )
        for prefix in prefixes:
            if rule.alternatives.index(prefix) > place and self.first_of(prefix.items) & self.first[operand]:
                return None
        if len(variables) > 1 or None in variables:
            raise GrammarError(f"rule {rule.name!r}: the first operand needs the same name everywhere")
        variable = variables.pop() if variables else "a"
        return Step(rule.name, operand, tuple(prefixes), tuple(tails), str(variable), recursive)

    def _bottom(self, name: str, steps: dict[str, Step]) -> str | None:
        """The lowest left-recursive step at or below ``name``."""
        bottom = None
        seen: set[str] = set()
        while name in steps and name not in seen:
            seen.add(name)
            if steps[name].repeated:
                bottom = name
            name = steps[name].operand
        return bottom

    def bottom(self, name: str) -> str:
        """The lowest left-recursive step at or below the step ``name``."""
        found = self._bottom(name, self.steps)
        assert found is not None
        return found

    def ladder(self, name: str) -> list[str]:
        """The steps from ``name`` down to its bottom, both included."""
        names = [name]
        bottom = self.bottom(name)
        while names[-1] != bottom:
            names.append(self.steps[names[-1]].operand)
        return names

    def plain_starts(self, name: str) -> tuple[frozenset[int], frozenset[int]]:
        """Return the first tokens with which every step from ``name`` to the bottom can only be its operand.

        The second set holds tokens after the first one that exclude it: `name :=` is no expression.
        """
        *above, bottom = self.ladder(name)
        kinds = self.first[bottom]
        seconds: frozenset[int] = frozenset()
        for each in above:
            for prefix in self.steps[each].prefixes:
                first, second = self.leading(prefix.items)
                if second is not None and NAME in first and len(second) == 1:
                    seconds |= second
                else:
                    kinds -= first
        return kinds, seconds

    def continuations(self, name: str) -> frozenset[int]:
        """Return the tokens that can continue an expression after an operand of the step ``name`` itself."""
        return frozenset().union(*(self.first_of(tail.items) for tail in self.steps[name].tails))

    def all_continuations(self, name: str) -> frozenset[int]:
        """Return the tokens that continue after the bottom's operand, in the step ``name`` or a step below it."""
        return frozenset().union(*(self.continuations(each) for each in self.ladder(name)[:-1]))

    # Choices that have to be tried, and what must be memoised for them.

    def leading(self, items: Sequence[Named]) -> tuple[frozenset[int], frozenset[int] | None]:
        """Return the first tokens of a row of items, and the second ones if the first item is one token."""
        first = self.first_of(items)
        rest = [named for named in items if not isinstance(named.item, Look | Cut)]
        if rest and isinstance(rest[0].item, Token | TokenChoice) and not self.is_nullable(rest[1:]):
            return first, self.first_of(rest[1:])
        return first, None

    def overlap(self, left: Sequence[Named], right: Sequence[Named]) -> frozenset[int]:
        """Return the first tokens for which both rows of items have to be tried."""
        left_first, left_second = self.leading(left)
        right_first, right_second = self.leading(right)
        if left_second is not None and right_second is not None and not left_second & right_second:
            return frozenset()
        # If one of them can match nothing, what follows the rule decides; only a text that is wrong is parsed twice.
        return left_first & right_first

    @cached_property
    def memoised(self) -> dict[str, frozenset[int] | None]:
        """The rules to memoise, with the first tokens for which it matters (``None``: all).

        A rule that tries two alternatives at one place, both of which can contain the rule again, takes exponential
        time on nested text unless what it found is kept.
        """
        tokens_of_rule: dict[str, frozenset[int] | None] = {
            rule.name: None for rule in self.rules.values() if rule.memo
        }
        for rule in self.rules.values():
            if rule.name in tokens_of_rule:
                continue
            kinds = self._retried(rule, frozenset(tokens_of_rule))
            if kinds:
                tokens_of_rule[rule.name] = kinds & self.first[rule.name]
        return tokens_of_rule

    def _retried(self, rule: Rule, stops: frozenset[str]) -> frozenset[int]:
        # The alternatives after a left operand are tried at another place than those before it.
        heads = {Reference(rule.name)}
        tails: list[Sequence[Named]] = []
        step = self.steps.get(rule.name)
        if step is not None:
            heads.add(Reference(step.operand))
            tails = [tail.items for tail in step.tails]
        bodies = [each.items for each in rule.alternatives if each.items[0].item not in heads]
        if step is not None:
            bodies.append((Named(Reference(step.operand), None),))
        start = self.first[rule.name]
        return self._retried_among(rule.name, bodies, stops, start) | self._retried_among(
            rule.name, tails, stops, start
        )

    def _retried_among(
        self, name: str, bodies: Sequence[Sequence[Named]], stops: frozenset[str], start: frozenset[int]
    ) -> frozenset[int]:
        kinds: frozenset[int] = frozenset()
        groups: list[list[Sequence[Named]]] = []
        for body in bodies:
            if groups and body and groups[-1][0] and same_item(groups[-1][0][0], body[0]):
                groups[-1].append(body)
            else:
                groups.append([body])
        for index, group in enumerate(groups):
            for later in groups[index + 1 :]:
                common = self.overlap(group[0], later[0])
                if (
                    common
                    and any(self._reaches(body, name, stops, to_cut=True) for body in group)
                    and any(self._reaches(body, name, stops, to_cut=False) for body in later)
                ):
                    kinds |= common
        for group in groups:
            if len(group) > 1:
                deeper = self._retried_among(name, [body[1:] for body in group], stops, start)
                if deeper:
                    kinds |= self.first_of(group[0]) or start
        return kinds

    def _reaches(self, items: Sequence[Named], target: str, stops: frozenset[str], *, to_cut: bool) -> bool:
        """Return whether ``items`` can contain ``target``; with ``to_cut``, before a failure would end the choice."""
        roots = []
        for entry in items:
            if to_cut and isinstance(entry.item, Cut):
                break
            roots += [
                item.rule
                for item in self.items_of(Alternative((entry,), None))
                if isinstance(item, Reference)
            ]
        rules_done: set[str] = set()
        while roots:
            rule = roots.pop()
            if rule == target:
                return True
            if rule in rules_done or rule in stops:
                continue
            rules_done.add(rule)
            for alternative in self.rules[rule].alternatives:
                roots += [item.rule for item in self.items_of(alternative) if isinstance(item, Reference)]
        return False

    def reachable(self) -> set[str]:
        """Return the rules that the start rule needs."""
        names: set[str] = set()
        roots = [self.grammar.start]
        while roots:
            rule = roots.pop()
            if rule not in names:
                names.add(rule)
                for alternative in self.rules[rule].alternatives:
                    roots += [item.rule for item in self.items_of(alternative) if isinstance(item, Reference)]
        return names


def same_item(left: Named, right: Named) -> bool:
    """Return whether two items are parsed alike and under one name, so that two alternatives can share them."""
    return left.item == right.item and (left.name == right.name or left.name is None or right.name is None)


NEWLINE = KINDS["NEWLINE"]
