"""Things from MJCF: their shapes for our scenes, and files in the form that robosuite reads."""

import xml.etree.ElementTree as ET
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from scenic.language.errors import Located, ScenicValueError
from scenic.runtime.geometry.meshes.convex_parts import convex_parts
from scenic.runtime.shapes.shapes import BoxShape, Shape

__all__ = ["check_mjcf", "geoms_of_shape", "shape_of_mjcf", "wrapped"]


def shape_of_mjcf(mjcf: object) -> Shape:
    """Return the shape of a thing that MJCF describes; a box if there is none, or if `check_mjcf` refuses it.

    Args:
        mjcf: the text, or the path of a file from the folder of the program, or ``None``.

    """
    try:
        return BoxShape((0.05, 0.05, 0.05)) if mjcf is None else _shape(str(mjcf))
    except Located:
        return BoxShape((0.05, 0.05, 0.05))


def check_mjcf(mjcf: object) -> None:
    """Raise `DescriptionError` if the MJCF of a thing cannot be read."""
    if mjcf is not None:
        _shape(str(mjcf))


@lru_cache(maxsize=64)
def _shape(mjcf: str) -> Shape:
    from scenic.simulators.mujoco.articulated import base_shape, description_of

    if not mjcf.lstrip().startswith("<"):
        description_of(mjcf)  # raises where it cannot be read
        return base_shape(mjcf)
    with TemporaryDirectory() as folder:
        path = Path(folder, "object.xml")
        path.write_text(mjcf)
        description_of(path)
        return base_shape(path)


def wrapped(mjcf: str) -> bytes:
    """Return MJCF as robosuite reads objects: one body ``object`` in another one, with sites that bound it.

    Raises:
        ScenicValueError: there is no body.

    """
    is_text = mjcf.lstrip().startswith("<")
    root = ET.fromstring(mjcf) if is_text else ET.parse(mjcf).getroot()
    first = root.find("./worldbody/body")
    if first is None:
        raise ScenicValueError(
            "the MJCF of an object has no body", help="put one <body> into its <worldbody>"
        )
    for parent in list(first.iter()):
        for joint in [*parent.findall("freejoint"), *parent.findall("joint[@type='free']")]:
            parent.remove(joint)
    if not is_text:
        for element in root.iter():
            if element.get("file"):
                element.set("file", str(Path(mjcf).absolute().parent / str(element.get("file"))))
    assets = root.find("asset")
    return _object_file(first, [] if assets is None else list(assets))


def geoms_of_shape(thing: Any, options: dict[str, Any]) -> bytes:
    """Return a file of robosuite with the convex parts of an object's shape at its size."""
    size = np.array([thing.width, thing.length, thing.height])
    mesh = thing.shape.mesh
    inner, assets = ET.Element("body"), []
    for number, points in enumerate(mesh.derived(convex_parts) or (mesh.vertices,)):
        vertex = " ".join(map(repr, (np.asarray(points) * size).ravel().tolist()))
        assets.append(ET.Element("mesh", name=f"part{number}", vertex=vertex))
        ET.SubElement(
            inner,
            "geom",
            type="mesh",
            mesh=f"part{number}",
            group="0",
            density=repr(options["density"]),
            attrib={
                key: " ".join(map(repr, options[key])) for key in ("friction", "solref", "solimp", "rgba")
            },
        )
    return _object_file(inner, assets)


def _object_file(inner: ET.Element, assets: list[ET.Element]) -> bytes:
    root = ET.Element("mujoco", model="object")
    ET.SubElement(root, "asset").extend(assets)
    outer = ET.SubElement(ET.SubElement(root, "worldbody"), "body")
    inner.attrib.clear()
    inner.set("name", "object")
    for geom in inner.iter("geom"):
        geom.set("group", geom.get("group") or "0")
    outer.append(inner)
    for name, place in (("bottom", "0 0 -0.1"), ("top", "0 0 0.1"), ("horizontal_radius", "0.1 0.1 0")):
        ET.SubElement(outer, "site", name=f"{name}_site", pos=place, size="0.005", rgba="0 0 0 0")
    return ET.tostring(root)
