"""Simulations as OpenSCENARIO XML 1.3: entities, and the trajectory that each of them follows.

OpenSCENARIO's frames are those of ISO 8855: x ahead, y to the left, z up; heading anticlockwise from east, pitch positive with the
nose down. The reference point of a vehicle is the middle of its rear axle on the ground, that of everything else the middle of its
base; so the centre of a bounding box lies ahead of it and above it.
"""

import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.dataclass import dataclass
from scenic.formats.files import write
from scenic.language.errors import UnsupportedError
from scenic.language.extras import needing
from scenic.runtime.values.values import Orientation, Vector

__all__ = [
    "OpenScenarioFile",
    "map_beside",
    "map_offset",
    "openscenario_about",
    "openscenario_document",
    "openscenario_support",
    "stands_on_ground",
    "variables_of",
]

Floats = NDArray[np.float64]
Poses = Sequence[tuple[Any, Any]]

_PROPERTY: Final = "scenic-simulation"
"""Property of the file header that contains the first line of a trajectory file."""

_MASS: Final = 65.0
"""Kilograms of a pedestrian that states none."""

_CATEGORIES: Final = (
    ("Motorcycle", "motorbike"),
    ("Bicycle", "bicycle"),
    ("Truck", "truck"),
    ("Bus", "bus"),
    ("Van", "van"),
)
"""Categories of vehicles by the names of classes; others are cars."""


def openscenario_support() -> Any:
    """Return the module ``scenariogeneration.xosc``; raises `UnsupportedError` without it. It is met here alone."""
    words = "OpenSCENARIO files need the package scenariogeneration"
    with needing(words, "openscenario", instead="; or write JSON Lines"):
        from scenariogeneration import xosc  # optional
    return xosc


@dataclass(frozen=True, slots=True)
class _Entity:
    """An object of the scene, its name in the file, and where its reference point is from its centre (own frame, metres)."""

    thing: Any
    name: str
    is_vehicle: bool
    offset: tuple[float, float, float]


def openscenario_document(
    things: Sequence[object],
    poses: Sequence[Poses],
    *,
    timestep: float,
    map_path: str,
    name: str,
    flat: bool,
    names: Sequence[str | None] = (),
    properties: Mapping[str, str] | None = None,
    offset: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
) -> Any:
    """Return a ``scenariogeneration.xosc.Scenario`` of a simulation.

    Args:
        things: the objects, with their names, sizes and what cars say of their axles.
        poses: position (metres) and orientation of each of them, for each state.
        timestep: seconds between states.
        map_path: of the OpenDRIVE file.
        name: of the scenario.
        flat: whether positions are on the ground rather than in the middle of the objects.
        names: of the variables of the objects, where they have some.
        properties: of the file header.
        offset: of the map's header: metres along x, y and z, and radians, by which players move the map.

    Raises:
        UnsupportedError: the package ``scenariogeneration`` is not installed.

    """
    xosc = openscenario_support()
    entities = _entities(things, names or [None] * len(things), flat=flat)
    document_entities, init = xosc.Entities(), xosc.Init()
    act = xosc.Act("Simulation", _when(xosc, "begins", 0.0))
    times = [float(step * timestep) for step in range(len(poses))]
    for index, entity in enumerate(entities):
        document_entities.add_scenario_object(entity.name, _scenario_object(xosc, entity))
        places = _places(xosc, entity, [state[index] for state in poses], offset)
        init.add_init_action(entity.name, xosc.TeleportAction(places[0]))
        speed = math.hypot(*entity.thing.velocity)
        if speed:
            at_once = xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0)
            init.add_init_action(entity.name, xosc.AbsoluteSpeedAction(speed, at_once))
        if len(places) > 1:
            act.add_maneuver_group(_followed(xosc, entity.name, times, places))
    story = xosc.StoryBoard(init, _when(xosc, "ends", times[-1], start=False))
    if len(times) > 1 and entities:
        story.add_act(act)
    header = xosc.Properties()
    for key, value in (properties or {}).items():
        header.add_property(key, value)
    return xosc.Scenario(
        name,
        "Scenic",
        xosc.ParameterDeclarations(),
        document_entities,
        story,
        xosc.RoadNetwork(roadfile=map_path),
        xosc.Catalog(),
        osc_minor_version=3,
        header_properties=header if properties else None,
    )


