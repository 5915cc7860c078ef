"""Results of the tools, as types from which their schemas follow."""

from typing import Any, Literal, NotRequired

from typing_extensions import TypedDict

__all__ = [
    "Answer",
    "Checked",
    "Diagnostic",
    "Edit",
    "Example",
    "Examples",
    "Fix",
    "Fixed",
    "Formatted",
    "Label",
    "Migrated",
    "Note",
    "Span",
    "Text",
]


class Span(TypedDict):
    """A place; lines and columns count from 1, and the end is exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


class Edit(TypedDict):
    """A change: what is at ``span`` is replaced by ``text``."""

    span: Span
    text: str


class Fix(TypedDict):
    """A repair: all edits at once."""

    title: str
    edits: list[Edit]


class Label(TypedDict, total=False):
    """A second place of a problem."""

    span: Span
    text: str
    filename: str


class Diagnostic(TypedDict):
    """A problem: its code, place, message, advice and repair."""

    code: str
    severity: str
    title: str
    message: str
    help: str | None
    filename: str | None
    span: Span | None
    labels: list[Label]
    fix: Fix | None
    page: NotRequired[str]


class Checked(TypedDict):
    """The problems of a program."""

    ok: bool
    diagnostics: list[Diagnostic]


class Fixed(TypedDict):
    """A program after its certain repairs, with the remaining problems."""

    text: str
    repairs: int
    ok: bool
    diagnostics: list[Diagnostic]


class Formatted(TypedDict):
    """A program in the usual style."""

    text: str
    changed: bool


class Note(TypedDict):
    """A change that a conversion makes, or leaves to be made by hand."""

    line: int
    rule: str
    message: str


class Migrated(TypedDict):
    """A converted program."""

    text: str
    changed: bool
    notes: list[Note]


class Text(TypedDict):
    """A page."""

    text: str


class Example(TypedDict):
    """A checked program of the documentation."""

    section: str
    page: str
    text: str
    program: str


class Examples(TypedDict):
    """Programs that match a query best."""

    examples: list[Example]


class Answer(TypedDict):
    """An answer of `scenic.trying.answer`: the phase that a program reaches, everything that is wrong, and the first scene."""

    version: int
    file: str
    phase: Literal["parse", "check", "load", "sample", "simulate"]
    ok: bool
    diagnostics: list[Diagnostic]
    draws: list[dict[str, Any]]
    rejections: dict[str, Any] | None
    map: dict[str, Any] | None
    scene: dict[str, Any] | None
    simulation: dict[str, Any] | None
    time: dict[str, float]
    scenes: NotRequired[list[dict[str, Any]]]
    output: NotRequired[str]
