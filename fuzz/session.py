"""A run: rounds of programs, of formulas and of mutants, tried on the properties of each; failures are shrunk and collected."""

import contextlib
import io
import re
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from hypothesis.errors import Flaky
from hypothesis.strategies import DrawFn, SearchStrategy

from fuzz.coverage import Coverage
from fuzz.derivations import AlternativeId
from fuzz.draws import Draws, HypothesisDraws, RandomDraws, replayed
from fuzz.grammar import Program, make_program
from fuzz.limits import SECONDS, TookTooLongError, limited
from fuzz.mutations import Mutant, make_mutant
from fuzz.properties import OF_PROGRAMS, OF_TEXTS, Case, Property, Violation
from fuzz.temporal import OF_FORMULAS, make_formula
from scenic.language.diagnostics import Severity

__all__ = ["Failure", "Report", "Signature", "fault_of", "run_round", "shrink", "signature_of", "try_text"]

PROGRAMS: Final = 200
MUTANTS: Final = 100
FORMULAS: Final = 20
"""The sizes of a round."""
_LONGEST: Final = 40.0
"""Largest number of seconds for which a failure is shrunk."""
_ENDLESS: Final = 0.5
"""Seconds beyond which a shorter text still takes far too long, when a text that takes too long is shrunk."""
_UNFINISHED: Final = frozenset({"SC900", "SC120", "SC214", "SC404"})
"""Errors of programs that are right, but need more than this version or the running Python has, and errors about values, whose
kinds the grammar does not know."""
_WORDS: Final = 8
_ROUNDS_APART: Final = 1 << 20

Sample = Program | Mutant


class Signature(NamedTuple):
    """The identity of a failure: the property, the kind of exception, and its place or message."""

    property: str
    exception: str
    detail: str


@dataclass(frozen=True, slots=True)
class Failure:
    """A shrunk text for which a property does not hold, and why not.

    ``mutant`` is the text with the program it was made from, if a mutation made it.
    """

    signature: Signature
    text: str
    of_grammar: bool
    seed: int
    reason: str
    mutant: Mutant | None = None
    found_at: float = field(default_factory=time.time, compare=False)
    """When it was found, before it was shrunk (by `time.time`)."""


@dataclass(slots=True)
class Report:
    """The work and the findings of a run so far."""

    programs: int = 0
    mutants: int = 0
    formulas: int = 0
    tokens: int = 0
    checks: int = 0
    sound: int = 0
    """Programs with no errors but those of `_UNFINISHED`."""
    seconds: dict[str, float] = field(default_factory=dict)
    """The processor time that making programs and mutants took, and each property."""
    coverage: Coverage = field(default_factory=Coverage)
    failures: list[Failure] = field(default_factory=list)
    repeated: Counter[Signature] = field(default_factory=Counter)

    def spend(self, name: str, since: float) -> None:
        """Note that ``name`` took the processor time since ``since`` (of `time.process_time`)."""
        self.seconds[name] = self.seconds.get(name, 0.0) + time.process_time() - since

    def merge(self, other: "Report") -> None:
        """Add what another worker did. Of equal failures the shortest is kept."""
        self.programs += other.programs
        self.mutants += other.mutants
        self.formulas += other.formulas
        self.tokens += other.tokens
        self.checks += other.checks
        self.sound += other.sound
        for name, seconds in other.seconds.items():
            self.seconds[name] = self.seconds.get(name, 0.0) + seconds
        self.coverage.add(other.coverage.covered)
        self.repeated += other.repeated
        for failure in other.failures:
            if any(earlier.signature == failure.signature for earlier in self.failures):
                self.repeated[failure.signature] += 1
            else:
                self.failures.append(failure)


class _Stop(BaseException):
    """Ends shrinking that takes too long; not an `Exception`, so that Hypothesis lets it through."""


class _Failed(Exception):
    """The failure that Hypothesis is to shrink."""


def signature_of(name: str, error: BaseException) -> Signature:
    """Return the signature of the exception that a property raised."""
    if isinstance(error, Violation):
        # The first words of the message, without places and what is quoted of the text.
        first, _, _ = str(error).partition("\n")
        plain_text = re.sub(r"'[^']*'|\"[^\"]*\"|`[^`]*`", "", first)
        detail = " ".join([word for word in plain_text.split() if word.isalpha()][:_WORDS])
    elif isinstance(error, TookTooLongError):
        # Where it was when the time was over is a matter of chance.
        detail = "it does not end"
    else:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        detail = f"{frame.filename.rpartition('/')[2]}:{frame.lineno}"
    return Signature(name, type(error).__name__, detail)


