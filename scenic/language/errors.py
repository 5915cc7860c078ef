"""The exceptions that users of the Python API meet (section 14 of the specification).

Each carries a code, a place and a help line, so that the command line can show it as a diagnostic.
"""

import linecache
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Self

from scenic.language.diagnostics import Diagnostic, Label, Severity
from scenic.language.spans import Span


class Finding(Exception):
    """A finding about a program, with a code, a place (``span`` and ``filename``) and help; never raised itself."""

    code = "SC400"
    severity = Severity.ERROR
    labels: tuple[Label, ...] = ()
    """Further places that take part in it."""
    argument: str | None = None
    """The parameter, of the behavior that is run, whose argument is wrong."""

    def __init__(
        self,
        message: str,
        *,
        code: str | None = None,
        span: Span | None = None,
        filename: str | None = None,
        help: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.span = span
        self.filename = filename
        self.help = help
        if code is not None:
            self.code = code

    def diagnostic(self) -> Diagnostic:
        """Return the same as plain data."""
        return Diagnostic(
            self.code,
            self.message,
            self.span,
            self.severity,
            filename=self.filename,
            help=self.help,
            labels=self.labels,
        )


class Located(Finding):
    """A problem that ends something; never raised itself."""

    program: str | None = None
    """The text that the place is in, where it is not in a file."""

    def at(self, place: "tuple[Span | None, str | None]") -> Self:
        """Return the same problem; at a place, span and file, unless it has one."""
        if self.span is None:
            self.span, self.filename = place
        return self

    @property
    def line(self) -> int | None:
        """The line of the problem, from 1."""
        return None if self.span is None else self.span.line

    @property
    def lineno(self) -> int | None:
        """The same under the name that Python's own syntax errors use."""
        return self.line

    @property
    def offset(self) -> int | None:
        """The column of the problem, from 1."""
        return None if self.span is None else self.span.column + 1

    @property
    def end_lineno(self) -> int | None:
        """The line where the problem ends."""
        return None if self.span is None else self.span.end_line

    @property
    def end_offset(self) -> int | None:
        """The column where the problem ends, from 1."""
        return None if self.span is None else self.span.end_column + 1

    @property
    def text(self) -> str | None:
        """The line of the program with the problem, if the program can still be read."""
        if self.line is None or self.filename is None:
            return None
        if self.program is not None:
            lines = self.program.splitlines(keepends=True)
            return lines[self.line - 1] if self.line <= len(lines) else None
        return linecache.getline(self.filename, self.line) or None

    def __str__(self) -> str:
        place = self.filename or ""
        if self.span is not None:
            place += f":{self.span.line}:{self.span.column + 1}"
        return f"{place}: {self.message}" if place else self.message


class ScenicError(Located):
    """Base of the errors about a Scenic program."""


class ParseCompileError(ScenicError):
    """The program could not be compiled; ``diagnostics`` holds every problem found, not only the first."""

    code = "SC110"

    def __init__(self, diagnostics: Sequence[Diagnostic], *, filename: str | None = None) -> None:
        first = diagnostics[0]
        super().__init__(
            first.message,
            code=first.code,
            span=first.span,
            filename=first.filename or filename,
            help=first.help,
        )
        self.diagnostics = tuple(diagnostics)

    def __reduce__(self) -> tuple[object, ...]:
        # Exceptions are made again from `args`, which is the message alone.
        return type(self), (self.diagnostics,), self.__dict__


class ScenicSyntaxError(ParseCompileError):
    """Lexical, grammatical and placement errors."""


class UndefinedNameError(ScenicSyntaxError, NameError):
    """A name that nothing defines: found before the program runs."""


class NoClassError(UndefinedNameError, TypeError):
    """A name after ``new`` that nothing defines, or that is something else than a class."""


class MissingNewError(ScenicSyntaxError, TypeError):
    """A class used like an instance, where ``new`` is missing."""


_BY_CODE: Mapping[str, type[ScenicSyntaxError]] = MappingProxyType(
    {"SC111": MissingNewError, "SC202": UndefinedNameError, "SC203": NoClassError}
)


def compile_error(diagnostics: Sequence[Diagnostic], *, filename: str | None = None) -> ScenicSyntaxError:
    """Return the exception of a program that cannot be compiled, of the class for its first problem."""
    return _BY_CODE.get(diagnostics[0].code, ScenicSyntaxError)(diagnostics, filename=filename)


class InvalidScenarioError(ScenicError):
    """The program describes no scenario."""

    code = "SC401"


class UnknownParameterError(InvalidScenarioError, AttributeError, KeyError):
    """A global parameter that the program does not set; also the error that ``hasattr`` and mappings expect."""


class UndefinedSamplingException(InvalidScenarioError):
    """A region from which no point can be drawn uniformly."""


class MissingFileError(ScenicError, FileNotFoundError):
    """The file of a program does not exist."""


class SpecifierError(ScenicError):
    """The specifiers of an object do not fit together (section 6.1)."""

    code = "SC402"


class RandomControlFlowError(ScenicError):
    """A random value was used where the program needs a definite one (section 8.3)."""

    code = "SC403"


class RandomIndexError(RandomControlFlowError, TypeError):
    """A random index of a container of Python's own."""


class SamplingError(ScenicError):
    """A requirement or property raised an exception on a candidate that nothing before it rejects."""

    code = "SC501"


class UnsupportedError(ScenicError):
    """A feature of the language that this version does not build yet."""

    code = "SC900"


class UnknownPairError(UnsupportedError, NotImplementedError):
    """A question about two regions of kinds for which the answer is not known."""


class ScenicTypeError(Located, TypeError):
    """A value of the wrong type for an operator, specifier or property."""

    code = "SC404"


class ScenicValueError(Located, ValueError):
    """A value of the right type that cannot be used."""

    code = "SC405"


class MeshError(ScenicValueError):
    """A mesh file that cannot be read, or a mesh that bounds no volume."""

    code = "SC602"


class ScenarioChoiceError(Located, RuntimeError):
    """No scenario, or more than one, could be meant; or the chosen one needs arguments."""

    code = "SC605"


class SerializationError(Located):
    """A saved scene that cannot be read, or that is of another program."""

    code = "SC607"


class RejectionException(Exception):
    """The current sample is rejected; or, from ``generate``, no sample was accepted.

    ``subject`` is the object that the message is about, if it is about one.
    """

    subject: object = None


def annotate(error: BaseException, diagnostic: Diagnostic, note: str) -> None:
    """Tell an exception of the program's own code where in the program it came up, without changing its type."""
    if annotation(error) is None:
        error.add_note(note)
        error.scenic_diagnostic = diagnostic  # type: ignore[attr-defined]


def annotation(error: BaseException) -> Diagnostic | None:
    """The note that `annotate` has added to an exception."""
    return getattr(error, "scenic_diagnostic", None)


class RejectSimulationException(Exception):
    """The running simulation is rejected; users see ``None`` as the result of ``simulate``."""


class GuardViolation(Exception):
    """A guard of a behavior or scenario does not hold.

    Args:
        behavior: what it guards.
        lineno: line of the guard, from 1.

    """

    violationType = "guard"

    def __init__(self, behavior: object, lineno: int | None) -> None:
        self.behaviorName = str(behavior).partition("(")[0]
        super().__init__(f"violated {self.violationType} of {self.behaviorName} on line {lineno}")
        self.behavior = behavior
        self.lineno = lineno

    def __reduce__(self) -> tuple[object, ...]:
        # Behaviors are classes of the program, which no other process can import: the name goes in place of the behavior.
        return type(self), (self.behaviorName, self.lineno)


class PreconditionViolation(GuardViolation):
    """A precondition does not hold when a behavior or scenario starts."""

    violationType = "precondition"


class InvariantViolation(GuardViolation):
    """An invariant does not hold when a behavior or scenario starts or continues."""

    violationType = "invariant"


class SimulationCreationError(Located):
    """The scene cannot be set up in the simulator."""

    code = "SC504"


class SimulationError(Located):
    """The simulator cannot continue."""

    code = "SC505"


class DivergenceError(Exception):
    """A replayed simulation goes another way than the one that was recorded."""


class StuckBehaviorError(Exception):
    """Code of a program has run for too long without taking an action or waiting."""


class ScenicWarning(Finding, UserWarning):
    """Something doubtful that ends nothing."""

    code = "SC407"
    severity = Severity.WARNING

    def __str__(self) -> str:
        return self.message if self.help is None else f"{self.message}: {self.help}"


class StuckBehaviorWarning(ScenicWarning):
    """Code of a program has run for long without taking an action or waiting."""


class InternalError(Exception):
    """A fault of this implementation, never of the program."""
