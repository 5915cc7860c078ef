"""Scenes as MJCF, the XML format of MuJoCo, with the settings of this package's own simulator.

One file has its meshes inline; files of a data set name the meshes of a shared folder. Poses have every digit.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

import numpy as np

from scenic.formats.robotics.asset_files import FOLDER, hull, image_file, mesh_file, mesh_name, obj_text
from scenic.formats.robotics.solids import Solid, solids_of
from scenic.formats.scene_cameras import Viewpoint
from scenic.formats.scene_protocols import Scene
from scenic.formats.scenery import scenery_of
from scenic.runtime.geometry.meshes.convex_parts import convex_parts

__all__ = ["mjcf"]

_NOT_DRAWN: Final = "3"
"""The group of geoms that MuJoCo does not draw unless it is asked to."""

_GRAVITY: Final = 9.81


def mjcf(scene: Scene, name: str, *, inline: bool) -> dict[str, bytes]:
    """Return the files of a scene by their paths: its own first, then images, and meshes unless they are inline.

    Args:
        scene: the scene.
        name: of its own file.
        inline: whether meshes are in this file.

    """
    return _Writer(scene, inline=inline).files(name)


def numbers(values: Iterable[float]) -> str:
    """Numbers as text that gives the same numbers back."""
    return " ".join(repr(float(value)) for value in values)


class _Writer:
    def __init__(self, scene: Scene, *, inline: bool) -> None:
        self._scene = scene
        self._inline = inline
        self._assets: dict[str, bytes] = {}
        self._known: set[str] = set()
        self._root = ET.Element("mujoco", model=f"scene {scene.k}")
        ET.SubElement(self._root, "compiler", angle="radian", autolimits="true")
        ET.SubElement(
            self._root,
            "option",
            timestep="0.002",
            gravity=numbers((0, 0, -_GRAVITY)),
            integrator="implicitfast",
            cone="elliptic",
            impratio="10",
        )
        custom = ET.SubElement(self._root, "custom")
        facts = {"seed": str(scene.seed), "k": str(scene.k), "digest": getattr(scene, "digest", "")}
        for key, text in facts.items():
            ET.SubElement(custom, "text", name=f"scenic {key}", data=text or "none")
        self._asset = ET.SubElement(self._root, "asset")
        self._world = ET.SubElement(self._root, "worldbody")
        self._sensors = ET.SubElement(self._root, "sensor")

    def files(self, name: str) -> dict[str, bytes]:
        solids = solids_of(self._scene)
        self._light()
        self._ground(solids)
        start: list[float] = []
        for solid in solids:
            self._body(solid)
            if not solid.is_static:
                x, y, z, w = solid.quaternion
                start += [*solid.position, w, x, y, z]
        if start:
            keys = ET.SubElement(self._root, "keyframe")
            ET.SubElement(keys, "key", name="start", qpos=numbers(start))
        ET.indent(self._root)
        return {name: ET.tostring(self._root, encoding="utf-8") + b"\n", **self._assets}

    def _light(self) -> None:
        scenery = scenery_of(self._scene.params)
        visual = ET.SubElement(self._root, "visual")
        ET.SubElement(visual, "headlight", ambient=numbers([0.5 * min(1.0, scenery.skylight)] * 3))
        ET.SubElement(
            self._world,
            "light",
            name="sun",
            type="directional",
            pos=numbers(20 * scenery.sun),
            dir=numbers(-scenery.sun),
            diffuse=numbers([min(1.0, 0.7 * scenery.sunlight)] * 3),
            castshadow="true",
        )

    def _ground(self, solids: Iterable[Solid]) -> None:
        """An endless floor at 0, or lower where an object reaches lower."""
        lowest = min((bottom(solid) for solid in solids), default=0.0)
        color = scenery_of(self._scene.params).ground
        ET.SubElement(
            self._world,
            "geom",
            name="ground plane",  # names of objects have no blanks
            type="plane",
            pos=numbers((0, 0, min(0.0, lowest))),
            size="0 0 1",
            rgba=numbers((*color, 1)),
        )

    def _body(self, solid: Solid) -> None:
        x, y, z, w = solid.quaternion
        body = ET.SubElement(
            self._world, "body", name=solid.name, pos=numbers(solid.position), quat=numbers((w, x, y, z))
        )
        if not solid.is_static:
            ET.SubElement(body, "freejoint", name=f"{solid.name} joint")
            for kind in ("framepos", "framequat"):
                ET.SubElement(
                    self._sensors, kind, name=f"{solid.name} {kind}", objtype="xbody", objname=solid.name
                )
        self._geoms(body, solid)
        for camera in solid.cameras:
            self._camera(body, solid, camera)

    # Forms

    def _geoms(self, body: ET.Element, solid: Solid) -> None:
        surface = self._surface(solid)
        weight = {} if solid.is_static else {"mass": repr(solid.inertia.mass)}
        looks = self._looks(solid)
        width, length, height = solid.size
        forms: dict[str, Mapping[str, str]] = {
            "box": {"type": "box", "size": numbers((width / 2, length / 2, height / 2))},
            "sphere": {"type": "sphere", "size": numbers((width / 2,))},
            "ellipsoid": {"type": "ellipsoid", "size": numbers((width / 2, length / 2, height / 2))},
            "cylinder": {"type": "cylinder", "size": numbers((width / 2, height / 2))},
        }
        form = forms.get(solid.form) or {"type": "mesh", "mesh": self._mesh(solid)}
        whole = {"name": solid.name, **form, **weight, **looks}
        pieces = list(self._pieces(solid)) if solid.collides else []
        if not pieces:
            ET.SubElement(body, "geom", {**whole, **surface})
            return
        # The whole is seen and has the inertia; its pieces touch others.
        ET.SubElement(body, "geom", {**whole, "contype": "0", "conaffinity": "0"})
        for number, piece in enumerate(pieces):
            name = {"name": f"{solid.name} piece {number}"}
            ET.SubElement(body, "geom", {**name, **piece, "mass": "0", "group": _NOT_DRAWN, **surface})

    def _surface(self, solid: Solid) -> dict[str, str]:
        found: dict[str, str] = {} if solid.is_static else {"priority": "1"}
        if solid.friction is not None:
            found["friction"] = numbers((solid.friction, 0.005, 0.0001))
        if not solid.collides:
            found |= {"contype": "0", "conaffinity": "0"}
        return found

    def _looks(self, solid: Solid) -> dict[str, str]:
        if not solid.is_rendered:
            return {"rgba": "0 0 0 0"}
        if solid.texture is None:
            return {"rgba": numbers(solid.color)}
        path, content = image_file(solid.texture)
        if not path.endswith(".png"):
            path, content = _as_png(path, content)
        material = path.rpartition("/")[2].partition(".")[0]
        if material not in self._known:
            self._known.add(material)
            self._assets[path] = content
            ET.SubElement(self._asset, "texture", name=material, type="2d", file=path)
            ET.SubElement(self._asset, "material", name=material, texture=material)
        return {"material": material}

    def _mesh(self, solid: Solid) -> str:
        """The name of the asset of a solid's mesh at its size."""
        path, content = mesh_file(solid)
        return self._declare(
            path, solid.size, content, solid.mesh if solid.texture is None else None, "exact"
        )

    def _pieces(self, solid: Solid) -> Iterator[dict[str, str]]:
        """Yield the forms that touch others; none if the form itself is as good."""
        if solid.form == "cylinder":
            yield {"type": "cylinder", "size": numbers((solid.touching_radius, solid.size[2] / 2))}
        if solid.form in ("mesh", "cone"):
            for number, points in enumerate(solid.mesh.derived(convex_parts)):
                path = f"{FOLDER}/{mesh_name(solid.mesh)}_{number}.obj"
                content = b"" if self._inline else obj_text(*hull(points))
                yield {"type": "mesh", "mesh": self._declare(path, solid.size, content, points, "convex")}

    def _declare(self, path: str, size: tuple[float, ...], content: bytes, source: Any, inertia: str) -> str:
        stem = path.rpartition("/")[2].removesuffix(".obj")
        name = f"{stem} {'x'.join(f'{extent:.17g}' for extent in size)}"
        if name in self._known:
            return name
        self._known.add(name)
        entry = ET.SubElement(self._asset, "mesh", name=name, inertia=inertia)
        if self._inline and source is not None:
            vertices = source.vertices if hasattr(source, "vertices") else source
            entry.set("vertex", numbers((vertices * size).ravel()))
            if hasattr(source, "faces"):
                entry.set("face", " ".join(map(str, np.asarray(source.faces).ravel().tolist())))
        else:
            entry.set("file", path)
            entry.set("scale", numbers(size))
            self._assets[path] = content
        return name

    # Cameras

    def _camera(self, body: ET.Element, solid: Solid, camera: Viewpoint) -> None:
        position, turn = in_frame(solid, camera)
        x, y, z, w = turn
        ET.SubElement(
            body,
            "camera",
            name=f"{solid.name} {camera.name}",
            pos=numbers(position),
            quat=numbers((w, x, y, z)),
            fovy=repr(camera.angles[1]),
            resolution=f"{camera.size[0]} {camera.size[1]}",
        )


