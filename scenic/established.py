"""The names of the established Python API: one table of their places here, and the modules made from it.

``import scenic.core.regions`` and the like give modules whose attributes are looked up in this table when they are first used.
A name that the language itself provides (`scenic.runtime.program.builtins`) needs no row of its own.
"""

import sys
from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType, ModuleType
from typing import Any, Final

from scenic.language.names import NAMES, SENSORS, NameKind
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS

_LANGUAGE: Final = "the language"
"""Home of names that every program finds in scope."""

_ERRORS: Final = "scenic.language.errors"
_DEFINITIONS: Final = "scenic.runtime.description.definitions"
_RECORDERS: Final = "scenic.runtime.dynamics.recorders"
_ESTABLISHED: Final = "scenic.runtime.scenes.established_api"
_FIELDS: Final = "scenic.runtime.regions.fields"
_VALUES: Final = "scenic.runtime.values.values"
_LAWS: Final = "scenic.runtime.python.custom_distributions"
_FUNCTIONS: Final = "scenic.runtime.elements.functions"
_OBJECTS: Final = "scenic.runtime.instances.objects"
_MUTATORS: Final = "scenic.runtime.instances.mutators"
_VENEER: Final = "scenic.runtime.program.veneer"
_PROPOSITIONS: Final = "scenic.runtime.temporal.propositions"
_SENSORS: Final = "scenic.runtime.elements.sensors"
_LAZY: Final = "scenic.runtime.values.lazy"
_EXTERNAL: Final = "scenic.runtime.elements.external_parameters"

_STATEMENTS: Final = "With ego globalParameters in_initial_scenario isActive localPath mutate new param simulationInProgress workspace"
"""Statements, and what asks for the state of a program, as functions."""


def _functions() -> str:
    """Return the names of the functions that operators and specifiers are."""
    functions = [element.functions for element in OPERATORS.values()]
    functions += [element.functions for element in SPECIFIERS.values()]
    return " ".join(function.name for each in functions for function in each)


def _language(kind: NameKind, *, external: bool = False) -> str:
    """Names of a kind that the language provides, those of external parameters or the others."""
    return " ".join(
        name.name
        for name in NAMES.values()
        if name.kind is kind and name.home is not None and name.home.startswith(_EXTERNAL) is external
    )


def _homes(*groups: tuple[str, str]) -> Mapping[str, str]:
    """Names, separated by blanks, with their homes; ``theirs=ours`` where a name differs."""
    return MappingProxyType({name: home for home, names in groups for name in names.split()})


