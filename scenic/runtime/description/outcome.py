"""The results of running a program: the raw material of a scenario."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field, replace
from typing import Any

from scenic.dataclass import dataclass
from scenic.graph.node import Node
from scenic.language.spans import Span
from scenic.runtime.description.declarations import Declared, Required
from scenic.runtime.description.definitions import Invocable, ModularScenario
from scenic.runtime.ground.context import Context
from scenic.runtime.instances.objects import Object, Point
from scenic.runtime.python.samples import Globals
from scenic.runtime.python.shared_containers import Originals
from scenic.runtime.regions.spaces import Workspace
from scenic.runtime.regions.visibility_nodes import Sighting


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
    formula: Required | None = field(default=None, compare=False)
    """The requirement as simulations follow it."""
    is_simulated: bool = False
    """True if a simulation decides it: it is then judged last."""

    def rebuilt(self) -> "Requirement":
        """Return the requirement about the objects as they are now."""
        return self if self.build is None else replace(self, condition=self.build())


@dataclass(slots=True)
class Program:
    """Everything that the modules of one compilation have produced so far, in order.

    ``overrides`` are parameters given from outside: they win over every ``param`` statement.
    """

    overrides: Mapping[str, Any] = field(default_factory=dict)
    context: Context = field(default_factory=Context)
    instances: list[Point] = field(default_factory=list)
    objects: list[Object] = field(default_factory=list)
    requirements: list[Requirement] = field(default_factory=list)
    sightings: list[tuple[Point, Sighting]] = field(default_factory=list)
    """Instances that somebody must see, or must not."""
    parameters: dict[str, Any] = field(default_factory=dict)
    read_parameters: set[str] = field(default_factory=set)
    """Parameters that the program has read by name."""
    simulator: Callable[[], Any] | None = None
    declared: Declared = field(default_factory=Declared)
    """Declarations of the program about simulations, beside requirements."""
    invocables: list[type[Invocable]] = field(default_factory=list)
    """The behaviors, monitors and scenarios that it defines."""
    top: ModularScenario | None = None
    """The scenario that the program means, where it is one of those that it defines."""
    ego: Object | None = None
    workspace: Workspace | None = None
    places: dict[int, tuple[Span | None, str | None]] = field(default_factory=dict)
    """The span and file where each instance was created, by the identity of the instance."""
    module: Mapping[str, Any] = field(default_factory=dict)
    """The names of its main module."""
    variables: Mapping[int, str] = field(default_factory=dict)
    """Variables that hold instances, by the instance's identity."""
    names: Globals = field(default_factory=Globals)
    """Global names as they are when the program has run, for the functions and methods in its scenes."""
    scopes: list[dict[str, Any]] = field(default_factory=list)
    """The global names of its modules."""
    settling: Any = None
    """The condition that nothing moves, with its tally, of a program that is loaded with it."""
    _originals: Originals | None = None

    @property
    def originals(self) -> Originals:
        """The containers that simulations share; made for the first one."""
        if self._originals is None:
            public_values = [
                value
                for scope in self.scopes
                for name, value in scope.items()
                if not (name.startswith("__") and name.endswith("__"))
            ]
            self._originals = Originals([*public_values, *self.reachable()])
            self.names.contents = self._originals.contents
        return self._originals

    @contextmanager
    def undisturbed(self) -> Iterator[None]:
        """Within this its containers hold what they held when it had run, whatever simulations have done."""
        if self._originals is None:
            yield
        else:
            with self._originals.put_back():
                yield

    def parameter(self, name: str, default: object = None) -> Any:
        """Return a global parameter as it is so far, or else a default."""
        self.read_parameters.add(name)
        return self.overrides.get(name, self.parameters.get(name, default))

    def reachable(self) -> Iterator[Any]:
        """Yield the values of which simulations need samples."""
        yield from self.objects
        yield from self.instances
        yield from self.parameters.values()
        for invocable in self.invocables:
            yield from invocable._definition.functions
        yield from self.declared.random_parts()
        for requirement in self.requirements:
            if requirement.formula is not None:
                for atom in requirement.formula.atoms:
                    yield from atom.random_parts()
        yield self.top


@dataclass(slots=True)
class RunningModule:
    """One file of the program while it runs."""

    filename: str
    ego: Object | None = None
    workspace: Workspace | None = None
    is_model: bool = False
    package: str = ""
    """The package that relative imports start from."""
    scope: dict[str, Any] = field(default_factory=dict)
    """The module's global names."""
