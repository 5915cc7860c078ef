"""Scenes as worlds of SDFormat 1.9, which Gazebo and Drake read, with a URDF of each object, which PyBullet reads.

Neither format has meshes inline, so both name the files of a shared folder.
"""

import hashlib
import json
import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from scenic.formats.robotics.asset_files import FOLDER, hull, image_file, mesh_file, mesh_name, obj_text
from scenic.formats.robotics.mjcf import bottom, numbers
from scenic.formats.robotics.solids import Inertia, Solid, solids_of
from scenic.formats.scene_cameras import Viewpoint
from scenic.formats.scene_protocols import Scene
from scenic.formats.scenery import scenery_of
from scenic.runtime.geometry.meshes.convex_parts import convex_parts

__all__ = ["sdf"]

_VERSION: Final = "1.9"
_NAMESPACE: Final = "drake.mit.edu"
_CLIP: Final = (0.01, 1000.0)
"""Distances between which cameras see, metres."""


def sdf(scene: Scene, name: str) -> dict[str, bytes]:
    """Return the files of a scene by their paths: the world, the index of its objects with their URDF, these, meshes and images.

    Args:
        scene: the scene.
        name: of the world's file.

    """
    return _Writer(scene).files(name)


class _Writer:
    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._assets: dict[str, bytes] = {}
        # Drake reads whether a mesh is convex from an element of its own.
        self._root = ET.Element("sdf", {"version": _VERSION, f"xmlns:{'drake'}": _NAMESPACE})
        self._world = ET.SubElement(self._root, "world", name="scene")

    def files(self, name: str) -> dict[str, bytes]:
        scene = self._scene
        physics = ET.SubElement(self._world, "physics", name="default", type="ode")
        _texts(physics, max_step_size="0.002", real_time_factor="1")
        _texts(self._world, gravity="0 0 -9.81")
        self._light()
        solids = solids_of(scene)
        self._ground(solids)
        entries = []
        for solid in solids:
            self._model(solid)
            entries.append(
                {
                    "name": solid.name,
                    "class": solid.class_name,
                    "urdf": self._urdf(solid),
                    "position": list(solid.position),
                    "quaternion": list(solid.quaternion),
                    "static": solid.is_static,
                }
            )
        ET.indent(self._root)
        index = {"seed": scene.seed, "k": scene.k, "digest": getattr(scene, "digest", ""), "objects": entries}
        return {
            name: ET.tostring(self._root, encoding="utf-8", xml_declaration=True) + b"\n",
            f"{name.removesuffix('.sdf')}.json": (json.dumps(index, indent=1) + "\n").encode(),
            **self._assets,
        }

    # The world

    def _light(self) -> None:
        scenery = scenery_of(self._scene.params)
        light = ET.SubElement(self._world, "light", name="sun", type="directional")
        bright = min(1.0, 0.8 * scenery.sunlight)
        _texts(
            light,
            cast_shadows="true",
            pose=f"{numbers(20 * scenery.sun)} 0 0 0",
            diffuse=numbers((bright, bright, bright, 1)),
            direction=numbers(-scenery.sun),
        )
        ambient = min(1.0, 0.4 * scenery.skylight)
        view = ET.SubElement(self._world, "scene")
        _texts(
            view, ambient=numbers((ambient, ambient, ambient, 1)), background=numbers((*scenery.zenith, 1))
        )

    def _ground(self, solids: tuple[Solid, ...]) -> None:
        lowest = min(0.0, *(bottom(solid) for solid in solids)) if solids else 0.0
        model = ET.SubElement(self._world, "model", name="ground plane")  # names of objects have no blanks
        _texts(model, static="true", pose=f"0 0 {lowest!r} 0 0 0")
        link = ET.SubElement(model, "link", name="link")
        # A half-space makes some versions of Drake crash, so that a thick board is touched in its place.
        collision = ET.SubElement(link, "collision", name="collision")
        _texts(collision, pose="0 0 -0.5 0 0 0")
        board = ET.SubElement(ET.SubElement(collision, "geometry"), "box")
        _texts(board, size="100 100 1")
        visual = ET.SubElement(link, "visual", name="visual")
        plane = ET.SubElement(ET.SubElement(visual, "geometry"), "plane")
        _texts(plane, normal="0 0 1", size="100 100")

    # Models

    def _model(self, solid: Solid) -> None:
        model = ET.SubElement(self._world, "model", name=solid.name)
        _texts(model, static=str(solid.is_static).lower())
        pose = ET.SubElement(model, "pose", rotation_format="quat_xyzw")
        pose.text = numbers((*solid.position, *solid.quaternion))
        link = ET.SubElement(model, "link", name="link")
        self._inertial(link, solid.inertia)
        if solid.collides:
            for number, geometry in enumerate(self._forms(solid)):
                collision = ET.SubElement(link, "collision", name=f"collision_{number}")
                collision.append(geometry)
                self._contact(collision, solid)
        if solid.is_rendered:
            visual = ET.SubElement(link, "visual", name="visual")
            visual.append(self._form(solid))
            self._material(visual, solid)
        for camera in solid.cameras:
            self._camera(link, solid, camera)

    def _inertial(self, link: ET.Element, inertia: Inertia) -> None:
        inertial = ET.SubElement(link, "inertial")
        _texts(inertial, pose=f"{numbers(inertia.center)} 0 0 0", mass=repr(inertia.mass))
        _texts(ET.SubElement(inertial, "inertia"), **_inertia_entries(inertia))

    def _contact(self, collision: ET.Element, solid: Solid) -> None:
        if solid.friction is None and solid.restitution is None:
            return
        surface = ET.SubElement(collision, "surface")
        if solid.restitution is not None:
            _texts(ET.SubElement(surface, "bounce"), restitution_coefficient=repr(solid.restitution))
        if solid.friction is not None:
            friction = ET.SubElement(surface, "friction")
            _texts(ET.SubElement(friction, "ode"), mu=repr(solid.friction), mu2=repr(solid.friction))

    def _material(self, visual: ET.Element, solid: Solid) -> None:
        material = ET.SubElement(visual, "material")
        _texts(material, ambient=numbers(solid.color), diffuse=numbers(solid.color))
        if solid.texture is not None:
            path, content = image_file(solid.texture)
            self._assets[path] = content
            metal = ET.SubElement(ET.SubElement(material, "pbr"), "metal")
            _texts(metal, albedo_map=path, metalness="0", roughness="0.8")

    def _camera(self, link: ET.Element, solid: Solid, camera: Viewpoint) -> None:
        from scipy.spatial.transform import Rotation  # slow to import

        back = Rotation.from_quat(solid.quaternion).inv()
        place = back.apply(camera.camera.eye - np.array(solid.position))
        # Cameras of SDFormat look along +X, ours along +Y.
        turn = (
            back * Rotation.from_quat(camera.quaternion) * Rotation.from_euler("Z", math.pi / 2)
        ).as_quat()
        kind = "depth_camera" if camera.outputs == ("depth",) else "camera"
        sensor = ET.SubElement(link, "sensor", name=camera.name, type=kind)
        pose = ET.SubElement(sensor, "pose", rotation_format="quat_xyzw")
        pose.text = numbers((*place, *turn))
        _texts(sensor, update_rate="30", always_on="true")
        lens = ET.SubElement(sensor, "camera")
        _texts(lens, horizontal_fov=repr(camera.angles[0]))
        _texts(ET.SubElement(lens, "image"), width=str(camera.size[0]), height=str(camera.size[1]))
        _texts(ET.SubElement(lens, "clip"), near=str(_CLIP[0]), far=str(_CLIP[1]))

    # Forms

    def _forms(self, solid: Solid) -> Iterator[ET.Element]:
        """Yield the geometries that others touch: the form itself, or convex parts of a mesh."""
        pieces = solid.mesh.derived(convex_parts) if solid.form in ("mesh", "cone") else ()
        if not pieces:
            yield self._form(solid, touches=True)
        for number, points in enumerate(pieces):
            path = f"{FOLDER}/{mesh_name(solid.mesh)}_{number}.obj"
            self._assets[path] = obj_text(*hull(points))
            yield _mesh_geometry(path, solid, convex=True)

    def _form(self, solid: Solid, *, touches: bool = False) -> ET.Element:
        width, _, height = solid.size
        if solid.form in ("mesh", "cone"):
            path, content = mesh_file(solid)
            self._assets[path] = content
            return _mesh_geometry(path, solid, convex=touches)
        geometry = ET.Element("geometry")
        form = ET.SubElement(geometry, solid.form)
        if solid.form == "box":
            _texts(form, size=numbers(solid.size))
        elif solid.form == "sphere":
            _texts(form, radius=repr(width / 2))
        elif solid.form == "ellipsoid":
            _texts(form, radii=numbers(extent / 2 for extent in solid.size))
        else:
            radius = solid.touching_radius if touches else width / 2
            _texts(form, radius=repr(radius), length=repr(height))
        return geometry

    # URDF

    def _urdf(self, solid: Solid) -> str:
        """Return the path of the URDF of an object, named after its class and content."""
        solid = solid.without_ellipsoid
        robot = ET.Element("robot", name=solid.class_name)
        link = ET.SubElement(robot, "link", name="base")
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", xyz=numbers(solid.inertia.center), rpy="0 0 0")
        ET.SubElement(inertial, "mass", value=repr(solid.inertia.mass))
        ET.SubElement(inertial, "inertia", _inertia_entries(solid.inertia))
        visual = ET.SubElement(link, "visual")
        visual.append(_urdf_form(self._form(solid)))
        material = ET.SubElement(visual, "material", name="color")
        ET.SubElement(material, "color", rgba=numbers(solid.color))
        if solid.collides:
            for geometry in self._forms(solid):
                ET.SubElement(link, "collision").append(_urdf_form(geometry))
        if solid.friction is not None:
            contact = ET.SubElement(link, "contact")
            ET.SubElement(contact, "lateral_friction", value=repr(solid.friction))
        ET.indent(robot)
        content = ET.tostring(robot, encoding="utf-8", xml_declaration=True) + b"\n"
        path = f"{FOLDER}/{solid.class_name}_{hashlib.sha256(content).hexdigest()[:12]}.urdf"
        self._assets[path] = content
        return path


def _inertia_entries(inertia: Inertia) -> dict[str, str]:
    rows = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    return {name: repr(float(inertia.matrix[row, column])) for name, row, column in rows}


def _mesh_geometry(path: str, solid: Solid, *, convex: bool) -> ET.Element:
    geometry = ET.Element("geometry")
    mesh = ET.SubElement(geometry, "mesh")
    _texts(mesh, uri=path, scale=numbers(solid.size))
    if convex:
        ET.SubElement(mesh, "drake:declare_convex")
    return geometry


def _urdf_form(geometry: ET.Element) -> ET.Element:
    """Return a geometry of SDFormat as one of URDF."""
    (form,) = geometry
    texts: dict[str, Any] = {item.tag: item.text for item in form}
    if form.tag == "mesh":
        # Paths in a URDF start from its own folder, which is that of the meshes.
        texts = {"filename": texts["uri"].rpartition("/")[2], "scale": texts["scale"]}
    found = ET.Element("geometry")
    ET.SubElement(found, form.tag, texts)
    return found


def _texts(parent: ET.Element, **entries: str) -> None:
    for tag, text in entries.items():
        ET.SubElement(parent, tag).text = text
