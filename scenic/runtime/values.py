"""The values a program computes with: numbers, vectors and orientations, definite or random.

A random value wraps a node of the value graph. Every function here takes definite and random values alike: with definite
operands an operation is evaluated at once, by the same reading that batches use; with a random one it becomes a node. So
the language's operators, vector methods and specifier formulas are each written once.
"""

import functools
import inspect
import math
import operator
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from types import BuiltinFunctionType, MappingProxyType
from typing import Any, ClassVar, Self, TypeGuard

import numpy as np

from scenic.graph import construction, quaternions
from scenic.graph.batch import Batch
from scenic.graph.bounds import Bounds
from scenic.graph.draws import Counter
from scenic.graph.kinds import Column, Kind
from scenic.graph.node import Graph, Node, axis, constant, key
from scenic.graph.operation import Call, Operation, always, by_lane
from scenic.graph.operations import TABLE
from scenic.graph.schedule import Scheduler
from scenic.language.errors import (
    InvalidScenarioError,
    RandomControlFlowError,
    RandomIndexError,
    RejectionException,
    ScenicTypeError,
    UnsupportedError,
)
from scenic.runtime.context import here, next_address, uniform_draw
from scenic.runtime.lazy import Lazy, defer
from scenic.runtime.methods import Arithmetic, Operand, OrientationMethods, VectorMethods
from scenic.runtime.spelling import plain_number, spelled

LARGEST_INTEGER = 2**62
"""Integers beyond this are kept as Python objects."""


class Hooks(Operand):
    """How the methods of values apply operations; see `scenic.runtime.methods`."""

    __slots__ = ()

    @staticmethod
    def _operate(name: str, *operands: Any, payload: Any = None) -> Any:
        return operate(name, *operands, payload=payload)

    @staticmethod
    def _vector(x: Any, y: Any, z: Any = 0) -> Any:
        return vector(x, y, z)

    @staticmethod
    def _to_vector(value: Any) -> Any:
        return to_vector(value)

    @staticmethod
    def _to_orientation(value: Any) -> Any:
        return to_orientation(value)

    @staticmethod
    def _is_vector(value: Any) -> bool:
        return is_vector(value)

    @staticmethod
    def _is_orientation(value: Any) -> bool:
        return is_orientation(value)

    @staticmethod
    def _with_vector(name: str, left: Any, right: Any) -> Any:
        try:
            return operate(name, to_vector(left), to_vector(right))
        except ScenicTypeError:
            return NotImplemented

    @staticmethod
    def _with_number(name: str, left: Any, right: Any) -> Any:
        is_scalar = is_number(right) or isinstance(right, Random)
        if is_scalar and not is_vector(right) and not is_orientation(right):
            return operate(name, left, to_scalar(right))
        return NotImplemented


class Random(Arithmetic, Hooks):
    """A value that is drawn when a scene is sampled.

    Arithmetic, indexing, calling and attribute access give further random values. Anything that needs a definite
    answer now (a truth value, a comparison, iteration) raises `RandomControlFlowError`.
    """

    __slots__ = ("_again", "node")
    drawn: ClassVar[Callable[[Any], Any]]
    """Draws one sample of a value; `scenic.runtime.drawing`, which knows how, puts itself here."""
    supported: ClassVar[Callable[[Any], tuple[float | None, float | None]]]
    __array_priority__ = 1000  # NumPy scalars on the left defer to the methods below.

    stand_in: ClassVar[Callable[[Any], Any]]
    """What stands for an instance that a choice draws; `scenic.runtime.standing`, which stands on this module, gives it."""
    later: ClassVar[Callable[..., Any]]
    """A call of Python code that is made on each sample; `scenic.runtime.opaque`, which stands on this module, gives it."""

    def __init__(self, node: Node, again: "Callable[[], Any] | None" = None) -> None:
        self.node = node
        self._again = again

    # Parts

    def __getitem__(self, index: Any) -> Any:
        if holds_instances(self.node):
            # Instances as they are in the sample; that they are instances is not known before (section 8.1).
            return Random.later(operator.getitem, self, index)
        element = element_at(self.node, index)
        return operate("getitem", self, index) if element is None else element

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") and name.endswith("__"):
            raise AttributeError(name)
        return attribute(self, name)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return called(self, args, kwargs)

    # What scripts ask of a law

    def sample(self, subsamples: Any = None) -> Any:
        """One sample, drawn now from Python's generator, independent of all scenes."""
        return Random.drawn(self)

    def supportInterval(self) -> tuple[float | None, float | None]:
        """The least and the greatest value, as far as they are known."""
        return Random.supported(self)

    def clone(self) -> Any:
        """An independent draw of the same law."""
        return self if self._again is None else self._again()

    # What a random value cannot do

    def _definite(self, what: str) -> RandomControlFlowError:
        return RandomControlFlowError(
            f"{what} a random value is not possible while the scenario is being built",
            span=here(),
            help="its value is known only in a sampled scene; use `require`, or make the choice itself "
            "random with `Uniform(...)` or `Discrete({...})`",
        )

    def __bool__(self) -> bool:
        raise self._definite("branching on the truth of")

    def __eq__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __ne__(self, other: object) -> bool:
        raise self._definite("comparing")

    def __lt__(self, other: Any) -> bool:
        raise self._definite("comparing")

    def __le__(self, other: Any) -> bool:
        raise self._definite("comparing")

    def __gt__(self, other: Any) -> bool:
        raise self._definite("comparing")

    def __ge__(self, other: Any) -> bool:
        raise self._definite("comparing")

    def __contains__(self, item: Any) -> bool:
        raise self._definite("looking into")

    def __iter__(self) -> Iterator[Any]:
        raise self._definite("iterating over")

    def __len__(self) -> int:
        raise self._definite("taking Python's own `len` of")

    def __index__(self) -> int:
        raise RandomIndexError(
            "indexing a container of Python's own with a random value is not possible",
            span=here(),
            help="make the container itself random: `Uniform(xs)[index]`, or choose an element: `Uniform(*xs)`",
        )

    def __int__(self) -> int:
        raise self._definite("converting (outside Scenic code)")

    def __float__(self) -> float:
        raise self._definite("converting (outside Scenic code)")

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return spelled(self.node)

    def __format__(self, spec: str) -> str:
        warnings.warn("a random value formatted as text shows no sample", stacklevel=2)
        return repr(self)

    def resampled(self) -> Any:
        """An independent draw of the same law with the same parameters (``resample``)."""
        if self._again is None:
            raise ScenicTypeError(
                "only primitive distributions can be resampled, not values computed from them",
                span=here(),
                help="resample the distribution itself and compute with the result",
            )
        return self._again()


