"""The names that are always in scope (sections 7.2, 8 and 9 of the specification), as data."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from enum import StrEnum
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.language.operators import OPERATORS, Operator
from scenic.language.specifiers import SPECIFIERS, SpecifierDeclaration
from scenic.language.types import (
    CALLABLE,
    DIMENSIONS,
    FIELD,
    HEADING,
    MESH,
    NONE,
    ORIENTATION,
    POINTS,
    POLYGON,
    POLYLINE,
    REGION,
    SCALAR,
    SHAPE,
    TEXT,
    VECTOR,
    Type,
)
from scenic.language.word_sets import word_set

__all__ = [
    "ANGLE_METHODS",
    "CONSTRUCTORS",
    "CONVERSIONS",
    "ELEMENT_FUNCTIONS",
    "IMPORTABLE",
    "LIFTED_FUNCTIONS",
    "LIFTED_METHODS",
    "NAMES",
    "RESERVED",
    "SENSORS",
    "TRACKED",
    "Name",
    "NameKind",
]


class NameKind(StrEnum):
    """The kinds of provided names."""

    CLASS = "class"
    DISTRIBUTION = "distribution"
    EXCEPTION = "exception"
    FUNCTION = "function"
    REGION = "region"
    SENSOR = "sensor"
    SHAPE = "shape"
    VALUE = "value"


@dataclass(frozen=True, kw_only=True)
class Name:
    """One provided name.

    Attributes:
        signature: how it is called, or the bare name of something that is not called.
        home: the place of its implementation, as ``package.module:name``; ``None`` for what Python provides, and for what
            each module has of its own.
        lifted: a function that takes random arguments, so that a call in a condition can become part of the value graph.
        is_complete: the signature shows all parameters; a call with others is a mistake.
        further: optional parameters that the signature leaves out, as Python writes them. With them it is complete.
        types: types of the parameters, in order, as far as the implementation gets them converted.
        takes: types of further parameters by name, which the implementation examines itself; see `accepted`.
        angles: the parameters whose numbers are angles in radians.
        result: the type of what a call returns, where that is always the same.
        operation: the operation of the value graph that a call makes of its arguments; random values made by it are shown
            as such a call.
        operations: further operations of the value graph that make values of a distribution.
        noun: a value of a distribution in words, where the operation's name does not say it.
        syntax: how the language writes what the name stands for, where it has syntax for that.

    """

    name: str
    kind: NameKind
    signature: str
    documentation: str
    home: str | None = None
    lifted: bool = False
    available: bool = True
    is_complete: bool = False
    further: str = ""
    types: tuple[Type, ...] = ()
    takes: Mapping[str, tuple[Type, ...]] = field(default_factory=dict)
    angles: tuple[str, ...] = ()
    result: Type | None = None
    operation: str | None = None
    operations: tuple[str, ...] = ()
    noun: str | None = None
    syntax: str | None = None

    @cached_property
    def accepted(self) -> Mapping[str, tuple[Type, ...]]:
        """The types of which the value of each parameter must have one, as far as they are declared."""
        return {
            **{name: (each,) for name, each in zip(self.parameters, self.types, strict=False)},
            **self.takes,
        }

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """The names of its positional parameters, as far as the signature names them."""
        inside = self.signature.partition("(")[2].removesuffix(")")
        # Defaults may hold commas in brackets; names of parameters never follow an opening bracket.
        flat = re.sub(r"\([^()]*\)|\{[^{}]*\}", "", inside)
        return tuple(part.partition("=")[0].strip() for part in flat.split(",") if part.strip())


def _name(kind: NameKind, signature: str, documentation: str, home: str | None, **rest: Any) -> Name:
    name = signature.partition("(")[0]
    if home is not None and ":" not in home:
        home = f"{home}:{name}"
    return Name(name=name, kind=kind, signature=signature, documentation=documentation, home=home, **rest)


def _function(
    signature: str, documentation: str, home: str | None = "scenic.runtime.elements.functions", **rest: Any
) -> Name:
    return _name(NameKind.FUNCTION, signature, documentation, home, **rest)


def _distribution(
    signature: str, documentation: str, home: str = "scenic.runtime.values.distributions", **rest: Any
) -> Name:
    return _name(NameKind.DISTRIBUTION, signature, documentation, home, **rest)


def _external(signature: str, documentation: str, **rest: Any) -> Name:
    return _distribution(signature, documentation, "scenic.runtime.elements.external_parameters", **rest)


def _region(signature: str, documentation: str, home: str, **rest: Any) -> Name:
    return _name(
        NameKind.REGION, signature, documentation, f"scenic.runtime.regions.{home}", result=REGION, **rest
    )


def _shape(
    signature: str,
    documentation: str,
    home: str = "scenic.runtime.shapes.shapes",
    **takes: tuple[Type, ...],
) -> Name:
    return _name(NameKind.SHAPE, signature, documentation, home, result=SHAPE, takes={**_FORM, **takes})


_FORM: Final = {"dimensions": (DIMENSIONS, NONE), "scale": (SCALAR,), "initial_rotation": (ORIENTATION, NONE)}
"""Parameters of shapes."""
_PLACED: Final = {
    "dimensions": (DIMENSIONS, NONE),
    "position": (VECTOR, NONE),
    "rotation": (ORIENTATION, NONE),
    "onDirection": (VECTOR, NONE),
}
"""Parameters of solid regions and surfaces."""


def _sensor(signature: str, documentation: str, home: str = "scenic.runtime.elements.sensors") -> Name:
    return _name(NameKind.SENSOR, signature, documentation, home)


def _class(signature: str, documentation: str, home: str, implementation: str = "", **rest: Any) -> Name:
    where = f"scenic.runtime.{home}{f':{implementation}' if implementation else ''}"
    return _name(NameKind.CLASS, signature, documentation, where, **rest)


def _exception(signature: str, documentation: str) -> Name:
    return _name(NameKind.EXCEPTION, signature, documentation, "scenic.language.errors")


_ALL = (
    # Classes and values
    _class("Point", "A position in space. Create one with `new Point`.", "instances.objects"),
    _class(
        "OrientedPoint",
        "A position with an orientation. Create one with `new OrientedPoint`.",
        "instances.objects",
    ),
    _class(
        "Object",
        "A physical object. Create one with `new Object`, or derive classes from it.",
        "instances.objects",
    ),
    _class(
        "Vector(x, y, z=0)",
        "A vector of three coordinates; `x @ y` and tuples can be used instead nearly everywhere.",
        "values.definite",
        operation="vector",
        result=VECTOR,
        takes={"x": (SCALAR,), "y": (SCALAR,), "z": (SCALAR,)},
        is_complete=True,
    ),
    _class(
        "Orientation",
        "A rotation in space. Made by `Orientation.fromEuler(yaw, pitch, roll)` or "
        "`Orientation.fromQuaternion((x, y, z, w))`; `*` composes.",
        "values.definite",
    ),
    _class(
        "VectorField(name, value, minSteps=4, defaultStepSize=5)",
        "An orientation for every point of space, given by a function.",
        "regions.fields",
        angles=("value",),
        result=FIELD,
        takes={
            "name": (TEXT, NONE),
            "value": (CALLABLE,),
            "minSteps": (SCALAR,),
            "defaultStepSize": (SCALAR,),
        },
        is_complete=True,
    ),
    _class(
        "PolygonalVectorField(name, cells, headingFunction=None, defaultHeading=None)",
        "A vector field that is constant on polygons.",
        "regions.fields",
        result=FIELD,
        takes={"name": (TEXT, NONE), "headingFunction": (CALLABLE, NONE), "defaultHeading": (HEADING, NONE)},
    ),
    _class(
        "Workspace(region=everywhere)",
        "The region that contains all objects, for `workspace = Workspace(region)`.",
        "regions.spaces",
        takes={"region": (REGION,)},
        further="*, name=None",
    ),
    _class(
        "Region",
        "Base class of all regions, for `isinstance` and for regions written in Python.",
        "regions.base",
        result=REGION,
    ),
    _class("Shape", "Base class of all shapes, for `isinstance`.", "shapes.shapes", result=SHAPE),
    _class("Mutator", "Base class of mutators, which add noise to mutated objects.", "instances.mutators"),
    _class("Behavior", "Base class of all behaviors.", "description.definitions"),
    _class("Monitor", "Base class of all monitors.", "description.definitions"),
    _class(
        "DynamicScenario",
        "Base class of all scenarios.",
        "description.definitions",
        implementation="ModularScenario",
    ),
    _class(
        "Modifier(name, value, terminator)",
        "A limit of a `do` statement as data: `for` or `until`, its value, and its unit.",
        "description.definitions",
    ),
    _class("Distribution", "Base class of distributions written in Python.", "python.custom_distributions"),
    _class("File(pattern, **options)", "A recorder that writes one file per series.", "dynamics.recorders"),
    _class("Files(pattern, **options)", "A recorder that writes one file per value.", "dynamics.recorders"),
    _name(
        NameKind.VALUE,
        "globalParameters",
        "The global parameters set by `param` and on the command line, to be read as attributes or items.",
        None,
    ),
    # Exceptions
    _exception("RejectionException", "Raised by a function to reject the current sample."),
    _exception("GuardViolation", "A guard of a behavior or scenario does not hold."),
    _exception("PreconditionViolation", "A precondition does not hold."),
    _exception("InvariantViolation", "An invariant does not hold."),
    # Functions
    _function(
        "sin(x)",
        "The sine of an angle in radians.",
        lifted=True,
        angles=("x",),
        operation="sin",
        result=SCALAR,
        is_complete=True,
    ),
    _function(
        "cos(x)",
        "The cosine of an angle in radians.",
        lifted=True,
        angles=("x",),
        operation="cos",
        result=SCALAR,
        is_complete=True,
    ),
    _function(
        "tan(x)",
        "The tangent of an angle in radians.",
        lifted=True,
        angles=("x",),
        operation="tan",
        result=SCALAR,
        is_complete=True,
    ),
    _function(
        "hypot(x, y, ...)",
        "The length of the vector with these coordinates.",
        lifted=True,
        operation="hypot",
        result=SCALAR,
    ),
    _function("max(a, b, ...)", "The largest of its arguments.", lifted=True, operation="maximum"),
    _function("min(a, b, ...)", "The smallest of its arguments.", lifted=True, operation="minimum"),
    _function("abs(x)", "The absolute value.", None, lifted=True, operation="absolute"),
    _function(
        "round(number, ndigits=None)",
        "The nearest integer, or the nearest number with `ndigits` decimals.",
        lifted=True,
        operation="round",
        is_complete=True,
    ),
    _function(
        "len(x)", "The number of elements.", lifted=True, operation="len", result=SCALAR, is_complete=True
    ),
    _function("str(x)", "Conversion to text, also of random values.", None, lifted=True, operation="str"),
    _function(
        "int(x)",
        "Conversion to an integer, also of random values.",
        None,
        lifted=True,
        operation="int",
        result=SCALAR,
    ),
    _function(
        "float(x)",
        "Conversion to a real number, also of random values.",
        None,
        lifted=True,
        operation="float",
        result=SCALAR,
    ),
    _function(
        "filter(function, values)", "The values for which the function is true, as a list.", is_complete=True
    ),
    _function("range(stop)", "Python's range; its arguments must not be random."),
    _function(
        "resample(value)",
        "An independent draw of the same distribution.",
        "scenic.runtime.values.distributions",
        is_complete=True,
    ),
    _function(
        "localPath(path)", "A path relative to the folder of this source file.", None, is_complete=True
    ),
    _function(
        "verbosePrint(*values, level=1, indent=True)", "Prints if the verbosity is at least the level."
    ),
    _function(
        "distributionFunction(function)",
        "Makes a Python function accept random arguments: it is then called with their sampled values.",
        is_complete=True,
    ),
    _function(
        "distributionMethod(method)",
        "Makes a method written in Python accept random arguments: it is then called with their sampled values.",
        "scenic.runtime.python.custom_distributions",
        is_complete=True,
    ),
    _function(
        "simulation()",
        "The running simulation.",
        "scenic.runtime.program.builtins:running_simulation",
        is_complete=True,
    ),
    # Distributions
    _distribution(
        "Range(low, high)",
        "A real number, uniform on an interval.",
        operation="range",
        types=(SCALAR, SCALAR),
        result=SCALAR,
        is_complete=True,
    ),
    _distribution(
        "DiscreteRange(low, high, weights=None)",
        "An integer between two, both included.",
        operation="discrete range",
        operations=("weighted integer",),
        noun="range of integers",
        result=SCALAR,
        is_complete=True,
        takes={"low": (SCALAR,), "high": (SCALAR,)},
    ),
    _distribution(
        "Normal(mean, stdDev)",
        "A real number with a normal distribution.",
        operation="normal",
        types=(SCALAR, SCALAR),
        result=SCALAR,
        is_complete=True,
    ),
    _distribution(
        "TruncatedNormal(mean, stdDev, low, high)",
        "A normal distribution restricted to an interval.",
        operations=("truncated normal",),
        types=(SCALAR, SCALAR),
        result=SCALAR,
        is_complete=True,
        takes={"low": (SCALAR,), "high": (SCALAR,)},
    ),
    _distribution(
        "Uniform(value, ...)", "One of the values, each equally likely.", operations=("select", "look-up")
    ),
    _distribution(
        "Discrete({value: weight, ...})",
        "One of the values, with these relative weights.",
        operations=("select", "look-up"),
        is_complete=True,
    ),
    _distribution(
        "Options({value: weight, ...})",
        "Another name of `Discrete`; takes a sequence too.",
        operations=("select", "look-up"),
        is_complete=True,
    ),
    _external(
        "VerifaiRange(low, high, buckets=None, weights=None)",
        "A real number that an external sampler may choose.",
        result=SCALAR,
        is_complete=True,
    ),
    _external(
        "VerifaiDiscreteRange(low, high, weights=None)",
        "An integer that an external sampler may choose.",
        result=SCALAR,
        is_complete=True,
    ),
    _external("VerifaiOptions(options)", "An option that an external sampler may choose.", is_complete=True),
    _external("VerifaiParameter", "Base of the values that an external sampler may choose."),
    _external(
        "TimeSeries(param)", "An external parameter that has a new value at every step.", is_complete=True
    ),
    # Shapes
    _shape("BoxShape(dimensions=(1, 1, 1), scale=1)", "A cuboid."),
    _shape("CylinderShape(dimensions=(1, 1, 1), scale=1, sections=24)", "A cylinder along the Z axis."),
    _shape("ConeShape(dimensions=(1, 1, 1), scale=1)", "A cone along the Z axis, with its tip up."),
    _shape("SpheroidShape(dimensions=(1, 1, 1), scale=1)", "A spheroid."),
    _shape(
        "MeshShape(mesh, dimensions=None, scale=1, initial_rotation=None)",
        "The form of a closed mesh; `MeshShape.fromFile(path)` reads one.",
        mesh=(MESH,),
    ),
    # Regions
    _region("everywhere", "All of space.", "spaces"),
    _region("nowhere", "The empty region.", "spaces"),
    _region(
        "PointSetRegion(name, points)",
        "A finite set of points.",
        "scattered",
        further="kdTree=None, orientation=None, tolerance=1e-6",
        takes={"name": (TEXT, NONE), "points": (POINTS,), "tolerance": (SCALAR,)},
    ),
    _region(
        "GridRegion(name, grid, Ax, Ay, Bx, By)",
        "The free cells of a grid.",
        "scattered",
        further="orientation=None",
        takes={"name": (TEXT, NONE), "Ax": (SCALAR,), "Ay": (SCALAR,), "Bx": (SCALAR,), "By": (SCALAR,)},
    ),
    _region(
        "PolylineRegion(points=None, polyline=None)",
        "A sequence of line segments in the plane.",
        "lines",
        takes={"points": (POINTS, NONE), "polyline": (POLYLINE, NONE)},
    ),
    _region(
        "PathRegion(points=None, polylines=None)",
        "A sequence of line segments in space.",
        "lines",
        takes={"points": (POINTS, NONE)},
    ),
    _region(
        "PolygonalRegion(points=(), polygon=None, z=0)",
        "A polygon in a horizontal plane.",
        "planar",
        takes={"points": (POINTS, NONE), "polygon": (POLYGON, NONE), "z": (SCALAR,)},
    ),
    _region(
        "PolygonalFootprintRegion(polygon)",
        "All points above and below a polygon.",
        "planar",
        further="name=None",
        takes={"polygon": (POLYGON,)},
    ),
    _region(
        "CircularRegion(center, radius)",
        "A disc in a horizontal plane.",
        "circular",
        further="resolution=32, *, name=None",
        takes={"center": (VECTOR,), "radius": (SCALAR,), "resolution": (SCALAR,)},
    ),
    _region(
        "SectorRegion(center, radius, heading, angle)",
        "A sector of a disc in a horizontal plane.",
        "sectors",
        angles=("heading", "angle"),
        further="resolution=32, *, name=None",
        takes={"center": (VECTOR,), "radius": (SCALAR,), "heading": (HEADING,), "angle": (SCALAR,)},
    ),
    _region(
        "RectangularRegion(position, heading, width, length)",
        "A rectangle in a horizontal plane.",
        "rectangular",
        angles=("heading",),
        further="*, name=None",
        takes={"position": (VECTOR,), "heading": (HEADING,), "width": (SCALAR,), "length": (SCALAR,)},
    ),
    _region(
        "MeshVolumeRegion(mesh, dimensions=None, position=None, rotation=None)",
        "The inside of a closed mesh.",
        "meshes",
        takes={"mesh": (MESH,), **_PLACED},
    ),
    _region(
        "MeshSurfaceRegion(mesh, dimensions=None, position=None, rotation=None)",
        "The surface of a mesh.",
        "meshes",
        takes={"mesh": (MESH,), **_PLACED},
    ),
    _region(
        "BoxRegion(dimensions=(1, 1, 1), position=None, rotation=None)",
        "A solid cuboid.",
        "volumes",
        takes=_PLACED,
    ),
    _region(
        "SpheroidRegion(dimensions=(2, 2, 2), position=None, rotation=None)",
        "A solid spheroid.",
        "volumes",
        takes=_PLACED,
    ),
)


def _functions_of_elements() -> Iterator[Name]:
    """Yield the functions of the established Python API that do what operators and specifiers do."""
    elements: list[Operator | SpecifierDeclaration] = [*OPERATORS.values(), *SPECIFIERS.values()]
    for element in elements:
        forms = " or ".join(f"`{form}`" for form in element.forms)
        for function in element.functions:
            yield _function(
                function.signature,
                f"{forms} as a function.",
                "scenic.runtime.program.veneer",
                syntax=forms,
                lifted=element.name in OPERATORS,
            )
    documentation = "`with prop val` as a function, of the property's name as text."
    yield _function("With(prop, val)", documentation, "scenic.runtime.program.veneer", syntax="with prop val")


_PROPOSITIONS = tuple(
    _function(signature, f"`{syntax}` as a formula.", "scenic.runtime.temporal.propositions", syntax=syntax)
    for signature, syntax in (
        ("Always(req)", "always X"),
        ("Eventually(req)", "eventually X"),
        ("Next(req)", "next X"),
        ("Until(lhs, rhs)", "X until Y"),
        ("Implies(lhs, rhs)", "X implies Y"),
        ("PropositionAnd(reqs)", "X and Y"),
        ("PropositionOr(reqs)", "X or Y"),
        ("PropositionNot(req)", "not X"),
        ("AtomicProposition(closure, syntaxId)", "X"),
    )
)

NAMES: Final[Mapping[str, Name]] = MappingProxyType(
    {name.name: name for name in (*_ALL, *_PROPOSITIONS, *_functions_of_elements())}
)
"""Names in scope beside Python's own builtins."""

