"""Scenes as worlds of Webots R2023a: nodes of its VRML format, and whole ``.wbt`` files with their meshes beside them."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.camera import corners, ground_height
from scenic.formats.files import make_folder, write
from scenic.formats.mesh_instances import MeshInstance, distinct_labels, picture
from scenic.formats.scene_protocols import Scene
from scenic.formats.webots_reading import WORLD_PARAMETER, WorldFile, read_world
from scenic.language.errors import ScenicValueError

__all__ = ["World", "def_names", "mesh_file", "solid", "webots_world", "write_world"]

_HEADER: Final = "#VRML_SIM R2023a utf8"
_STEP: Final = 16
"""Basic time step of the world, milliseconds."""
_MARGIN: Final = 2.0
"""The floor and the view reach this far beyond the objects, metres."""
_GRAY: Final = (0.8, 0.8, 0.8)
_SUPERVISOR: Final = "scenic_supervisor"
_SUPERVISOR_NAME: Final = "scenic"
_DEF: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_RESERVED: Final = frozenset({"FLOOR", "SCENIC"})
"""DEF names of nodes that a written world has beside its objects."""

_ADDRESSES: Final = MappingProxyType(
    {
        PurePosixPath(path).name: f"webots://projects/{path}.proto"
        for path in (
            "vehicles/protos/bmw/BmwX5",
            "vehicles/protos/citroen/CitroenCZero",
            "vehicles/protos/lincoln/LincolnMKZ",
            "vehicles/protos/range_rover/RangeRoverSportSVR",
            "vehicles/protos/toyota/ToyotaPrius",
            "humans/pedestrian/protos/Pedestrian",
            "objects/barrels/protos/OilBarrel",
            "objects/solids/protos/SolidBox",
            "objects/traffic/protos/TrafficCone",
            "objects/traffic/protos/WorkBarrier",
        )
    }
)
"""Addresses of PROTO files that come with Webots, by the names of their nodes."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class World:
    """A world and the files beside it.

    Attributes:
        text: the contents of the ``.wbt`` file.
        files: contents of the other files, by their paths relative to it.

    """

    text: str
    files: Mapping[str, bytes] = field(default_factory=dict)


def webots_world(
    scene: Scene,
    stem: str,
    *,
    program: str | Path | None = None,
    params: Mapping[str, object] = MappingProxyType({}),
) -> World:
    """Return a scene as a world.

    Objects with a property ``webotsProto`` become nodes of that PROTO (a name, found in ``../protos``, or an address that ends
    in ``NAME.proto``) with their ``controller``, ``customData`` and ``battery``. All others are a ``Solid`` of their shape and
    colour, which has physics if they have a ``density`` or a ``mass``. Objects that are not drawn are left out. The objects of a
    program that uses the roads of a world are added to that world, in its axes; nodes that it has already stay.

    Args:
        scene: the scene.
        stem: the name of the file without its ending; meshes are in the folder ``STEM_meshes``.
        program: path of the scene's program, to add a supervisor that runs the program's behaviors in this world. Objects with
            ``webotsAdhoc`` are then left out, since the supervisor makes them.
        params: parameters that the program was loaded with.

    Raises:
        ScenicValueError: two objects have one ``webotsName``, or a name cannot be a DEF name.

    """
    names = def_names(scene.objects)
    instances = picture([scene]).scenes[0]
    files: dict[str, bytes] = {}
    protos: list[str] = []
    nodes: list[str] = []
    world_path = scene.params.get(WORLD_PARAMETER)
    world = None if world_path is None else read_world(str(world_path))
    frame = None if world is None else world.matrix
    for instance, label in zip(instances, _labels(instances), strict=True):
        thing: Any = instance.thing
        name = names[id(thing)]
        made_later = program is not None and getattr(thing, "webotsAdhoc", None) is not None
        if made_later or (world is not None and name in world.names):
            continue
        proto = getattr(thing, "webotsProto", None)
        if proto is None:
            nodes.append(solid(thing, stem, files, name, label, instance.color, frame=frame))
        else:
            protos.append(_address(str(proto)))
            nodes.append(_robot(thing, PurePosixPath(protos[-1]).stem, name, label, frame))
    protos = list(dict.fromkeys(protos))
    supervisor = "" if program is None else _supervisor(scene, Path(program).absolute(), params, files)
    if world is not None:
        return World(_extended(world, protos, "".join(nodes) + supervisor), files)
    externals = "".join(f"EXTERNPROTO {_text(address)}\n" for address in protos)
    surroundings = _surroundings(scene, instances)
    return World(f"{_HEADER}\n{externals}\n{surroundings}{''.join(nodes)}{supervisor}", files)


