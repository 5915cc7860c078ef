"""The exceptions that users of the Python API meet (section 14 of the specification).

Each carries a code, a place and a help line, so that the command line can show it as a diagnostic.
"""

from collections.abc import Sequence

from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.spans import Span


class Located(Exception):
    """A problem with a code and a place; never raised itself."""

    code = "SC400"

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

    @property
    def line(self) -> int | None:
        """The line of the problem, from 1."""
        return None if self.span is None else self.span.line

    def diagnostic(self) -> Diagnostic:
        """The same problem as plain data."""
        return Diagnostic(
            self.code, self.message, self.span, Severity.ERROR, filename=self.filename, help=self.help
        )

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


class ScenicSyntaxError(ParseCompileError):
    """Lexical, grammatical and placement errors."""


class InvalidScenarioError(ScenicError):
    """The program describes no scenario."""

    code = "SC401"


class SpecifierError(ScenicError):
    """The specifiers of an object do not fit together (section 6.1)."""

    code = "SC402"


class RandomControlFlowError(ScenicError):
    """A random value was used where the program needs a definite one (section 8.3)."""

    code = "SC403"


class SamplingError(ScenicError):
    """A requirement or property raised an exception on a candidate that nothing before it rejects."""

    code = "SC501"


class UnsupportedError(ScenicError):
    """A feature of the language that this version does not build yet."""

    code = "SC900"


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


class RejectionException(Exception):
    """The current sample is rejected; or, from ``generate``, no sample was accepted."""


class InternalError(Exception):
    """A fault of this implementation, never of the program."""