ELEMENT_FUNCTIONS: Final = frozenset(name.name for name in _functions_of_elements())
"""Functions of operators and specifiers: calls of them may read the ego."""

CONVERSIONS: Final = frozenset({"int", "float", "str"})
"""Conversions: their calls are lifted wherever they stand, so the names cannot be bound."""

TRACKED: Final[Mapping[str, str]] = MappingProxyType(
    {
        "ego": "The object from whose point of view the scenario is written. Set with `ego = object`.",
        "workspace": "The region that contains all objects. Set with `workspace = Workspace(region)`.",
    }
)
"""Names that read and write the current scenario; they can only be assigned as a whole."""

RESERVED: Final = frozenset({*TRACKED, *CONVERSIONS, "globalParameters"})
"""Names that nothing else may bind (section 1.3)."""

LIFTED_FUNCTIONS: Final = frozenset(name.name for name in NAMES.values() if name.lifted)
"""Functions whose calls in a condition may become part of the value graph."""

CONSTRUCTORS: Final = frozenset(
    name.name
    for name in _ALL
    if (name.kind is NameKind.REGION and "(" in name.signature) or name.name == "Vector"
)
"""Constructors that conditions may apply to random values, as parts of the value graph."""

ANGLE_METHODS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {"fromEuler": ("yaw", "pitch", "roll"), "rotatedBy": ("angle",)}
)
"""Parameters of methods whose numbers are angles in radians."""