def in_frame(solid: Solid, camera: Viewpoint) -> tuple[Any, Any]:
    """Place ``(3,)`` and orientation ``(x, y, z, w)`` of a camera that looks along -Z with +Y up, in its owner's frame."""
    from scipy.spatial.transform import Rotation  # slow to import

    back = Rotation.from_quat(solid.quaternion).inv()
    place = back.apply(camera.camera.eye - np.array(solid.position))
    turn = back * Rotation.from_quat(camera.quaternion) * Rotation.from_euler("X", math.pi / 2)
    return place, turn.as_quat()


def bottom(solid: Solid) -> float:
    """The height of the lowest point of a solid, metres."""
    from scenic.formats.poses import rotation_matrix

    # Convex parts may reach a little lower than the mesh.
    corners = [solid.mesh.vertices, *(solid.mesh.derived(convex_parts) if solid.form == "mesh" else ())]
    heights = (np.concatenate(corners) * solid.size) @ rotation_matrix(solid.quaternion)[2]
    return float(solid.position[2] + heights.min())


def _as_png(path: str, content: bytes) -> tuple[str, bytes]:
    """Return an image as PNG, the only format of images that MuJoCo reads."""
    from io import BytesIO

    from scenic.formats.imaging import require_pillow

    require_pillow()
    from PIL import Image

    stream = BytesIO()
    Image.open(BytesIO(content)).convert("RGB").save(stream, format="PNG")
    return f"{path.rpartition('.')[0]}.png", stream.getvalue()
