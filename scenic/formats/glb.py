"""A scene as binary glTF 2.0 (``.glb``), which 3D programs and browsers read.

Each object is a node with a name, a place, a rotation and a size; objects of one shape and colour share one mesh. One node
above them turns Scenic's Z up into glTF's Y up. Class, name and index of each object are in the node's ``extras``.
"""

import json
import math
import struct
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.image_coordinates import image_coordinates
from scenic.formats.mesh_instances import MeshInstance, MeshSurface, distinct_labels, picture
from scenic.formats.poses import Four, Triple
from scenic.formats.scene_cameras import viewpoints
from scenic.formats.scene_protocols import Scene
from scenic.formats.scenery import scenery_of
from scenic.formats.textures import ImageTexture, placed_errors, texture_of
from scenic.graph import quaternions

_FLOAT: Final = 5126
_UINT16: Final = 5123
_UINT32: Final = 5125
_ARRAY_BUFFER: Final = 34962
_ELEMENT_BUFFER: Final = 34963
_REPEAT: Final = 10497
_LIGHTS: Final = "KHR_lights_punctual"
_SUNLIGHT: Final = 3.0
"""Strength of the usual sun; viewers take glTF's lux for brightness."""
_QUARTER: Final = (0.5**0.5, 0.0, 0.0, 0.5**0.5)
"""A quarter turn about X."""


def glb(scene: Scene) -> bytes:
    """Return the scene as the content of a ``.glb`` file."""
    scene_picture = picture([scene])
    buffers = _Buffers()
    primitives = [buffers.surface(surface) for surface in scene_picture.surfaces]
    looks = _Looks(buffers)
    meshes: dict[object, int] = {}
    mesh_list: list[dict[str, Any]] = []
    nodes: list[dict[str, Any]] = []
    names = distinct_labels(scene_picture.scenes[0])
    for index, instance in enumerate(scene_picture.scenes[0]):
        with placed_errors(scene):
            texture = texture_of(instance.thing.properties.get("texture"), instance.color, instance.folder)
            image = texture if isinstance(texture, ImageTexture) else None
            # An image covers objects of each size in its own way.
            identity = (id(instance.thing),) if image is not None else ()
            key = (instance.surface, instance.color, *identity)
            if key not in meshes:
                meshes[key] = len(mesh_list)
                parts = (
                    primitives[instance.surface]
                    if image is None
                    else [(None, buffers.covered(scene_picture.surfaces[instance.surface], instance, image))]
                )
                mesh_list.append(
                    {
                        "primitives": [
                            {**part, "material": looks.material(color, image)}
                            for paint, part in parts
                            for color in [instance.color if paint is None else (*paint, instance.color[3])]
                        ]
                    }
                )
        nodes.append(_node(instance, index, meshes[key], names[index]))
    cameras, lights = _cameras(scene, nodes), _sun(scene, nodes)
    # A quarter turn about X: Z up becomes Y up, and north (Y) becomes -Z, which is ahead in glTF.
    root: dict[str, Any] = {"name": "scene", "rotation": [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]}
    if nodes:
        root["children"] = list(range(len(nodes)))
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "Scenic", "extras": {"seed": scene.seed, "k": scene.k}},
        "scene": 0,
        "scenes": [{"nodes": [len(nodes)]}],
        "nodes": [*nodes, root],
    }
    if mesh_list:
        document |= {
            "meshes": mesh_list,
            **looks.document(),
            "accessors": buffers.accessors,
            "bufferViews": buffers.views,
            "buffers": [{"byteLength": len(buffers.data)}],
        }
    if cameras:
        document["cameras"] = cameras
    if lights:
        document["extensionsUsed"] = [_LIGHTS]
        document["extensions"] = {_LIGHTS: {"lights": lights}}
    return _container(json.dumps(document, separators=(",", ":")).encode(), bytes(buffers.data))


def _cameras(scene: Scene, nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the cameras of a scene, whose nodes are added; they look along -Z of their nodes, with +Y up."""
    cameras: list[dict[str, Any]] = []
    for viewpoint in viewpoints(scene):
        across, upward = viewpoint.camera.tangents
        lens = {"yfov": 2 * math.atan(upward), "aspectRatio": across / upward, "znear": 0.01}
        nodes.append(
            {
                "name": viewpoint.name,
                "camera": len(cameras),
                "translation": viewpoint.camera.eye.tolist(),
                "rotation": _normalized(tuple(_product(viewpoint.quaternion, _QUARTER))),
                "extras": {"width": viewpoint.size[0], "height": viewpoint.size[1]},
            }
        )
        cameras.append({"name": viewpoint.name, "type": "perspective", "perspective": lens})
    return cameras


def _sun(scene: Scene, nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the sun of a scene whose parameters tell of it, whose node is added; it shines along -Z of its node."""
    if not isinstance(scene.params.get("lighting"), Mapping):
        return []
    scenery = scenery_of(scene.params)
    x, y, z = (float(part) for part in scenery.sun)
    # The shortest rotation that takes +Z to the direction towards the sun, which is above the ground.
    turn = _normalized((-y, x, 0.0, 1.0 + z))
    nodes.append({"name": "sun", "rotation": turn, "extensions": {_LIGHTS: {"light": 0}}})
    lux = _SUNLIGHT * scenery.sunlight * scenery.exposure
    return [{"name": "sun", "type": "directional", "intensity": lux, "color": [1.0, 0.96, 0.9]}]


def _product(p: object, q: object) -> npt.NDArray[np.float64]:
    """Return the product of two quaternions ``(x, y, z, w)``."""
    return np.asarray(quaternions.multiply(np.asarray(p, np.float64), np.asarray(q, np.float64)))


def _node(instance: MeshInstance, index: int, mesh: int, name: str) -> dict[str, Any]:
    """Return the node of an object."""
    return {
        "name": name,
        "mesh": mesh,
        "translation": list(instance.position),
        "rotation": _normalized(instance.quaternion),
        "scale": list(instance.size),
        "extras": {"class": instance.class_name, "index": index, "ego": instance.is_ego},
    }


def _normalized(quaternion: tuple[float, ...]) -> list[float]:
    values = np.asarray(quaternion)
    return [float(value) for value in values / np.linalg.norm(values)]


def _material(color: Four) -> dict[str, Any]:
    red, green, blue, alpha = color
    material: dict[str, Any] = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(_linear(value) for value in (red, green, blue)), alpha],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,
        }
    }
    if alpha < 1:
        material["alphaMode"] = "BLEND"
    return material