def _scalar(name: str) -> Callable[..., Any]:
    """An operation of the table on plain numbers."""
    scalar = TABLE[name].scalar
    assert scalar is not None, name
    return scalar


_ADD, _SUBTRACT, _MULTIPLY = map(_scalar, ("add", "subtract", "multiply"))


class Vector(VectorMethods, Hooks):
    """A definite vector: three floats, in metres. ``Vector(x, y, z)`` with a random coordinate is a random vector."""

    __slots__ = ("_row",)
    _row: tuple[float, float, float]

    def __new__(cls, x: Any, y: Any, z: Any = 0) -> Any:
        if is_random(x) or is_random(y) or is_random(z):
            return vector(x, y, z)
        return cls.of((float(x), float(y), float(z)))

    @classmethod
    def of(cls, row: Iterable[float]) -> Self:
        """The vector of three floats."""
        self = object.__new__(cls)
        self._row = tuple(row)  # type: ignore[assignment] # of three
        return self

    @property
    def row(self) -> tuple[float, float, float]:
        """The three floats."""
        return self._row

    @property
    def x(self) -> float:
        return self._row[0]

    @property
    def y(self) -> float:
        return self._row[1]

    @property
    def z(self) -> float:
        return self._row[2]

    def __iter__(self) -> Iterator[float]:
        return iter(self._row)

    # The operations that running simulations do most, without a detour.

    def __add__(self, other: Any) -> Any:
        if type(other) is Vector:
            return Vector.of(_ADD(None, self._row, other._row))
        return super().__add__(other)

    def __sub__(self, other: Any) -> Any:
        if type(other) is Vector:
            return Vector.of(_SUBTRACT(None, self._row, other._row))
        return super().__sub__(other)

    def __mul__(self, other: Any) -> Any:
        if type(other) is float or type(other) is int:
            return Vector.of(_MULTIPLY(None, self._row, float(other)))
        return super().__mul__(other)

    __rmul__ = __mul__

    def rotatedBy(self, rotation: Any) -> Any:
        """As of `VectorMethods`, without a detour."""
        return _ROTATE(to_orientation(rotation), self)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Vector):
            return self._row == other._row
        if isinstance(other, tuple | list) and not is_random(other):
            return len(other) in (2, 3) and self._row == tuple(other) + (0,) * (3 - len(other))
        return NotImplemented

    def __hash__(self) -> int:
        return hash(self._row)

    def __repr__(self) -> str:
        return "Vector({}, {}, {})".format(*map(plain_number, self._row))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return np.array(self._row, dtype=dtype)

    def __reduce__(self) -> tuple[Any, ...]:
        return Vector, self._row

    def __deepcopy__(self, _memo: Any) -> Self:
        return self  # nothing of it can change

    def __copy__(self) -> Self:
        return self