def stands_on_ground(scene: Any) -> bool:
    """Return whether positions in a scene are on the ground, as on flat maps, rather than in the middle of the objects."""
    return bool(scene.program.context.mode_2d or scene.params.get("use2DMap"))


def variables_of(scene: Any) -> list[str | None]:
    """The names of the variables of a scene's objects; ``None`` for objects without one."""
    return [scene.names.get(thing) for thing in scene.objects]


def map_beside(path: Any, folder: Path) -> str:
    """The path of a map as a file in a folder names it: relative to the folder, if both are on one drive."""
    file = Path(path)
    if not file.is_file() and file.with_suffix(".xodr").is_file():
        file = file.with_suffix(".xodr")
    try:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    except ValueError:  # another drive
        return str(file.resolve())


def _entities(things: Sequence[Any], names: Sequence[str | None], *, flat: bool) -> list[_Entity]:
    names_in_use: set[str] = set()
    entities: list[_Entity] = []
    for index, (thing, variable) in enumerate(zip(things, names, strict=True)):
        is_vehicle = bool(getattr(thing, "isVehicle", False))
        kind = (
            "Vehicle" if is_vehicle else "Pedestrian" if getattr(thing, "isPedestrian", False) else "Object"
        )
        own_name = getattr(thing, "name", None)
        base_name = own_name if isinstance(own_name, str) and own_name else variable or f"{kind}{index}"
        name, number = base_name, 2
        while name in names_in_use:
            name, number = f"{base_name}_{number}", number + 1
        names_in_use.add(name)
        back = -_wheelbase(thing) / 2 if is_vehicle else 0.0
        entities.append(_Entity(thing, name, is_vehicle, (0.0, back, 0.0 if flat else -thing.height / 2)))
    return entities


def _wheelbase(thing: Any) -> float:
    return float(getattr(thing, "wheelbase", 0.6 * thing.length))


def _scenario_object(xosc: Any, entity: _Entity) -> Any:
    thing = entity.thing
    width, length, height = float(thing.width), float(thing.length), float(thing.height)
    box = xosc.BoundingBox(width, length, height, -entity.offset[1], 0.0, height / 2)
    mass = getattr(thing, "mass", None)
    if not entity.is_vehicle:
        if getattr(thing, "isPedestrian", False):
            weight = _MASS if mass is None else float(mass)
            return xosc.Pedestrian(entity.name, weight, xosc.PedestrianCategory.pedestrian, box)
        return xosc.MiscObject(
            entity.name, 0.0 if mass is None else float(mass), xosc.MiscObjectCategory.obstacle, box
        )
    steering = float(getattr(thing, "maxSteeringAngle", math.radians(35)))
    wheel, track = (
        float(getattr(thing, "wheelDiameter", 0.7)),
        float(getattr(thing, "trackWidth", 0.85 * width)),
    )
    clearance = float(getattr(thing, "groundClearance", wheel / 2))
    names = {cls.__name__ for cls in type(thing).__mro__}
    category = next((value for cls, value in _CATEGORIES if cls in names), "car")
    return xosc.Vehicle(
        entity.name,
        getattr(xosc.VehicleCategory, category),
        box,
        xosc.Axle(steering, wheel, track, _wheelbase(thing), clearance),
        xosc.Axle(steering, wheel, track, 0.0, clearance),
        float(getattr(thing, "maxSpeed", 45.0)),
        float(getattr(thing, "maxAcceleration", 5.0)),
        float(getattr(thing, "maxDeceleration", 10.0)),
        mass=None if mass is None else float(mass),
    )


def map_offset(scene: Any) -> tuple[float, float, float, float]:
    """Return metres along x, y and z, and radians, by which the header of a scene's map moves its coordinates."""
    network = getattr(scene.workspace, "network", None)
    found: tuple[float, float, float, float] = getattr(network, "offset", (0.0, 0.0, 0.0, 0.0))
    return found