def _linear(value: float) -> float:
    """Return an sRGB component as linear light, which is what glTF's factors are (IEC 61966-2-1)."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


class _Looks:
    """Materials and images."""

    def __init__(self, buffers: "_Buffers") -> None:
        self._buffers = buffers
        self._materials: dict[object, int] = {}
        self._list: list[dict[str, Any]] = []
        self._images: dict[str, int] = {}
        self._image_list: list[dict[str, Any]] = []

    def material(self, color: Four, image: ImageTexture | None) -> int:
        """The number of the material of a colour, or of an image."""
        digest = None if image is None else image.digest()
        key = (color, digest)
        if key not in self._materials:
            self._materials[key] = len(self._list)
            material = _material(color)
            if image is not None and digest is not None:
                factors = material["pbrMetallicRoughness"]
                factors["baseColorFactor"] = [1.0, 1.0, 1.0, color[3]]  # the image is multiplied with it
                factors["baseColorTexture"] = {"index": self._image(image, digest)}
            self._list.append(material)
        return self._materials[key]

    def _image(self, image: ImageTexture, digest: str) -> int:
        if digest not in self._images:
            self._images[digest] = len(self._image_list)
            content = image.path.read_bytes()
            kind = "image/png" if content.startswith(b"\x89PNG") else "image/jpeg"
            self._image_list.append({"bufferView": self._buffers.view(content), "mimeType": kind})
        return self._images[digest]

    def document(self) -> dict[str, Any]:
        """Return the parts of the document."""
        if not self._image_list:
            return {"materials": self._list}
        return {
            "materials": self._list,
            "images": self._image_list,
            "textures": [{"source": number, "sampler": 0} for number in range(len(self._image_list))],
            "samplers": [{"wrapS": _REPEAT, "wrapT": _REPEAT}],
        }


class _Buffers:
    """The binary part and its descriptions."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def surface(self, surface: MeshSurface) -> list[tuple[Triple | None, dict[str, Any]]]:
        """Store a surface; returns the primitives that use it, without a material, with their colours if they have their own."""
        vertices = surface.vertices.astype("<f4")
        positions = self._add(vertices, "VEC3", _FLOAT, _ARRAY_BUFFER)
        # Limits are required of positions.
        self.accessors[positions] |= {
            "min": vertices.min(axis=0).tolist(),
            "max": vertices.max(axis=0).tolist(),
        }
        normals = self._add(surface.normals.astype("<f4"), "VEC3", _FLOAT, _ARRAY_BUFFER)
        attributes = {"POSITION": positions, "NORMAL": normals}
        return [
            (paint, {"attributes": attributes, "indices": self._indices(faces, len(vertices))})
            for paint, faces in surface.painted()
        ]

    def covered(self, surface: MeshSurface, instance: MeshInstance, image: ImageTexture) -> dict[str, Any]:
        """Store a surface with an image on it, corner by corner."""
        corners = surface.faces.reshape(-1)
        vertices = surface.vertices[corners].astype("<f4")
        positions = self._add(vertices, "VEC3", _FLOAT, _ARRAY_BUFFER)
        self.accessors[positions] |= {
            "min": vertices.min(axis=0).tolist(),
            "max": vertices.max(axis=0).tolist(),
        }
        shape = instance.thing.shape
        places = image_coordinates(shape.mesh, image, instance.size, shape.source.as_dict()).reshape(-1, 2)
        # Images of glTF begin above.
        places = np.column_stack([places[:, 0], 1 - places[:, 1]]).astype("<f4")
        return {
            "attributes": {
                "POSITION": positions,
                "NORMAL": self._add(surface.normals[corners].astype("<f4"), "VEC3", _FLOAT, _ARRAY_BUFFER),
                "TEXCOORD_0": self._add(places, "VEC2", _FLOAT, _ARRAY_BUFFER),
            }
        }

    def view(self, content: bytes) -> int:
        """Store bytes that are no array."""
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content)})
        self.data += content + b"\0" * (-len(content) % 4)
        return len(self.views) - 1

    def _indices(self, faces: npt.NDArray[np.int64], count: int) -> int:
        small = count < 0xFFFF
        indices = faces.reshape(-1).astype("<u2" if small else "<u4")
        return self._add(indices, "SCALAR", _UINT16 if small else _UINT32, _ELEMENT_BUFFER)

    def _add(self, values: npt.NDArray[Any], kind: str, component: int, target: int) -> int:
        content = values.tobytes()
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content), "target": target}
        )
        self.data += content
        self.data += b"\0" * (-len(self.data) % 4)
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": component,
                "count": len(values),
                "type": kind,
            }
        )
        return len(self.accessors) - 1


def _container(document: bytes, binary: bytes) -> bytes:
    """Return the two chunks of a GLB file behind its header; chunks are multiples of four bytes."""
    document += b" " * (-len(document) % 4)
    chunks = struct.pack("<II", len(document), 0x4E4F534A) + document
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks
