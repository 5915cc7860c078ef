"""A prelude that computes with plain values and notes where it was called from."""

import operator
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from scenic.compiler.compile import compile_text
from scenic.compiler.tracebacks import SOURCE_NAME, TracedPlace, locate
from scenic.language.source import Source
from scenic.runtime.description.conditions import picked

COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


class Instance(SimpleNamespace):
    pass


class Recorder:
    """Stands for the runtime: ``calls`` are the prelude's functions in order, with the text they were called for.

    Every leaf of a condition is evaluated in both readings where it has both.
    """

    def __init__(self, text: str) -> None:
        self._source = Source(text, "program.scenic")
        self.Object = Instance
        self.workspace: Any = None
        self.calls: list[tuple[str, str]] = []
        self.required: list[tuple[Any, Any, Any]] = []
        self.readings: list[tuple[Any, Any]] = []
        self.parameters: dict[str, Any] = {}
        self.scenarios: dict[str, Callable[..., Any]] = {}
        self._ego: Any = None

    def _note(self, name: str) -> None:
        place = locate(sys._getframe(2))
        assert isinstance(place, TracedPlace)
        assert place.filename == "program.scenic"
        self.calls.append((name, segment(self._source, place)))

    @property
    def ego(self) -> Any:
        self._note("ego")
        return self._ego

    @ego.setter
    def ego(self, value: Any) -> None:
        self._ego = value

    def new(self, cls: Any, *specifiers: tuple[str, Any]) -> Any:
        self._note("new")
        instance = cls.__new__(cls)
        instance.__dict__.update(dict(specifiers))
        return instance

    def specifier(self, name: str, *operands: Any, property: str | None = None) -> tuple[str, Any]:
        self._note("specifier")
        return property or name.replace(" ", "_"), operands[0] if len(operands) == 1 else operands

    def property(self, name: str, attributes: Sequence[str], value: Any, reads: Sequence[str]) -> Any:
        self._note("property")
        return name, tuple(attributes), value, tuple(reads)

    def behavior(self, preconditions: Sequence[Any], invariants: Sequence[Any]) -> Any:
        self._note("behavior")
        return lambda function: function

    def monitor(self) -> Any:
        self._note("monitor")
        return lambda function: function

    def scenario(
        self, preconditions: Sequence[Any], invariants: Sequence[Any], compose: Any, sets_up: bool
    ) -> Any:
        self._note("scenario")

        def keep(function: Any) -> Any:
            self.scenarios[function.__name__] = function
            return function

        return keep

    def take(self, instance: Any, *actions: Any) -> Any:
        self._note("take")
        return actions

    def operation(self, name: str, *operands: Any) -> Any:
        self._note(f"operation {name}")
        if name == "deg":
            return operands[0] / 100
        if name == "intersects":
            return operands[0] is operands[1]
        return (name, *operands)

    def convert(self, name: str, *args: Any) -> Any:
        self._note("convert")
        return {"int": int, "float": float, "str": str}[name](*args)

    def spread(self, function: Any, parts: Sequence[tuple[bool, Any]], keywords: dict[str, Any]) -> Any:
        arguments = [item for starred, value in parts for item in (value if starred else (value,))]
        return function(*arguments, **keywords)

    def param(self, values: dict[str, Any]) -> None:
        self._note("param")
        self.parameters.update(values)

    def model(self, name: str, scope: dict[str, Any]) -> None:
        self._note("model")
        scope[name.replace(".", "_")] = name

    def simulator(self, make: Callable[[], Any]) -> None:
        self._note("simulator")
        self.parameters["simulator"] = make

    def require(self, condition: Any, *, probability: float | None, name: str | None) -> None:
        self._note("require")
        self.required.append((bool(condition), probability, name))

    def condition(
        self,
        symbolic: Any,
        concrete: Any,
        captured: Sequence[Any],
        margin: Any = None,
        indices: Any = None,
    ) -> Any:
        self._note("condition")
        value = concrete(*captured)
        self.readings.append((value if symbolic is None else symbolic(*captured), value))
        if indices is not None:
            self.readings.append((concrete(*picked(captured, indices)), value))
        return value

    def perhaps(self, test: Any, make: Callable[[], list[Any]]) -> list[Any]:
        return make() if test else []

    def number_of(self, length: Any, values: list[Any]) -> Any:
        return length(values)

    def occurrences(self, values: Any, value: Any) -> Any:
        return values.count(value)

    def items_of(self, container: Any, view: str) -> Any:
        return list(getattr(container, view)())

    def ascending(self, function: Any, values: Any) -> Any:
        return values == function(values)

    def conjunction(self, *parts: Any) -> Any:
        return all(parts)

    def disjunction(self, *parts: Any) -> Any:
        return any(parts)

    def negation(self, part: Any) -> Any:
        return not part

    def temporal(self, operator: str, *parts: Any) -> Any:
        assert operator == "implies"
        return not parts[0] or parts[1]

    def read(self, value: Any, name: str) -> Any:
        return getattr(value, name)

    def call(self, value: Any, name: str, *args: Any) -> Any:
        return getattr(value, name)(*args)

    def compare(self, symbol: str, left: Any, right: Any) -> Any:
        return COMPARISONS[symbol](left, right)

    def contains(self, item: Any, container: Any) -> Any:
        return item in container

    def iterated(self, _name: str, function: Any, *sequences: Any) -> list[Any]:
        return list(function(*sequences))

    def each(self, sequence: Any, function: Any, spread: bool) -> list[Any]:
        return [value for item in sequence for value in (function(*item) if spread else function(item))]

    def given(self, test: Any, make: Any) -> list[Any]:
        return make() if test else []

    def over(self, _name: str, function: Any, values: Any) -> Any:
        return function(values)

    def identical(self, left: Any, right: Any) -> bool:
        return left is right

    def all_of(self, *values: Any) -> Any:
        for value in values:
            if not value:
                return value
        return values[-1]

    def any_of(self, *values: Any) -> Any:
        for value in values:
            if value:
                return value
        return values[-1]

    def invert(self, value: Any) -> Any:
        return not value

    def choose(self, test: Any, then: Callable[[], Any], otherwise: Callable[[], Any]) -> Any:
        return then() if test else otherwise()

    def provided(self, name: str, function: Any) -> Any:
        return function


def segment(source: Source, place: TracedPlace) -> str:
    """The text at a place."""
    span = place.span
    lines = [source.line(number) for number in range(span.line, span.end_line + 1)]
    lines[-1] = lines[-1][: span.end_column]
    lines[0] = lines[0][span.column :]
    return "\n".join(lines)


def run(text: str, *, folder: Path | None = None, **names: Any) -> tuple[Recorder, dict[str, Any]]:
    """Compiles and runs a program with a recording prelude; ``names`` are provided as builtins."""
    import builtins
    import math

    if names:
        # A program that mentions `globals` may read names that nothing in it binds.
        text += "\nglobals\n"
    compiled = compile_text(text, filename="program.scenic")
    assert compiled.code is not None, compiled.diagnostics
    recorder = Recorder(text)
    provided = {
        **vars(builtins),
        "Object": Instance,
        "Point": Instance,
        "sin": math.sin,
        "cos": math.cos,
        "hypot": math.hypot,
        **names,
    }
    scope: dict[str, Any] = {
        "__scenic__": recorder,
        "__builtins__": provided,
        "__name__": "program",
        SOURCE_NAME: Source(text, "program.scenic"),
    }
    exec(compiled.code, scope)
    return recorder, scope
