"""The names that every module of Scenic code finds in scope (section 7.2 of the specification)."""

import builtins
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from pkgutil import resolve_name
from types import MappingProxyType
from typing import Any

from scenic.language.errors import InvalidScenarioError, UnknownParameterError
from scenic.language.names import NAMES
from scenic.runtime.description.outcome import Program
from scenic.runtime.dynamics.run_context import RunContext
from scenic.runtime.ground.context import current, here
from scenic.runtime.ground.used_files import note_file
from scenic.runtime.regions import algebra as algebra  # registers what regions do together


def running_simulation() -> Any:
    """Return the simulation that is running; raises `InvalidScenarioError` where none is."""
    context = current.get()
    if not isinstance(context, RunContext):
        raise InvalidScenarioError(
            "there is no simulation yet",
            span=here(),
            help="`simulation()` can be used in behaviors, monitors, compose blocks and their conditions",
        )
    return context.run.simulation


def is_simulating() -> bool:
    """Return whether a simulation is running, not only a scene being drawn."""
    return isinstance(current.get(), RunContext)


def present_objects() -> Sequence[Any]:
    """Return the objects of the running simulation, or those of the scene whose requirements are evaluated.

    Raises `InvalidScenarioError` where there is neither.
    """
    context = current.get()
    if isinstance(context, RunContext) or context is None or context.sample is None:
        objects: Sequence[Any] = running_simulation().objects
        return objects
    return [item for item in context.present if item.present]


class GlobalParameters:
    """The program's parameters, read by attribute or index."""

    def __init__(self, program: Program) -> None:
        object.__setattr__(self, "_program", program)

    def __getitem__(self, name: str) -> Any:
        active = current.get()
        # A simulation knows what the random ones are.
        owner = active.run if type(active) is RunContext else self._program
        parameters = owner.parameters
        self._program.read_parameters.add(name)
        if name in self._program.overrides:
            return self._program.overrides[name]
        if name not in parameters:
            names = ", ".join(sorted(parameters)) or "none"
            raise UnknownParameterError(
                f"there is no global parameter {name!r}",
                span=here(),
                help=f"parameters set so far: {names}; set it with `param {name} = ...`",
            )
        return parameters[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self[name]

    def __contains__(self, name: object) -> bool:
        return name in self._program.parameters or name in self._program.overrides

    def __iter__(self) -> Iterator[str]:
        return iter({**self._program.parameters, **self._program.overrides})

    def __len__(self) -> int:
        return len({**self._program.parameters, **self._program.overrides})

    def __setattr__(self, name: str, value: object) -> None:
        raise InvalidScenarioError(
            "global parameters are set by `param`, not by assignment",
            span=here(),
            help=f"write `param {name} = ...`",
        )


_NAMES: Mapping[str, Any] = MappingProxyType(
    {declared.name: resolve_name(declared.home) for declared in NAMES.values() if declared.home is not None}
)


def language_names() -> Mapping[str, Any]:
    """The language's own names, apart from those that depend on the module they are used in."""
    return _NAMES


def provided(name: str) -> Any:
    """The meaning of a name where the program does not bind it itself; ``None`` for unknown names."""
    return _NAMES.get(name, getattr(builtins, name, None))


def builtin_names(program: Program, filename: str, importer: Callable[..., Any]) -> dict[str, Any]:
    """Return the builtins of one module: Python's, the language's, and what depends on the module's place."""
    folder = Path(filename).parent

    def local_path(relative: str) -> Path:
        """Return a path relative to the file that the program is in."""
        path = folder / relative
        if isinstance(path, Path):  # not a random one
            note_file(path)
        return path

    return {
        **vars(builtins),
        **language_names(),
        "globalParameters": GlobalParameters(program),
        "localPath": local_path,
        "__import__": importer,
    }
