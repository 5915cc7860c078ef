"""Failures of programs as diagnostics: what a program's code raises, with its place in the text."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from scenic.compiler.tracebacks import locate, raised_at
from scenic.language.diagnostics import Diagnostic, Label
from scenic.language.errors import (
    InvalidScenarioError,
    Located,
    ParseCompileError,
    RejectionException,
    annotate,
    annotation,
)
from scenic.language.spans import Span
from scenic.language.spelling import nearest_attribute
from scenic.runtime.ground.context import current
from scenic.runtime.ground.missing_items import missing_item
from scenic.runtime.ground.reported_places import Place, reported
from scenic.runtime.values.random_base import is_random

__all__ = ["diagnose", "placed"]


def diagnose(error: BaseException) -> Diagnostic | None:
    """Return an exception as a diagnostic: with its place in the program, if the program or its use caused it."""
    if isinstance(error, Located):
        return error.diagnostic()
    annotation_of_error = annotation(error)
    if annotation_of_error is not None:
        return _with_origin(annotation_of_error, error)
    place = locate(error.__traceback__) if error.__traceback__ is not None else None
    if place is None:
        return None
    if isinstance(error, ModuleNotFoundError):
        return Diagnostic(
            "SC406",
            f"there is no module {error.name!r}",
            place.span,
            filename=place.filename,
            help="modules are .scenic files beside the program, or anything that Python can import",
        )
    if isinstance(error, KeyError) and is_random(error.args):
        return Diagnostic(
            "SC403",
            "looking up a random key in a dictionary of Python's own is not possible",
            place.span,
            filename=place.filename,
            help="make the dictionary itself random: `Uniform(d)[key]`, or choose a value: `Uniform(*d.values())`",
        )
    near = nearest_attribute(error)
    hint = f"did you mean `{near}`?" if near else missing_item(error, current.get())
    diagnostic = Diagnostic(
        "SC400",
        f"{type(error).__name__}: {error}",
        place.span,
        filename=place.filename,
        help=hint or "the program raised this exception while it ran",
    )
    return _with_origin(diagnostic, error)


def _with_origin(found: Diagnostic, error: BaseException) -> Diagnostic:
    """Return the diagnostic with the line that raised the exception, where that is another one."""
    origin = raised_at(error)
    if origin is None or found.span is None or found.labels:
        return found
    if origin.filename == found.filename and found.span.line <= origin.span.line <= found.span.end_line:
        return found
    return replace(found, labels=(Label(origin.span, "raised here", origin.filename),))


@contextmanager
def placed(text: str, filename: str) -> Iterator[None]:
    """Give errors that a program raises while it runs their place in its text.

    Raises:
        InvalidScenarioError: in place of ``SystemExit`` and of a rejection, which describe no scenario.

    """
    try:
        yield
    except SystemExit as error:
        raise _no_scenario(
            error,
            filename,
            f"the program ended itself (`sys.exit`, with {error.code!r}) before it described a scenario",
            "raise an exception that says what is wrong instead",
        ) from error
    except RejectionException as error:
        raise _no_scenario(
            error,
            filename,
            "the program rejected itself while it ran: every scene would be rejected",
            f"{error}" if str(error) else "raise `RejectionException` only in what is evaluated on samples",
        ) from error
    except Located as error:
        if error.span is None or error.filename is None:
            place = locate(error.__traceback__) if error.__traceback__ is not None else None
            error.span = error.span or (place.span if place else None)
            error.filename = error.filename or (place.filename if place else filename)
        if not isinstance(error, ParseCompileError):
            raise_place: Place = error.span, error.filename
            (error.span, error.filename), labels = reported(raise_place, (_program_place(error), filename))
            error.labels += labels
        if error.filename == filename:
            error.program = text
        raise
    except Exception as error:
        diagnostic = diagnose(error)
        if diagnostic is not None and diagnostic.span is not None:
            program_place = _program_place(error), filename
            (span, file), labels = reported((diagnostic.span, diagnostic.filename), program_place)
            span = diagnostic.span if span is None else span
            diagnostic = replace(diagnostic, span=span, filename=file, labels=labels or diagnostic.labels)
            annotate(error, diagnostic, f"{file}:{span.line}:{span.column + 1}: raised while the program ran")
        raise


def _program_place(error: BaseException) -> Span | None:
    """The innermost line of the program's own file that an exception has passed through."""
    context = current.get()
    return None if context is None else context.program_place(error.__traceback__)


def _no_scenario(error: BaseException, filename: str, message: str, help: str) -> InvalidScenarioError:
    place = locate(error.__traceback__) if error.__traceback__ is not None else None
    raised: Place = (None, filename) if place is None else (place.span, place.filename)
    (span, file), labels = reported(raised, (_program_place(error), filename))
    found = InvalidScenarioError(message, span=span, filename=file, help=help)
    found.labels = labels
    return found
