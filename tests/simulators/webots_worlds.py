"""Strict checks of Webots worlds: every field has a value of the type that the reference manual of R2023 gives it.

https://cyberbotics.com/doc/reference/nodes-and-api-functions, and VRML97 (ISO/IEC 14772-1, annex A) for the syntax.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from scenic.formats.webots_reading import WorldNode, parse_nodes

POSE = {"translation": "SFVec3f", "rotation": "SFRotation", "children": "MFNode"}
SOLID = {
    **POSE,
    "name": "SFString",
    "model": "SFString",
    "description": "SFString",
    "contactMaterial": "SFString",
    "immersionProperties": "MFNode",
    "boundingObject": "SFNode",
    "physics": "SFNode",
    "locked": "SFBool",
    "radarCrossSection": "SFFloat",
    "recognitionColors": "MFColor",
    "linearVelocity": "SFVec3f",
    "angularVelocity": "SFVec3f",
}
ROBOT = {
    **SOLID,
    "controller": "SFString",
    "controllerArgs": "MFString",
    "customData": "SFString",
    "supervisor": "SFBool",
    "synchronization": "SFBool",
    "battery": "MFFloat",
    "cpuConsumption": "SFFloat",
    "selfCollision": "SFBool",
    "window": "SFString",
    "remoteControl": "SFString",
}
FIELDS: dict[str, dict[str, str]] = {
    "WorldInfo": {
        "info": "MFString",
        "title": "SFString",
        "window": "SFString",
        "gravity": "SFFloat",
        "basicTimeStep": "SFFloat",
        "FPS": "SFFloat",
        "coordinateSystem": "SFString",
        "randomSeed": "SFInt32",
    },
    "Viewpoint": {
        "fieldOfView": "SFFloat",
        "orientation": "SFRotation",
        "position": "SFVec3f",
        "near": "SFFloat",
        "far": "SFFloat",
    },
    "Background": {"skyColor": "MFColor", "luminosity": "SFFloat"},
    "DirectionalLight": {
        "ambientIntensity": "SFFloat",
        "color": "SFColor",
        "direction": "SFVec3f",
        "intensity": "SFFloat",
        "on": "SFBool",
        "castShadows": "SFBool",
    },
    "Group": {"children": "MFNode"},
    "Pose": POSE,
    "Solid": SOLID,
    "Robot": ROBOT,
    "Shape": {
        "appearance": "SFNode",
        "geometry": "SFNode",
        "castShadows": "SFBool",
        "isPickable": "SFBool",
    },
    "PBRAppearance": {
        "baseColor": "SFColor",
        "transparency": "SFFloat",
        "roughness": "SFFloat",
        "metalness": "SFFloat",
    },
    "Physics": {
        "density": "SFFloat",
        "mass": "SFFloat",
        "centerOfMass": "MFVec3f",
        "inertiaMatrix": "MFVec3f",
    },
    "Box": {"size": "SFVec3f"},
    "Cylinder": {
        "radius": "SFFloat",
        "height": "SFFloat",
        "subdivision": "SFInt32",
        "top": "SFBool",
        "bottom": "SFBool",
    },
    "Sphere": {"radius": "SFFloat", "subdivision": "SFInt32", "ico": "SFBool"},
    "Plane": {"size": "SFVec2f"},
    "Mesh": {"url": "MFString", "ccw": "SFBool", "name": "SFString", "materialIndex": "SFInt32"},
    "ElevationGrid": {
        "height": "MFFloat",
        "xDimension": "SFInt32",
        "xSpacing": "SFFloat",
        "yDimension": "SFInt32",
        "ySpacing": "SFFloat",
        "thickness": "SFFloat",
    },
}
GEOMETRIES = {"Box", "Cylinder", "Sphere", "Plane", "Mesh", "ElevationGrid"}
"""They may also bound a solid; a cone could not."""
CHILDREN = {
    "appearance": {"PBRAppearance"},
    "geometry": GEOMETRIES,
    "boundingObject": GEOMETRIES,
    "physics": {"Physics"},
}
RANGES: dict[tuple[str, str], Callable[[Any], bool]] = {
    ("WorldInfo", "basicTimeStep"): lambda value: value >= 1,
    ("WorldInfo", "coordinateSystem"): lambda value: value in ("ENU", "NUE", "EUN"),
    ("DirectionalLight", "ambientIntensity"): lambda value: 0 <= value <= 1,
    ("DirectionalLight", "intensity"): lambda value: value >= 0,
    ("DirectionalLight", "direction"): any,
    ("PBRAppearance", "transparency"): lambda value: 0 <= value <= 1,
    ("PBRAppearance", "roughness"): lambda value: 0 <= value <= 1,
    ("PBRAppearance", "metalness"): lambda value: 0 <= value <= 1,
    ("Physics", "density"): lambda value: value == -1 or value > 0,
    ("Physics", "mass"): lambda value: value == -1 or value > 0,
    ("Box", "size"): lambda value: min(value) > 0,
    ("Plane", "size"): lambda value: min(value) > 0,
    ("Cylinder", "radius"): lambda value: value > 0,
    ("Cylinder", "height"): lambda value: value > 0,
    ("Cylinder", "subdivision"): lambda value: value >= 3,
    ("Sphere", "radius"): lambda value: value > 0,
    ("Sphere", "subdivision"): lambda value: 1 <= value <= 5,
    ("ElevationGrid", "xDimension"): lambda value: value >= 2,
    ("ElevationGrid", "yDimension"): lambda value: value >= 2,
    ("ElevationGrid", "xSpacing"): lambda value: value > 0,
    ("ElevationGrid", "ySpacing"): lambda value: value > 0,
    ("ElevationGrid", "thickness"): lambda value: value >= 0,
}
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class Node(dict[str, Any]):
    """A node: its fields, its ``type``, and ``DEF`` if it has such a name."""


def strict(node: WorldNode, protos: set[str], names: set[str]) -> Node:
    """A node with the values of its fields by their types; ``names`` are the DEF names so far."""
    found = Node(type=node.kind)
    if node.name is not None:
        assert NAME.fullmatch(node.name), node.name
        assert node.name not in names, f"{node.name} twice"
        names.add(node.name)
        found["DEF"] = node.name
    known = ROBOT if node.kind in protos else FIELDS[node.kind]
    for field, raw in node.fields.items():
        assert field in known, f"{node.kind} has no field {field}"
        value = typed(known[field], raw, protos, names)
        assert RANGES.get((node.kind, field), lambda _: True)(value), (node.kind, field, value)
        if field in CHILDREN and value is not None:
            assert value["type"] in CHILDREN[field], (node.kind, field, value["type"])
        found[field] = value
    return found


SIZES = {"Float": 1, "Int32": 1, "Vec2f": 2, "Vec3f": 3, "Color": 3, "Rotation": 4}
"""Numbers of a value."""


def typed(kind: str, raw: Any, protos: set[str], names: set[str]) -> Any:
    """A value of a type, ``SF`` for one and ``MF`` for several."""
    several, kind = kind.startswith("MF"), kind[2:]
    if kind in SIZES:
        size, numbers = SIZES[kind], raw if isinstance(raw, list) else [raw]
        assert all(isinstance(number, float) for number in numbers), raw
        assert len(numbers) % size == 0
        rows = [numbers[start : start + size] for start in range(0, len(numbers), size)]
        values: list[Any] = [checked(kind, row[0] if size == 1 else row) for row in rows]
    else:
        items = raw if isinstance(raw, list) else [raw]
        values = [strict(item, protos, names) if isinstance(item, WorldNode) else item for item in items]
        wanted: tuple[type, ...] = {"Node": (Node, type(None)), "String": (str,), "Bool": (bool,)}[kind]
        assert all(isinstance(value, wanted) for value in values), raw
    if several:
        return values
    (value,) = values
    return value


def checked(kind: str, value: Any) -> Any:
    """A value of numbers, if it is one of its type."""
    if kind == "Int32":
        assert value.is_integer(), value
        return int(value)
    if kind == "Color":
        assert all(0 <= part <= 1 for part in value), value
    if kind == "Rotation":
        assert abs(np.linalg.norm(value[:3]) - 1) < 1e-12, value
        assert 0 <= value[3] <= np.pi + 1e-12, value
    return value


def read_nodes(text: str, protos: set[str] = frozenset()) -> list[Node]:  # type: ignore[assignment] # it is not changed
    """The nodes of a text without a header."""
    names: set[str] = set()
    return [strict(node, protos, names) for node in parse_nodes(text)]


def read_world(file: Path) -> list[Node]:
    """The nodes of a world, after all checks of the world as a whole and of the files that it names."""
    header, _, text = file.read_text().partition("\n")
    assert re.fullmatch(r"#VRML_SIM R20\d\d[ab] utf8", header), header
    protos: set[str] = set()
    while found := re.match(r'\s*EXTERNPROTO "([^"\n]*?([^"/\n]+)\.proto)"\n', text):
        assert found[2] not in FIELDS
        protos.add(found[2])
        text = text[found.end() :]
    nodes = read_nodes(text, protos)
    kinds = [node["type"] for node in nodes]
    assert kinds[0] == "WorldInfo"
    assert kinds.count("WorldInfo") == kinds.count("Viewpoint") == 1
    assert protos == set(kinds) - set(FIELDS), "each PROTO is declared, and is used"
    labels = [node["name"] for node in nodes if "name" in node]
    assert len(labels) == len(set(labels)), "names of sibling solids differ"
    assert not any(":" in label for label in labels)
    for node in nodes:
        for inner in _inner(node):
            _check(inner, file.parent)
    return nodes


def _inner(node: Node) -> Iterator[Node]:
    yield node
    for value in node.values():
        for item in value if isinstance(value, list) else [value]:
            if isinstance(item, Node):
                yield from _inner(item)


def _check(node: Node, folder: Path) -> None:
    if node.get("physics") is not None and node["type"] == "Solid":
        assert node.get("boundingObject") is not None
        assert (node["physics"]["density"] == -1) != (node["physics"]["mass"] == -1)
    if node["type"] == "ElevationGrid":
        assert len(node["height"]) == node["xDimension"] * node["yDimension"]
    if node["type"] == "Mesh":
        (url,) = node["url"]
        assert not Path(url).is_absolute()
        assert trimesh.load(folder / url, process=False, force="mesh").is_volume, url


def corners_of(geometry: Node, folder: Path) -> Any:
    """The lowest and highest corner ``(2, 3)`` of a geometry in the frame of its node."""
    kind = geometry["type"]
    if kind == "Mesh":
        lines = (folder / geometry["url"][0]).read_text().splitlines()
        points = np.array([line.split()[1:] for line in lines if line[:2] == "v "], dtype=np.float64)
        return np.array([points.min(axis=0), points.max(axis=0)])
    if kind == "ElevationGrid":
        size = (
            (geometry["xDimension"] - 1) * geometry["xSpacing"],
            (geometry["yDimension"] - 1) * geometry["ySpacing"],
        )
        low = min(geometry["height"]) - geometry["thickness"]
        return np.array([[0, 0, low], [*size, max(geometry["height"])]])
    if kind == "Box":
        half = np.array(geometry["size"]) / 2
    elif kind == "Cylinder":
        half = np.array([geometry["radius"], geometry["radius"], geometry["height"] / 2])
    else:
        assert kind == "Sphere"
        half = np.full(3, geometry["radius"])
    return np.array([-half, half])