LIFTED_METHODS: Final = word_set(
    # Vectors
    "altitudeTo angleTo angleWith azimuthTo cross distanceTo dot norm normalized offsetLocally "
    "offsetRadially offsetRotated rotatedBy sphericalCoordinates "
    # Orientations
    "approxEq localAnglesFor "
    # Road networks and their elements
    "crossingAt elementAt intersectionAt laneAt laneGroupAt laneSectionAt roadAt sectionAt shoulderAt "
    "sidewalkAt "
    # Points and objects
    "canSee containsPoint distancePast intersects relativePosition relativize toHeading toOrientation "
    "toVector "
    # Regions
    "containsObject containsRegion "
)
"""Methods of vectors, orientations, objects and regions whose calls in a condition may become part of the graph."""

_CAMERA: Final = "(*, offset=None, rotation=(0, 0, 0), width=640, height=480, attributes=None)"

SENSORS: Final[Mapping[str, Name]] = MappingProxyType(
    {
        sensor.name: sensor
        for sensor in (
            _sensor(f"RGBSensor{_CAMERA}", "A camera that gives colour images."),
            _sensor(
                f"DepthSensor{_CAMERA}",
                "A camera that gives the distance of each pixel along its axis, in metres.",
            ),
            _sensor(
                f"SSSensor{_CAMERA}",
                "A camera that gives the class and the object of each pixel: semantic and instance segmentation.",
            ),
            _sensor(
                "CallbackSensor(defaultValue=None)",
                "A sensor whose data a simulator delivers when it has them.",
            ),
            _sensor(
                "GroundTruthSensor(value)",
                "Observes a value, or the result of a function, as it is at each step.",
            ),
        )
    }
)
"""Sensors that the language provides. They are not in scope: programs import them from `scenic`."""

_MOTION: Final = ("Fly", "SetAcceleration", "SetSteering", "SetThrottle", "SetVelocity", "SetWheelSpeeds")

IMPORTABLE: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(SENSORS, "scenic"),
        **dict.fromkeys((*_MOTION, "KinematicSimulator"), "scenic.simulators.kinematic"),
        **dict.fromkeys(("ApplyForce", "Grasp", "MujocoSimulator", "Release"), "scenic.simulators.mujoco"),
        "Action": "scenic.simulators.actions",
        "DummySimulator": "scenic.simulators.dummy",
    }
)
"""Names that programs import rather than find, and the module that each is taken from."""
