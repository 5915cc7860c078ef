"""Emits the parser: one function for each rule, all within one function that holds the state of a run.

The state is the index ``p`` of the next token, shared by all functions as a closure variable. A function returns what
the rule matched and leaves ``p`` behind it, or returns ``None`` and leaves ``p`` anywhere: whoever tries something else
then puts it back. Two parsers are emitted from one grammar. The fast one looks at the next token to choose among
alternatives. The recording one tries them all, notes how far it came and what would have gone on there, and lets
``recover`` run the loops over statements; it is used only on statements that are known to be wrong.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass

from grammar.generator.actions import OPERATORS, PLACE, Translator
from grammar.generator.analysis import Analysis, Step, same_item
from grammar.generator.checks import value_item
from grammar.generator.model import (
    KINDS,
    NAME,
    Alternative,
    BlockEnded,
    Cut,
    Gather,
    GrammarError,
    Item,
    Look,
    Optional,
    Reference,
    Repeat,
    Rule,
    Token,
    TokenChoice,
)


NAME_TOKEN = Token("NAME", literal=False)


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
    """What is done with the value of an alternative: returned, or made the left operand of the next round.

    ``operand`` is the name of a left operand that is matched already. ``whole`` says that the rule fails if the
    choice does.
    """

    rule: str
    operand: str | None = None
    again: bool = False
    whole: bool = False


class Emitter:
    """Emits one of the two parsers."""

    def __init__(self, analysis: Analysis, *, recording: bool) -> None:
        self.analysis = analysis
        self.grammar = analysis.grammar
        self.recording = recording
        self.translator = Translator()
        self.lines: list[str] = []
        self.depth = 0
        self.counter = 0
        self.sets: dict[frozenset[int], str] = {}
        self.tables: list[dict[int, list[tuple[int, str]]]] = []
        self.all_soft = analysis.soft_kinds | {NAME}

    # Text.

    def line(self, text: str) -> None:
        self.lines.append("    " * self.depth + text)

    @contextmanager
    def block(self, header: str) -> Iterator[None]:
        self.line(header)
        self.depth += 1
        yield
        self.depth -= 1

    def fresh(self, prefix: str) -> str:
        self.counter += 1
        return f"{prefix}{self.counter}"

    # Tests of tokens.

    def kinds(self, kinds: frozenset[int], what: str, *, negated: bool = False) -> str:
        """The code that tests whether the kind ``what`` is one of ``kinds``."""
        if len(kinds) == 1:
            return f"{what} {'!=' if negated else '=='} {next(iter(kinds))}"
        if kinds == self.all_soft:
            return f"{what} {'<' if negated else '>='} {NAME}"
        name = self.sets.setdefault(kinds, f"SET_{len(self.sets)}")
        return f"{what} {'not in' if negated else 'in'} {name}"

    def token_test(self, item: Token | TokenChoice, what: str) -> str:
        kinds = self.analysis.kinds_of(item)
        if not self.recording:
            return self.kinds(kinds, what)
        if len(kinds) == 1:
            return f"expect({next(iter(kinds))})"
        if kinds == self.all_soft:
            return "expect_name()"
        return f"expect_any({self.sets.setdefault(kinds, f'SET_{len(self.sets)}')})"

    # Choices.

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
        if len(groups) > 1 and not self.recording:
            what = self.fresh("k")
            self.line(f"{what} = kinds[p]")
        for index, group in enumerate(groups):
            if group[0].done:
                self.finish(group[0], mode)
                return
            later = groups[index + 1 :]
            self.group(group, mark if later else None, what, mode, later if len(groups) > 1 else None)

    @staticmethod
    def next_of(branch: Branch):  # type: ignore[no-untyped-def]
        return branch.alternative.items[branch.position]

    def is_last_resort(
        self, group: list[Branch], first: frozenset[int], later: list[list[Branch]], mode: Mode
    ) -> bool:
        """Whether the rule has matched or failed with the next item of ``group``, if it starts with ``first``."""
        branch = group[0]
        if len(group) > 1 or branch.position or len(branch.alternative.items) > 1 or mode.operand is not None:
            return False
        if not isinstance(self.next_of(branch).item, Reference) or branch.alternative.action is not None:
            return False
        return mode.whole and not any(
            first & self.analysis.first_of(other.alternative.items) for each in later for other in each
        )

    def needed_ahead(self, group: list[Branch]) -> int | None:
        """The keyword that has to follow an expression, at the same depth of brackets, for ``group`` to match.

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
        if later is not None and not self.recording and not isinstance(item, Look | Cut | BlockEnded):
            rests = [branch.alternative.items[branch.position :] for branch in group]
            if not any(self.analysis.is_nullable(rest) for rest in rests):
                first = frozenset().union(*(self.analysis.first_of(rest) for rest in rests))
                with self.block(f"if {self.kinds(first, what)}:"):
                    if self.is_last_resort(group, first, later, mode):
                        self.line(f"return parse_{item.rule}()")
                        return
                    needed = self.needed_ahead(group)
                    with self.block(f"if ahead({needed})[p]:") if needed is not None else nullcontext():
                        self.step(group, mode)
                    if mark is not None:
                        self.reset(mark)
                return
        self.step(group, mode)
        if mark is not None:
            self.reset(mark)

    def variable_of(self, group: list[Branch]) -> str | None:
        """The variable for the value of the next item of ``group``, if any of its branches uses it."""
        for branch in group:
            if self.next_of(branch).name is not None:
                return f"v_{self.next_of(branch).name}"
        for branch in group:
            alternative = branch.alternative
            if alternative.action is None and value_item(alternative, "") is self.next_of(branch):
                return self.fresh("u")
        return None

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
        # In the recording parser the tests move ``p`` on, and captures are counted back from it.
        captures: list[tuple[str, int]] = []
        while True:
            item = self.next_of(group[0]).item
            variable = self.variable_of(group)
            offset = len(tests)
            tests.append(self.token_test(item, what if offset == 0 else f"kinds[p + {offset}]"))
            if variable is not None and start is not None and not self.recording:
                variable = plus(start, before + offset)
            elif variable is not None:
                captures.append((variable, offset))
            group = [
                Branch(
                    each.alternative, each.position + 1, (*each.variables, variable), start, before + offset + 1
                )
                for each in group
            ]
            if (
                len(group) > 1
                or group[0].done
                or not isinstance(self.next_of(group[0]).item, Token | TokenChoice)
            ):
                break
        with self.block(f"if {' and '.join(tests)}:"):
            if self.recording:
                for variable, offset in captures:
                    self.line(f"{variable} = p - {len(tests) - offset}")
            else:
                for variable, offset in captures:
                    self.line(f"{variable} = {plus('p', offset)}")
                self.line(f"p += {len(tests)}" if start is None else f"p = {plus(start, before + len(tests))}")
            inner = "p"
            if sum(1 for _ in self.split(group)) > 1:
                inner = self.fresh("m")
                self.line(f"{inner} = p")
            self.choice(group, inner, mode)
            if mark is not None and not self.recording:
                self.reset(mark)
        if mark is not None and self.recording:
            self.reset(mark)

    def reset(self, mark: str) -> None:
        """Put ``p`` back, unless the line before leaves anyway."""
        last = self.lines[-1]
        if last.startswith("    " * self.depth + "return") or last == "    " * self.depth + "continue":
            return
        self.line(f"p = {mark}")

    def step(self, group: list[Branch], mode: Mode) -> None:
        """Match the next item of ``group``, which is not a token, and go on with what follows it."""
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
                self.look(item, lambda: self.advance(group, variable, mode))
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

    # Values of items.

    def value(self, item: Item, target: str) -> None:
        """Set ``target`` to the value of ``item``, or to ``None`` (then ``p`` is anywhere)."""
        match item:
            case Reference():
                self.line(f"{target} = parse_{item.rule}()")
            case Token() | TokenChoice():
                with self.block(f"if {self.token_test(item, 'kinds[p]')}:"):
                    if self.recording:
                        self.line(f"{target} = p - 1")
                    else:
                        self.line(f"{target} = p")
                        self.line("p += 1")
                with self.block("else:"):
                    self.line(f"{target} = None")
            case Gather():
                element = self.fresh("u")
                self.value(item.item, element)
                with self.block(f"if {element} is None:"):
                    self.line(f"{target} = None")
                with self.block("else:"):
                    self.line(f"{target} = [{element}]")
                    self.gather(item, target, element)
            case _:
                raise GrammarError(f"an item in this place needs a rule of its own: {item}")

    def optional(self, item: Item, target: str) -> None:
        if isinstance(item, Token | TokenChoice):
            self.value(item, target)
            return
        self.line(f"{target} = None")
        mark = self.fresh("m")
        header = "if True:"
        if not self.recording:
            header = f"if {self.kinds(self.first_of_item(item), 'kinds[p]')}:"
        with self.block(header):
            self.line(f"{mark} = p")
            self.value(item, target)
            with self.block(f"if {target} is None:"):
                self.line(f"p = {mark}")

    def repeat(self, item: Repeat, target: str) -> None:
        inner = item.item
        if self.recording and isinstance(inner, Reference) and inner.rule in self.grammar.recover:
            self.line(f"{target}, p = recover({inner.rule!r}, p)")
            return
        self.line(f"{target} = []")
        element, mark = self.fresh("u"), self.fresh("m")
        header = "while True:"
        if not self.recording:
            header = f"while {self.kinds(self.first_of_item(inner), 'kinds[p]')}:"
        with self.block(header):
            self.line(f"{mark} = p")
            self.value(inner, element)
            with self.block(f"if {element} is None:"):
                self.line(f"p = {mark}")
                self.line("break")
            self.line(f"{target}.append({element})")

    def gather(self, item: Gather, target: str, element: str) -> None:
        """Go on with a list of which the first element is matched."""
        mark = self.fresh("m")
        if not isinstance(item.separator, Token):
            raise GrammarError(f"a separator has to be a token: {item.separator}")
        test = self.token_test(item.separator, "kinds[p]")
        header = "while True:" if self.recording else f"while {test}:"
        with self.block(header):
            self.line(f"{mark} = p")
            if self.recording:
                with self.block(f"if not {test}:"):
                    self.line("break")
            else:
                self.line("p += 1")
            self.value(item.item, element)
            with self.block(f"if {element} is None:"):
                self.line(f"p = {mark}")
                self.line("break")
            self.line(f"{target}.append({element})")

    def first_of_item(self, item: Item) -> frozenset[int]:
        return self.analysis._first_of_item(item, self.analysis.first)

    def look(self, item: Look, then: Callable[[], None]) -> None:
        inner = item.item
        if isinstance(inner, Reference):
            rule = self.analysis.rules[inner.rule]
            tokens = [
                [named.item for named in alternative.items if isinstance(named.item, Token | TokenChoice)]
                for alternative in rule.alternatives
            ]
            if all(
                len(found) == len(alternative.items)
                for found, alternative in zip(tokens, rule.alternatives, strict=True)
            ):
                tests = [
                    " and ".join(
                        self.kinds(self.analysis.kinds_of(token), f"kinds[p + {offset}]" if offset else "kinds[p]")
                        for offset, token in enumerate(found)
                    )
                    for found in tokens
                ]
                if len({len(found) for found in tokens}) == 1 and len(tokens[0]) == 1:
                    kinds = frozenset().union(*(self.analysis.kinds_of(found[0]) for found in tokens))
                    tests = [self.kinds(kinds, "kinds[p]")]
                test = " or ".join(f"({each})" for each in tests) if len(tests) > 1 else tests[0]
                with self.block(f"if {test}:" if item.positive else f"if not ({test}):"):
                    then()
                return
            mark, found_variable = self.fresh("m"), self.fresh("u")
            self.line(f"{mark} = p")
            if self.recording:
                self.line("quiet += 1")
            self.line(f"{found_variable} = parse_{inner.rule}()")
            if self.recording:
                self.line("quiet -= 1")
            self.line(f"p = {mark}")
            with self.block(f"if {found_variable} is {'not ' if item.positive else ''}None:"):
                then()
            return
        if not isinstance(inner, Token | TokenChoice):
            raise GrammarError(f"looking ahead at this needs a rule of its own: {inner}")
        kinds = self.analysis.kinds_of(inner)
        if self.recording and item.positive:
            # What is looked for is also what was expected.
            mark = self.fresh("m")
            self.line(f"{mark} = p")
            with self.block(f"if {self.token_test(inner, 'kinds[p]')}:"):
                self.line(f"p = {mark}")
                then()
            return
        with self.block(f"if {self.kinds(kinds, 'kinds[p]', negated=not item.positive)}:"):
            then()

    # Results.

    def finish(self, branch: Branch, mode: Mode) -> None:
        """All items of an alternative are matched: make its value."""
        alternative = branch.alternative
        if alternative.action is None:
            chosen = value_item(alternative, mode.rule)
            index = next(i for i, named in enumerate(alternative.items) if named is chosen)
            self.result(str(branch.variables[index]), mode)
            return
        names = {
            named.name: str(variable)
            for named, variable in zip(alternative.items, branch.variables, strict=True)
            if named.name is not None
        }
        if mode.operand is not None:
            names[mode.operand] = f"v_{mode.operand}"
        translated = self.translator.translate(alternative.action, names, mode.rule)
        if translated.guard is not None:
            with self.block(f"if {translated.guard}:"):
                self.make(branch, translated, mode)
        else:
            self.make(branch, translated, mode)

    def make(self, branch: Branch, translated, mode: Mode) -> None:  # type: ignore[no-untyped-def]
        end = "e"
        if translated.place:
            if branch.start is not None and not self.recording:
                end = plus(branch.start, branch.tokens - 1)
                if end != branch.start or "end_lines[e]" in str(translated.value) or "[e]" in str(translated.node):
                    self.line(f"e = {end}")
                    end = "e"
            else:
                self.line("e = p - 1")
            if self.analysis.ends_with_layout(branch.alternative.items):
                with self.block("while kinds[e] < 4:"):
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
            self.result("n", mode)
        elif translated.may_fail and translated.value not in branch.variables:
            self.line(f"r = {translated.value}")
            with self.block("if r is not None:"):
                self.result("r", mode)
        else:
            self.result(str(translated.value), mode)

    def result(self, value: str, mode: Mode) -> None:
        if mode.again:
            self.line(f"v_{mode.operand} = {value}")
            self.line("continue")
        else:
            self.line(f"return {value}")

    # Rules.

    def rule(self, rule: Rule) -> None:
        """Emit the functions of a rule."""
        self.counter = 0
        step = self.analysis.steps.get(rule.name)
        memoised = self.analysis.memoised
        if step is not None:
            self.loop(rule.name, step.tails, step.variable, repeated=step.repeated)
            self.step_rule(rule, step)
        elif self.analysis.is_left_recursive(rule):
            self.left_recursive(rule)
        elif rule.name in memoised:
            with self.function(f"fresh_{rule.name}"):
                self.body(rule)
            with self.function(f"parse_{rule.name}"):
                self.line("s = p")
                self.memo(rule.name, f"fresh_{rule.name}", memoised[rule.name])
                if memoised[rule.name] is not None:
                    self.line(f"return fresh_{rule.name}()")
        else:
            with self.function(f"parse_{rule.name}"):
                self.body(rule)
        self.label(rule)

    @contextmanager
    def function(self, name: str, parameters: str = "") -> Iterator[None]:
        self.line("")
        with self.block(f"def {name}({parameters}):"):
            self.line("nonlocal p, quiet" if self.recording else "nonlocal p")
            yield

    def body(self, rule: Rule) -> None:
        self.line("s = p")
        self.choice(
            [Branch(each, start="s") for each in rule.alternatives], "s", Mode(rule.name, whole=True)
        )
        self.line("return None")

    def memo(self, name: str, function: str, kinds: frozenset[int] | None) -> None:
        """Return what ``function`` returned at this place before, or what it returns now."""
        header = "if True:" if kinds is None else f"if {self.kinds(kinds, 'kinds[s]')}:"
        with self.block(header):
            self.line(f"hit = memo_{name}.get(s)")
            with self.block("if hit is not None:"):
                self.line("p = hit[1]")
                self.line("return hit[0]")
            self.line(f"r = {function}()")
            self.line(f"memo_{name}[s] = (r, p)")
            self.line("return r")

    def label(self, rule: Rule) -> None:
        """In the recording parser, note a rule's label rather than the tokens that it starts with."""
        if not self.recording or rule.label is None:
            return
        self.line("")
        self.line(f"inner_{rule.name} = parse_{rule.name}")
        with self.function(f"parse_{rule.name}"):
            self.line("nonlocal label, label_at")
            with self.block("if label_at == p:"):
                self.line(f"return inner_{rule.name}()")
            self.line("saved = label, label_at")
            self.line(f"label = {rule.label!r}")
            self.line("label_at = p")
            self.line(f"r = inner_{rule.name}()")
            self.line("label, label_at = saved")
            self.line("return r")

    def loop(self, name: str, tails: Sequence[Alternative], variable: str, *, repeated: bool) -> None:
        """Emit the function that applies the operators of a step to an operand, as far as they go."""
        if not tails:
            return
        with self.function(f"loop_{name}", f"v_{variable}, s"):
            branches = [Branch(tail, start="m") for tail in tails]
            with self.block("while True:") if repeated else nullcontext():
                self.line("m = p")
                self.choice(branches, "m", Mode(name, variable, again=repeated))
                self.line("p = m")
                self.line(f"return v_{variable}")

    def left_recursive(self, rule: Rule) -> None:
        """A left-recursive rule that is not a step of a ladder."""
        bases, tails, variable = [], [], ""
        for alternative in rule.alternatives:
            if alternative.items[0].item == Reference(rule.name):
                tails.append(Alternative(alternative.items[1:], alternative.action))
                variable = str(alternative.items[0].name)
            else:
                bases.append(alternative)
        self.loop(rule.name, tails, variable, repeated=True)
        with self.function(f"base_{rule.name}"):
            self.line("s = p")
            self.choice([Branch(each, start="s") for each in bases], "s", Mode(rule.name, whole=True))
            self.line("return None")
        with self.function(f"parse_{rule.name}"):
            self.line("s = p")
            self.line(f"r = base_{rule.name}()")
            self.line(f"return None if r is None else loop_{rule.name}(r, s)")

    def step_rule(self, rule: Rule, step: Step) -> None:
        """A step of a ladder of operators."""
        name = rule.name
        analysis = self.analysis
        prefixes = [Branch(each, start="s") for each in step.prefixes]
        memoised = analysis.memoised.get(name)
        general = f"parse_{name}"
        if memoised is not None:
            general = f"general_{name}"
            with self.function(general):
                self.line("s = p")
                self.general(step, prefixes)
        with self.function(f"parse_{name}"):
            self.line("s = p")
            if not self.recording and analysis.bottom(name) != name:
                self.short_cut(name)
            if memoised is not None:
                self.memo(name, general, memoised)
                self.line(f"return {general}()")
            else:
                self.general(step, prefixes)

    def short_cut(self, name: str) -> None:
        """Go straight to the bottom of the ladder if the next token can mean nothing else."""
        analysis = self.analysis
        plain, seconds = analysis.plain_starts(name)
        bottom = analysis.bottom(name)
        continuations = analysis.all_continuations(name)
        test = self.kinds(plain, "kinds[p]")
        if seconds:
            test += f" and {self.kinds(seconds, 'kinds[p + 1]', negated=True)}"
        with self.block(f"if {test}:"):
            if not continuations:
                self.line(f"return parse_{bottom}()")
                return
            self.line(f"r = parse_{bottom}()")
            with self.block(f"if {self.kinds(continuations, 'kinds[p]')} and r is not None:"):
                table, limit = self.table_for(name)
                self.line(f"return climb_{table}(r, s, {limit})")
            self.line("return r")

    def table_for(self, name: str) -> tuple[int, int]:
        """The table of operators that serves the ladder from ``name`` down, and the last level to use of it."""
        ladder = self.analysis.ladder(name)
        table: dict[int, list[tuple[int, str]]] = {}
        limit = 0
        for level, each in enumerate(reversed(ladder)):
            if level and self.analysis.steps[each].tails:
                limit = level
                for kind in sorted(self.analysis.continuations(each)):
                    table.setdefault(kind, []).append((level, each))
        for number, known in enumerate(self.tables):
            cut = {
                kind: entries
                for kind, all_entries in known.items()
                if (entries := [entry for entry in all_entries if entry[0] <= limit])
            }
            if cut == table:
                return number, limit
        self.tables.append(table)
        return len(self.tables) - 1, limit

    def general(self, step: Step, prefixes: list[Branch]) -> None:
        if prefixes:
            self.choice(prefixes, "s", Mode(step.rule))
            self.line("p = s")
        self.operand(step)
        if step.tails:
            continuations = self.analysis.continuations(step.rule)
            test = "" if self.recording else f" and {self.kinds(continuations, 'kinds[p]')}"
            with self.block(f"if r is not None{test}:"):
                self.line(f"return loop_{step.rule}(r, s)")
        self.line("return r")

    def operand(self, step: Step) -> None:
        """Set ``r`` to the operand of a step; a plain name, the most frequent one, without another call."""
        rule = self.analysis.rules[step.operand]
        name = next(
            (each for each in rule.alternatives if [item.item for item in each.items] == [NAME_TOKEN]), None
        )
        others = [each for each in rule.alternatives if each is not name]
        if (
            self.recording
            or step.operand in self.analysis.steps
            or name is None
            or any(NAME in self.analysis.first_of(each.items) for each in others)
        ):
            self.line(f"r = parse_{step.operand}()")
            return
        assert name.action is not None
        translated = self.translator.translate(name.action, {str(name.items[0].name): "s"}, rule.name)
        if translated.node is None:
            raise GrammarError(f"rule {rule.name!r}: a name should become a node")
        with self.block(f"if kinds[s] == {NAME}:"):
            self.line("p = s + 1")
            self.line(f"r = new({translated.node[0]})")
            self.line(
                f"r.__dict__ = {{{translated.node[1]}, 'lineno': lines[s], 'col_offset': columns[s], "
                "'end_lineno': end_lines[s], 'end_col_offset': end_columns[s]}"
            )
        with self.block("else:"):
            self.line(f"r = parse_{step.operand}()")

    # The module.

    def emit(self, header: str) -> str:
        """The text of the module."""
        self.depth = 1
        # Upper rules first, so that tables of operators are made for whole ladders and shared by their parts.
        for rule in sorted(
            self.analysis.rules.values(),
            key=lambda each: -len(self.analysis.ladder(each.name)) if each.name in self.analysis.steps else 0,
        ):
            self.rule(rule)
        body, self.lines, self.depth = self.lines, [], 0
        self.preamble(header)
        self.lines += body
        self.depth = 1
        self.ending()
        return "\n".join(line.rstrip() for line in self.lines) + "\n"

    def preamble(self, header: str) -> None:
        translator = self.translator
        for line in header.splitlines():
            self.line(line)
        self.line("")
        for module in ("ast", "tree"):
            names = sorted(
                name for name in translator.used_classes if translator.classes[name].module == module
            )
            if module == "ast":
                names = sorted({*names, "AST", *(OPERATORS[each] for each in translator.used_operators)})
            if names:
                origin = "ast" if module == "ast" else "scenic.compiler.tree"
                self.line(f"from {origin} import ({', '.join(names)})")
        self.line("")
        self.line("new = AST.__new__")
        for name in sorted(translator.used_operators):
            self.line(f"{name} = new({OPERATORS[name]})")
        for kinds, name in self.sets.items():
            words = " ".join(self.grammar.vocabulary.describe(kind) for kind in sorted(kinds))
            self.line(f"{name} = frozenset({{{', '.join(map(str, sorted(kinds)))}}})  # {words}")
        self.line("")
        self.line("")
        with self.block("def make(cls, fields, place):"):
            self.line("n = new(cls)")
            with self.block("if place is not None:"):
                self.line(
                    "fields['lineno'], fields['col_offset'], fields['end_lineno'], fields['end_col_offset'] = place"
                )
            self.line("n.__dict__ = fields")
            self.line("return n")
        self.line("")
        self.line("")
        extra = ", recover" if self.recording else ""
        self.line(f"def build(kinds, texts, lines, columns, end_lines, end_columns, actions{extra}):")
        self.depth = 1
        self.line("p = 0")
        if self.recording:
            self.recorder()
        else:
            operators = self.grammar.vocabulary.operators
            openers = sorted(operators[text] for text in "([{" if text in operators)
            closers = sorted(operators[text] for text in ")]}" if text in operators)
            for line in AHEAD.format(openers=openers, closers=closers, newline=KINDS["NEWLINE"]).splitlines():
                self.line(line)
        for name in sorted(translator.used_helpers):
            self.line(f"{name} = actions.{name}")
        for name in self.analysis.memoised:
            self.line(f"memo_{name} = {{}}")
        self.depth = 0

    def recorder(self) -> None:
        for line in RECORDER.splitlines():
            self.line(line)

    def ending(self) -> None:
        for number, table in enumerate(self.tables):
            self.line("")
            with self.block(f"table_{number} = {{"):
                for kind, entries in sorted(table.items()):
                    loops = "".join(f"({level}, loop_{rule}), " for level, rule in entries)
                    self.line(f"{kind}: ({loops.rstrip()}),  # {self.grammar.vocabulary.describe(kind)}")
            self.line("}")
            for line in CLIMB.format(number=number).splitlines():
                self.line(line)
        entries = [self.grammar.start, *sorted(self.grammar.recover)]
        rules = ", ".join(f"{name!r}: parse_{name}" for name in entries)
        self.line("")
        self.line(f"rules = {{{rules}}}")
        self.line("")
        with self.function("run", "rule, position"):
            if self.recording:
                self.line("nonlocal far, expected, label, label_at")
                self.line("outer = far, expected, label, label_at, quiet")
                self.line("far, expected, label, label_at, quiet = -1, set(), None, -1, 0")
            self.line("p = position")
            self.line("r = rules[rule]()")
            if self.recording:
                self.line("found = far, expected")
                self.line("far, expected, label, label_at, quiet = outer")
                self.line("return r, p, *found")
            else:
                self.line("return r, p")
        self.line("")
        self.line("return run")


