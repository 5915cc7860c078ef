"""Where the names of the established Python API live here: one table, and the modules that it makes.

``import scenic.core.regions`` and the like give modules whose attributes are looked up in this table when they are first used.
A name that the language itself provides (`scenic.runtime.names`) needs no row of its own.
"""

import sys
from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType, ModuleType
from typing import Any, Final

_LANGUAGE: Final = "the language"
"""Home of names that every program finds in scope."""

_ERRORS: Final = "scenic.language.errors"
_DEFINITIONS: Final = "scenic.runtime.dynamics.definitions"
_RECORDERS: Final = "scenic.runtime.dynamics.recorders"
_ESTABLISHED: Final = "scenic.runtime.established"
_FIELDS: Final = "scenic.runtime.fields"
_VALUES: Final = "scenic.runtime.values"
_LAWS: Final = "scenic.runtime.laws"
_FUNCTIONS: Final = "scenic.runtime.functions"
_OBJECTS: Final = "scenic.runtime.objects"
_MUTATORS: Final = "scenic.runtime.mutators"


def _homes(*groups: tuple[str, str]) -> Mapping[str, str]:
    """Names, separated by blanks, with their homes; ``theirs=ours`` where a name differs."""
    return MappingProxyType({name: home for home, names in groups for name in names.split()})


MODULES: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "scenic.core.distributions": _homes(
            (
                _LANGUAGE,
                (
                    "Range DiscreteRange Normal TruncatedNormal Uniform Discrete Options Distribution"
                    " distributionFunction distributionMethod"
                ),
            ),
            (_LAWS, "supportInterval"),
            (_ERRORS, "RejectionException RandomControlFlowError"),
            (_VALUES, "Samplable=Random"),
            (_ESTABLISHED, "needsSampling toDistribution"),
            (_FUNCTIONS, "monotonicDistributionFunction=distributionFunction"),
        ),
        "scenic.core.dynamics": _homes(
            ("scenic.simulators.actions", "Action"),
            (_DEFINITIONS, "Behavior Monitor Invocable DynamicScenario=ModularScenario"),
            (
                _ERRORS,
                (
                    "GuardViolation PreconditionViolation InvariantViolation RejectSimulationException"
                    " StuckBehaviorWarning"
                ),
            ),
        ),
        "scenic.core.dynamics.actions": _homes(("scenic.simulators.actions", "Action")),
        "scenic.core.dynamics.behaviors": _homes((_DEFINITIONS, "Behavior Monitor")),
        "scenic.core.dynamics.guards": _homes(
            (_ERRORS, "GuardViolation PreconditionViolation InvariantViolation")
        ),
        "scenic.core.dynamics.invocables": _homes((_DEFINITIONS, "Invocable")),
        "scenic.core.dynamics.scenarios": _homes((_DEFINITIONS, "DynamicScenario=ModularScenario")),
        "scenic.core.dynamics.utils": _homes((_ERRORS, "RejectSimulationException StuckBehaviorWarning")),
        "scenic.core.errors": _homes(
            (
                _ERRORS,
                (
                    "ScenicError ScenicSyntaxError ParseCompileError ScenicParseError=ScenicSyntaxError"
                    " PythonCompileError=ScenicSyntaxError ASTParseError=ScenicSyntaxError InvalidScenarioError"
                    " InconsistentScenarioError=InvalidScenarioError SpecifierError RandomControlFlowError"
                ),
            ),
            (_ESTABLISHED, "setDebuggingOptions"),
        ),
        "scenic.core.external_params": _homes(
            (_LANGUAGE, "VerifaiRange VerifaiDiscreteRange VerifaiOptions VerifaiParameter"),
        ),
        "scenic.core.geometry": _homes(
            (_LANGUAGE, "sin cos hypot max min"),
            (
                _ESTABLISHED,
                (
                    "normalizeAngle averageVectors rotateVector headingOfSegment viewAngleToPoint"
                    " apparentHeadingAtPoint polygonUnion pointIsInCone distanceToLine findMinMax removeHoles"
                    " triangulatePolygon"
                ),
            ),
        ),
        "scenic.core.lazy_eval": _homes(
            (_ESTABLISHED, "DelayedArgument valueInContext needsLazyEvaluation needsSampling"),
            ("scenic.runtime.lazy", "isLazy=is_lazy requiredProperties=reads_of LazilyEvaluable=Lazy"),
        ),
        "scenic.core.object_types": _homes(
            (_LANGUAGE, "Point OrientedPoint Object Mutator"),
            (_MUTATORS, "PositionMutator OrientationMutator"),
            (_OBJECTS, "Constructible=Point Point2D=Point OrientedPoint2D=OrientedPoint Object2D=Object"),
        ),
        "scenic.core.regions": _homes(
            (
                _LANGUAGE,
                (
                    "everywhere nowhere CircularRegion SectorRegion RectangularRegion PolygonalRegion PolylineRegion"
                    " PathRegion PointSetRegion GridRegion MeshVolumeRegion MeshSurfaceRegion BoxRegion SpheroidRegion"
                    " PolygonalFootprintRegion"
                ),
            ),
            ("scenic.runtime.regions.base", "Region AllRegion=Everywhere EmptyRegion=Nowhere"),
            ("scenic.runtime.regions.composite", "IntersectionRegion UnionRegion DifferenceRegion"),
            ("scenic.runtime.regions.voxels", "VoxelRegion"),
            ("scenic.runtime.regions.views", "ViewRegion"),
            (_ERRORS, "UndefinedSamplingException"),
            (_ESTABLISHED, "regionFromShapelyObject convertToFootprint toPolygon"),
        ),
        "scenic.core.scenarios": _homes(
            ("scenic.runtime.scenario", "Scenario"), ("scenic.runtime.scene", "Scene")
        ),
        "scenic.core.shapes": _homes(
            (_LANGUAGE, "MeshShape BoxShape CylinderShape ConeShape SpheroidShape"),
            ("scenic.runtime.shapes", "Shape"),
        ),
        "scenic.core.sensors": _homes(
            ("scenic.runtime.sensors", "Sensor RGBSensor SSSensor"),
            (_RECORDERS, "Recorder File Files"),
        ),
        "scenic.core.serialization": _homes((_ERRORS, "SerializationError")),
        "scenic.core.simulators": _homes(
            ("scenic.simulators.simulator", "Simulator"),
            ("scenic.simulators.simulation", "Simulation"),
            ("scenic.simulators.results", "SimulationResult TerminationType"),
            ("scenic.simulators.dummy", "DummySimulator DummySimulation"),
            ("scenic.simulators.actions", "Action"),
            (_ERRORS, "SimulationCreationError DivergenceError GuardViolation RejectSimulationException"),
        ),
        "scenic.core.specifiers": _homes(("scenic.runtime.specifiers", "Specifier")),
        "scenic.core.type_support": _homes(
            (
                _ESTABLISHED,
                "Heading underlyingType isA canCoerce coerce toTypes toType toScalar toHeading toOrientation toVector",
            ),
        ),
        "scenic.core.utils": _homes((_ESTABLISHED, "cached cached_method cached_property argsToString")),
        "scenic.core.vectors": _homes(
            (_LANGUAGE, "Vector Orientation VectorField PolygonalVectorField"),
            (_FIELDS, "PiecewiseVectorField PolyhedronVectorField"),
            (_ESTABLISHED, "alwaysGlobalOrientation globalOrientation"),
        ),
        "scenic.core.workspaces": _homes((_LANGUAGE, "Workspace")),
        "scenic.syntax.translator": _homes(
            ("scenic.pipeline", "scenarioFromFile scenarioFromString"),
            (_ERRORS, "InvalidScenarioError ScenicSyntaxError"),
        ),
        "scenic.syntax.veneer": _homes((_ERRORS, "InvalidScenarioError")),
    }
)
"""The established modules, and where each of their names lives here."""