def _address(proto: str) -> str:
    address = _ADDRESSES.get(proto, proto)
    return address if address.endswith(".proto") else f"../protos/{proto}.proto"


def _extended(world: WorldFile, protos: Sequence[str], nodes: str) -> str:
    """The text of a world with more nodes at its end, and the PROTOs that they need declared if its version wants that."""
    text = world.text if world.text.endswith("\n") else f"{world.text}\n"
    if world.declares_protos:
        head, _, rest = text.partition("\n")
        missing = [address for address in protos if f"/{PurePosixPath(address).name}" not in text]
        text = head + "".join(f"\nEXTERNPROTO {_text(address)}" for address in missing) + f"\n{rest}"
    return f"{text}{nodes}"


def def_names(objects: Sequence[object]) -> dict[int, str]:
    """The DEF names of the nodes of a scene's objects, by the identities of the objects.

    It is an object's ``webotsName``; otherwise ``TYPE_0``, ``TYPE_1`` and so on for objects of one ``webotsType``, and
    ``object_NUMBER`` for the others. A supervisor finds the nodes by the same rule.

    Raises:
        ScenicValueError: two objects have one name, or a name cannot be a DEF name.

    """
    names: dict[int, str] = {}
    things_by_name: dict[str, Any] = {}
    types: Counter[str] = Counter()
    for number, thing in enumerate(objects):
        name, kind = getattr(thing, "webotsName", None), getattr(thing, "webotsType", None)
        if name is not None:
            name = str(name)
        elif kind is not None:
            name = f"{kind}_{types[str(kind)]}"
            types[str(kind)] += 1
        else:
            name = f"object_{number}"
        if not _DEF.fullmatch(name):
            raise ScenicValueError(
                f"{name!r} of {thing!r} is not a DEF name of Webots",
                help="`webotsName` and `webotsType` are letters, digits and `_`, and begin with no digit",
            )
        if name in things_by_name or name in _RESERVED:
            other = f"{things_by_name[name]!r}" if name in things_by_name else "a node of every written world"
            raise ScenicValueError(
                f"{thing!r} has the DEF name {name} of {other}",
                help="give each object a `webotsName` of its own, or all of them one `webotsType`",
            )
        things_by_name[name] = thing
        names[id(thing)] = name
    return names


def _labels(instances: Sequence[MeshInstance]) -> list[str]:
    """Different names for the nodes; Webots allows no colon in them."""
    labels: list[str] = []
    for label in distinct_labels(instances):
        plain = label.replace(":", "_")
        while plain in labels or plain in ("floor", _SUPERVISOR_NAME):
            plain += "_"
        labels.append(plain)
    return labels


def write_world(
    scene: Scene,
    path: Path,
    *,
    program: str | Path | None = None,
    params: Mapping[str, object] = MappingProxyType({}),
) -> None:
    """Write `webots_world` to a ``.wbt`` file and the folder beside it; raises ``OutputError``."""
    world = webots_world(scene, path.stem, program=program, params=params)
    for name, content in world.files.items():
        place = path.parent / name
        make_folder(place.parent)
        write(place, content)
    write(path, world.text.encode())


