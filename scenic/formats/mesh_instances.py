"""A scene as a picture needs it: triangle meshes, each used at several places, sizes and colours.

The meshes are shared by all objects and scenes that use them. Their corners carry normals, so that round things
look round and edges stay sharp.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final, cast

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.lamps import COLORS, lamp_form, shown_colors
from scenic.formats.mesh_coordinates import coordinates_of
from scenic.formats.painted_solids import Appearance
from scenic.formats.poses import Four, Triple, quaternion_of, rotation_matrix
from scenic.formats.road_users import AppearanceError, appearance_of
from scenic.formats.scene_protocols import Scene, SceneObject, UnitMesh
from scenic.runtime.geometry.patches import Lamp, Patch
from scenic.runtime.regions.spaces import Workspace

Array = npt.NDArray[np.float64]

PALETTE: tuple[Triple, ...] = (
    (0.36, 0.54, 0.74),
    (0.87, 0.60, 0.33),
    (0.44, 0.66, 0.45),
    (0.76, 0.45, 0.47),
    (0.58, 0.50, 0.73),
    (0.65, 0.54, 0.45),
    (0.82, 0.60, 0.74),
    (0.55, 0.60, 0.62),
    (0.75, 0.72, 0.40),
    (0.38, 0.68, 0.71),
)
"""Colours of objects that have none of their own: one for each class, in order of appearance, or for each plain object."""

_SHADES = (1.0, 0.72, 1.12, 0.86, 0.6)
"""Brightness of successive objects of one class, so that neighbours can be distinguished."""

_PLAIN: Final = "Object"
"""The class of objects that have no class of their own."""

_LOW: Final = 0.75
"""Height of objects on maps, in parts of their shorter side: that of a car."""

CREASE = np.cos(np.radians(35))
"""Faces that meet at a smaller angle are shaded as one smooth surface."""


@dataclass(frozen=True, slots=True)
class MeshSurface:
    """A mesh in the unit box with a normal for every corner; corners at sharp edges occur several times.

    ``vertices`` and ``normals`` have shape ``(v, 3)``, ``faces`` ``(f, 3)``. ``paints``, ``(v, 3)``, are the colours in sRGB of
    corners that do not take the object's colour, NaN for those that do; all corners of a face have the same one. ``None`` where
    everything takes the object's colour.
    """

    vertices: Array
    normals: Array
    faces: npt.NDArray[np.int64]
    paints: Array | None = None
    _known: dict[str, npt.NDArray[np.float32] | None] = field(default_factory=dict, repr=False, compare=False)

    def coordinates(self, source: Mapping[str, object]) -> npt.NDArray[np.float32] | None:
        """Return texture coordinates of its triangles ``(f, 3, 2)``, found once; see `coordinates_of`."""
        key = repr(source)
        if key not in self._known:
            self._known[key] = coordinates_of(source, self.vertices, self.faces)
        return self._known[key]

    def face_paints(self) -> Array | None:
        """Return the colours of faces, ``(f, 3)``, as ``paints`` has them for corners."""
        return None if self.paints is None else self.paints[self.faces[:, 0]]

    def painted(self) -> list[tuple[Triple | None, npt.NDArray[np.int64]]]:
        """The faces ``(f, 3)`` of each colour of its own, and those of the object's colour with ``None``; none is empty."""
        paints = self.face_paints()
        if paints is None:
            return [(None, self.faces)]
        # Not a number is not equal to itself, but -1 is.
        colors, number = np.unique(np.nan_to_num(paints, nan=-1.0), axis=0, return_inverse=True)
        return [
            (None if red < 0 else (red, green, blue), self.faces[number.reshape(-1) == k])
            for k, (red, green, blue) in enumerate(colors.tolist())
        ]


def category_of(thing: SceneObject, class_name: str) -> str:
    """Return the class of an object in labels: its property ``category`` where that is text, else the name of its class."""
    value = thing.properties.get("category")
    return value if isinstance(value, str) and value else class_name


