"""The program that is being compiled or simulated right now, as an explicit object.

Generated code reaches its context through the prelude that it was given. Functions that programs call like any Python
function (``Range(0, 1)``) find it in a context variable, so that several scenarios can be compiled side by side.
"""

import os
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Sequence
from contextvars import ContextVar
from dataclasses import field
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, Final, NamedTuple

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph.draws import address
from scenic.language.errors import ScenicWarning
from scenic.language.spans import Span
from scenic.runtime.ground.choosable import Choosable

_PACKAGE: Final = f"{Path(__file__).parents[1]}{os.sep}"
"""The directory of this package, ending in a separator."""

Locator = Callable[..., Span | None]
"""Finds the place in the Scenic source of a Python frame or of a traceback's failure
(`scenic.compiler.tracebacks`); passed in, since the runtime knows nothing of source text."""

Namer = Callable[[FrameType], Hashable]
"""A name of the place of a frame whatever is added before it: the text of its line, not the number."""


Quoter = Callable[[Span], tuple[str, str] | None]
"""Returns the file and the text of a span that a `Locator` has found; ``None`` for other spans."""


class Site(NamedTuple):
    """A call in generated code, whose place is looked up on demand."""

    frame: FrameType
    instruction: int


@dataclass(slots=True)
class Parameters:
    """Global parameters, as far as code below the program's own has to know them."""

    value: Callable[[str, Any], Any] = lambda _name, default: default
    """Returns a parameter as the program has set it so far, or else a default."""
    given: frozenset[str] = frozenset()
    """The parameters whose values are given from outside, and win over the program's own."""
    places: dict[str, tuple[Span | None, str | None]] = field(default_factory=dict)
    """Place and file where the program itself, rather than its model, has set each of its parameters."""
    model_place: tuple[Span | None, str | None] = None, None
    """Place and file of the program's ``model`` statement."""


@dataclass(slots=True)
class StandIns:
    """Substitutes for instances that choices draw, until the program has ended and they may be mutated."""

    make: Callable[[Any], Any] = lambda instance: instance
    """Returns the substitute: the instance itself unless some module may mutate instances."""
    made: dict[int, tuple[Any, Any]] = field(default_factory=dict)
    """Instances and their substitutes, by the identities of the instances."""


class Emptied(NamedTuple):
    """A filter that left nothing: its result, its elements and condition, and where it is called."""

    result: object
    elements: Sequence[Any]
    function: object
    place: Span | None


@dataclass(slots=True)
class Record:
    """Facts about the program that running it brings up, for whoever works on it afterwards."""

    calls: list[tuple[Any, tuple[Any, ...]]] = field(default_factory=list)
    """The nodes of calls that are made on samples, each with the instances that it sees."""
    externals: dict[int, Choosable] = field(default_factory=dict)
    """Values that an external sampler may choose, by address."""
    unrolled: list[tuple[Collection[Any], tuple[Any, ...]]] = field(default_factory=list)
    """Sequences, or values of dictionaries, that conditions were unrolled over, with the elements that they had."""
    emptied: list[Emptied] = field(default_factory=list)
    """Filters that left nothing."""
    files: dict[Path, None] = field(default_factory=dict)
    """Files whose content decides the scenes, in the order in which they are named."""
    imports: dict[str, None] = field(default_factory=dict)
    """Full names of Python's modules, and of what is imported from them."""
    looks: bool = False
    """True if some condition depends on visibility: it must be made again when all objects exist."""
    awaits: bool = False
    """True if some condition reads names that its module sets later: it must be made again when the program has ended."""

    @property
    def has_later_elements(self) -> bool:
        """Return whether a sequence that a condition was unrolled over has other elements now."""
        return any(
            len(sequence) != len(before) or any(a is not b for a, b in zip(sequence, before, strict=True))
            for sequence, before in self.unrolled
        )