def _places(xosc: Any, entity: _Entity, poses: Poses, moved: tuple[float, float, float, float]) -> list[Any]:
    """Positions of the reference point; height, pitch and roll only where some state has them."""
    offset = Vector.of(entity.offset)
    points = np.array([tuple(position + offset.rotatedBy(orientation)) for position, orientation in poses])
    *shift, turn = moved
    sine, cosine = math.sin(turn), math.cos(turn)
    points[:, :2] = points[:, :2] @ np.array([[cosine, sine], [-sine, cosine]])
    points += shift
    angles = np.array([_euler(orientation) for _, orientation in poses])
    # Players interpolate between states: a heading that jumps by a whole turn would spin the entity.
    headings = np.unwrap(angles[:, 0] + math.pi / 2 + turn)
    rises, pitches, rolls = points[:, 2].any(), angles[:, 1].any(), angles[:, 2].any()
    return [
        xosc.WorldPosition(
            float(x),
            float(y),
            float(z) if rises else None,
            float(heading),
            float(-pitch) if pitches else None,
            float(roll) if rolls else None,
        )
        for (x, y, z), heading, (_, pitch, roll) in zip(points, headings, angles, strict=True)
    ]


def _euler(orientation: Orientation) -> tuple[float, float, float]:
    yaw, pitch, roll = orientation.eulerAngles
    return yaw, pitch, roll


def _followed(xosc: Any, name: str, times: Sequence[float], places: Sequence[object]) -> Any:
    """The group by which one entity follows its states."""
    trajectory = xosc.Trajectory(f"{name} trajectory", closed=False)
    trajectory.add_shape(xosc.Polyline(list(times), list(places)))
    action = xosc.FollowTrajectoryAction(
        trajectory,
        xosc.FollowingMode.position,
        reference_domain=xosc.ReferenceContext.absolute,
        scale=1,
        offset=0,
    )
    event = xosc.Event(f"{name} event", xosc.Priority.override)
    event.add_action(f"{name} action", action)
    event.add_trigger(_when(xosc, f"{name} begins", 0.0))
    maneuver = xosc.Maneuver(f"{name} maneuver")
    maneuver.add_event(event)
    group = xosc.ManeuverGroup(f"{name} group")
    group.add_actor(name)
    group.add_maneuver(maneuver)
    return group


def _when(xosc: Any, name: str, time: float, *, start: bool = True) -> Any:
    """A trigger at a time of the simulation in seconds."""
    condition = xosc.SimulationTimeCondition(time, xosc.Rule.greaterThan)
    point = "start" if start else "stop"
    return xosc.ValueTrigger(name, 0, xosc.ConditionEdge.none, condition, triggeringpoint=point)


class OpenScenarioFile:
    """A file of a simulation at ``path``, made when the simulation has ended.

    Raises `UnsupportedError` without the package ``scenariogeneration``.
    """

    def __init__(self, path: Path) -> None:
        openscenario_support()
        self._path = path
        self._poses: list[Poses] = []

    def add(self, _simulation: object, poses: Poses) -> None:
        """Take the next state: position and orientation of each object."""
        self._poses.append(poses)

    def finish(self, simulation: Any, about: Mapping[str, object]) -> None:
        """Write the file.

        Raises:
            UnsupportedError: the program has no map, or made objects while it ran.

        """
        from xml.etree import ElementTree

        scene = simulation.scene
        if "map" not in scene.params:
            raise UnsupportedError(
                "OpenSCENARIO needs a road network, and this program has no parameter `map`",
                help="use a driving model, or write JSON Lines",
            )
        if any(len(state) != len(scene.objects) for state in self._poses):
            raise UnsupportedError(
                "OpenSCENARIO has no objects that are made during the simulation", help="write JSON Lines"
            )
        document = openscenario_document(
            scene.objects,
            self._poses,
            timestep=simulation.timestep,
            map_path=map_beside(scene.params["map"], self._path.parent),
            name=self._path.stem,
            flat=stands_on_ground(scene),
            names=variables_of(scene),
            offset=map_offset(scene),
            properties={_PROPERTY: json.dumps(about, allow_nan=False, separators=(",", ":"))},
        )
        tree = document.get_element()
        ElementTree.indent(tree)
        write(self._path, ElementTree.tostring(tree, encoding="utf-8", xml_declaration=True) + b"\n")

    def close(self) -> None:
        """Give up what is not finished."""
        self._poses.clear()


def openscenario_about(path: Path) -> Any:
    """Read the data about the whole simulation from a file of this package; ``None`` for other files.

    Raises ``OSError`` or ``ValueError`` where it cannot be read.
    """
    from xml.etree import ElementTree

    try:
        header = ElementTree.parse(path).find("FileHeader/Properties")
    except ElementTree.ParseError as error:
        raise ValueError(f"{path} is not XML: {error}") from error
    for item in () if header is None else header.iter("Property"):
        if item.get("name") == _PROPERTY:
            return json.loads(item.get("value", "null"))
    return None