class Orientation(OrientationMethods, Hooks):
    """A definite orientation: a unit quaternion. Made by `fromEuler` or `fromQuaternion`, or from SciPy's ``Rotation``."""

    __slots__ = ("_row",)
    _row: tuple[float, float, float, float]

    def __init__(self, rotation: Any = None) -> None:
        if rotation is not None and not hasattr(rotation, "as_quat"):
            raise ScenicTypeError(
                f"`Orientation` takes a rotation of SciPy, not {describe(rotation)}",
                span=here(),
                help="use `Orientation.fromEuler(yaw, pitch, roll)` or `Orientation.fromQuaternion((x, y, z, w))`",
            )
        self._row = (0.0, 0.0, 0.0, 1.0) if rotation is None else tuple(rotation.as_quat().tolist())

    @classmethod
    def of(cls, row: Iterable[float]) -> Self:
        """The orientation of a unit quaternion x, y, z, w."""
        self = object.__new__(cls)
        self._row = tuple(row)  # type: ignore[assignment]
        return self

    @staticmethod
    def fromEuler(yaw: Any, pitch: Any, roll: Any) -> Any:
        """Intrinsic rotations about Z, the new X and the new Y (radians)."""
        if (
            type(yaw) is float
            and type(pitch) is float
            and type(roll) is float
            and math.isfinite(yaw + pitch + roll)
        ):
            return Orientation.of(quaternions.of_euler(yaw, pitch, roll))
        return operate("from euler", to_scalar(yaw), to_scalar(pitch), to_scalar(roll))

    @classmethod
    def fromQuaternion(cls, quaternion: Sequence[float]) -> "Orientation":
        """From (x, y, z, w), normalised; raises ``ValueError`` for the zero quaternion."""
        x, y, z, w = (float(part) for part in quaternion)
        length = math.sqrt(x * x + y * y + z * z + w * w)
        if not (length > 0 and math.isfinite(length)):
            raise ValueError(f"not a rotation: quaternion {tuple(quaternion)}")
        return cls.of((x / length, y / length, z / length, w / length))

    @property
    def x(self) -> float:
        """First imaginary part of the quaternion."""
        return self._row[0]

    @property
    def y(self) -> float:
        """Second imaginary part of the quaternion."""
        return self._row[1]

    @property
    def z(self) -> float:
        """Third imaginary part of the quaternion."""
        return self._row[2]

    @property
    def w(self) -> float:
        """Real part of the quaternion."""
        return self._row[3]

    @property
    def q(self) -> tuple[float, float, float, float]:
        """The quaternion (x, y, z, w)."""
        return self._row

    @property
    def r(self) -> Any:
        """The rotation as SciPy's ``Rotation``."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(self._row)

    def getRotation(self) -> Any:
        """The rotation as SciPy's ``Rotation``."""
        return self.r

    def approxEq(self, other: "Orientation", tol: float = 1e-10) -> bool:
        """Whether the two differ by a rotation of at most about ``tol`` (up to the sign of the quaternion)."""
        product = sum(a * b for a, b in zip(self._row, other._row, strict=True))
        return bool(abs(product) >= 1 - tol)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Orientation):
            return NotImplemented
        return self._row == other._row or self._row == tuple(-part for part in other._row)

    def __hash__(self) -> int:
        sign = next((part for part in reversed(self._row) if part != 0), 1.0)
        return hash(tuple(part if sign > 0 else -part for part in self._row))

    @property
    def yaw(self) -> float:
        """Rotation about Z, the first of the intrinsic Euler angles (radians)."""
        return quaternions.euler_angle(self._row, 0)

    @property
    def eulerAngles(self) -> tuple[float, float, float]:
        """Yaw, pitch and roll."""
        return quaternions.euler_angles(self._row)

    def __repr__(self) -> str:
        return "Orientation.fromEuler({}, {}, {})".format(*map(plain_number, self.eulerAngles))


class RandomVector(VectorMethods, Random):
    """A random vector."""

    __slots__ = ()
    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        raise self._definite("comparing")


class RandomOrientation(OrientationMethods, Random):
    """A random orientation."""

    __slots__ = ()
    __hash__ = object.__hash__


# Kinds and conversion between values and nodes


def is_random(value: Any) -> bool:
    """Whether a value is random or a container with random parts."""
    if isinstance(value, Random):
        return True
    if isinstance(value, tuple | list):
        return any(is_random(item) for item in value)
    if isinstance(value, slice):
        return is_random(value.start) or is_random(value.stop) or is_random(value.step)
    if type(value) is dict:
        return any(is_random(item) for item in value.values())
    return False


_NUMBERS = (int, float, np.integer, np.floating, np.bool_)  # made once: it is asked for all the time
_ROWS = (tuple, list, np.ndarray)


def is_number(value: Any) -> TypeGuard[float]:
    """Whether a definite value is a real number."""
    return isinstance(value, _NUMBERS)


def is_vector(value: Any) -> bool:
    """Whether a value is a vector, or a pair or triple that stands for one."""
    if isinstance(value, Random):
        return value.node.kind is Kind.VECTOR
    if isinstance(value, tuple | list):
        return len(value) in (2, 3)
    return isinstance(value, Vector) or (isinstance(value, np.ndarray) and value.shape in ((2,), (3,)))


