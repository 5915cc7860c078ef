"""Behaviors, monitors and modular scenarios as the program defines and instantiates them (section 12.1).

A definition becomes a Python class, and an instance of it holds its arguments, and later its local variables, as
attributes. An instance made while the scenario is compiled may hold random values; each simulation runs a copy of it
(`scenic.runtime.dynamics.copies`). What runs it is an activation (`scenic.runtime.dynamics.activations`).
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from types import FrameType, SimpleNamespace
from typing import Any, ClassVar, Final, NamedTuple

from scenic.dataclass import dataclass
from scenic.language.diagnostics import Diagnostic
from scenic.language.errors import InvalidScenarioError, ScenicSyntaxError, ScenicTypeError
from scenic.language.spans import Span
from scenic.runtime.ground.context import current, here
from scenic.runtime.ground.reported_places import argument_span, is_library
from scenic.runtime.instances.objects import Point
from scenic.runtime.regions.base import Region
from scenic.runtime.values.describing import describe, wrong_type
from scenic.runtime.values.lazy import Lazy, is_lazy, resolve
from scenic.runtime.values.random_values import Random
from scenic.runtime.values.values import Vector

__all__ = [
    "Behavior",
    "Definition",
    "Invocable",
    "Modifier",
    "ModularScenario",
    "Monitor",
    "behavior_of",
    "define",
    "running_in",
]

Guard = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Definition:
    """The parts of a definition.

    ``body`` is the generator function of a behavior, monitor or compose block (``None`` without one), ``setup`` the
    set-up of a scenario. Functions take the instance, those of behaviors then the agent, then the arguments (not
    ``body`` of a scenario, nor guards). ``signature`` is that of the arguments alone.
    """

    name: str
    signature: inspect.Signature
    body: Callable[..., Any] | None
    setup: Callable[..., Any] | None = None
    preconditions: Sequence[Guard] = ()
    invariants: Sequence[Guard] = ()
    span: Span | None = None
    sets_up: bool = False
    """True if a scenario has a set-up of its own, and does not only compose others."""

    @property
    def functions(self) -> list[Callable[..., Any]]:
        """All code of the definition."""
        own = [function for function in (self.body, self.setup) if function is not None]
        return [*own, *self.preconditions, *self.invariants]


class Invocable:
    """Base of behaviors, monitors and modular scenarios. Its attributes are the program's own names."""

    __slots__ = ("__dict__", "__weakref__", "_activation", "_arguments", "_place")
    _definition: ClassVar[Definition]
    _kind: ClassVar[str] = "invocable"

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        context = current.get()
        if context is not None and (context.evaluating or getattr(context, "guarding", False)):
            if self._kind == "monitor" and context.evaluating:
                name = self._definition.name
                raise ScenicSyntaxError(
                    [
                        Diagnostic(
                            "SC114",
                            f"`monitor` is missing: `{name}` is a monitor, not a condition",
                            here(),
                            help=f"write `require monitor {name}(...)`",
                        )
                    ]
                )
            raise InvalidScenarioError(
                f"a {self._kind} cannot be created in a condition",
                span=here(),
                help="create it before, and name it in the condition",
            )
        try:
            bound = self._definition.signature.bind(*args, **kwargs)
        except TypeError as error:
            raise ScenicTypeError(
                f"{self._kind} {self._definition.name}: {error}",
                code="SC211",
                span=here(),
                help=f"it is defined as `{self._definition.name}{self._definition.signature}`",
            ) from None
        bound.apply_defaults()
        _check_numbers(self._definition, bound.arguments)
        self._arguments = bound
        self._place = _place_in_program(self._definition)
        self._activation: Any = None
        self.__dict__.update(bound.arguments)

    def settle(self) -> None:
        """It is about to start: what its arguments read of scenarios that have started since is known now."""
        given = self._arguments.arguments
        for name, value in given.items():
            if is_lazy(value):
                given[name] = self.__dict__[name] = resolve(value, SimpleNamespace())
        _check_numbers(self._definition, given)

    def random_parts(self) -> list[Any]:
        """Return the values in the invocable that may be random, for sampling."""
        return [*self._arguments.arguments.values(), *self.__dict__.values(), *self._definition.functions]

    def sampled(self, sample: Any) -> "Invocable":
        """Return the same with sampled arguments and attributes."""
        copy = object.__new__(type(self))
        copy._activation = None
        copy._place = self._place
        if hasattr(sample, "remember"):
            # Local functions lead back to the instance.
            sample.remember(self, copy)
        arguments = {name: sample.value(value) for name, value in self._arguments.arguments.items()}
        copy._arguments = inspect.BoundArguments(self._arguments.signature, arguments)
        copy.__dict__.update((name, sample.value(value)) for name, value in self.__dict__.items())
        return copy

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self._arguments.arguments.items())
        return f"{self._definition.name}({inside})"


