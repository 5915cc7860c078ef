"""The text of a parser as it grows, and the smallest pieces of it."""

from collections.abc import Iterator
from contextlib import contextmanager

from grammar.generator.actions import Translator
from grammar.generator.analysis import Analysis
from grammar.generator.model import NAME, Token, TokenChoice


class Writer:
    """Lines of code, with what they need: variables, sets of kinds, translated actions."""

    def __init__(self, analysis: Analysis, *, recording: bool = False, tracing: bool = False) -> None:
        self.analysis = analysis
        self.grammar = analysis.grammar
        self.recording = recording
        self.tracing = tracing
        # The fast parser looks at the next token before it tries something; the others try everything.
        self.fast = not (recording or tracing)
        self.translator = Translator()
        self.lines: list[str] = []
        self.depth = 0
        self.counter = 0
        self.sets: dict[frozenset[int], str] = {}
        self.tables: list[dict[int, list[tuple[int, str]]]] = []
        self.all_soft = analysis.soft_kinds | {NAME}

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

    @contextmanager
    def function(self, name: str, parameters: str = "") -> Iterator[None]:
        self.line("")
        with self.block(f"def {name}({parameters}):"):
            self.line("nonlocal p, quiet" if self.recording else "nonlocal p")
            yield

    def reset(self, mark: str) -> None:
        """Put ``p`` back, unless the line before leaves anyway."""
        last = self.lines[-1]
        if last.startswith("    " * self.depth + "return") or last == "    " * self.depth + "continue":
            return
        self.line(f"p = {mark}")

    def kinds(self, kinds: frozenset[int], what: str, *, negated: bool = False) -> str:
        """Write the code that tests whether the kind ``what`` is one of ``kinds``."""
        if len(kinds) == 1:
            return f"{what} {'!=' if negated else '=='} {next(iter(kinds))}"
        if kinds == self.all_soft:
            return f"{what} {'<' if negated else '>='} {NAME}"
        name = self.sets.setdefault(kinds, f"SET_{len(self.sets)}")
        return f"{what} {'not in' if negated else 'in'} {name}"

    def token_test(self, item: Token | TokenChoice, what: str) -> str:
        kinds = self.analysis.kinds_of(item)
        if self.fast:
            return self.kinds(kinds, what)
        if len(kinds) == 1:
            return f"expect({next(iter(kinds))})"
        if kinds == self.all_soft:
            return "expect_name()"
        return f"expect_any({self.sets.setdefault(kinds, f'SET_{len(self.sets)}')})"


def plus(variable: str, count: int) -> str:
    """The code of a variable plus a number."""
    return f"{variable} + {count}" if count else variable