def is_orientation(value: Any) -> bool:
    """Whether a value is an orientation."""
    if isinstance(value, Random):
        return value.node.kind is Kind.ORIENTATION
    return isinstance(value, Orientation)


class ValueCodec:
    """Columns as the values above; see `scenic.graph.kinds.Codec`."""

    def decode(self, kind: Kind, column: Column) -> list[Any]:
        """The values of a column, lane by lane."""
        if not kind.trailing:
            return column.tolist()  # type: ignore[no-any-return]
        cls = Vector if kind is Kind.VECTOR else Orientation
        values: list[Any] = [object.__new__(cls) for _ in column]
        for value, row in zip(values, zip(*column.T.tolist(), strict=True), strict=True):
            value._row = row
        return values

    def encode(self, kind: Kind, value: Any) -> Any:
        """The row of a value; raises ``TypeError`` where it is of another kind."""
        if kind.is_boxed:
            return value
        if isinstance(value, Random):
            raise UnsupportedError(
                "reaching a random value of an instance through a random container is not supported yet",
                help="choose among the instances themselves: `Uniform(a, b)`",
            )
        if kind is Kind.VECTOR:
            return tuple(to_vector(value))
        if kind is Kind.ORIENTATION:
            orientation = to_orientation(value)
            return (orientation.x, orientation.y, orientation.z, orientation.w)
        if not is_number(value):
            raise ScenicTypeError(f"expected a number, not {describe(value)}")
        return value


CODEC = ValueCodec()

_TUPLE = Operation(
    "tuple",
    always(Kind.OTHER),
    by_lane,
    "A tuple with random parts.",
    python=lambda *parts: parts,
)
_LIST = Operation(
    "list",
    always(Kind.OTHER),
    by_lane,
    "A list with random parts.",
    python=lambda *parts: list(parts),
)


_SLICE = Operation("slice", always(Kind.OTHER), by_lane, "A slice with random ends.", python=slice)


def _container(value: Any) -> Operation:
    """What makes a container of the type of ``value`` from its parts."""
    if isinstance(value, list):
        return _LIST
    if not hasattr(value, "_fields"):
        return _TUPLE
    return Operation(
        "named tuple", always(Kind.OTHER), by_lane, "A named tuple with random parts.", python=type(value)
    )


def as_node(value: Any) -> Node:
    """The node of a value: its own if random, else a constant."""
    if isinstance(value, Random):
        return value.node
    if isinstance(value, tuple | list) and is_random(value):
        return construction.make_node(_container(value), [as_node(item) for item in value], span=here())
    if isinstance(value, slice) and is_random(value):
        ends = [as_node(end) for end in (value.start, value.stop, value.step)]
        return construction.make_node(_SLICE, ends, span=here())
    kind = kind_of(value)
    return constant(value, kind, CODEC.encode(kind, value))


def kind_of(value: Any) -> Kind:
    """The kind of a definite value."""
    if isinstance(value, bool | np.bool_):
        return Kind.BOOLEAN
    if isinstance(value, int | np.integer):
        return Kind.INTEGER if abs(int(value)) < LARGEST_INTEGER else Kind.OTHER
    if isinstance(value, float | np.floating):
        return Kind.SCALAR
    if isinstance(value, Vector):
        return Kind.VECTOR
    if isinstance(value, Orientation):
        return Kind.ORIENTATION
    kind: Kind = getattr(value, "scenic_kind", Kind.OTHER)
    return kind if isinstance(kind, Kind) else Kind.OTHER


def as_value(node: Node, again: Callable[[], Any] | None = None) -> Any:
    """The value of a node: definite for a constant, else random."""
    if node.is_constant:
        return node.value
    if node.kind is Kind.VECTOR:
        return RandomVector(node, again)
    if node.kind is Kind.ORIENTATION:
        return RandomOrientation(node, again)
    return Random(node, again)


# Applying operations


def operate(name: str, *operands: Any, payload: Any = None) -> Any:
    """Apply an operation of the table to values."""
    return apply(TABLE[name], *operands, payload=payload)


def apply(operation: Operation, *operands: Any, payload: Any = None) -> Any:
    """Apply any operation to values: at once when all are definite, as a new node otherwise; later where one is lazy."""
    if operation.scalar is not None:
        result = _at_once(operation.scalar, payload, operands)
        if result is not NotImplemented:
            return result
    if any(isinstance(operand, Lazy) for operand in operands):
        return defer(apply, operation, *operands, payload=payload)
    nodes = [as_node(operand) for operand in operands]
    if operation.pure and all(node.is_constant for node in nodes):
        return folded(operation, nodes, payload)
    if operation.pure and operation.is_python(nodes, Kind.OTHER):
        distributed = over_options(nodes, lambda *options: operation.python(*options))  # type: ignore[misc] # it has one
        if distributed is not None:
            return distributed
    return as_value(construction.make_node(operation, nodes, payload, here()))


MOST_OPTIONS = 256
"""Options of a choice for each of which a call is made at once, at most."""