def solid(
    thing: object,
    stem: str,
    files: dict[str, bytes],
    name: str,
    label: str,
    color: Sequence[float] = _GRAY,
    *,
    physics: bool | None = None,
    frame: Array | None = None,
) -> str:
    """Return a ``Solid`` of an object.

    Args:
        thing: the object.
        stem: meshes are in the folder ``STEM_meshes``.
        files: gets the file of its mesh, if it needs one.
        name: the node's DEF name, and that of the file of its mesh.
        label: the node's field ``name``.
        color: red, green, blue and perhaps opacity, from 0 to 1.
        physics: whether it moves; by default if it has a density or a mass.
        frame: the matrix ``(3, 3)`` that takes vectors of ours to those of the world, if it has other axes.

    """
    geometry = _geometry(thing, stem, files, name)
    opacity = color[3] if len(color) > 3 else 1.0
    look = f"baseColor {_numbers(color[:3])} transparency {_number(1 - opacity)} roughness 1 metalness 0"
    density, mass = (getattr(thing, name, None) for name in ("density", "mass"))
    moves = (density is not None or mass is not None) if physics is None else physics
    lines = [
        f"children [ Shape {{ appearance PBRAppearance {{ {look} }} geometry {geometry} }} ]",
        f"name {_text(label)}",
        f"boundingObject {geometry}",
    ]
    if moves and mass is not None:
        lines.append(f"physics Physics {{ density -1 mass {_number(mass)} }}")
    elif moves:
        lines.append(
            f"physics Physics {{ density {_number(1000.0 if density is None else density)} mass -1 }}"
        )
    return _node("Solid", thing, name, lines, frame)


def mesh_file(thing: Any) -> bytes:
    """The closed mesh of an object in its own frame and size (metres), as Wavefront OBJ."""
    source = thing.shape.mesh
    size = np.array([thing.width, thing.length, thing.height], dtype=np.float64)
    lines = [f"v {x:.12g} {y:.12g} {z:.12g}" for x, y, z in (np.asarray(source.vertices) * size).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (np.asarray(source.faces) + 1).tolist()]
    return ("\n".join(lines) + "\n").encode()


def _geometry(thing: Any, stem: str, files: dict[str, bytes], name: str) -> str:
    width, length, height = float(thing.width), float(thing.length), float(thing.height)
    heights = getattr(thing, "heights", None)
    if heights is not None:
        values = np.asarray(heights, dtype=np.float64)
        rows, columns = values.shape
        thickness = float(values.min()) + float(getattr(thing, "baseThickness", 0))
        return (
            f"ElevationGrid {{ xDimension {columns} yDimension {rows} xSpacing {_number(width / (columns - 1))}"
            f" ySpacing {_number(length / (rows - 1))} thickness {_number(thickness)} height {_numbers(values.ravel(), listed=True)} }}"
        )
    source = thing.shape.source
    if source.initial_rotation is None:
        if source.kind == "box":
            return f"Box {{ size {_numbers((width, length, height))} }}"
        if source.kind == "cylinder" and width == length:
            return f"Cylinder {{ radius {_number(width / 2)} height {_number(height)} subdivision 32 }}"
        if source.kind == "spheroid" and width == length == height:
            return f"Sphere {{ radius {_number(width / 2)} subdivision 3 }}"
    file = f"{stem}_meshes/{name}.obj"
    files[file] = mesh_file(thing)
    return f"Mesh {{ url [ {_text(file)} ] }}"


def _robot(thing: object, proto: str, name: str, label: str, frame: Array | None = None) -> str:
    lines = [f"name {_text(label)}"]
    colors = ["primaryColor", "secondaryColor"] if hasattr(thing, "primaryColor") else ["color"]
    for field_name in (
        "shirtColor",
        "pantsColor",
        "shoesColor",
        *(colors if hasattr(thing, "roadDeviation") else ()),
    ):
        value = getattr(thing, field_name, None)
        if value is not None:
            lines.append(f"{field_name} {_numbers(value[:3])}")
    for field_name in ("controller", "customData"):
        value = getattr(thing, field_name, None)
        if value is not None:
            lines.append(f"{field_name} {_text(str(value))}")
    battery = getattr(thing, "battery", None)
    if battery is not None:
        lines.append(f"battery {_numbers(battery, listed=True)}")
    return _node(proto, thing, name, lines, frame)


