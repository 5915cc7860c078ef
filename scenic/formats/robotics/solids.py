"""Objects of a scene as physics reads them: names, poses, forms, masses, surfaces and cameras.

The writers of OpenUSD, MJCF and SDFormat share these facts, so that the files describe the same bodies.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.mesh_instances import PALETTE, category_of
from scenic.formats.poses import Four, Triple, quaternion_of
from scenic.formats.scene_cameras import Viewpoint, sensor_viewpoint
from scenic.formats.scene_protocols import Scene, SceneObject
from scenic.formats.textures import ImageTexture, placed_errors, texture_of
from scenic.language.errors import Located
from scenic.runtime.elements.sensors import CameraSensor
from scenic.runtime.geometry.meshes.primitives import round_share

__all__ = ["DENSITY", "Inertia", "Solid", "SolidError", "identifiers", "solids_of"]

Array = npt.NDArray[np.float64]

DENSITY: Final = 1000.0
"""Density of objects that have neither ``mass`` nor ``density``, kilograms per cubic metre."""

_ROUND: Final = 16
"""Prisms over polygons of fewer corners are not cylinders."""


class SolidError(Located):
    """An object that physics cannot have."""

    code = "SC504"


@dataclass(frozen=True, slots=True)
class Inertia:
    """Mass (kilograms), centre of mass ``(3,)`` (metres) and inertia about it ``(3, 3)`` (kg m²), in the object's frame."""

    mass: float
    center: Array
    matrix: Array


@dataclass(frozen=True, slots=True)
class Solid:
    """An object as physics reads it.

    Attributes:
        thing: the object.
        name: an identifier that no other object of the scene has.
        index: its number among the objects of the scene.
        position: its middle, metres.
        quaternion: its orientation ``(x, y, z, w)``.
        size: extents in its own frame, metres.
        form: ``box``, ``sphere``, ``ellipsoid``, ``cylinder``, ``cone`` (these along Z) or ``mesh``.
        is_static: whether it cannot be moved.
        inertia: its mass properties.
        friction: coefficient of friction; ``None`` if the object has none.
        restitution: coefficient of restitution, likewise.
        color: sRGB and opacity.
        texture: the image on it; ``None`` without one.
        cameras: its cameras.

    """

    thing: SceneObject
    name: str
    index: int
    position: Triple
    quaternion: Four
    size: Triple
    form: str
    is_static: bool
    inertia: Inertia
    friction: float | None
    restitution: float | None
    color: Four
    texture: ImageTexture | None
    cameras: tuple[Viewpoint, ...]

    @property
    def without_ellipsoid(self) -> "Solid":
        """The object for formats that have no ellipsoids: then it is a mesh."""
        return replace(self, form="mesh") if self.form == "ellipsoid" else self

    @property
    def mesh(self) -> Any:
        """The mesh in the unit box."""
        return self.thing.shape.mesh

    @property
    def touching_radius(self) -> float:
        """Radius of the cylinder or cone that touches others, metres: the widest within the mesh, by which collisions are decided."""
        share: float = self.mesh.derived(round_share)
        return share * self.size[0] / 2

    @property
    def class_name(self) -> str:
        """The name of its class."""
        return type(self.thing).__name__

    @property
    def category(self) -> str:
        """The class of the object in labels; see `category_of`."""
        return category_of(self.thing, self.class_name)

    @property
    def is_rendered(self) -> bool:
        """Return whether pictures show it."""
        return bool(self.thing.properties.get("render", True))

    @property
    def collides(self) -> bool:
        """Return whether others bounce off it."""
        return bool(self.thing.properties.get("collides", True))


def solids_of(scene: Scene) -> tuple[Solid, ...]:
    """The objects of a scene, in its order; those without a size are left out.

    Raises:
        SolidError: an object has a mass, friction or restitution that it cannot have.
        TextureError: an object has a texture that there is not.

    """
    things = [
        (number, thing)
        for number, thing in enumerate(scene.objects)
        if min(float(thing.width), float(thing.length), float(thing.height)) > 0
    ]
    names = identifiers(_label(scene, thing) for _, thing in things)
    folder: Path | None = getattr(scene, "folder", None)
    with placed_errors(scene):
        return tuple(
            _solid(scene, number, thing, name, folder)
            for (number, thing), name in zip(things, names, strict=True)
        )


def identifiers(labels: Iterator[str]) -> list[str]:
    """Names of letters, digits and underscores, each once, that resemble the labels."""
    names: dict[str, None] = {}
    for label in labels:
        base = re.sub(r"\W", "_", label, flags=re.ASCII) or "thing"
        base = f"_{base}" if base[0].isdigit() else base
        name, count = base, 1
        while name in names:
            count += 1
            name = f"{base}_{count}"
        names[name] = None
    return list(names)