def over_options(operands: Sequence[Node], function: Callable[..., Any]) -> Any:
    """The result of a function that depends on nothing but its operands, where these are constants and choices by one draw.

    It is the choice among the results, so that no sample needs a call: what the options give is computed here. An option for
    which the function fails does so only in samples that draw it. ``None`` for other operands, and for choices among instances.
    """
    choices = [node for node in operands if not node.is_constant]
    if not choices or not all(_is_choice_of_data(node) for node in choices):
        return None
    index, count = choices[0].operands[0], len(choices[0].operands) - 1
    if count > MOST_OPTIONS or any(node.operands[0] is not index for node in choices):
        return None
    results: list[Node] = []
    for place in range(1, count + 1):
        values = [(node if node.is_constant else node.operands[place]).value for node in operands]
        try:
            results.append(as_node(function(*values)))
        except RejectionException:
            return None
        except Exception as error:  # noqa: BLE001 - whatever it raises is an error where this option is drawn
            results.append(construction.make_node(_MISSING, (), error, here()))
    return _select(index, results)


NOTHING = "there is nothing to choose from"


def element_of(index: Node, lists: Sequence[Sequence[Node]], draw: Random) -> Any:
    """The element at the share ``draw`` of the length of one of several lists, which ``index`` draws.

    Samples in which the list is empty are rejected.
    """
    results = []
    for elements in lists:
        if elements:
            place = apply(_PLACE, draw, payload=len(elements))
            results.append(as_node(_select(as_node(place), elements)))
        else:
            results.append(construction.make_node(_NOTHING, (), span=here()))
    return _select(index, results)


def elements_of(node: Node) -> Sequence[Node] | None:
    """The elements of a list or tuple of fixed length, as nodes; ``None`` for anything else."""
    if node.operation in (_LIST, _TUPLE):
        return node.operands
    if node.is_constant and type(node.value) in (list, tuple):
        return [as_node(item) for item in node.value]
    return None


def element_at(node: Node, index: Any) -> Any:
    """An element of a choice among containers: the choice among their elements. ``None`` for other operands."""
    if node.operation is not TABLE["select"] or type(index) not in (int, str):
        return None
    draw, *options = node.operands
    if len(options) > MOST_OPTIONS:
        return None
    results = []
    for option in options:
        try:
            if option.operation in (_LIST, _TUPLE) and type(index) is int:
                results.append(option.operands[index])
            elif option.is_constant and type(option.value) in (list, tuple, dict):
                results.append(as_node(option.value[index]))
            else:
                return None
        except LookupError as error:
            results.append(construction.make_node(_MISSING, (), error, here()))
    return _select(draw, results)


def _is_choice_of_data(node: Node) -> bool:
    """Whether a node is a choice among constants that are data of Python, in which nothing is random."""
    if node.operation is not TABLE["select"]:
        return False
    return all(option.is_constant and _is_data(option.value) for option in node.operands[1:])


def _is_data(value: Any) -> bool:
    cls = type(value)
    if cls in (list, tuple, set, frozenset):
        return all(map(_is_data, value))
    if cls is dict:
        return all(_is_data(key) and _is_data(item) for key, item in value.items())
    return value is None or cls in (int, float, bool, str, bytes, slice, Vector, Orientation)


def _at_once(scalar: Callable[..., Any], payload: Any, operands: Sequence[Any]) -> Any:
    """The value of an operation on plain numbers, vectors and orientations; ``NotImplemented`` where there are others."""
    rows = []
    for operand in operands:
        cls = type(operand)
        if cls is Vector or cls is Orientation:
            rows.append(operand._row)
        elif cls is float or cls is int:
            rows.append(operand)
        else:
            return NotImplemented
    return _of_row(scalar(payload, *rows))


def _of_row(result: Any) -> Any:
    if type(result) is not tuple:
        return result
    value: Any = object.__new__(Vector if len(result) == 3 else Orientation)
    value._row = result
    return value


def unary(name: str) -> Callable[[Any], Any]:
    """`operate` for one operation of one operand without data, for what simulations do all the time."""
    operation, scalar = TABLE[name], _scalar(name)

    def applied(operand: Any) -> Any:
        cls = type(operand)
        if cls is float:
            result = scalar(None, operand)
        elif cls is Vector or cls is Orientation:
            result = scalar(None, operand._row)
        else:
            return apply(operation, operand)
        return apply(operation, operand) if result is NotImplemented else _of_row(result)

    return applied


def binary(name: str) -> Callable[[Any, Any], Any]:
    """`operate` for one operation of two operands without data, for what simulations do all the time."""
    operation, scalar = TABLE[name], _scalar(name)

    def applied(left: Any, right: Any) -> Any:
        first, second = type(left), type(right)
        if second is Vector and (first is Vector or first is Orientation):
            return _of_row(scalar(None, left._row, right._row))
        if first is float and second is float:
            result = scalar(None, left, right)
            return apply(operation, left, right) if result is NotImplemented else result
        return apply(operation, left, right)

    return applied