class Context:
    """The way in which the program is being read.

    Args:
        locate: finds the place of a frame of generated code.
        name: names that place, for the addresses of draws.
        quote: returns file and text of a place, for reports.
        generator: ``None`` while a scenario is compiled (distributions become nodes of the graph); during a
            simulation the source of the draws (distributions draw at once and give plain values).
        mode_2d: whether the 2D compatibility mode is on (section 5.5 of the specification).

    """

    def __init__(
        self,
        *,
        locate: Locator = lambda *_: None,
        name: Namer = lambda _frame: None,
        quote: Quoter = lambda _span: None,
        generator: np.random.Generator | None = None,
        mode_2d: bool = False,
    ) -> None:
        self._locate = locate
        self._name = name
        self.quote = quote
        self.filename: str | None = None
        """The file of the program itself, rather than of a module that it imports."""
        self._occurrences: Counter[Hashable] = Counter()
        self.generator = generator
        self.mode_2d = mode_2d
        self.objects: list[Any] = []
        """The objects of the scenario so far, in order of creation: what may stand in the way of a look."""
        self.evaluating = False
        """True if a requirement's condition is being evaluated: nothing may be created then."""
        self.judging = False
        """True if the node of a requirement's condition is being made."""
        self.sample: Any = None
        """The sample on which Python code is being called."""
        self.concerns: Span | None = None
        """The place of what is worked on where no line of the program runs."""
        self.parameters = Parameters()
        self.stand_ins = StandIns()
        self.record = Record()

    @property
    def present(self) -> Sequence[Any]:
        """The existing objects, as values of the caller: of the program, of a sample, of a simulation."""
        if self.sample is None:
            return self.objects
        return [self.sample.value(item) for item in self.objects]

    def settled(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function of the program over the values of what is running."""
        return function

    @property
    def is_symbolic(self) -> bool:
        """Return whether distributions stand for values to be drawn later."""
        return self.generator is None

    @property
    def locator(self) -> Locator:
        """The function that finds places, for a context of the same program."""
        return self._locate

    def place_of(self, traceback: TracebackType) -> Span | None:
        """Place in the program where an exception comes from."""
        return self._locate(traceback)

    def program_place(self, traceback: TracebackType | None) -> Span | None:
        """Place in the program's own file that an exception has passed through, the innermost one."""
        found = None
        while traceback is not None:
            if traceback.tb_frame.f_code.co_filename == self.filename:
                found = self._locate(traceback.tb_frame, traceback.tb_lasti) or found
            traceback = traceback.tb_next
        return found

    def place_at(self, site: "Site") -> Span | None:
        """Place in the program of a call that was made earlier."""
        return self._locate(site.frame, site.instruction)

    def place(self) -> Span | None:
        """Place in the program of whoever called the runtime."""
        found = self._locate(sys._getframe(1))
        return self.concerns if found is None else found

    def own_place(self) -> Span | None:
        """Place in the program's own file that the present call comes from, by way of libraries or not."""
        frame: FrameType | None = sys._getframe(1)
        while frame is not None and frame.f_code.co_filename != self.filename:
            frame = frame.f_back
        return None if frame is None else self._locate(frame)

    def file(self) -> str | None:
        """Return the file of whoever called the runtime, if that is generated code."""
        frame = sys._getframe(1)
        found = self._locate(frame)
        if found is None:
            return None
        # From functions in between that are plain Python the same place is found.
        while frame.f_back is not None and self._locate(frame.f_back) == found:
            frame = frame.f_back
        return frame.f_code.co_filename

    @property
    def namer(self) -> Namer:
        """The function that names places, for a context of the same program."""
        return self._name

    def place_name(self) -> Hashable:
        """The name of the place in the program of whoever called the runtime."""
        return self._name(sys._getframe(1))

    def next_address(self) -> int:
        """The address of a new draw: the place in the program that makes it, and how many it has made before."""
        place = self._name(sys._getframe(1))
        self._occurrences[place] += 1
        return address(place, self._occurrences[place])


verbosity: ContextVar[int] = ContextVar("scenic verbosity", default=0)
"""Amount that programs and simulations print: 0 nothing, 1 main steps, 2 details, 3 every action."""

current: ContextVar[Context | None] = ContextVar("scenic context", default=None)


def here() -> Span | None:
    """Place in the program of whoever called the runtime, if a program is running."""
    context = current.get()
    return None if context is None else context.place()


def warn(
    message: str,
    *,
    code: str | None = None,
    span: Span | None = None,
    filename: str | None = None,
    help: str | None = None,
) -> None:
    """Issue a `ScenicWarning` of a place in the program, by default that of whoever called the runtime."""
    context = current.get()
    file = filename or (None if context is None else context.file())
    place = span or here()
    if file is None or place is None:
        # No program runs: Python's own code called.
        notice = ScenicWarning(message, code=code, help=help)
        file, line = _caller()
    else:
        notice = ScenicWarning(message, code=code, span=place, filename=file, help=help)
        line = place.line
    warnings.warn_explicit(notice, None, file, line)


def _caller() -> tuple[str, int]:
    """Return the file and line that called this package."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
    return ("<unknown>", 1) if frame is None else (frame.f_code.co_filename, frame.f_lineno)


def next_address() -> int | None:
    """The address of a new draw of the running program; ``None`` if none is running."""
    context = current.get()
    return None if context is None else context.next_address()


def uniform_draw() -> float | None:
    """A draw from (0, 1) when values are drawn at once, ``None`` when they become nodes."""
    context = current.get()
    if context is None or context.generator is None:
        return None
    draw: Any = context.generator.random()
    # The open interval: zero comes up once in 2**53 draws, and has no image under an unbounded law.
    return float(draw) or 2.0**-54
