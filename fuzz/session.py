"""A long run: rounds of programs and of mutants, until the time is over; failures are shrunk and collected."""

import contextlib
import io
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple, TypeVar

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.errors import Flaky
from hypothesis.strategies import SearchStrategy

from fuzz.derivations import AlternativeId
from fuzz.grammar import Program, derivations, from_grammar, programs
from fuzz.mutations import mutated
from fuzz.properties import OF_PROGRAMS, OF_TEXTS, Case, Property, Violation

__all__ = ["Failure", "Report", "Signature", "run_round", "search", "signature_of"]

_ROUND: Final = 200


class Signature(NamedTuple):
    """What makes two failures the same one: the property, the kind of exception, and where or what it says."""

    property: str
    exception: str
    detail: str


@dataclass(frozen=True, slots=True)
class Failure:
    """A shrunk text for which a property does not hold, and why not."""

    signature: Signature
    text: str
    of_grammar: bool
    seed: int
    reason: str


@dataclass(slots=True)
class Report:
    """What a run has done so far."""

    programs: int = 0
    mutants: int = 0
    tokens: int = 0
    checks: int = 0
    covered: set[AlternativeId] = field(default_factory=set)
    failures: list[Failure] = field(default_factory=list)
    repeated: Counter[Signature] = field(default_factory=Counter)

    @property
    def missing(self) -> tuple[AlternativeId, ...]:
        """The alternatives that no program has used."""
        return tuple(sorted(derivations().countable - self.covered))


class _Stop(BaseException):
    """Ends a round whose time is over; not an `Exception`, so that Hypothesis lets it through."""


class _Failed(Exception):
    """A new failure, which Hypothesis is to shrink."""


def signature_of(name: str, error: BaseException) -> Signature:
    """The signature of the exception that a property raised."""
    if isinstance(error, Violation):
        # The words of the message, without places and names.
        detail = " ".join(word for word in str(error).split() if word.isalpha())
    else:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        detail = f"{frame.filename.rpartition('/')[2]}:{frame.lineno}"
    return Signature(name, type(error).__name__, detail)


def run_round(
    report: Report,
    *,
    seed_of_round: int,
    until: float,
    examples: int = _ROUND,
    of_programs: Sequence[Property] = OF_PROGRAMS,
) -> None:
    """Try some programs and some mutants on the properties of each. Stops at the time ``until`` (of `time.monotonic`), except to shrink.

    What is found is entered in ``report``. Failures known to it are counted and not shrunk again.
    """
    aims = report.missing or tuple(sorted(derivations().countable))

    def try_program(program: Program) -> str:
        report.programs += 1
        report.tokens += len(program.pieces)
        report.covered |= program.alternatives
        return program.text

    def try_mutant(text: str) -> str:
        report.mutants += 1
        return text

    search(report, programs(aims=aims), try_program, of_programs, seed_of_round, until, examples)
    search(report, mutated(from_grammar()), try_mutant, OF_TEXTS, seed_of_round, until, examples // 2)


_Drawn = TypeVar("_Drawn")


def search(
    report: Report,
    strategy: SearchStrategy[_Drawn],
    note: Callable[[_Drawn], str],
    properties: Sequence[Property],
    seed_of_round: int,
    until: float,
    examples: int,
) -> None:
    """Try what a strategy makes on ``properties``; ``note`` counts it and gives its text.

    At most one new failure is found, shrunk and entered in ``report``.
    """
    known = {failure.signature for failure in report.failures}
    found: list[Failure] = []

    def attempt(drawn: _Drawn) -> None:
        # While a failure is being shrunk, the clock does not matter and nothing counts.
        if found:
            text = drawn.text if isinstance(drawn, Program) else str(drawn)
        else:
            if time.monotonic() >= until:
                raise _Stop
            text = note(drawn)
        case = Case(text)
        for each in properties:
            if not found:
                report.checks += 1
            try:
                each.holds(case)
            except Exception as error:
                signature = signature_of(each.name, error)
                if signature in known:
                    if not found:
                        report.repeated[signature] += 1
                    continue
                if found and signature != found[-1].signature:
                    # Shrinking must not slip from one failure to another.
                    continue
                reason = "".join(traceback.format_exception(error)[-3:])
                found.append(Failure(signature, text, isinstance(drawn, Program), seed_of_round, reason))
                raise _Failed(str(signature)) from error

    test = settings(
        max_examples=examples,
        deadline=None,
        database=None,
        phases=(Phase.generate, Phase.shrink),
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )(seed(seed_of_round)(given(strategy)(attempt)))
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            test()
        except _Stop:
            pass
        except (_Failed, Flaky):
            # Hypothesis tries the shortest one last. What fails only sometimes is a failure, too.
            report.failures.append(found[-1])