def run_round(
    report: Report,
    *,
    seed_of_round: int,
    until: float,
    programs: int = PROGRAMS,
    mutants: int = MUTANTS,
    formulas: int = FORMULAS,
    of_programs: Sequence[Property] = OF_PROGRAMS,
    of_texts: Sequence[Property] = OF_TEXTS,
    of_formulas: Sequence[Property] = OF_FORMULAS,
    first: bool = False,
    trying: Callable[[str], None] | None = None,
) -> None:
    """Try some programs, some formulas, and some mutants of the programs, on the properties of each, up to the time ``until`` (of `time.monotonic`).

    What is found is entered in ``report``. Failures known to it are counted and not shrunk again. If ``first``, nothing more is
    tried once something has failed. ``trying`` is told of each text before.
    """
    trying = trying or (lambda _text: None)
    aims = report.coverage.aims or None
    pool: list[tuple[str, Sequence[int]]] = []
    for number in range(programs):
        if time.monotonic() >= until or (first and report.failures):
            return
        start = time.process_time()
        draws = RandomDraws(seed_of_round * _ROUNDS_APART + number)
        program = make_program(draws, aims=aims)
        pool.append((program.text, tuple(draws.choices)))
        report.spend("making", start)
        report.programs += 1
        report.tokens += len(program.pieces)
        trying(program.text)
        case = Case(program.text)
        if not try_text(report, case, of_programs, _program_again(aims), draws.choices, seed_of_round):
            # Else tracing it might fail in the same way.
            continue
        start = time.process_time()
        report.coverage.note(program)
        report.spend("tracing", start)
        report.sound += _is_sound(case)
    for number in range(formulas):
        if time.monotonic() >= until or (first and report.failures):
            return
        start = time.process_time()
        # Formulas have numbers that no program or mutant has.
        draws = RandomDraws((seed_of_round + 1) * _ROUNDS_APART - 1 - number)
        formula = make_formula(draws)
        report.spend("making formulas", start)
        report.formulas += 1
        trying(formula.text)
        try_text(report, Case(formula.text), of_formulas, make_formula, draws.choices, seed_of_round)
    if not pool:
        return
    for number in range(mutants):
        if time.monotonic() >= until or (first and report.failures):
            return
        start = time.process_time()
        draws = RandomDraws(seed_of_round * _ROUNDS_APART + programs + number)
        mutant = _mutant_of(pool, draws)
        report.spend("making mutants", start)
        report.mutants += 1
        trying(mutant.text)
        case = Case(mutant.text, mutant)
        try_text(report, case, of_texts, _mutant_again(aims), draws.choices, seed_of_round)


def _is_sound(case: Case) -> bool:
    """Return whether a program passes all checks, so that it is lowered or only waits for a feature."""
    try:
        found = case.checked
    except Exception:  # noqa: BLE001 - a property says so, if it is among those that are tried
        return False
    return all(each.code in _UNFINISHED for each in found if each.severity is Severity.ERROR)


def _mutant_of(pool: Sequence[tuple[str, Sequence[int]]], draws: RandomDraws) -> Mutant:
    """A mutant of programs of the same round, with choices as if these had been made now."""

    def pick() -> str:
        # Replaying makes the program instead of picking it.
        text, choices = pool[draws.pick(len(pool))]
        draws.extend(choices)
        return text

    return make_mutant(draws, pick(), pick)


def _program_again(aims: Sequence[AlternativeId] | None) -> Callable[[Draws], Sample]:
    return lambda draws: make_program(draws, aims=aims)


def _mutant_again(aims: Sequence[AlternativeId] | None) -> Callable[[Draws], Sample]:
    def make(draws: Draws) -> Mutant:
        def another() -> str:
            return make_program(draws, aims=aims).text

        return make_mutant(draws, another(), another)

    return make


def try_text(
    report: Report,
    case: Case,
    properties: Sequence[Property],
    again: Callable[[Draws], Sample],
    choices: Sequence[int],
    seed: int,
) -> bool:
    """Try ``properties`` on a text; return whether all hold. At most one new failure is shrunk and entered in ``report``.

    ``again`` makes the text from the numbers ``choices``, and shorter ones from others.
    """
    right = True
    for each in properties:
        report.checks += 1
        start = time.process_time()
        error = fault_of(each, case)
        report.spend(each.name, start)
        if error is not None:
            right = False
            signature = signature_of(each.name, error)
            if any(earlier.signature == signature for earlier in report.failures):
                report.repeated[signature] += 1
                continue
            reason = "".join(traceback.format_exception(error)[-3:])
            first = Failure(signature, case.text, case.mutant is None, seed, reason, _mutant(case))
            report.failures.append(shrink(first, each, again, choices))
            break
    return right


def fault_of(
    broken: Property, case: Case, *, seconds: float = SECONDS
) -> Exception | TookTooLongError | None:
    """Return the exception that a property raises, or the error that it took longer than ``seconds`` of processor time."""
    try:
        with limited(seconds):
            broken.holds(case)
    except (Exception, TookTooLongError) as error:  # noqa: BLE001 - whatever is raised is what the fuzzer looks for
        return error
    return None


def _mutant(case: Case) -> Mutant | None:
    return case.mutant if isinstance(case.mutant, Mutant) else None


def shrink(
    failure: Failure, broken: Property, again: Callable[[Draws], Sample], choices: Sequence[int]
) -> Failure:
    """Return the same failure with as short a text as Hypothesis finds, starting with the one made from ``choices``."""
    failures = [failure]
    until = time.monotonic() + _LONGEST
    endless = failure.signature.exception == TookTooLongError.__name__

    def attempt(sample: Sample) -> None:
        if time.monotonic() >= until:
            raise _Stop
        mutant = sample if isinstance(sample, Mutant) else None
        seconds = _ENDLESS if endless else SECONDS
        error = fault_of(broken, Case(sample.text, mutant, thorough=True), seconds=seconds)
        # Shrinking must not slip from one failure to another.
        if error is not None and signature_of(broken.name, error) == failure.signature:
            reason = "".join(traceback.format_exception(error)[-3:])
            failures.append(replace(failure, text=sample.text, reason=reason, mutant=mutant))
            raise _Failed(str(failure.signature)) from error

    test = settings(
        deadline=None,
        database=replayed(choices),
        phases=(Phase.reuse, Phase.shrink),
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )(given(_samples(again))(attempt))
    with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(_Stop, _Failed, Flaky):
        # Hypothesis tries the shortest one last. What fails only sometimes is a failure, too.
        test()
    return failures[-1]


def _samples(again: Callable[[Draws], Sample]) -> SearchStrategy[Sample]:
    @st.composite
    def sample(draw: DrawFn) -> Sample:
        return again(HypothesisDraws(draw))

    return sample()
