"""Emits what matches one item of an alternative."""

from collections.abc import Callable

from grammar.generator.model import (
    Gather,
    GrammarError,
    Item,
    Look,
    Reference,
    Repeat,
    Token,
    TokenChoice,
)
from grammar.generator.writing import Writer


class ItemWriter(Writer):
    """Code that sets a variable to the value of an item, or to ``None``."""

    def value(self, item: Item, target: str) -> None:
        """Set ``target`` to the value of ``item``, or to ``None`` (then ``p`` is anywhere)."""
        match item:
            case Reference():
                self.line(f"{target} = parse_{item.rule}()")
            case Token() | TokenChoice():
                with self.block(f"if {self.token_test(item, 'kinds[p]')}:"):
                    if self.fast:
                        self.line(f"{target} = p")
                        self.line("p += 1")
                    else:
                        self.line(f"{target} = p - 1")
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
        if self.fast:
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
        if self.fast:
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
        header = f"while {test}:" if self.fast else "while True:"
        with self.block(header):
            self.line(f"{mark} = p")
            if self.fast:
                self.line("p += 1")
            else:
                with self.block(f"if not {test}:"):
                    self.line("break")
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
                [entry.item for entry in alternative.items if isinstance(entry.item, Token | TokenChoice)]
                for alternative in rule.alternatives
            ]
            if all(
                len(row) == len(alternative.items)
                for row, alternative in zip(tokens, rule.alternatives, strict=True)
            ):
                tests = [
                    " and ".join(
                        self.kinds(
                            self.analysis.kinds_of(token), f"kinds[p + {offset}]" if offset else "kinds[p]"
                        )
                        for offset, token in enumerate(row)
                    )
                    for row in tokens
                ]
                if len({len(row) for row in tokens}) == 1 and len(tokens[0]) == 1:
                    kinds = frozenset().union(*(self.analysis.kinds_of(row[0]) for row in tokens))
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
        if not self.fast and item.positive:
            # What is looked for is also what was expected.
            mark = self.fresh("m")
            self.line(f"{mark} = p")
            with self.block(f"if {self.token_test(inner, 'kinds[p]')}:"):
                self.line(f"p = {mark}")
                then()
            return
        with self.block(f"if {self.kinds(kinds, 'kinds[p]', negated=not item.positive)}:"):
            then()
