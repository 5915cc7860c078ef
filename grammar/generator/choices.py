"""Emits choices among alternatives: what they have in common is matched once, then the ways part."""

from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass

from grammar.generator.actions import Translated
from grammar.generator.analysis import same_item
from grammar.generator.checks import value_item
from grammar.generator.items import ItemWriter
from grammar.generator.model import (
    ERROR,
    KINDS,
    Alternative,
    BlockEnded,
    Cut,
    Gather,
    GrammarError,
    Look,
    Named,
    Optional,
    Reference,
    Repeat,
    Token,
    TokenChoice,
    is_varied,
)
from grammar.generator.writing import plus


@dataclass(frozen=True, slots=True)
class Branch:
    """An alternative of which the items before ``position`` are matched, their values in ``variables``.

    As long as only tokens are matched, ``start`` is the variable with the index of the first, ``tokens`` their number.
    """

    alternative: Alternative
    position: int = 0
    variables: tuple[str | None, ...] = ()
    start: str | None = None
    tokens: int = 0

    @property
    def done(self) -> bool:
        return self.position == len(self.alternative.items)


@dataclass(frozen=True, slots=True)
class Mode:
    """The use of an alternative's value: it is returned, or becomes the left operand of the next iteration.

    ``operand`` is the name of a left operand that is matched already. ``whole`` says that the rule fails if the
    choice does.
    """

    rule: str
    operand: str | None = None
    again: bool = False
    whole: bool = False