_ROTATE = binary("rotate")


def folded(operation: Operation, nodes: Sequence[Node], payload: Any) -> Any:
    """The value of an operation on constants; raises what a sample of it would raise."""
    kind = operation.kind(nodes, payload)
    plain = all(node.kind.is_number for node in nodes) or kind.is_boxed
    if operation.python is not None and (plain or any(node.kind.is_boxed for node in nodes)):
        return operation.python(*(node.value for node in nodes))
    call = Call(
        (1,), payload, [None] * len(nodes), kinds=[node.kind for node in nodes], kind=kind, codec=CODEC
    )
    with np.errstate(all="ignore"):
        column = operation.batch(call, *(node.payload.column for node in nodes))
    if call.error is not None:
        raise call.error
    if call.status is not None:
        raise InvalidScenarioError(
            f"this {operation.name} can never be drawn", span=here(), help="it rejects every sample"
        )
    return CODEC.decode(kind, column[:1])[0]


def fixed_batch(nodes: Iterable[Node]) -> Batch:
    """A batch of one lane that holds fixed nodes."""
    return Batch(Scheduler(Graph(nodes)), Counter(np.zeros(1, dtype=np.uint64)), CODEC)


def uniform() -> Any:
    """One axis of the cube as a value: uniform on (0, 1)."""
    drawn = uniform_draw()
    return Random(axis(here(), next_address())) if drawn is None else drawn


def random_key() -> Any:
    """A random word as a value, which keys the further draws of an operation that retries."""
    drawn = uniform_draw()
    if drawn is None:
        return Random(key(here(), next_address()))
    return as_value(constant(drawn, Kind.KEY, int(drawn * 2.0**52)))


# Attributes and calls


def attribute(value: Random, name: str) -> Any:
    """An attribute of a random value. A choice gives the choice among the options' attributes."""
    node = value.node
    if node.operation is TABLE["select"]:
        index, *options = node.operands
        return _select(index, [_attribute_of_option(option, name) for option in options])
    if node.kind.is_number and hasattr(0.0 if node.kind is Kind.SCALAR else 0, name):
        return apply(_GETATTR, value, name)
    if node.kind.is_number or node.kind in (Kind.VECTOR, Kind.ORIENTATION):
        raise AttributeError(f"a random {node.kind.value} has no attribute {name!r}")
    return Random.later(getattr, value, name) if holds_instances(node) else apply(_GETATTR, value, name)


def called(value: Random, args: Sequence[Any], kwargs: dict[str, Any]) -> Any:
    """The result of calling a random value. A choice among functions calls each with the arguments."""
    node = value.node
    if node.operation is TABLE["select"]:
        index, *options = node.operands
        results = []
        for option in options:
            if option.operation is _MISSING:
                results.append(option)
            elif option.is_constant and _is_of_runtime(option.value):
                results.append(_traced(option.value, args, kwargs))
            elif option.is_constant and isinstance(option.value, BuiltinFunctionType):
                results.append(_call_in_lanes(option, args, kwargs))
            else:
                results.append(as_node(Random.later(as_value(option), *args, **kwargs)))
        return _select(index, results)
    return Random.later(value, *args, **kwargs)


def _is_of_runtime(function: Any) -> bool:
    """Whether a callable is one of the runtime's own, which take random arguments; what programs define does not."""
    defined = getattr(function, "__func__", function)
    module = getattr(defined, "__module__", None) or ""
    return module.startswith("scenic.runtime.")


def _traced(function: Any, args: Sequence[Any], kwargs: dict[str, Any]) -> Node:
    """The result of a call; an error of it counts only where this option is drawn."""
    try:
        return as_node(function(*args, **kwargs))
    except Exception as error:  # noqa: BLE001 - whatever the call raises
        return construction.make_node(_MISSING, (), error, here())


def _call_in_lanes(function: Node, args: Sequence[Any], kwargs: dict[str, Any]) -> Node:
    operands = [function, *(as_node(item) for item in (*args, *kwargs.values()))]
    names, positional = tuple(kwargs), len(args)

    def invoke(target: Any, *values: Any) -> Any:
        return target(*values[:positional], **dict(zip(names, values[positional:], strict=True)))

    operation = Operation("call", always(Kind.OTHER), by_lane, "A call of Python's own.", python=invoke)
    return construction.make_node(operation, operands, span=here())


def _attribute_of_option(option: Node, name: str) -> Node:
    if option.operation is _MISSING:
        return option
    value = drawn_option(option)
    if kind_of(value) is Kind.OBJECT and _is_computed(type(value), name):  # type: ignore[arg-type] # classes are hashable
        return as_node(Random.later(getattr, value, name))
    try:
        return as_node(getattr(value, name))
    except AttributeError as error:
        return construction.make_node(_MISSING, (), error, here())


