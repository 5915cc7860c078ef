"""The language's operators, specifiers and statements as functions, under the names of the established Python API.

Programs write ``distance from x``; Python modules that they import may call ``DistanceFrom(x)``. What such a call means beside its
arguments (the ego, the workspace, where a new object belongs) is that of the module of Scenic code that is running:
the innermost one among the callers.
"""

import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from scenic.language.errors import InvalidScenarioError
from scenic.language.operators import OPERATORS, Function, Operator
from scenic.language.specifiers import SPECIFIERS, SpecifierDeclaration
from scenic.runtime.description import mutation
from scenic.runtime.dynamics.run_context import RunContext
from scenic.runtime.elements.operators import operation
from scenic.runtime.elements.resolution import build
from scenic.runtime.elements.specifiers import Specifier, specify
from scenic.runtime.ground.context import current
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.spaces import everywhere


def _scope() -> Mapping[str, Any] | None:
    """Return the globals of the module of Scenic code that is running; ``None`` outside of any."""
    frame = sys._getframe(1)
    while frame is not None and "__scenic__" not in frame.f_globals:
        frame = frame.f_back  # type: ignore[assignment] # the outermost frame has none
    return None if frame is None else frame.f_globals


def _language() -> Any:
    """Return the prelude of the module that is running; ``None`` outside of any."""
    scope = _scope()
    return None if scope is None else scope["__scenic__"]


def _needed(what: str) -> Any:
    language = _language()
    if language is None:
        raise InvalidScenarioError(
            f"no program is running, so there is no {what}",
            help="call this from code that a program runs, or give all operands",
        )
    return language


def _ego() -> Any:
    return _needed("ego").ego


def _space() -> Region:
    return everywhere


def _operate(name: str, *operands: Any) -> Any:
    return operation(name, _ego, *operands)


def _specify(name: str, *operands: Any) -> Specifier:
    language = _language()
    if language is not None:
        specifier: Specifier = language.specifier(name, *operands)
        return specifier
    return specify(name, _ego, _space, *operands)


def _function(
    made_by: Callable[..., Any], element: Operator | SpecifierDeclaration, declared: Function
) -> Callable[..., Any]:
    """Return the declared function of an operator or a specifier."""
    kind, no_default = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.empty
    signature = inspect.Signature(
        [
            inspect.Parameter(name, kind, default=None if optional else no_default)
            for name, optional in declared.parameters.items()
        ]
    )
    words = [*declared.parameters] if declared.operands is None else declared.operands.split()
    words += ["-"] * (len(element.operands) - len(words))

    def function(*args: Any, **keywords: Any) -> Any:
        bound = signature.bind(*args, **keywords)
        bound.apply_defaults()
        return made_by(element.name, *(bound.arguments.get(word) for word in words))

    function.__name__ = function.__qualname__ = declared.name
    function.__doc__ = f"``{element.name}`` of the language, as a function."
    function.__signature__ = signature  # type: ignore[attr-defined] # read by `inspect`
    return function


def With(prop: str, val: object) -> Specifier:
    """Return the specifier ``with prop val``."""
    language = _language()
    if language is None:
        return specify("with", _ego, _space, prop, val)
    specifier: Specifier = language.specifier("with", val, property=prop)
    return specifier


def new(cls: Any, specifiers: Sequence[Specifier] = ()) -> Any:
    """Return a new instance of a Scenic class; an object becomes one of the program's that is running."""
    language = _language()
    return build(cls, tuple(specifiers)) if language is None else language.new(cls, *specifiers)


def ego(obj: object = None) -> Any:
    """Return the ego; with an argument, it becomes the ego."""
    language = _needed("ego")
    if obj is not None:
        language.ego = obj
    return language.ego


def workspace(workspace: object = None) -> Any:
    """Return the workspace; with an argument, it becomes the workspace."""
    language = _needed("workspace")
    if workspace is not None:
        language.workspace = workspace
    return language.workspace


def param(params: Mapping[str, object]) -> None:
    """Set global parameters."""
    _needed("program to set parameters of").param(params)


def mutate(*objects: Any, scale: object = 1) -> None:
    """Mutate these objects; without any, all that the program has made so far."""
    language = _language()
    if language is None:
        mutation.request(objects, scale)
    else:
        language.mutate(objects or None, scale)


def globalParameters() -> Any:
    """Return the global parameters, by attribute or index."""
    _needed("parameter")
    scope = _scope()
    assert scope is not None
    return scope["__builtins__"]["globalParameters"]


def localPath(relpath: str) -> Path:
    """Return a path relative to the file of the program that is running, or else to the working directory."""
    scope = _scope()
    if scope is None:
        return Path.cwd() / relpath
    path: Path = scope["__builtins__"]["localPath"](relpath)
    return path


def in_initial_scenario() -> bool:
    """Evaluate ``initial scenario`` of the language."""
    language = _language()
    return True if language is None else bool(language.operation("initial scenario"))


def isActive() -> bool:
    """Return whether a program is being compiled, or simulated."""
    return current.get() is not None


def simulationInProgress() -> bool:
    """Return whether a simulation is running."""
    return isinstance(current.get(), RunContext)


FUNCTIONS: Final[Mapping[str, Callable[..., Any]]] = MappingProxyType(
    {
        **{
            each.name: _function(_operate, item, each)
            for item in OPERATORS.values()
            for each in item.functions
        },
        **{
            each.name: _function(_specify, item, each)
            for item in SPECIFIERS.values()
            for each in item.functions
        },
        **{
            function.__name__: function
            for function in (
                With,
                new,
                ego,
                workspace,
                param,
                mutate,
                globalParameters,
                localPath,
                in_initial_scenario,
                isActive,
                simulationInProgress,
            )
        },
    }
)
"""All of them, by their established names."""


def __getattr__(name: str) -> Any:
    try:
        return FUNCTIONS[name]
    except KeyError:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}") from None


__all__ = ["FUNCTIONS"]