@dataclass(frozen=True, slots=True)
class MeshInstance:
    """One object as it is drawn: a surface with a place, a rotation ``(x, y, z, w)``, a size and a colour."""

    surface: int
    thing: SceneObject
    name: str | None
    class_name: str
    position: Triple
    quaternion: Four
    size: Triple
    color: Four
    is_ego: bool
    folder: Path | None = None
    """Folder where paths of images start."""

    @property
    def category(self) -> str:
        """The class of the object in labels; see `category_of`."""
        return category_of(self.thing, self.class_name)

    @property
    def label(self) -> str:
        """The variable's name where it is known, else the object's class in labels."""
        return self.name or ("ego" if self.is_ego else self.category)

    def matrix(self) -> Array:
        """Return the matrix, shape ``(4, 4)``, that takes the unit box to the object."""
        matrix = np.eye(4)
        matrix[:3, :3] = rotation_matrix(self.quaternion) * np.asarray(self.size)
        matrix[:3, 3] = self.position
        return matrix


@dataclass(frozen=True, slots=True)
class GroundPiece:
    """A part of the ground as it is drawn, in the place where it is: a surface and a colour.

    Of pieces that overlap, the one with the largest ``layer`` is on top. ``is_flat`` tells whether it lies wherever the ground of
    the picture is.
    """

    surface: int
    color: Four
    layer: int
    is_flat: bool


@dataclass(frozen=True, slots=True)
class Picture:
    """Scenes as drawn: the surfaces they share, the instances of each scene, its parameters, the ground under them, lights and signs."""

    surfaces: tuple[MeshSurface, ...]
    scenes: tuple[tuple[MeshInstance, ...], ...]
    params: tuple[Mapping[str, object], ...]
    grounds: tuple[tuple[GroundPiece, ...], ...]
    lamps: tuple[tuple[MeshInstance, ...], ...] = ()


class _Stand:
    """The object of an instance that is not one of the scene: it has no properties."""

    properties: Final[Mapping[str, object]] = MappingProxyType({})


KeyedLamp = tuple[str, MeshInstance]
"""A light or a sign with the key of its colour."""


def lit(lamps: Iterable[KeyedLamp], colors: Mapping[str, str]) -> tuple[MeshInstance, ...]:
    """Return lamps in the colours of a moment, by their keys."""
    return tuple(replace(item, color=(*COLORS[colors.get(key, "off")], 1.0)) for key, item in lamps)


class MeshSurfaces:
    """The surfaces of meshes at sizes, of which those used last are kept."""

    _MOST: Final = 256

    def __init__(self) -> None:
        # The mesh is kept beside its surface: its identity stays taken while the entry lives.
        self._known: dict[tuple[int, Triple], tuple[UnitMesh | Appearance, MeshSurface]] = {}

    def of(self, mesh: UnitMesh | Appearance, size: Triple) -> MeshSurface:
        """Return the surface of a mesh that is used at a size."""
        found = self._known.pop((id(mesh), size), None) or (mesh, surface_of(mesh, size))
        self._known[id(mesh), size] = found
        if len(self._known) > self._MOST:
            del self._known[next(iter(self._known))]
        return found[1]