@functools.lru_cache(maxsize=1024)
def _is_computed(cls: type, name: str) -> bool:
    """Whether an attribute is computed by code of the program, which has to see sampled values."""
    found = inspect.getattr_static(cls, name, None)
    code = found.fget if isinstance(found, property) else getattr(found, "func", None)
    return isinstance(found, property | functools.cached_property) and not _is_of_runtime(code)


def holds_instances(node: Node) -> bool:
    """Whether instances of the program are among the constants that a node is made of, or in containers there."""
    stack, seen = [node], {node}
    while stack:
        below = stack.pop()
        if below.is_constant:
            if below.kind is Kind.OBJECT or (below.kind.is_boxed and _with_instances(below.value)):
                return True
        elif not below.is_drawn and below.operation.pure:  # calls on samples give sampled instances
            new = [operand for operand in below.operands if operand not in seen]
            seen.update(new)
            stack.extend(new)
    return False


def _with_instances(value: Any) -> bool:
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, tuple | list | set | frozenset):
        return any(_with_instances(item) for item in value)
    return holds_instances(value.node) if isinstance(value, Random) else kind_of(value) is Kind.OBJECT


def _select(index: Node, options: Sequence[Node]) -> Any:
    return as_value(construction.make_node(TABLE["select"], [index, *options], span=here()))


def _missing(call: Call) -> Any:
    call.fault(np.ones(1, dtype=np.bool_), call.payload)
    return np.empty(1, dtype=object)


_MISSING = Operation(
    "missing attribute",
    always(Kind.OTHER),
    _missing,
    "An attribute that an option of a choice does not have; an error only where that option is drawn.",
    pure=False,
    faults=True,
)


def _nothing(call: Call) -> Any:
    call.reject(np.ones(1, dtype=np.bool_))
    return np.empty(1, dtype=object)


_NOTHING = Operation(
    "nothing",
    always(Kind.OTHER),
    _nothing,
    "An element of an empty list; a sample that draws it is rejected.",
    pure=False,
    rejects=True,
)
_PLACE = Operation(
    "place in a list",
    always(Kind.INTEGER),
    lambda call, draw: np.minimum((draw * call.payload).astype(np.int64), call.payload - 1),
    "The place of an element that is drawn by a number of the unit interval; payload the length.",
    bounds=lambda count, draw: Bounds(
        np.clip(np.floor(draw.lower * count) - 1, 0, count - 1),
        np.clip(np.floor(draw.upper * count) + 1, 0, count - 1),
    ),
    stacks=True,
)
_GETATTR = Operation(
    "attribute", always(Kind.OTHER), by_lane, "An attribute of a random value.", python=getattr
)


# Coercions (section 4.3)


def describe(value: Any) -> str:
    """A value in words for a message."""
    if isinstance(value, Random):
        return f"a random {value.node.kind.value}"
    if value is None:
        return "None"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value)
    kind = type(value).__name__
    return f"{text} ({kind})" if len(text) < 40 else f"a value of type {kind}"


_ADVICE = MappingProxyType(
    {
        "a number": "numbers are written plainly, drawn as by `Range(1, 2)`, or measured as by `distance to x`",
        "a vector": "write `(x, y, z)` or `x @ y`, or name a point or an object",
        "a heading": "write an angle, as `30 deg`, or name an oriented point or an object",
        "an orientation (a heading, Euler angles or an oriented point)": "write three Euler angles `(yaw, pitch, roll)`, or name an oriented point or an object",
        "a region": "make one, as `CircularRegion((0, 0), 5)`, or take one of an object, as `x.topSurface`",
        "a shape": "make one, as `BoxShape()` or `MeshShape.fromFile(path)`",
        "an object": "make one with `new Object`",
        "a point or an object": "make one with `new Point` or `new Object`",
        "an oriented point": "make one with `new OrientedPoint`, or give an object",
        "a region, an object or a vector": "name an object, or make a region, as `CircularRegion((0, 0), 5)`",
        "an object or a region": "name an object, or make a region, as `CircularRegion((0, 0), 5)`",
        "a pair of angles": "write two angles, as `(90 deg, 45 deg)`",
    }
)
"""What to write where something of a type is wanted."""


def wrong_type(wanted: str, value: Any, what: str = "") -> ScenicTypeError:
    """The error for a value that cannot be read as ``wanted``."""
    hint = _ADVICE.get(wanted)
    if isinstance(value, type):
        is_scenic = hasattr(value, "scenic_properties")
        hint = f"to create an instance write `{'new ' * is_scenic}{value.__name__}{'()' * (not is_scenic)}`"
    prefix = f"{what}: " if what else ""
    return ScenicTypeError(f"{prefix}expected {wanted}, not {describe(value)}", span=here(), help=hint)


