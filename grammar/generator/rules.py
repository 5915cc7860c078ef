"""Emits the functions of rules: plain ones, memoised ones, and the steps of ladders of operators."""

from collections.abc import Sequence
from contextlib import nullcontext

from grammar.generator.analysis import Step
from grammar.generator.choices import Branch, ChoiceWriter, Mode
from grammar.generator.model import NAME, Alternative, GrammarError, Reference, Rule, Token

NAME_TOKEN = Token("NAME", literal=False)


class RuleWriter(ChoiceWriter):
    """Code for whole rules."""

    def rule(self, rule: Rule) -> None:
        """Emit the functions of a rule."""
        self.counter = 0
        step = self.analysis.steps.get(rule.name)
        memo_kinds = self.analysis.memoised
        if step is not None:
            self.loop(rule.name, step.tails, step.variable, repeated=step.repeated, plain=self.plain(step))
            self.step_rule(rule, step)
        elif self.analysis.is_left_recursive(rule):
            self.left_recursive(rule)
        elif rule.name in memo_kinds:
            with self.function(f"fresh_{rule.name}"):
                self.body(rule)
            with self.function(f"parse_{rule.name}"):
                self.line("s = p")
                self.memo(rule.name, f"fresh_{rule.name}", memo_kinds[rule.name])
                if memo_kinds[rule.name] is not None:
                    self.line(f"return fresh_{rule.name}()")
        else:
            with self.function(f"parse_{rule.name}"):
                self.body(rule)
        self.label(rule)

    def body(self, rule: Rule) -> None:
        self.line("s = p")
        self.choice([Branch(each, start="s") for each in rule.alternatives], "s", Mode(rule.name, whole=True))
        self.line("return None")

    def memo(self, name: str, function: str, kinds: frozenset[int] | None) -> None:
        """Return what ``function`` returned at this place before, or what it returns now."""
        header = "if True:" if kinds is None else f"if {self.kinds(kinds, 'kinds[s]')}:"
        with self.block(header):
            self.line(f"hit = memo_{name}.get(s)")
            if self.tracing:
                # What is kept is the way through this rule alone; the ways to it differ.
                with self.block("if hit is None:"):
                    self.line("p = Position(s)")
                    self.line(f"r = {function}()")
                    self.line(f"hit = memo_{name}[s] = (r, p)")
                self.line("p = s.through(hit[1])")
                self.line("return hit[0]")
                return
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

    def plain(self, step: Step) -> int:
        """The number of the alternative of a step that is just its operand."""
        return next(
            number
            for number, each in enumerate(self.grammar.rules[step.rule].alternatives, 1)
            if [named.item for named in each.items] == [Reference(step.operand)]
        )

    def loop(
        self,
        name: str,
        tails: Sequence[Alternative],
        variable: str,
        *,
        repeated: bool,
        plain: int | None = None,
    ) -> None:
        """Emit the function that applies the operators of a step to an operand, as far as they go.

        ``plain`` is the number of the alternative that matched if there are none, where that is not known before.
        """
        if not tails:
            return
        with self.function(f"loop_{name}", f"v_{variable}, s"):
            branches = [Branch(tail, start="m") for tail in tails]
            with self.block("while True:") if repeated else nullcontext():
                self.line("m = p")
                self.choice(branches, "m", Mode(name, variable, again=repeated))
                self.line("p = m")
                if self.tracing and plain is not None and not repeated:
                    self.line(f"p = p.after({name!r}, {plain})")
                self.line(f"return v_{variable}")

    def left_recursive(self, rule: Rule) -> None:
        """Write a left-recursive rule that is not a step of a ladder."""
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
        memo_kinds = analysis.memoised.get(name)
        general = f"parse_{name}"
        if memo_kinds is not None:
            general = f"general_{name}"
            with self.function(general):
                self.line("s = p")
                self.general(step, prefixes)
        with self.function(f"parse_{name}"):
            self.line("s = p")
            if self.fast and analysis.bottom(name) != name:
                self.short_cut(name)
            if memo_kinds is not None:
                self.memo(name, general, memo_kinds)
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
        """Return the table of operators that serves the ladder from ``name`` down, and the last level to use of it."""
        ladder = self.analysis.ladder(name)
        table: dict[int, list[tuple[int, str]]] = {}
        limit = 0
        for level, each in enumerate(reversed(ladder)):
            if level and self.analysis.steps[each].tails:
                limit = level
                for kind in sorted(self.analysis.continuations(each)):
                    table.setdefault(kind, []).append((level, each))
        for number, earlier_table in enumerate(self.tables):
            cut = {
                kind: entries
                for kind, all_entries in earlier_table.items()
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
        if self.tracing and (step.repeated or not step.tails):
            with self.block("if r is not None:"):
                self.line(f"p = p.after({step.rule!r}, {self.plain(step)})")
        if step.tails:
            continuations = self.analysis.continuations(step.rule)
            test = f" and {self.kinds(continuations, 'kinds[p]')}" if self.fast else ""
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
            not self.fast
            or step.operand in self.analysis.steps
            or name is None
            or any(NAME in self.analysis.first_of(each.items) for each in others)
        ):
            self.line(f"r = parse_{step.operand}()")
            return
        assert name.action is not None
        translation = self.translator.translate(name.action, {str(name.items[0].name): "s"}, rule.name)
        if translation.node is None:
            raise GrammarError(f"rule {rule.name!r}: a name should become a node")
        with self.block(f"if kinds[s] == {NAME}:"):
            self.line("p = s + 1")
            self.line(f"r = new({translation.node[0]})")
            self.line(
                f"r.__dict__ = {{{translation.node[1]}, 'lineno': lines[s], 'col_offset': columns[s], "
                "'end_lineno': end_lines[s], 'end_col_offset': end_columns[s]}"
            )
        with self.block("else:"):
            self.line(f"r = parse_{step.operand}()")
