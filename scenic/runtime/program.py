"""What running a program produces: the raw material of a scenario."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from scenic.graph.node import Node
from scenic.language.spans import Span
from scenic.runtime.objects import Object, Point
from scenic.runtime.regions.base import Workspace
from scenic.runtime.samples import Globals


@dataclass(frozen=True, slots=True)
class Requirement:
    """One ``require`` statement.

    ``probability`` is that with which it is enforced in a scene; ``label`` names it in reports. ``build`` makes the
    condition again, from objects that have been mutated since.
    """

    condition: Node
    probability: float
    label: str
    span: Span | None = None
    filename: str | None = None
    build: Callable[[], Node] | None = field(default=None, compare=False)

    def rebuilt(self) -> "Requirement":
        """The requirement about the objects as they are now."""
        return self if self.build is None else replace(self, condition=self.build())


@dataclass(slots=True)
class Program:
    """Everything that the modules of one compilation have produced so far, in order.

    ``overrides`` are parameters given from outside: they win over every ``param`` statement.
    """

    overrides: Mapping[str, Any] = field(default_factory=dict)
    instances: list[Point] = field(default_factory=list)
    objects: list[Object] = field(default_factory=list)
    requirements: list[Requirement] = field(default_factory=list)
    parameters: dict[str, Any] = field(default_factory=dict)
    read_parameters: set[str] = field(default_factory=set)
    """Parameters that the program has asked for by name."""
    simulator: Callable[[], Any] | None = None
    places: dict[int, tuple[Span | None, str | None]] = field(default_factory=dict)
    """Where each instance was created, by its identity: span and file."""
    names: Globals = field(default_factory=Globals)
    """Global names as they are when the program has run, for the functions and methods in its scenes."""


@dataclass(slots=True)
class Module:
    """One file of the program while it runs."""

    filename: str
    ego: Object | None = None
    workspace: Workspace | None = None
    is_model: bool = False
    package: str = ""
    """The package that relative imports start from."""
    scope: dict[str, Any] = field(default_factory=dict)
    """The module's global names."""


@dataclass(frozen=True, slots=True)
class ScenarioClass:
    """A ``scenario`` definition: its name and its set-up, called with the running instance and the arguments."""

    name: str
    setup: Callable[..., Any]

    def __call__(self, *args: Any, **kwargs: Any) -> "ScenarioInstance":
        return ScenarioInstance(self, args, kwargs)


class ScenarioInstance:
    """A scenario with its arguments; the local variables of its set-up become attributes."""

    def __init__(self, scenario: ScenarioClass, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        self.scenario = scenario
        self.args = args
        self.kwargs = kwargs


@dataclass(frozen=True, slots=True)
class BehaviorClass:
    """A ``behavior`` definition. Static scenes carry behaviors as data: which one, with which arguments."""

    name: str
    signature: Callable[..., Any]

    def __call__(self, *args: Any, **kwargs: Any) -> "Behavior":
        bound = inspect.signature(self.signature).bind(*args, **kwargs)
        bound.apply_defaults()
        return Behavior(self, dict(bound.arguments))


@dataclass(frozen=True, slots=True, eq=False)
class Behavior:
    """A behavior with its arguments, which may be random."""

    behavior: BehaviorClass
    arguments: Mapping[str, Any]

    def random_parts(self) -> list[Any]:
        """The arguments, for sampling."""
        return list(self.arguments.values())

    def sampled(self, sample: Any) -> "Behavior":
        """The behavior with sampled arguments."""
        return Behavior(self.behavior, {name: sample.value(value) for name, value in self.arguments.items()})

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.arguments.items())
        return f"{self.behavior.name}({inside})"
