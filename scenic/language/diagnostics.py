"""Diagnostics of programs: one value for every problem, and the table of all codes.

A diagnostic is plain data. The command line, the language server and the exceptions of the Python API
all show the same ones; how they look is decided where they are shown.
"""

from dataclasses import field
from enum import StrEnum
from types import MappingProxyType
from typing import Final

from scenic.dataclass import dataclass
from scenic.language.spans import Span

_LONGEST: Final = 2000
"""The characters of a message, about; of a longer one the middle is left out."""


UNSUPPORTED: Final = "SC900"
"""The code of what is right, but not built by this version."""


class Severity(StrEnum):
    """Severity of a diagnostic: errors keep a program from being compiled; errors and warnings make ``scenic check`` fail."""

    ERROR = "error"
    WARNING = "warning"
    INFORMATION = "information"


@dataclass(frozen=True, slots=True)
class Label:
    """A second place that takes part in a problem, and what it has to do with it.

    It is in the file of the problem, unless ``filename`` names another.
    """

    span: Span
    text: str
    filename: str | None = None


@dataclass(frozen=True, slots=True)
class Edit:
    """One change of a text: what stands at ``span`` is replaced by ``text``."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A repair that a machine can apply: all ``edits`` at once, none of which overlap.

    ``title`` says what it does, in the imperative. One that is not ``certain`` is a guess: people may choose it, and no
    tool makes it by itself.
    """

    title: str
    edits: tuple[Edit, ...]
    certain: bool = True


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One problem.

    ``span`` is ``None`` only for problems of no place in a text (a file that cannot be read).
    ``message`` says what is wrong, ``help`` what to do about it; neither ends in a full stop.
    """

    code: str
    message: str
    span: Span | None = None
    severity: Severity = Severity.ERROR
    filename: str | None = None
    help: str | None = None
    labels: tuple[Label, ...] = field(default=())
    fix: Fix | None = None

    def __post_init__(self) -> None:
        if self.code not in CODES:
            raise ValueError(f"unknown diagnostic code {self.code!r}")
        if len(self.message) > _LONGEST:
            # It quotes a name, and a name may be of any length.
            half = _LONGEST // 2
            object.__setattr__(self, "message", f"{self.message[:half]} … {self.message[-half:]}")


CODES: Final = MappingProxyType(
    {
        # Lexical and syntax errors.
        "SC100": "invalid character",
        "SC101": "unterminated string",
        "SC102": "bad indentation",
        "SC103": "unbalanced bracket",
        "SC104": "invalid number",
        "SC105": "invalid string or f-string",
        "SC106": "text after a line continuation",
        "SC107": "the file is not UTF-8 text",
        "SC110": "invalid syntax",
        "SC111": "missing `new`",
        "SC112": "nesting too deep",
        "SC113": "missing comma",
        "SC114": "missing word",
        "SC115": "form of an older dialect",
        "SC116": "clauses in the wrong order",
        "SC117": "misused temporal operator",
        "SC118": "misspelt keyword",
        "SC119": "keyword used as a name",
        "SC120": "syntax newer than the running Python",
        "SC121": "missing colon",
        "SC122": "`=` where a value is compared",
        "SC123": "cannot be assigned",
        "SC124": "form of Python 2",
        "SC125": "missing parentheses around an operand",
        "SC126": "arguments or parameters in the wrong order",
        "SC127": "missing block",
        "SC128": "missing unit of a duration",
        "SC129": "form of another language",
        "SC130": "unknown attribute of a property",
        "SC131": "impossible probability",
        "SC132": "guard in the wrong place",
        "SC133": "missing parentheses of a definition",
        "SC134": "clause without its beginning",
        "SC135": "object made like a call",
        "SC136": "program of Scenic 2",
        # Names and placement.
        "SC200": "reserved name",
        "SC201": "statement in the wrong place",
        "SC202": "undefined name",
        "SC203": "unknown class",
        "SC204": "name used before its definition",
        "SC205": "unused local variable",
        "SC206": "unused import",
        "SC207": "name of the language hidden",
        "SC208": "definition replaced before it is used",
        "SC209": "the ego does not exist yet",
        "SC210": "duplicate definition",
        "SC211": "wrong arguments",
        "SC212": "name that a module lacks",
        "SC213": "names that cannot be known",
        "SC214": "unknown attribute",
        "SC220": "a literal was required",
        # Meaning, found without running the program.
        "SC300": "misspelt property",
        "SC301": "conflicting specifiers",
        "SC302": "degrees where radians are meant",
        "SC303": "unreachable code",
        "SC304": "endless loop within one step",
        "SC305": "nothing that takes time",
        "SC306": "condition that is always the same",
        "SC307": "suspicious expression",
        "SC308": "specifiers that depend on each other",
        "SC309": "default value that is changed",
        "SC310": "misspelt guard",
        "SC311": "comma that makes a tuple",
        "SC312": "behavior or monitor that nothing runs",
        "SC313": "attribute where a property is meant",
        "SC314": "wrong kind of thing to run",
        "SC315": "function where the language has words",
        "SC390": "ignore comment that silences nothing",
        "SC391": "ignore comment that cannot be understood",
        # Found while the program runs.
        "SC400": "the program raised an exception",
        "SC401": "invalid scenario",
        "SC402": "incompatible specifiers",
        "SC403": "random value used to decide control flow",
        "SC404": "value of the wrong type",
        "SC405": "unsuitable value",
        "SC406": "module not found",
        "SC407": "doubtful value or statement while the program runs",
        # Found while sampling.
        "SC500": "no scene found",
        "SC501": "a requirement or property failed while sampling",
        "SC503": "a simulator failed",
        "SC504": "scene cannot be set up in the simulator",
        "SC505": "simulation cannot continue",
        # Files, options, parameters.
        "SC600": "file cannot be read",
        "SC601": "file cannot be written",
        "SC602": "mesh cannot be used",
        "SC603": "unknown parameter",
        "SC604": "bad option",
        "SC605": "scenario cannot be chosen",
        "SC606": "bad configuration",
        "SC607": "saved scene cannot be used",
        "SC608": "time limit reached before sampling",
        "SC609": "run cannot be resumed or replayed",
        "SC610": "sampling process died",
        "SC611": "cluster cannot be used",
        "SC612": "data set cannot be used",
        "SC613": "texture cannot be used",
        "SC614": "description of a thing with joints cannot be used",
        "SC615": "folder or file is in use",
        "SC616": "appearance cannot be shown",
        "SC620": "map cannot be used",
        "SC621": "road of a map repaired or omitted",
        "SC622": "lane of a map repaired or omitted",
        "SC623": "link of a map dropped",
        "SC624": "junction of a map repaired or omitted",
        # Found by analysis.
        "SC700": "requirements contradict each other",
        "SC701": "requirement always holds",
        "SC702": "option never occurs",
        "SC703": "branch never taken",
        # The tools themselves.
        "SC900": "not supported yet",
        "SC999": "internal error",
    }
)
"""Every code with its short title; a clash would be a duplicate key here."""
