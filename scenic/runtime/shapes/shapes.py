"""The shapes of objects (section 9.1 of the specification): unit meshes with default dimensions."""

import math
import numbers
from collections.abc import Callable, Mapping
from dataclasses import field
from functools import cache, lru_cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final, TypeAlias

import numpy as np

from scenic.dataclass import dataclass
from scenic.graph import quaternions
from scenic.language.errors import Located, ScenicTypeError, ScenicValueError
from scenic.language.names import NAMES, NameKind
from scenic.runtime.geometry.containment.body_containment import contains_points
from scenic.runtime.geometry.meshes import primitives
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.loading import factor_of, load_mesh
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.meshes.solids import proper_volume
from scenic.runtime.geometry.poses import Floats, Poses
from scenic.runtime.ground.used_files import note_file
from scenic.runtime.values.random_base import RandomBase

Triple: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class ShapeSource:
    """The origin of the mesh of a shape, which a written scene refers to.

    Attributes:
        kind: ``box``, ``cylinder``, ``cone``, ``spheroid`` or ``mesh``.
        path: the mesh file, absolute; ``None`` for primitives and for meshes made in memory.
        parameters: what else selects the mesh: ``sections``, ``unify`` where not the default.
        initial_rotation: (yaw, pitch, roll) in radians, or ``None``.

    """

    kind: str
    path: str | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)
    initial_rotation: Triple | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return ShapeSource, (self.kind, self.path, dict(self.parameters), self.initial_rotation)

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain data for JSON; entries that say nothing are left out."""
        result: dict[str, Any] = {"kind": self.kind}
        if self.path is not None:
            result["path"] = self.path
        result.update(self.parameters)
        if self.initial_rotation is not None:
            result["initial_rotation"] = list(self.initial_rotation)
        return result


class Shape:
    """A closed volume modulo position, rotation and size; its front is +Y.

    Attributes:
        mesh: the unit mesh: centred on its bounding box, which is the unit cube.
        dimensions: the default (width, length, height) in metres of objects of this shape, without a random scale.
        source: where the mesh comes from.

    """

    _factor: Any = None
    """A random factor of the dimensions."""

    def __init__(self, mesh: Mesh, dimensions: Triple, source: ShapeSource) -> None:
        self.mesh: Final = mesh
        self.dimensions: Final = dimensions
        self.source: Final = source

    @property
    def width(self) -> Any:
        """Default extent along X; random if the scale is."""
        return self._extent(0)

    @property
    def length(self) -> Any:
        """Default extent along Y; random if the scale is."""
        return self._extent(1)

    @property
    def height(self) -> Any:
        """Default extent along Z; random if the scale is."""
        return self._extent(2)

    def _extent(self, axis: int) -> Any:
        size = self.dimensions[axis]
        return size if self._factor is None else size * self._factor

    def _scale_by(self, scale: object) -> Any:
        """Keep a random scale as the factor of the dimensions; returns the scale that is left."""
        if isinstance(scale, RandomBase):
            self._factor = scale
            return 1
        return scale

    @property
    def isConvex(self) -> bool:
        """Return whether the volume is convex."""
        return self.mesh.is_convex

    @property
    def containsCenter(self) -> bool:
        """Return whether the middle of the bounding box lies in the volume."""
        body = Body((self.mesh,), None, Poses.fixed(np.zeros(3), size=np.ones(3)))
        return bool(contains_points(body, np.zeros((1, 3)))[0])

    def __repr__(self) -> str:
        width, length, height = self.dimensions
        return f"{type(self).__name__}(dimensions=({width:g}, {length:g}, {height:g}))"


class PrimitiveShape(Shape):
    """A shape with a mesh that follows from a few numbers.

    Each class gives its ``kind``, which stands for it in files, and ``make``, the function that makes its mesh.
    """

    kind: ClassVar[str]
    make: ClassVar[Callable[..., Mesh]]

    def __init__(
        self,
        dimensions: object = (1, 1, 1),
        scale: object = 1,
        initial_rotation: object = None,
        **parameters: int,
    ) -> None:
        name = type(self).__name__
        rotation = _rotation(initial_rotation, name)
        scale = self._scale_by(scale)
        super().__init__(
            _primitive(self.make, rotation, **parameters),
            _scaled(_triple(dimensions, "dimensions", name), scale, name),
            ShapeSource(self.kind, parameters=MappingProxyType(parameters), initial_rotation=rotation),
        )


class BoxShape(PrimitiveShape):
    """A cuboid."""

    kind = "box"
    make = staticmethod(primitives.box)


class CylinderShape(PrimitiveShape):
    """A prism along Z over a regular polygon of ``sections`` corners."""

    kind = "cylinder"
    make = staticmethod(primitives.cylinder)

    def __init__(
        self,
        dimensions: object = (1, 1, 1),
        scale: object = 1,
        initial_rotation: object = None,
        sections: object = primitives.CYLINDER_SECTIONS,
    ) -> None:
        if not isinstance(sections, numbers.Integral):
            raise ScenicTypeError(
                f"CylinderShape needs a fixed whole number of sections, not {_described(sections)}"
            )
        if sections < 3:
            raise ScenicValueError(f"CylinderShape needs at least 3 sections, not {sections}")
        super().__init__(dimensions, scale, initial_rotation, sections=int(sections))


class ConeShape(PrimitiveShape):
    """A cone along Z, its apex up."""

    kind = "cone"
    make = staticmethod(primitives.cone)


class SpheroidShape(PrimitiveShape):
    """An ellipsoid, as a subdivided icosahedron."""

    kind = "spheroid"
    make = staticmethod(primitives.spheroid)


def primitive_of(kind: str) -> type[PrimitiveShape] | None:
    """Return the class of the primitive shapes of a kind; ``None`` if the language declares no such shape."""
    for declared in NAMES.values():
        if declared.kind is NameKind.SHAPE and declared.home is not None:
            module, _, name = declared.home.partition(":")
            cls = getattr(import_module(module), name)
            if isinstance(cls, type) and issubclass(cls, PrimitiveShape) and cls.kind == kind:
                return cls
    return None


class MeshShape(Shape):
    """The shape of a given mesh.

    Args:
        mesh: a `Mesh` or a ``trimesh.Trimesh`` that bounds a volume.
        dimensions: default (width, length, height); by default the extents of the mesh.
        scale: factor of the dimensions.
        initial_rotation: (yaw, pitch, roll) applied before the extents are measured.

    Raises:
        MeshError: the mesh is not a proper volume.

    """

    def __init__(
        self, mesh: object, dimensions: object = None, scale: object = 1, initial_rotation: object = None
    ) -> None:
        rotation = _rotation(initial_rotation, "MeshShape")
        solid = proper_volume(_as_mesh(mesh), unify=False)
        unit, extents = _measured(solid, rotation)
        self._finish(unit, extents, dimensions, scale, ShapeSource("mesh", initial_rotation=rotation))

    def _finish(
        self, unit: Mesh, extents: Triple, dimensions: object, scale: object, source: ShapeSource
    ) -> None:
        size = extents if dimensions is None else _triple(dimensions, "dimensions", "MeshShape")
        scale = self._scale_by(scale)
        super().__init__(unit, _scaled(size, scale, "MeshShape"), source)

    @classmethod
    def fromFile(
        cls,
        path: object,
        unify: bool = True,
        dimensions: object = None,
        scale: object = 1,
        initial_rotation: object = None,
        unit: str = "m",
    ) -> "MeshShape":
        """Return the shape in a mesh file; see `load_mesh`. Relative paths start from the current directory.

        A file read before and unchanged since is not read again.

        Args:
            path: the file.
            unify: whether bodies that overlap are united.
            dimensions: default (width, length, height) in metres; by default the extents of the mesh.
            scale: factor of the dimensions.
            initial_rotation: (yaw, pitch, roll) applied before the extents are measured.
            unit: the file's unit of length: ``m``, ``cm``, ``mm``, ``km``, ``in`` or ``ft``.

        Raises:
            MeshError: the file cannot be read, or its mesh is not a proper volume.
            ScenicValueError: the unit is unknown, or a dimension is not positive.

        """
        if not isinstance(path, str | Path):
            raise ScenicTypeError(f"MeshShape.fromFile needs a fixed path, not {_described(path)}")
        rotation = _rotation(initial_rotation, "MeshShape")
        metres = factor_of(unit, 1, "MeshShape.fromFile")
        note_file(path)
        mesh, (width, length, height) = _from_file(str(path), _stamp(Path(path)), bool(unify), rotation)
        extents = width * metres, length * metres, height * metres
        shape = cls.__new__(cls)
        parameters = MappingProxyType({} if unify else {"unify": False})
        source = ShapeSource("mesh", str(Path(path).absolute()), parameters, rotation)
        shape._finish(mesh, extents, dimensions, scale, source)
        return shape


@cache
def _primitive(make: Callable[..., Mesh], rotation: Triple | None, **parameters: int) -> Mesh:
    return _measured(make(**parameters), rotation)[0]


@lru_cache(maxsize=64)
def _from_file(
    path: str,
    stamp: tuple[str, int, int] | None,  # noqa: ARG001  # makes a changed file another entry of the cache
    unify: bool,
    rotation: Triple | None,
) -> tuple[Mesh, Triple]:
    """Return the unit mesh and the extents in the file."""
    return _measured(load_mesh(path, unify=unify), rotation)


def _stamp(path: Path) -> tuple[str, int, int] | None:
    try:
        status = path.stat()
    except OSError:
        return None  # reading the file says what is wrong with it
    return str(path.absolute()), status.st_mtime_ns, status.st_size


def _measured(mesh: Mesh, rotation: Triple | None) -> tuple[Mesh, Triple]:
    """The unit mesh after the rotation, and the extents before it is scaled."""
    if rotation is not None:
        mesh = mesh.moved(_exact_quarters(quaternions.to_matrix(quaternions.from_euler(*rotation))))
    unit, _, extents = mesh.normalized()
    width, length, height = extents.tolist()
    return unit, (width, length, height)


def _exact_quarters(matrix: Floats) -> Floats:
    """Return a rotation matrix with the entries 0 and ±1 freed from rounding: a box turned by 90° stays a box."""
    near = np.round(matrix)
    return np.where(np.abs(matrix - near) < 1e-15, near, matrix)


def _as_mesh(mesh: Any) -> Mesh:
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, RandomBase):
        raise ScenicTypeError(
            "MeshShape needs a fixed mesh, not a random one",
            help="make the whole shape in a function, `shape_of = distributionFunction(lambda x: MeshShape(...))`",
        )
    try:
        vertices, faces = mesh.vertices, mesh.faces
    except AttributeError:
        raise ScenicTypeError(
            f"MeshShape needs a mesh, not {_described(mesh)}",
            help="pass a `trimesh.Trimesh`, or load a file with `MeshShape.fromFile(path)`",
        ) from None
    return Mesh(vertices, faces)


def _rotation(value: object, name: str) -> Triple | None:
    return None if value is None else _triple(value, "initial_rotation", name)


def _triple(value: Any, what: str, name: str) -> Triple:
    try:
        items = tuple(value)
    except (TypeError, Located):
        items = ()
    if len(items) != 3:
        raise ScenicTypeError(f"{name} needs three fixed numbers as `{what}`, not {_described(value)}")
    x, y, z = (_number(item, what, name) for item in items)
    return x, y, z


def _scaled(dimensions: Triple, scale: object, name: str) -> Triple:
    factor = _number(scale, "scale", name)
    width, length, height = (factor * extent for extent in dimensions)
    if not min(width, length, height) > 0:
        raise ScenicValueError(
            f"the dimensions of {name} must be positive, not {(width, length, height)}",
            help="they are width, length and height in metres, times `scale`",
        )
    return width, length, height


def _number(value: object, what: str, name: str) -> float:
    if not isinstance(value, numbers.Real):
        raise ScenicTypeError(
            f"{name} needs a fixed number in `{what}`, not {_described(value)}",
            help="give objects a random `width`, `length` or `height` instead of a random shape",
        )
    number = float(value)
    if not math.isfinite(number):
        raise ScenicValueError(f"{name} needs finite numbers in `{what}`, not {number}")
    return number


def _described(value: object) -> str:
    return (
        f"`{value!r}`"
        if isinstance(value, str | int | float | tuple | list)
        else f"a value of type `{type(value).__name__}`"
    )