RECORDER = """\
far = -1
expected = set()
label = None
label_at = -1
quiet = 0

def expect(kind):
    nonlocal p
    if kinds[p] == kind:
        p += 1
        return True
    if p >= far and not quiet:
        missed(kind)
    return False

def expect_name():
    nonlocal p
    if kinds[p] >= 256:
        p += 1
        return True
    if p >= far and not quiet:
        missed(256)
    return False

def expect_any(wanted):
    nonlocal p
    if kinds[p] in wanted:
        p += 1
        return True
    if p >= far and not quiet:
        for kind in wanted:
            missed(kind)
    return False

def missed(kind):
    nonlocal far, expected
    if p > far:
        far = p
        expected = set()
    expected.add(label if label_at == p else kind)
"""

AHEAD = """\
found_ahead = {{}}

def ahead(kind):
    # For every token: is there one of this kind, there or further on, before the bracket or the line ends?
    flags = found_ahead.get(kind)
    if flags is None:
        flags = found_ahead[kind] = bytearray(len(kinds))
        outer = []
        found = 0
        for index in range(len(kinds) - 1, -1, -1):
            k = kinds[index]
            if k == kind:
                found = 1
            elif k in {closers}:
                outer.append(found)
                found = 0
            elif k in {openers}:
                found = outer.pop() if outer else 0
            elif k == {newline}:
                found = 0
            flags[index] = found
    return flags
"""

CLIMB = """
def climb_{number}(r, s, limit):
    last = -1
    while True:
        for level, loop in table_{number}.get(kinds[p], ()):
            if last < level <= limit:
                m = p
                r = loop(r, s)
                if p != m:
                    last = level
                    break
        else:
            return r
"""



def plus(variable: str, count: int) -> str:
    """The code of a variable plus a number."""
    return f"{variable} + {count}" if count else variable


__all__ = ["PLACE", "Emitter"]
