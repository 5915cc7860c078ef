"""Coverage of the grammar by accepted programs: the alternatives that they use, and in which forms."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache

from fuzz.grammar import Program, derivations
from grammar.origins import of_scenic
from grammar.tracing import AlternativeId, Choice, Trace, TracingParser, choices, explain
from scenic.compiler import tree
from scenic.compiler.actions import Actions
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import deep_recursion

__all__ = ["Coverage", "Share", "all_choices", "trace"]


@cache
def all_choices() -> frozenset[Choice]:
    """Return all choices of a program: to use an alternative, or to have one of its optional or repeated parts in some form."""
    return frozenset(choices(derivations().grammar))


@cache
def _choices_of_scenic() -> frozenset[Choice]:
    scenic = of_scenic(derivations().grammar, tree.__all__)
    return frozenset(choice for choice in all_choices() if choice.alternative in scenic)


@cache
def _parser() -> TracingParser:
    return TracingParser(derivations().grammar)


def trace(text: str) -> Trace:
    """Parse a text; return its tree and the choices that it uses.

    Of a text with errors, the tree is ``None`` and the choices are empty.
    """
    tokens = lex(text, WORDS)
    if tokens.diagnostics:
        return Trace(None, frozenset())
    with deep_recursion():
        return _parser().parse(tokens.lists(), Actions(tokens))


@dataclass(frozen=True, slots=True)
class Share:
    """The share of some choices that have been made."""

    name: str
    covered: int
    total: int
    missing: tuple[Choice, ...]

    def __str__(self) -> str:
        percent = 100 * self.covered / self.total
        return f"{self.name}: {self.covered} of {self.total} ({percent:.1f} %)"

    def explained(self) -> list[str]:
        """Describe the missing choices in words."""
        return [explain(derivations().grammar, choice) for choice in self.missing]


@dataclass(slots=True)
class Coverage:
    """The choices that programs have made so far.

    Only programs that may make a new choice are traced, since tracing is slow.
    """

    covered: set[Choice] = field(default_factory=set)
    traced: int = 0
    _missing: dict[AlternativeId, set[Choice]] = field(init=False)

    def __post_init__(self) -> None:
        self._missing = {}
        for choice in sorted(all_choices() - self.covered):
            self._missing.setdefault(choice.alternative, set()).add(choice)

    def note(self, program: Program) -> None:
        """Enter what the parse of a program uses."""
        if not self._missing.keys().isdisjoint(program.alternatives):
            self.traced += 1
            self.add(trace(program.text).choices)

    def add(self, found: Iterable[Choice]) -> None:
        """Enter choices."""
        for choice in found:
            if choice not in self.covered:
                self.covered.add(choice)
                missing = self._missing[choice.alternative]
                missing.discard(choice)
                if not missing:
                    del self._missing[choice.alternative]

    @property
    def aims(self) -> tuple[AlternativeId, ...]:
        """The alternatives of which something is missing."""
        return tuple(sorted(self._missing))

    def shares(self) -> tuple[Share, Share]:
        """The shares of Scenic's and of Python's choices."""
        scenic = _choices_of_scenic()
        return (
            self._share("alternatives of Scenic's rules", scenic),
            self._share("alternatives of Python's rules", all_choices() - scenic),
        )

    def _share(self, name: str, wanted: frozenset[Choice]) -> Share:
        missing = tuple(sorted(wanted - self.covered))
        return Share(name, len(wanted) - len(missing), len(wanted), missing)