class ChoiceWriter(ItemWriter):
    """Code that tries alternatives in order and leaves with the value of the first that matches."""

    def choice(self, branches: Sequence[Branch], mark: str, mode: Mode) -> None:
        """Try ``branches`` at ``mark``, where ``p`` is; code after this runs if none of them matches."""
        groups: list[list[Branch]] = []
        for branch in branches:
            if (
                groups
                and not branch.done
                and not groups[-1][0].done
                and same_item(self.next_of(groups[-1][0]), self.next_of(branch))
            ):
                groups[-1].append(branch)
            else:
                groups.append([branch])
        what = "kinds[p]"
        if len(groups) > 1 and self.fast:
            what = self.fresh("k")
            self.line(f"{what} = kinds[p]")
        for index, group in enumerate(groups):
            if group[0].done:
                self.finish(group[0], mode)
                return
            later = groups[index + 1 :]
            self.group(group, mark if later else None, what, mode, later if len(groups) > 1 else None)

    @staticmethod
    def next_of(branch: Branch) -> Named:
        return branch.alternative.items[branch.position]

    def is_last_resort(
        self, group: list[Branch], first: frozenset[int], later: list[list[Branch]], mode: Mode
    ) -> bool:
        """Return whether the rule's outcome is that of the next item of ``group``, for a token in ``first``."""
        branch = group[0]
        if len(group) > 1 or branch.position or len(branch.alternative.items) > 1 or mode.operand is not None:
            return False
        if branch.alternative.action is not None:
            return False
        return mode.whole and not any(
            first & self.analysis.first_of(other.alternative.items) for each in later for other in each
        )

    def needed_ahead(self, group: list[Branch]) -> int | None:
        """Return the keyword that has to follow an expression, at the same depth of brackets, for ``group`` to match.

        Whether it does can be looked up; that saves parsing the expression in vain.
        """
        branch = group[0]
        items = branch.alternative.items
        if len(group) > 1 or branch.position + 1 >= len(items):
            return None
        item, following = items[branch.position].item, items[branch.position + 1].item
        if not isinstance(item, Reference) or item.rule not in self.analysis.steps:
            return None
        if not isinstance(following, Token) or following.text not in self.grammar.vocabulary.hard_keywords:
            return None
        return self.grammar.vocabulary.kind(following)

    def group(
        self,
        group: list[Branch],
        mark: str | None,
        what: str,
        mode: Mode,
        later: list[list[Branch]] | None,
    ) -> None:
        """Try branches with a common next item; put ``p`` back to ``mark`` afterwards, if given.

        ``later`` are the groups tried after it, ``None`` if it is the only one.
        """
        item = self.next_of(group[0]).item
        if isinstance(item, Token | TokenChoice):
            self.tokens(group, mark, what, mode)
            return
        if later is not None and self.fast and not isinstance(item, Look | Cut | BlockEnded):
            rests = [branch.alternative.items[branch.position :] for branch in group]
            if not any(self.analysis.is_nullable(rest) for rest in rests):
                first = frozenset().union(*(self.analysis.first_of(rest) for rest in rests))
                with self.block(f"if {self.kinds(first, what)}:"):
                    if isinstance(item, Reference) and self.is_last_resort(group, first, later, mode):
                        self.line(f"return parse_{item.rule}()")
                        return
                    kinds_ahead = self.needed_ahead(group)
                    with (
                        self.block(f"if ahead({kinds_ahead}):") if kinds_ahead is not None else nullcontext()
                    ):
                        self.step(group, mode)
                    if mark is not None:
                        self.reset(mark)
                return
        self.step(group, mode)
        if mark is not None:
            self.reset(mark)

    def variable_of(self, group: list[Branch]) -> str | None:
        """Return the variable for the value of the next item of ``group``, if any of its branches uses it."""
        for branch in group:
            if self.next_of(branch).name is not None:
                return f"v_{self.next_of(branch).name}"
        for branch in group:
            alternative = branch.alternative
            if alternative.action is None and value_item(alternative, "") is self.next_of(branch):
                return self.fresh("u")
        return self.fresh("u") if self.tracing and is_varied(self.next_of(group[0]).item) else None

    def advance(self, group: list[Branch], variable: str | None, mode: Mode) -> None:
        """Go on with the items after the next one of ``group``."""
        keeps = isinstance(self.next_of(group[0]).item, Look | Cut | BlockEnded)
        branches = [
            Branch(
                branch.alternative,
                branch.position + 1,
                (*branch.variables, variable),
                branch.start if keeps else None,
                branch.tokens,
            )
            for branch in group
        ]
        mark = "p"
        if sum(1 for _ in self.split(branches)) > 1:
            mark = self.fresh("m")
            self.line(f"{mark} = p")
        self.choice(branches, mark, mode)

    def split(self, branches: Sequence[Branch]) -> Iterator[None]:
        previous: Branch | None = None
        for branch in branches:
            if (
                previous is None
                or previous.done
                or branch.done
                or not same_item(self.next_of(previous), self.next_of(branch))
            ):
                previous = branch
                yield None

    def tokens(self, group: list[Branch], mark: str | None, what: str, mode: Mode) -> None:
        """The next item is a token; so may be some after it."""
        tests: list[str] = []
        start = group[0].start
        before = group[0].tokens
        # But in the fast parser the tests move ``p`` on, and captures are counted back from it.
        captures: list[tuple[str, int]] = []
        while isinstance(item := self.next_of(group[0]).item, Token | TokenChoice):
            variable = self.variable_of(group)
            offset = len(tests)
            tests.append(self.token_test(item, what if offset == 0 else f"kinds[p + {offset}]"))
            if variable is not None and start is not None and self.fast:
                variable = plus(start, before + offset)
            elif variable is not None:
                captures.append((variable, offset))
            group = [
                Branch(
                    each.alternative,
                    each.position + 1,
                    (*each.variables, variable),
                    start,
                    before + offset + 1,
                )
                for each in group
            ]
            if len(group) > 1 or group[0].done:
                break
        with self.block(f"if {' and '.join(tests)}:"):
            if self.fast:
                for variable, offset in captures:
                    self.line(f"{variable} = {plus('p', offset)}")
                self.line(
                    f"p += {len(tests)}" if start is None else f"p = {plus(start, before + len(tests))}"
                )
            else:
                for variable, offset in captures:
                    self.line(f"{variable} = p - {len(tests) - offset}")
            inner = "p"
            if sum(1 for _ in self.split(group)) > 1:
                inner = self.fresh("m")
                self.line(f"{inner} = p")
            self.choice(group, inner, mode)
            if mark is not None and self.fast:
                self.reset(mark)
        if mark is not None and not self.fast:
            self.reset(mark)

    def step(self, group: list[Branch], mode: Mode) -> None:
        """Match the next item of ``group``, which is not a token, and continue with the items after it."""
        item = self.next_of(group[0]).item
        variable = self.variable_of(group)
        match item:
            case Reference():
                target = variable or self.fresh("u")
                self.line(f"{target} = parse_{item.rule}()")
                with self.block(f"if {target} is not None:"):
                    self.advance(group, variable, mode)
            case Optional():
                target = variable or self.fresh("u")
                self.optional(item.item, target)
                self.advance(group, variable, mode)
            case Repeat():
                target = variable or self.fresh("u")
                self.repeat(item, target)
                if item.at_least_one:
                    with self.block(f"if {target}:"):
                        self.advance(group, variable, mode)
                else:
                    self.advance(group, variable, mode)
            case Gather():
                target = variable or self.fresh("u")
                element = self.fresh("u")
                self.value(item.item, element)
                with self.block(f"if {element} is not None:"):
                    self.line(f"{target} = [{element}]")
                    self.gather(item, target, element)
                    self.advance(group, variable, mode)
            case Look():

                def then() -> None:
                    if self.tracing and variable is not None:
                        self.line(f"{variable} = int(p)")
                    self.advance(group, variable, mode)

                self.look(item, then)
            case BlockEnded():
                with self.block(f"if kinds[p - 1] == {KINDS['DEDENT']}:"):
                    self.advance(group, variable, mode)
            case Cut():
                if mode.operand is not None:
                    raise GrammarError(f"rule {mode.rule!r}: `~` cannot stand after a left operand")
                self.advance(group, variable, mode)
                self.line("return None")
            case _:
                raise AssertionError(item)

    # Results.

    def finish(self, branch: Branch, mode: Mode) -> None:
        """All items of an alternative are matched: make its value."""
        alternative = branch.alternative
        if alternative.action is None:
            item_of_value = value_item(alternative, mode.rule)
            index = next(i for i, entry in enumerate(alternative.items) if entry is item_of_value)
            self.used(branch, mode)
            self.result(str(branch.variables[index]), mode)
            return
        names = {
            entry.name: str(variable)
            for entry, variable in zip(alternative.items, branch.variables, strict=True)
            if entry.name is not None
        }
        if mode.operand is not None:
            names[mode.operand] = f"v_{mode.operand}"
        translation = self.translator.translate(alternative.action, names, mode.rule)
        if translation.guard is not None:
            with self.block(f"if {translation.guard}:"):
                self.make(branch, translation, mode)
        else:
            self.make(branch, translation, mode)

    def make(self, branch: Branch, translated: Translated, mode: Mode) -> None:
        end = "e"
        if translated.place:
            if branch.start is not None and self.fast:
                end = plus(branch.start, branch.tokens - 1)
                if (
                    end != branch.start
                    or "end_lines[e]" in str(translated.value)
                    or "[e]" in str(translated.node)
                ):
                    self.line(f"e = {end}")
                    end = "e"
            else:
                self.line("e = p - 1")
            if self.analysis.ends_with_layout(branch.alternative.items):
                # In a text with a mistake, a token without text may stand after the end of the source.
                gap = f" or (kinds[e] == {ERROR} and not texts[e])" if self.recording else ""
                with self.block(f"while kinds[e] < 4{gap}:"):
                    self.line("e -= 1")
        if translated.node is not None:
            name, fields = translated.node
            self.line(f"n = new({name})")
            if self.translator.classes[name].located:
                places = (
                    "'lineno': lines[s], 'col_offset': columns[s], "
                    f"'end_lineno': end_lines[{end}], 'end_col_offset': end_columns[{end}]"
                )
                fields = f"{fields}, {places}" if fields else places
            self.line(f"n.__dict__ = {{{fields}}}")
            self.used(branch, mode)
            self.result("n", mode)
        elif translated.may_fail and translated.value not in branch.variables:
            self.line(f"r = {translated.value}")
            with self.block("if r is not None:"):
                self.used(branch, mode)
                self.result("r", mode)
        else:
            self.used(branch, mode)
            self.result(str(translated.value), mode)

    def used(self, branch: Branch, mode: Mode) -> None:
        """In the tracing parser, note on the way that an alternative matched, and with which optional parts."""
        if not self.tracing:
            return
        values = [
            str(variable)
            for entry, variable in zip(branch.alternative.items, branch.variables, strict=True)
            if is_varied(entry.item)
        ]
        number = self.number_of(mode.rule, branch.alternative, has_operand=mode.operand is not None)
        self.line(f"p = p.after({', '.join([repr(mode.rule), str(number), *values])})")

    def number_of(self, rule: str, alternative: Alternative, *, has_operand: bool) -> int:
        """The number of an alternative in its rule, from 1; its left operand may be cut off."""
        return next(
            number
            for number, each in enumerate(self.grammar.rules[rule].alternatives, 1)
            if each.items[1 if has_operand else 0 :] == alternative.items
            and each.action == alternative.action
        )

    def result(self, value: str, mode: Mode) -> None:
        if mode.again:
            self.line(f"v_{mode.operand} = {value}")
            self.line("continue")
        else:
            self.line(f"return {value}")
