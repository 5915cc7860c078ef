"""The names that every module of Scenic code finds in scope (section 7.2 of the specification)."""

import builtins
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from scenic.language import errors
from scenic.language.errors import InvalidScenarioError, UnknownParameterError
from scenic.runtime.dynamics.definitions import Behavior, Monitor
from scenic.runtime.dynamics.recorders import File, Files
from scenic.runtime.dynamics.run import RunContext
from scenic.runtime.elements import distributions, external, functions, shapes
from scenic.runtime.instances.mutators import Mutator
from scenic.runtime.instances.objects import Object, OrientedPoint, Point
from scenic.runtime.program.context import current, here
from scenic.runtime.program.outcome import Program
from scenic.runtime.python import custom_distributions as laws
from scenic.runtime.regions import algebra as algebra  # gives regions their algebra
from scenic.runtime.regions import fields
from scenic.runtime.regions.lines import PathRegion, PolylineRegion
from scenic.runtime.regions.meshes import MeshSurfaceRegion, MeshVolumeRegion
from scenic.runtime.regions.planar import (
    CircularRegion,
    PolygonalFootprintRegion,
    PolygonalRegion,
    RectangularRegion,
)
from scenic.runtime.regions.scattered import GridRegion, PointSetRegion
from scenic.runtime.regions.sectors import SectorRegion
from scenic.runtime.regions.spaces import Workspace, everywhere, nowhere
from scenic.runtime.regions.volumes import BoxRegion, SpheroidRegion
from scenic.runtime.values.values import Orientation, Vector


def running_simulation() -> Any:
    """The simulation that is running; raises `InvalidScenarioError` where none is."""
    context = current.get()
    if not isinstance(context, RunContext):
        raise InvalidScenarioError(
            "there is no simulation yet",
            span=here(),
            help="`simulation()` can be used in behaviors, monitors, compose blocks and their conditions",
        )
    return context.run.simulation


_NAMES: Mapping[str, Any] = MappingProxyType(
    {
        "Point": Point,
        "OrientedPoint": OrientedPoint,
        "Object": Object,
        "Vector": Vector,
        "Orientation": Orientation,
        "Mutator": Mutator,
        "VectorField": fields.VectorField,
        "PolygonalVectorField": fields.PolygonalVectorField,
        "Range": distributions.Range,
        "DiscreteRange": distributions.DiscreteRange,
        "Normal": distributions.Normal,
        "TruncatedNormal": distributions.TruncatedNormal,
        "Uniform": distributions.Uniform,
        "Discrete": distributions.Discrete,
        "Options": distributions.Options,
        "resample": distributions.resample,
        "sin": functions.sin,
        "cos": functions.cos,
        "hypot": functions.hypot,
        "max": functions.max,
        "min": functions.min,
        "round": functions.round,
        "len": functions.len,
        "filter": functions.filter,
        "range": functions.range,
        "Distribution": laws.Distribution,
        "distributionFunction": functions.distributionFunction,
        "distributionMethod": laws.distributionMethod,
        "verbosePrint": functions.verbosePrint,
        "BoxShape": shapes.BoxShape,
        "CylinderShape": shapes.CylinderShape,
        "ConeShape": shapes.ConeShape,
        "SpheroidShape": shapes.SpheroidShape,
        "MeshShape": shapes.MeshShape,
        "everywhere": everywhere,
        "nowhere": nowhere,
        "Workspace": Workspace,
        "CircularRegion": CircularRegion,
        "PolygonalRegion": PolygonalRegion,
        "RectangularRegion": RectangularRegion,
        "SectorRegion": SectorRegion,
        "PolygonalFootprintRegion": PolygonalFootprintRegion,
        "PolylineRegion": PolylineRegion,
        "PathRegion": PathRegion,
        "PointSetRegion": PointSetRegion,
        "GridRegion": GridRegion,
        "MeshVolumeRegion": MeshVolumeRegion,
        "MeshSurfaceRegion": MeshSurfaceRegion,
        "BoxRegion": BoxRegion,
        "SpheroidRegion": SpheroidRegion,
        "RejectionException": errors.RejectionException,
        "GuardViolation": errors.GuardViolation,
        "PreconditionViolation": errors.PreconditionViolation,
        "InvariantViolation": errors.InvariantViolation,
        "Behavior": Behavior,
        "Monitor": Monitor,
        "File": File,
        "Files": Files,
        "simulation": running_simulation,
        "TimeSeries": external.TimeSeries,
        "VerifaiDiscreteRange": external.VerifaiDiscreteRange,
        "VerifaiOptions": external.VerifaiOptions,
        "VerifaiParameter": external.VerifaiParameter,
        "VerifaiRange": external.VerifaiRange,
    }
)


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
            known = ", ".join(sorted(parameters)) or "none"
            raise UnknownParameterError(
                f"there is no global parameter {name!r}",
                span=here(),
                help=f"parameters set so far: {known}; set it with `param {name} = ...`",
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

    def __setattr__(self, name: str, value: Any) -> None:
        raise InvalidScenarioError(
            "global parameters are set by `param`, not by assignment",
            span=here(),
            help=f"write `param {name} = ...`",
        )


def language_names() -> Mapping[str, Any]:
    """The language's own names, apart from those that depend on the module they are used in."""
    return _NAMES


def provided(name: str) -> Any:
    """What a name means where the program does not bind it itself; ``None`` for unknown names."""
    return _NAMES.get(name, getattr(builtins, name, None))


def builtin_names(program: Program, filename: str, import_module: Callable[..., Any]) -> dict[str, Any]:
    """The builtins of one module: Python's, the language's, and what depends on the module's place."""
    folder = Path(filename).parent

    def local_path(relative: str) -> Path:
        """A path relative to the file that the program is in."""
        return folder / relative

    return {
        **vars(builtins),
        **language_names(),
        "globalParameters": GlobalParameters(program),
        "localPath": local_path,
        "__import__": import_module,
    }
