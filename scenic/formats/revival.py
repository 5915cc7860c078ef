"""Scenes that were read back, with their meshes, so that pages, images and 3D files can be made of them."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenic.formats.mesh_files import ChangedMeshError, check_unchanged
from scenic.formats.reading import ReadObject, ReadScene
from scenic.formats.scene_protocols import Shape
from scenic.language.errors import Located, MeshError
from scenic.runtime.shapes.shapes import BoxShape, MeshShape, primitive_of
from scenic.runtime.values.values import Orientation, Vector


class RevivedObject:
    """An object of a revived scene; a class of its name is made for each class of the program."""

    def __init__(self, told: ReadObject, shape: Shape) -> None:
        self.position = Vector(*told.position)
        self.orientation = Orientation.of(told.quaternion)
        self.yaw, self.pitch, self.roll = told.euler
        self.width, self.length, self.height = told.size
        self.shape = shape
        self.properties = told.properties
        color = told.properties.get("color")
        self.color = tuple(color) if isinstance(color, list) else None


class RevivedScene:
    """A scene that was read back. Files of scenes do not contain a workspace."""

    workspace = None

    def __init__(self, told: ReadScene, objects: tuple[RevivedObject, ...]) -> None:
        self.seed = told.seed
        self.k = told.k
        self.attempts = told.attempts
        self.params = told.params
        self.objects = objects
        self.names = {
            revived: read.name
            for revived, read in zip(objects, told.objects, strict=True)
            if read.name is not None
        }
        self.egoObject = next(
            (revived for revived, read in zip(objects, told.objects, strict=True) if read is told.ego), None
        )

    def origin(self, thing: RevivedObject) -> "RevivedOrigin":
        """Return the facts about an object: the properties in its line."""
        return RevivedOrigin(thing)


class RevivedOrigin:
    """The properties of an object that was read back, all of which may differ from scene to scene."""

    fixed: frozenset[str] = frozenset()

    def __init__(self, thing: RevivedObject) -> None:
        self.names = self.given = tuple(sorted(thing.properties))

    def read(self, thing: RevivedObject, name: str) -> object:
        """Return the value of a property, as plain data."""
        return thing.properties[name]


class Revival:
    """Makes scenes that can be drawn of those that were read; each mesh is made once.

    Attributes:
        substituted: why forms are drawn as boxes: for each such form, what is missing.

    """

    def __init__(self) -> None:
        self.substituted: dict[str, str] = {}
        self._shapes: dict[str, Shape] = {}
        self._classes: dict[str, type[RevivedObject]] = {}

    def revive(self, scene: ReadScene) -> RevivedScene:
        """Return the scene with its meshes; where one cannot be had, the object's box stands for it (`substituted`).

        Raises ``ChangedMeshError`` where a mesh file is not the one that the scene was made with.
        """
        objects = tuple(self._class(item.kind)(item, self._shape(item.shape)) for item in scene.objects)
        return RevivedScene(scene, objects)

    def _class(self, name: str) -> type[RevivedObject]:
        if name not in self._classes:
            self._classes[name] = type(name, (RevivedObject,), {})
        return self._classes[name]

    def _shape(self, told: Mapping[str, object]) -> Shape:
        key = json.dumps(told, sort_keys=True)
        if key not in self._shapes:
            try:
                self._shapes[key] = _shape_of(told)
            except ChangedMeshError:
                raise
            except MeshError as error:
                self.substituted[key] = error.message
            except (Located, TypeError, ValueError) as error:
                self.substituted[key] = f"the form {key} is not known ({error})"
            if key in self.substituted:
                self._shapes[key] = BoxShape()
        return self._shapes[key]


def _shape_of(told: Mapping[str, Any]) -> Shape:
    """Return the shape of a ``shape`` entry of the file; raises ``MeshError`` where its mesh cannot be had."""
    fields = dict(told)
    kind = fields.pop("kind", None)
    if "initial_rotation" in fields:
        fields["initial_rotation"] = tuple(fields["initial_rotation"])
    primitive = primitive_of(str(kind))
    if primitive is not None:
        return primitive(**fields)
    if kind != "mesh":
        raise ValueError(f"no kind of form is called {kind!r}")
    path, sha256 = fields.pop("path", None), fields.pop("sha256", None)
    if path is None:
        raise MeshError("a mesh that the program itself made is not in the file")
    if sha256 is not None:
        check_unchanged(Path(path), sha256)
    return MeshShape.fromFile(path, **fields)


__all__ = ["Revival", "RevivedObject", "RevivedOrigin", "RevivedScene"]