def _label(scene: Scene, thing: SceneObject) -> str:
    return scene.names.get(thing) or ("ego" if thing is scene.egoObject else type(thing).__name__)


def _solid(scene: Scene, number: int, thing: SceneObject, name: str, folder: Path | None) -> Solid:
    x, y, z = (float(value) for value in thing.position)
    size = (float(thing.width), float(thing.length), float(thing.height))
    color = _color(thing, number)
    texture = texture_of(thing.properties.get("texture"), color, folder)
    try:
        inertia = _inertia(thing, size)
        friction, restitution = (_coefficient(thing, key) for key in ("friction", "restitution"))
    except SolidError as error:
        if hasattr(scene, "place"):
            error.at(scene.place(number))
        raise
    return Solid(
        thing=thing,
        name=name,
        index=number,
        position=(x, y, z),
        quaternion=quaternion_of(thing),
        size=size,
        form=_form(thing, size),
        # Things with joints are written as they stand.
        is_static=thing.properties.get("dynamics", "point") in ("static", "articulated", "link"),
        inertia=inertia,
        friction=friction,
        restitution=restitution,
        color=color,
        texture=texture if isinstance(texture, ImageTexture) else None,
        cameras=tuple(_cameras(thing)),
    )


def _color(thing: SceneObject, number: int) -> Four:
    if thing.color is None:
        return (*PALETTE[number % len(PALETTE)], 1.0)
    red, green, blue, *alpha = (float(value) for value in thing.color)
    return red, green, blue, alpha[0] if alpha else 1.0


def _form(thing: SceneObject, size: Triple) -> str:
    """Return the form that describes the shape at its size exactly, else ``mesh``."""
    data = thing.shape.source.as_dict()
    if "initial_rotation" in data:
        return "mesh"
    width, length, height = size
    match data["kind"]:
        case "box":
            return "box"
        case "spheroid":
            return "sphere" if width == length == height else "ellipsoid"
        case "cylinder" if width == length and int(data.get("sections", _ROUND)) >= _ROUND:
            return "cylinder"
        case "cone" if width == length:
            return "cone"
    return "mesh"


def _cameras(thing: SceneObject) -> Iterator[Viewpoint]:
    sensors = thing.properties.get("sensors")
    if isinstance(sensors, Mapping):
        for name, sensor in sensors.items():
            if isinstance(sensor, CameraSensor):
                yield sensor_viewpoint(str(name), thing, sensor)


def _coefficient(thing: SceneObject, name: str) -> float | None:
    value = thing.properties.get(name)
    if value is None:
        return None
    limit = 1.0 if name == "restitution" else 100.0
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= limit:
        raise SolidError(
            f"the {name} of {thing!r} must be a number from 0 to {limit:g}, not {value!r}",
            help="friction 0 is ice, 1 is rubber; restitution 0 does not bounce, 1 loses nothing",
        )
    return float(value)


def _inertia(thing: SceneObject, size: Triple) -> Inertia:
    """Return mass properties of the whole mesh at its size, of one density."""
    mesh: Any = thing.shape.mesh
    volume, center, moments = mesh.derived(_moments) if hasattr(mesh, "derived") else _moments(mesh)
    scale = np.array(size)
    volume *= float(np.prod(scale))
    mass = _given_mass(thing, volume)
    # Second moments scale by both of their axes, and with the volume.
    second = moments * np.outer(scale, scale) * mass
    return Inertia(mass, center * scale, np.trace(second) * np.eye(3) - second)


def _given_mass(thing: SceneObject, volume: float) -> float:
    for name, factor in (("mass", 1.0), ("density", volume)):
        value = thing.properties.get(name)
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
            raise SolidError(
                f"the {name} of {thing!r} must be a positive number, not {value!r}",
                help="`mass` is in kilograms, `density` in kilograms per cubic metre; for what cannot be moved "
                "write `with dynamics 'static'`",
            )
        return float(value) * factor
    return DENSITY * volume


def _moments(mesh: Any) -> tuple[float, Array, Array]:
    """Return the volume of a closed mesh, its centre of mass ``(3,)``, and second moments about it ``(3, 3)``, divided by the volume.

    A sum over the tetrahedra between the origin and each face (F. Tonon, "Explicit exact formulas for the 3-D tetrahedron inertia
    tensor", 2004).
    """
    corners = np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.faces)]
    parts = np.linalg.det(corners) / 6
    volume = float(parts.sum())
    sums = corners.sum(axis=1)
    center = np.einsum("f,fx->x", parts, sums) / 4 / volume
    second = np.einsum("f,fcx,fcy->xy", parts, corners, corners) + np.einsum("f,fx,fy->xy", parts, sums, sums)
    return volume, center, second / 20 / volume - np.outer(center, center)
