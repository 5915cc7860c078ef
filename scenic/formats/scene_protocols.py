"""The parts of scenes that writers need: structural types that the runtime's scenes and objects satisfy."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt


class UnitMesh(Protocol):
    """A closed triangle mesh scaled to the unit box."""

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """Corners, shape ``(v, 3)``, every coordinate in ``[-0.5, 0.5]``."""

    @property
    def faces(self) -> npt.NDArray[np.integer[Any]]:
        """Triangles as indices of corners, shape ``(f, 3)``, anticlockwise seen from outside."""


class ShapeSource(Protocol):
    """The origin of a shape."""

    def as_dict(self) -> dict[str, Any]:
        """Return plain data: ``kind``, and what else selects the mesh."""


class Shape(Protocol):
    """The form of an object, without its size and place."""

    @property
    def mesh(self) -> UnitMesh: ...

    @property
    def source(self) -> ShapeSource: ...


class Quaternion(Protocol):
    """A rotation; the scalar part is ``w``."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def z(self) -> float: ...
    @property
    def w(self) -> float: ...


class SceneObject(Protocol):
    """An object of a scene with all of its values drawn."""

    @property
    def position(self) -> Iterable[float]:
        """Metres: X east, Y north, Z up."""

    @property
    def orientation(self) -> Quaternion: ...
    @property
    def yaw(self) -> float: ...
    @property
    def pitch(self) -> float: ...
    @property
    def roll(self) -> float: ...
    @property
    def width(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def height(self) -> float: ...
    @property
    def shape(self) -> Shape: ...
    @property
    def color(self) -> Sequence[float] | None: ...
    @property
    def properties(self) -> Mapping[str, object]: ...


class Origin(Protocol):
    """The description of an object in all scenes of its program."""

    @property
    def names(self) -> Sequence[str]:
        """All its properties, sorted."""

    @property
    def given(self) -> Sequence[str]:
        """The properties that the program gives, sorted; the others have the defaults of the language."""

    @property
    def fixed(self) -> frozenset[str]:
        """The properties that are the same in every scene."""

    def read(self, thing: Any, name: str) -> object:
        """Return the value of a property of the object in one scene."""


class Scene(Protocol):
    """A sampled scene."""

    def origin(self, thing: Any) -> Origin:
        """Return the description of an object of the scene in all scenes."""

    @property
    def seed(self) -> int: ...
    @property
    def k(self) -> int:
        """The number of the scene among those of its seed, from 0."""

    @property
    def attempts(self) -> int:
        """Number of candidates that were drawn until this one met every requirement."""

    @property
    def params(self) -> Mapping[str, object]: ...
    @property
    def objects(self) -> Sequence[SceneObject]:
        """The ego first, when there is one."""

    @property
    def egoObject(self) -> SceneObject | None: ...
    @property
    def workspace(self) -> object:
        """The region in which all objects have to be; anything else where there is none."""

    @property
    def names(self) -> Mapping[Any, str]:
        """The names of the program's variables that hold objects, as far as they are known."""