def _node(kind: str, thing: Any, name: str, lines: Sequence[str], frame: Array | None = None) -> str:
    from scipy.spatial.transform import Rotation  # slow to import

    turn = thing.orientation
    rotation = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w])
    rotation = rotation * Rotation.from_euler("ZXY", getattr(thing, "rotationOffset", (0, 0, 0)))
    if frame is not None:
        rotation = Rotation.from_matrix(frame @ rotation.as_matrix() @ frame.T)
    vector = rotation.as_rotvec()
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle else np.array([0.0, 0.0, 1.0])
    shift = np.array(tuple(getattr(thing, "positionOffset", (0, 0, 0))), dtype=np.float64)
    place = np.array(tuple(thing.position), dtype=np.float64) + shift
    if frame is not None:
        place = frame @ place
    body = [f"translation {_numbers(place)}", f"rotation {_numbers((*axis, angle))}", *lines]
    return f"DEF {name} {kind} {{\n" + "".join(f"  {line}\n" for line in body) + "}\n"


def _surroundings(scene: Scene, instances: Sequence[MeshInstance]) -> str:
    """Return the nodes of a world beside its objects: settings, view, sky, light and floor."""
    from scipy.spatial.transform import Rotation

    points = corners(instances) if instances else np.zeros((1, 3))
    low, high = points.min(axis=0), points.max(axis=0)
    middle, reach = (low + high) / 2, float(np.linalg.norm(high - low)) + _MARGIN
    # The camera of a viewpoint looks along its x axis, with z upwards.
    view = Rotation.from_euler("ZY", [np.pi / 2, np.radians(40)])
    place = middle - reach * 1.2 * view.apply([1.0, 0.0, 0.0])
    vector = view.as_rotvec()
    angle = float(np.linalg.norm(vector))
    width, length = (high - low + 2 * _MARGIN)[:2].tolist()
    floor = f"Plane {{ size {_numbers((width, length))} }}"
    return (
        f"WorldInfo {{\n  info [ {_text(f'scene {scene.k} of seed {scene.seed}')} ]\n  basicTimeStep {_STEP}\n"
        '  coordinateSystem "ENU"\n}\n'
        f"Viewpoint {{\n  orientation {_numbers((*(vector / angle), angle))}\n  position {_numbers(place)}\n}}\n"
        "Background {\n  skyColor [ 0.7 0.8 0.9 ]\n}\n"
        "DirectionalLight {\n  ambientIntensity 0.5\n  direction 0.5 0.3 -1\n  intensity 2\n  castShadows TRUE\n}\n"
        f"DEF FLOOR Solid {{\n  translation {_numbers((middle[0], middle[1], ground_height(points)))}\n"
        f"  children [ Shape {{ appearance PBRAppearance {{ baseColor 0.75 0.75 0.75 roughness 1 metalness 0 }} geometry {floor} }} ]\n"
        f'  name "floor"\n  boundingObject {floor}\n  locked TRUE\n}}\n'
    )


def _supervisor(scene: Scene, program: Path, params: Mapping[str, object], files: dict[str, bytes]) -> str:
    """Return a robot that runs the program's behaviors in this world, and its controller."""
    script = f'''"""Runs the behaviors of a Scenic program in this world, on its scene {scene.k} of seed {scene.seed}."""

from controller import Supervisor

import scenic
from scenic.simulators.webots.simulator import WebotsSimulator

scenario = scenic.load({str(program)!r}, params={dict(params)!r})
scene = scenario.sample({scene.k + 1}, seed={scene.seed})[{scene.k}]
WebotsSimulator(Supervisor()).simulate(scene)
'''
    files[f"../controllers/{_SUPERVISOR}/{_SUPERVISOR}.py"] = script.encode()
    return f'DEF SCENIC Robot {{\n  name "{_SUPERVISOR_NAME}"\n  controller "{_SUPERVISOR}"\n  supervisor TRUE\n}}\n'


def _number(value: Any) -> str:
    return repr(float(value))


def _numbers(values: Any, *, listed: bool = False) -> str:
    text = " ".join(_number(value) for value in values)
    return f"[ {text} ]" if listed else text


def _text(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
