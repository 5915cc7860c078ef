"""A strict reader of Webots worlds: every field is read by the type that the reference manual of R2023 gives it.

https://cyberbotics.com/doc/reference/nodes-and-api-functions, and VRML97 (ISO/IEC 14772-1, annex A) for the syntax.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

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
WORDS = re.compile(r'\s*(?:#[^\n]*\n\s*)*("(?:[^"\\]|\\.)*"|[{}\[\]]|[^\s{}\[\]",]+)')
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class Node(dict[str, Any]):
    """A node: its fields, its ``type``, and ``DEF`` if it has such a name."""


class Reader:
    def __init__(self, text: str, protos: set[str]) -> None:
        self.words = []
        place, text = 0, text.rstrip()
        while place < len(text):
            found = WORDS.match(text, place)
            assert found is not None, text[place : place + 40]
            self.words.append(found[1])
            place = found.end()
        self.words.reverse()
        self.protos = protos
        self.names: set[str] = set()

    def take(self) -> str:
        assert self.words, "the file ends early"
        return self.words.pop()

    def node(self) -> Node | None:
        word = self.take()
        if word == "NULL":
            return None
        node = Node()
        if word == "DEF":
            name = self.take()
            assert NAME.fullmatch(name), name
            assert name not in self.names, f"{name} twice"
            self.names.add(name)
            node["DEF"] = name
            word = self.take()
        node["type"] = word
        known = ROBOT if word in self.protos else FIELDS[word]
        assert self.take() == "{"
        while (field := self.take()) != "}":
            assert field in known, f"{word} has no field {field}"
            assert field not in node, f"{field} twice"
            value = self.value(known[field])
            assert RANGES.get((word, field), lambda _: True)(value), (word, field, value)
            if field in CHILDREN and value is not None:
                assert value["type"] in CHILDREN[field], (word, field, value["type"])
            node[field] = value
        return node

    def value(self, kind: str) -> Any:
        single = "SF" + kind[2:]
        if kind == single:
            return self.single(kind)
        if self.words[-1] != "[":
            return [self.single(single)]
        self.take()
        items = []
        while self.words[-1] != "]":
            items.append(self.single(single))
        self.take()
        return items

    def single(self, kind: str) -> Any:
        if kind == "SFNode":
            return self.node()
        if kind == "SFString":
            word = self.take()
            assert word[0] == '"', word
            return re.sub(r"\\(.)", r"\1", word[1:-1])
        if kind == "SFBool":
            return {"TRUE": True, "FALSE": False}[self.take()]
        if kind == "SFInt32":
            return int(self.take())
        count = {"SFFloat": 1, "SFVec2f": 2, "SFVec3f": 3, "SFColor": 3, "SFRotation": 4}[kind]
        values = [self.number() for _ in range(count)]
        if kind == "SFColor":
            assert all(0 <= value <= 1 for value in values), values
        if kind == "SFRotation":
            assert abs(np.linalg.norm(values[:3]) - 1) < 1e-12, values
            assert 0 <= values[3] <= np.pi + 1e-12, values
        return values[0] if count == 1 else values

    def number(self) -> float:
        word = self.take()
        assert NUMBER.fullmatch(word), word
        return float(word)


def read_nodes(text: str, protos: set[str] = frozenset()) -> list[Node]:  # type: ignore[assignment] # it is not changed
    """The nodes of a text without a header."""
    reader = Reader(text, protos)
    nodes = []
    while reader.words:
        node = reader.node()
        assert node is not None
        nodes.append(node)
    return nodes


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