_EVERYTHING: Final = frozenset({"scenic.syntax.veneer"})
"""Modules that hold every name of the language."""


def _provided() -> Mapping[str, Any]:
    names: Mapping[str, Any] = import_module("scenic.runtime.names").language_names()
    return names


def _homes_by_name(module: str) -> dict[str, tuple[str, str]]:
    """The names of a module, each with its home and its name there."""
    found = {}
    for entry, home in MODULES[module].items():
        theirs, _, ours = entry.partition("=")
        found[theirs] = (home, ours or theirs)
    if module in _EVERYTHING:
        found.update((name, (_LANGUAGE, name)) for name in _provided())
    return found


def lookup(module: str, name: str) -> Any:
    """The object of a name of an established module; raises ``AttributeError`` for unknown ones."""
    home, ours = _homes_by_name(module).get(name, (None, name))
    if home is None:
        raise AttributeError(f"module {module!r} has no attribute {name!r}")
    if home == _LANGUAGE:
        return _provided()[ours]
    return getattr(import_module(home), ours)


class _Established(ModuleType):
    """A module whose names are those of the table."""

    def __getattr__(self, name: str) -> Any:
        if name == "__all__":
            return sorted(_homes_by_name(self.__name__))
        if name.startswith("__"):
            raise AttributeError(name)
        return lookup(self.__name__, name)

    def __dir__(self) -> list[str]:
        return sorted(_homes_by_name(self.__name__))


def provide(package: ModuleType) -> None:
    """Make the modules of a package of the established API importable; called by the package itself."""
    for name in MODULES:
        holder, _, short = name.rpartition(".")
        if name.startswith(f"{package.__name__}."):
            module = _Established(name, "Names of the established Python API; see `scenic.established`.")
            sys.modules[name] = module
            # Modules stand in the table before those in them.
            setattr(sys.modules[holder], short, module)


__all__ = ["MODULES", "lookup", "provide"]