class Gallery:
    """Collects scenes to be drawn, one by one; it keeps what is drawn of them and not the scenes.

    Args:
        classes: the classes whose colours come first, in this order.
        surfaces: what is known of meshes already.

    """

    def __init__(self, classes: Iterable[str] = (), surfaces: MeshSurfaces | None = None) -> None:
        self._made = MeshSurfaces() if surfaces is None else surfaces
        self._surfaces: list[MeshSurface] = []
        # The mesh is kept beside its number: its identity stays taken while the table lives.
        self._known: dict[int, tuple[UnitMesh | Appearance, int]] = {}
        self._patches: dict[int, tuple[Patch, GroundPiece]] = {}
        self._colors: dict[str, Triple] = {}
        for name in classes:
            if name != _PLAIN:
                self._class_color(name)

    @property
    def classes(self) -> tuple[str, ...]:
        """The classes that have colours, in order."""
        return tuple(self._colors)

    @property
    def surfaces(self) -> tuple[MeshSurface, ...]:
        """The meshes of all scenes added so far."""
        return tuple(self._surfaces)

    def add(self, scene: Scene) -> tuple[MeshInstance, ...]:
        """Add a scene: all objects but those with ``render`` false and those of no size.

        Raises `AppearanceError`, at the object's place where the scene knows it, for an unknown appearance.
        """
        instances = []
        names = scene.names
        # Scenes that were read back do not know where their program was.
        folder: Path | None = getattr(scene, "folder", None)
        shades: Counter[str] = Counter()
        for number, thing in enumerate(scene.objects):
            class_name = type(thing).__name__
            size = (float(thing.width), float(thing.length), float(thing.height))
            if not thing.properties.get("render", True) or min(size) <= 0:
                continue
            x, y, z = (float(value) for value in thing.position)
            default = self._default_color(class_name, shades[class_name])
            shades[class_name] += thing.color is None
            instances.append(
                MeshInstance(
                    surface=self.number(_appearance(scene, number) or thing.shape.mesh, size),
                    thing=thing,
                    name=names.get(thing),
                    class_name=class_name,
                    position=(x, y, z),
                    quaternion=quaternion_of(thing),
                    size=size,
                    color=_color(thing, default),
                    is_ego=thing is scene.egoObject,
                    folder=folder,
                )
            )
        return tuple(instances)

    def ground(self, workspace: object, places: Array) -> tuple[GroundPiece, ...]:
        """Return the pieces that a workspace shows under objects at places ``(n, 3)``."""
        if not isinstance(workspace, Workspace) or not len(places):
            return ()
        return tuple(self._piece(patch) for patch in workspace.patches(places))

    def lamps(self, workspace: object, places: Array) -> tuple["KeyedLamp", ...]:
        """Return the lights and signs that a workspace shows around places ``(n, 3)``, switched off."""
        around = getattr(workspace, "lamps", None)
        if around is None or not len(places):
            return ()
        return tuple(self._lamp(lamp) for lamp in around(places))

    def _lamp(self, lamp: Lamp) -> "KeyedLamp":
        x, y, z = lamp.position
        half = 0.5 * lamp.yaw
        instance = MeshInstance(
            surface=self.number(lamp_form(lamp.form), lamp.size),
            thing=cast("SceneObject", _Stand()),
            name=None,
            class_name=lamp.form,
            position=(x, y, z + 0.5 * lamp.size[2]),
            quaternion=(0.0, 0.0, math.sin(half), math.cos(half)),
            size=lamp.size,
            color=(*COLORS["off"], 1.0),
            is_ego=False,
        )
        return lamp.key, instance

    def _piece(self, patch: Patch) -> GroundPiece:
        known = self._patches.get(id(patch))
        if known is None:
            normals = np.tile([0.0, 0.0, 1.0], (len(patch.vertices), 1))
            self._surfaces.append(MeshSurface(patch.vertices, normals, patch.faces))
            piece = GroundPiece(len(self._surfaces) - 1, (*patch.color, 1.0), patch.layer, patch.is_flat)
            known = self._patches[id(patch)] = (patch, piece)
        return known[1]

    def _default_color(self, class_name: str, number: int) -> Triple:
        """Return the colour of an object that has none, by its number among those of its class in the scene.

        A class has one colour in several shades; of plain objects, which have no class of their own, each has another colour.
        """
        if class_name == _PLAIN:
            # From the end, since classes take theirs from the beginning.
            base, shade = PALETTE[-1 - number % len(PALETTE)], number // len(PALETTE)
        else:
            base = self._class_color(class_name)
            shade = number
        bright = _SHADES[shade % len(_SHADES)]
        return base[0] * bright, base[1] * bright, base[2] * bright

    def _class_color(self, class_name: str) -> Triple:
        return self._colors.setdefault(class_name, PALETTE[len(self._colors) % len(PALETTE)])

    def number(self, mesh: UnitMesh | Appearance, size: Triple) -> int:
        """The number of the surface of a mesh; its first use decides about its edges."""
        if id(mesh) not in self._known:
            self._known[id(mesh)] = (mesh, len(self._surfaces))
            self._surfaces.append(self._made.of(mesh, size))
        return self._known[id(mesh)][1]


def _appearance(scene: Scene, number: int) -> Appearance | None:
    """The appearance of an object, with the object's place in errors."""
    try:
        return appearance_of(scene.objects[number])
    except AppearanceError as error:
        place = getattr(scene, "place", None)
        if place is not None:
            error.at(place(number))
        raise


def picture(scenes: Iterable[Scene], *, ground: bool = False) -> Picture:
    """Return the picture of the scenes; with what their workspaces show under the objects if ``ground``."""
    gallery = Gallery()
    instances_of_scenes, params, grounds, lamps = [], [], [], []
    for scene in scenes:
        instances_of_scenes.append(gallery.add(scene))
        params.append(scene.params)
        places = places_of(instances_of_scenes[-1] if ground else ())
        grounds.append(gallery.ground(scene.workspace, places))
        lamps.append(lit(gallery.lamps(scene.workspace, places), shown_colors(scene)))
    return Picture(gallery.surfaces, tuple(instances_of_scenes), tuple(params), tuple(grounds), tuple(lamps))