_NO_NUMBERS: Final = (str, bytes, list, tuple, dict, set, frozenset, type(None), Point, Region, Vector)


def _place_in_program(definition: Definition) -> Span | None:
    """Return where the program's own file makes an instance of the library: what goes wrong in it is reported there."""
    body, context = definition.body, current.get()
    if context is None or body is None or not is_library(body.__code__.co_filename):
        return None
    return context.own_place()


def _check_numbers(definition: Definition, arguments: Mapping[str, Any]) -> None:
    """Raise `ScenicTypeError` for an argument of a behavior of the library that is no number, where one belongs."""
    body = definition.body
    if body is None or not is_library(body.__code__.co_filename):
        return
    for name, parameter in definition.signature.parameters.items():
        default = parameter.default
        value = arguments.get(name, default)
        is_number = type(default) in (int, float) or parameter.annotation is float
        if is_number and value is not default and isinstance(value, _NO_NUMBERS):
            error = wrong_type("a number", value, f"`{name}` of {definition.name}")
            error.help = "give a number" + ("" if default is None else f"; the default is {default}")
            error.argument = name
            context = current.get()
            quotation = None if context is None or error.span is None else context.quote(error.span)
            if error.span is not None and quotation is not None:
                parameters = list(definition.signature.parameters)
                error.span = argument_span(error.span, quotation[1], parameters, name)
            raise error


class Behavior(Invocable):
    """Base of all behaviors."""

    __slots__ = ()
    _kind = "behavior"

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        _need_time(self)
        super().__init__(*args, **kwargs)


class Monitor(Invocable):
    """Base of all monitors."""

    __slots__ = ()
    _kind = "monitor"

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        _need_time(self)
        super().__init__(*args, **kwargs)


class ModularScenario(Invocable):
    """Base of all modular scenarios. The ego and the objects of a running one can be read from outside."""

    __slots__ = ()
    _kind = "scenario"

    def __getattr__(self, name: str) -> Any:
        # Reached only for what is no local name of the scenario.
        activation = None if name.startswith("_") else self._activation
        if activation is not None and name in ("ego", "objects", "agents", "workspace"):
            return getattr(activation, name)
        context = current.get()
        if (
            activation is None
            and not name.startswith("_")
            and getattr(context, "run", None) is not None
            and not (context.evaluating or context.guarding)  # type: ignore[union-attr] # it is that of a run
        ):
            # It will have been set up when another scenario starts that has this for an argument.
            return Lazy(frozenset(), lambda _: getattr(self, name))
        raise AttributeError(
            f"scenario {self._definition.name!r} has no variable {name!r}", name=name, obj=self
        )


class Modifier(NamedTuple):
    """A limit of a ``do`` statement as data: ``for`` or ``until``, its value, and its unit."""

    name: str
    value: Any
    terminator: str | None = None


def _need_time(instance: Invocable) -> None:
    definition = instance._definition
    if not inspect.isgeneratorfunction(definition.body):
        raise InvalidScenarioError(
            f"{instance._kind} {definition.name!r} never takes an action nor waits",
            span=here() or definition.span,
            help="use `take`, `wait` or `do` in it",
        )


def define(base: type[Invocable], definition: Definition, documentation: str | None, module: str) -> Any:
    """Return the class for a definition, derived from ``base``."""
    members = {
        "__slots__": (),
        "__doc__": documentation,
        "__module__": module,
        "_definition": definition,
        "__signature__": definition.signature,
    }
    return type(definition.name, (base,), members)


def behavior_of(value: object) -> Any:
    """Return the value of the property ``behavior``: a class stands for an instance without arguments.

    Raises `ScenicTypeError` for what is no behavior, nor a random value that may be one.
    """
    if isinstance(value, type) and issubclass(value, Behavior):
        return value()
    later = isinstance(value, Random) and value.node.kind.is_boxed
    if value is None or later or isinstance(value, Behavior):
        return value
    raise ScenicTypeError(
        f"property 'behavior' must be a behavior, not {describe(value)}",
        span=here(),
        help="define one with `behavior NAME():`, and write `with behavior NAME()`",
    )


def running_in(frame: FrameType | None) -> Invocable | None:
    """Return the behavior, monitor or scenario whose code runs in a frame or has called it; ``None`` outside of such code."""
    while frame is not None:
        for name in frame.f_code.co_varnames[:1]:
            instance = frame.f_locals.get(name)
            if isinstance(instance, Invocable):
                return instance
        frame = frame.f_back
    return None