def to_scalar(value: Any, what: str = "") -> Any:
    """A real number, as a float."""
    if type(value) is float:
        return value
    if isinstance(value, Lazy):
        return defer(to_scalar, value, what)
    if isinstance(value, Random):
        if value.node.kind is Kind.SCALAR:
            return value
        if value.node.kind.is_number:
            return operate("float", value)
        if value.node.kind.is_boxed:
            if all(option.kind.is_number for option in value.node.operands[1:]):
                # A choice among integers and floats: as floats its options have one kind, which analysis understands.
                return _coerce_boxed(value, Kind.SCALAR, to_scalar, what)
            return _coerce_later(value, Kind.SCALAR, to_scalar, what)
    elif is_number(value):
        return float(value)
    raise wrong_type("a number", value, what)


def to_vector(value: Any, what: str = "") -> Any:
    """A vector: also a pair (z = 0), a triple, and anything with a position."""
    if isinstance(value, Vector):
        return value
    if isinstance(value, Lazy):
        return defer(to_vector, value, what)
    if isinstance(value, Random):
        if value.node.kind is Kind.VECTOR:
            return value
        if value.node.kind.is_boxed:
            return _coerce_boxed(value, Kind.VECTOR, to_vector, what)
        raise wrong_type("a vector", value, what)
    if isinstance(value, _ROWS):
        if len(value) not in (2, 3):
            raise ScenicTypeError(
                f"{what + ': ' if what else ''}a vector has 2 or 3 coordinates, not {len(value)}",
                span=here(),
            )
        return vector(*value)
    if hasattr(value, "toVector") and not isinstance(value, type):
        return value.toVector()
    raise wrong_type("a vector", value, what)


def to_heading(value: Any, what: str = "") -> Any:
    """A heading in radians: a number, the global yaw of an orientation, the heading of an oriented point."""
    if type(value) is float:
        return value
    if isinstance(value, Lazy):
        return defer(to_heading, value, what)
    if isinstance(value, Random):
        if value.node.kind.is_number:
            return to_scalar(value)
        if value.node.kind is Kind.ORIENTATION:
            return value.yaw
        if value.node.kind.is_boxed:
            return _coerce_boxed(value, Kind.SCALAR, to_heading, what)
    elif is_number(value):
        return float(value)
    elif hasattr(value, "toHeading") and not isinstance(value, type):
        return value.toHeading()
    raise wrong_type("a heading", value, what)


def to_orientation(value: Any, what: str = "") -> Any:
    """An orientation: also a heading, a triple of Euler angles, and anything that has an orientation."""
    if isinstance(value, Orientation):
        return value
    if type(value) is float:
        return Orientation.fromEuler(value, 0.0, 0.0)
    if isinstance(value, Lazy):
        return defer(to_orientation, value, what)
    if isinstance(value, Random):
        if value.node.kind is Kind.ORIENTATION:
            return value
        if value.node.kind.is_number:
            return Orientation.fromEuler(value, 0, 0)
        if value.node.kind is Kind.VECTOR:
            return Orientation.fromEuler(*value)
        if value.node.kind.is_boxed:
            return _coerce_boxed(value, Kind.ORIENTATION, to_orientation, what)
    elif is_number(value):
        return Orientation.fromEuler(value, 0, 0)
    elif isinstance(value, Vector) or (isinstance(value, _ROWS) and len(value) == 3):
        return Orientation.fromEuler(*value)
    elif hasattr(value, "toOrientation") and not isinstance(value, type):
        return value.toOrientation()
    raise wrong_type("an orientation (a heading, Euler angles or an oriented point)", value, what)


def vector(x: Any, y: Any, z: Any = 0) -> Any:
    """The vector of three numbers."""
    if type(x) is float and type(y) is float and type(z) is float:
        return Vector.of((x, y, z))
    if is_number(x) and is_number(y) and is_number(z):
        return Vector.of((float(x), float(y), float(z)))
    return operate("vector", to_scalar(x), to_scalar(y), to_scalar(z))


def drawn_option(option: Node) -> Any:
    """The value of an option of a choice, as the choice draws it: an instance after mutation."""
    value = as_value(option)
    return Random.stand_in(value) if kind_of(value) is Kind.OBJECT else value


def per_option(value: Any, function: Callable[[Any], Any]) -> Any:
    """``function`` of a value; of each option where the value is a random choice, and the choice among the results."""
    if isinstance(value, Random) and value.node.operation is TABLE["select"]:
        index, *options = value.node.operands
        return _select(index, [as_node(function(drawn_option(option))) for option in options])
    return function(value)


def _coerce_boxed(value: Random, kind: Kind, function: Callable[..., Any], what: str) -> Any:
    """Coerce option by option where ``value`` is a choice, else when it is sampled."""
    if value.node.operation is TABLE["select"]:
        index, *options = value.node.operands
        return _select(index, [as_node(function(drawn_option(option), what)) for option in options])
    return _coerce_later(value, kind, function, what)


def _coerce_later(value: Random, kind: Kind, function: Callable[..., Any], what: str) -> Any:
    operation = Operation(
        f"to {kind.value}",
        always(kind),
        by_lane,
        "A coercion that has to wait for the sampled value.",
        python=lambda sampled: function(sampled, what),
    )
    return apply(operation, value)