def resting(instances: Sequence[MeshInstance]) -> tuple[MeshInstance, ...]:
    """Return objects of the 2D mode as they are shown on a map: no higher than cars are, and on the ground.

    That mode gives objects the height of their longest side, and puts their middles on the plane. Those with an appearance
    are as high as what they look like, if their own height is that of the mode.
    """
    return tuple(
        replace(instance, size=(*instance.size[:2], height), position=(x, y, z + height / 2))
        if getattr(instance.thing, "_planar", False)
        else instance
        for instance in instances
        for x, y, z in [instance.position]
        for height in [_shown_height(instance)]
    )


def _shown_height(instance: MeshInstance) -> float:
    width, length, height = instance.size
    appearance = appearance_of(instance.thing)
    if appearance is None:
        return min(height, _LOW * min(width, length))
    return appearance.size[2] if height == max(width, length) else height


def places_of(instances: Iterable[MeshInstance]) -> Array:
    """Return the positions of instances, ``(n, 3)``."""
    return np.array([instance.position for instance in instances], dtype=np.float64).reshape(-1, 3)


def distinct_labels(instances: Iterable[MeshInstance]) -> list[str]:
    """A name for each instance that no other has: its label, with a number from the second use on."""
    names: dict[str, None] = {}
    for instance in instances:
        name, count = instance.label, 1
        while name in names:
            count += 1
            name = f"{instance.label} {count}"
        names[name] = None
    return list(names)


def _color(thing: SceneObject, default: Triple) -> Four:
    if thing.color is None:
        return (*default, 1.0)
    red, green, blue, *alpha = (float(value) for value in thing.color)
    return (red, green, blue, alpha[0] if alpha else 1.0)


def surface_of(mesh: UnitMesh | Appearance, size: Triple) -> MeshSurface:
    """Return the mesh with normals that are shared across smooth edges and split at sharp ones.

    ``size`` is a size the mesh is used at: angles between faces are those of the mesh at that size. The normals are
    in the unit box, as the vertices are.
    """
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    faces = np.asarray(mesh.faces, dtype=np.int64)
    flat, area = _face_normals(vertices * size, faces)
    corner_normals = _smooth(vertices, faces, flat, area)
    # At the given size a normal n is n * size in the unit box (the inverse transpose of the scaling).
    unit = corner_normals * size
    unit /= np.maximum(np.linalg.norm(unit, axis=1, keepdims=True), 1e-30)
    columns = [faces.reshape(-1), np.round(unit * 1024).astype(np.int64)]
    paints = np.repeat(mesh.paints, 3, axis=0) if isinstance(mesh, Appearance) else None
    if paints is not None:
        columns.append(np.nan_to_num(paints * 255, nan=-1.0).astype(np.int64))
    _, first, index = np.unique(np.column_stack(columns), axis=0, return_index=True, return_inverse=True)
    return MeshSurface(
        vertices[faces.reshape(-1)[first]],
        unit[first],
        index.reshape(-1, 3).astype(np.int64),
        None if paints is None else paints[first],
    )


def _face_normals(vertices: Array, faces: npt.NDArray[np.int64]) -> tuple[Array, Array]:
    """Return unit normals and areas of the faces."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    return normal / np.maximum(length, 1e-30)[:, None], length / 2


def _smooth(vertices: Array, faces: npt.NDArray[np.int64], flat: Array, area: Array) -> Array:
    """For every corner of every face, the mean normal of the faces round it that are smooth with this one.

    Returns shape ``(3 f, 3)``; faces weigh by their area.
    """
    import scipy.sparse

    count = len(faces)
    corners = faces.reshape(-1)
    owner = np.repeat(np.arange(count), 3)
    # Pairs of (corner of a face, face at the same vertex): a product of two incidence matrices.
    at_vertex = scipy.sparse.csr_array((np.ones(3 * count), (corners, owner)), shape=(len(vertices), count))
    pairs = at_vertex[corners].tocoo()
    corner, other = pairs.coords
    smooth = np.einsum("ij,ij->i", flat[owner[corner]], flat[other]) > CREASE
    corner, other = corner[smooth], other[smooth]
    weighted_normals = flat[other] * area[other, None]
    total = np.column_stack([np.bincount(corner, weighted_normals[:, axis], 3 * count) for axis in range(3)])
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 1e-30, total / np.maximum(length, 1e-30), flat[owner])