MODULES: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "scenic.core.distributions": _homes(
            (
                _LANGUAGE,
                f"{_language(NameKind.DISTRIBUTION)} Distribution distributionFunction distributionMethod",
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
            ("scenic.simulators.step_watchdog", "stuckBehaviorWarningTimeout=STUCK_AFTER"),
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
            (_LANGUAGE, _language(NameKind.DISTRIBUTION, external=True)),
            (_EXTERNAL, "ExternalParameter"),
            ("scenic.falsification.external", "ExternalSampler VerifaiSampler"),
        ),
        "scenic.core.geometry": _homes(
            (_LANGUAGE, "sin cos hypot max min"),
            (
                _ESTABLISHED,
                (
                    "normalizeAngle averageVectors rotateVector headingOfSegment viewAngleToPoint"
                    " apparentHeadingAtPoint polygonUnion pointIsInCone distanceToLine findMinMax removeHoles"
                    " triangulatePolygon plotPolygon"
                ),
            ),
        ),
        "scenic.core.lazy_eval": _homes(
            (_ESTABLISHED, "DelayedArgument valueInContext needsLazyEvaluation needsSampling"),
            (_LAZY, "isLazy=is_lazy requiredProperties=reads_of LazilyEvaluable=Lazy"),
            (_ESTABLISHED, "makeDelayedFunctionCall"),
        ),
        "scenic.core.object_types": _homes(
            (_LANGUAGE, "Point OrientedPoint Object Mutator"),
            (_MUTATORS, "PositionMutator OrientationMutator"),
            (_OBJECTS, "Constructible=Point Point2D=Point OrientedPoint2D=OrientedPoint Object2D=Object"),
        ),
        "scenic.core.regions": _homes(
            (
                _LANGUAGE,
                _language(NameKind.REGION),
            ),
            ("scenic.runtime.regions.base", "Region"),
            ("scenic.runtime.regions.declared_orientations", "orientedRegion unorientedRegion"),
            ("scenic.runtime.regions.spaces", "AllRegion=Everywhere EmptyRegion=Nowhere"),
            ("scenic.runtime.regions.combinations", "IntersectionRegion UnionRegion DifferenceRegion"),
            ("scenic.runtime.regions.voxels", "VoxelRegion"),
            ("scenic.runtime.regions.view_regions", "ViewRegion"),
            ("scenic.runtime.regions.meshes", "MeshRegion"),
            (_ERRORS, "UndefinedSamplingException"),
            (_ESTABLISHED, "regionFromShapelyObject convertToFootprint toPolygon"),
        ),
        "scenic.core.sample_checking": _homes(
            (_ESTABLISHED, "SampleChecker BasicChecker WeightedAcceptanceChecker")
        ),
        "scenic.core.scenarios": _homes(
            ("scenic.runtime.scenes.scenario", "Scenario"), ("scenic.runtime.scenes.scene", "Scene")
        ),
        "scenic.core.shapes": _homes(
            (_LANGUAGE, _language(NameKind.SHAPE)),
            ("scenic.runtime.shapes.shapes", "Shape"),
        ),
        "scenic.core.sensors": _homes(
            (_SENSORS, "Sensor"),
            *((each.home.partition(":")[0], name) for name, each in SENSORS.items() if each.home is not None),
            (_RECORDERS, "Recorder File Files"),
        ),
        "scenic.core.serialization": _homes(
            (_ERRORS, "SerializationError"),
            (_ESTABLISHED, "dumpAsScenicCode scenicToJSON"),
        ),
        "scenic.core.simulators": _homes(
            ("scenic.simulators.simulator", "Simulator"),
            ("scenic.simulators.simulation", "Simulation"),
            ("scenic.simulators.results", "SimulationResult SimulationState TerminationType"),
            ("scenic.simulators.stepped", "TerminatedSimulationException"),
            ("scenic.batch.group", "SimulatorGroup"),
            ("scenic.simulators.dummy", "DummySimulator DummySimulation"),
            ("scenic.simulators.actions", "Action"),
            (_ERRORS, "SimulationCreationError DivergenceError GuardViolation RejectSimulationException"),
            (_ESTABLISHED, "SimulatorInterfaceWarning"),
        ),
        "scenic.core.specifiers": _homes(
            ("scenic.runtime.elements.specifiers", "Specifier"),
        ),
        "scenic.core.type_support": _homes(
            (
                _ESTABLISHED,
                (
                    "Heading underlyingType isA canCoerce canCoerceType coerce toTypes toType toScalar toHeading toOrientation toVector"
                    " coerceToAny=toTypes"
                ),
            ),
            (_ERRORS, "CoercionFailure=ScenicTypeError"),
        ),
        "scenic.core.utils": _homes(
            (
                _ESTABLISHED,
                "cached cached_method cached_property argsToString batched repairMesh=proper_mesh unifyMesh=united_mesh",
            ),
        ),
        "scenic.core.vectors": _homes(
            (_LANGUAGE, "Vector Orientation VectorField PolygonalVectorField"),
            (_FIELDS, "PiecewiseVectorField PolyhedronVectorField"),
            (_ESTABLISHED, "alwaysGlobalOrientation globalOrientation"),
            ("scenic.runtime.values.random_values", "VectorDistribution=RandomVector"),
            ("scenic.runtime.values.definite", "OrientedVector"),
        ),
        "scenic.core.workspaces": _homes((_LANGUAGE, "Workspace")),
        "scenic.syntax.translator": _homes(
            ("scenic.pipeline", "scenarioFromFile scenarioFromString"),
            (_ERRORS, "InvalidScenarioError ScenicSyntaxError"),
        ),
        "scenic.syntax.veneer": _homes(
            (_ERRORS, "InvalidScenarioError"),
            (_LANGUAGE, "Modifier DynamicScenario"),
            (
                _PROPOSITIONS,
                "Always AtomicProposition Eventually Implies Next PropositionAnd PropositionNot PropositionOr Until",
            ),
            (_VENEER, f"{_functions()} {_STATEMENTS}"),
        ),
    }
)
"""The established modules, and where each of their names lives here."""

_EVERYTHING: Final = frozenset({"scenic.syntax.veneer"})
"""Modules that hold every name of the language."""


def _provided() -> Mapping[str, Any]:
    names: Mapping[str, Any] = import_module("scenic.runtime.program.builtins").language_names()
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
    home, ours = _homes_by_name(module).get(name) or _home_elsewhere(name)
    if home is None:
        raise AttributeError(
            f"module {module!r} has no attribute {name!r}; docs/howto/moving.md says what of the established API is here"
        )
    if home == _LANGUAGE:
        return _provided()[ours]
    return getattr(import_module(home), ours)


def _home_elsewhere(name: str) -> tuple[str | None, str]:
    """The home of a name of some other module: scripts import from a module what it has imported itself."""
    if name in _provided():
        return _LANGUAGE, name
    homes = (_homes_by_name(module).get(name) for module in MODULES)
    return next((home for home in homes if home is not None), (None, name))


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
