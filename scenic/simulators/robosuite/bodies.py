"""Objects of a scene as objects of robosuite, and its tables as one of robosuite's arenas."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.language.errors import SimulationCreationError
from scenic.runtime.values.values import Vector
from scenic.simulators.robosuite.custom import geoms_of_shape, wrapped
from scenic.simulators.robosuite.library import library

__all__ = ["arena", "base_pose", "body", "body_pose", "middle", "placed_statically"]

Floats = NDArray[np.float64]

_FRONT: Final = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
"""The quarter turn ``(w, x, y, z)`` from +X, where the front of robosuite's robots is, to +Y, where that of our objects is."""


def body(thing: Any, name: str) -> Any:
    """Return the object of robosuite for one of ours; the origin of its body is wherever robosuite has it (`middle`)."""
    library()
    from robosuite.models import objects

    joints = None if thing.dynamics == "static" else "default"
    if getattr(thing, "robosuite_class", None) is not None:
        model = getattr(objects, thing.robosuite_class)(name=name)
        if joints is None:
            for joint in model.get_obj().findall("joint"):
                model.get_obj().remove(joint)
        return model
    size = np.array([thing.width, thing.length, thing.height]) / 2
    source = thing.shape.source
    options = {
        "density": float(getattr(thing, "density", 1000.0)),
        "friction": _triple(getattr(thing, "friction", 1.0)),
        "solref": list(getattr(thing, "solref", (0.02, 1.0))),
        "solimp": list(getattr(thing, "solimp", (0.9, 0.95, 0.001))),
        "rgba": [*(thing.color or (0.6, 0.62, 0.66)), 1.0][:4],
        "joints": joints,
    }
    form = None if getattr(thing, "mjcf", None) is not None or source.initial_rotation else source.kind
    is_round = size[0] == size[1]
    if form == "box":
        return objects.BoxObject(name=name, size=size.tolist(), **options)
    if form == "spheroid" and is_round and size[1] == size[2]:
        return objects.BallObject(name=name, size=[size[0]], **options)
    if form == "cylinder" and is_round:
        if getattr(thing, "capsule", False):
            return objects.CapsuleObject(name=name, size=[size[0], size[2] - size[0]], **options)
        return objects.CylinderObject(name=name, size=[size[0], size[2]], **options)
    with TemporaryDirectory() as folder:
        path = Path(folder, "object.xml")
        path.write_bytes(
            wrapped(thing.mjcf) if form is None and thing.mjcf else geoms_of_shape(thing, options)
        )
        return objects.MujocoXMLObject(str(path), name=name, joints=joints)


def middle(made: Any) -> Floats:
    """Return the middle of the box around what touches others of an object of robosuite, in its body's frame ``(3,)``, metres."""
    library()
    import mujoco
    from robosuite.models.arenas import EmptyArena
    from robosuite.models.tasks import Task

    task = Task(mujoco_arena=EmptyArena(), mujoco_robots=[], mujoco_objects=[made])
    model = mujoco.MjModel.from_xml_string(task.get_xml())
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    root = model.body(made.root_body).id
    back = data.xmat[root].reshape(3, 3).T
    corners = []
    for geom in range(model.ngeom):
        if model.body_rootid[model.geom_bodyid[geom]] != root or not model.geom_contype[geom]:
            continue
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            first, count = (
                table[model.geom_dataid[geom]] for table in (model.mesh_vertadr, model.mesh_vertnum)
            )
            points = model.mesh_vert[first : first + count]
        else:
            box = model.geom_aabb[geom]
            points = box[:3] + box[3:] * np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
        turn = back @ data.geom_xmat[geom].reshape(3, 3)
        corners.append(points @ turn.T + back @ (data.geom_xpos[geom] - data.xpos[root]))
    if not corners:
        return np.zeros(3)
    all_corners = np.concatenate(corners)
    return np.asarray((all_corners.min(axis=0) + all_corners.max(axis=0)) / 2, np.float64)


def body_pose(thing: Any, offset: Floats) -> tuple[Floats, Floats]:
    """Return the position ``(3,)`` and orientation ``(w, x, y, z)`` of the body of an object whose middle is at an offset ``(3,)``."""
    turn = thing.orientation
    local = Vector.of(tuple(offset.tolist())).rotatedBy(turn)
    return np.array(tuple(thing.position - local)), np.array([turn.w, turn.x, turn.y, turn.z])


def base_pose(thing: Any) -> tuple[Floats, Floats]:
    """The lowest point of a robot's base ``(3,)`` and its orientation ``(w, x, y, z)`` in robosuite, where its front is +X."""
    import mujoco

    position, turn = body_pose(thing, np.array([0.0, 0.0, float(thing.height) / 2]))
    result = np.empty(4)
    mujoco.mju_mulQuat(result, turn, _FRONT)
    return position, result


def arena(tables: Sequence[Any]) -> Any:
    """Return the arena with the tables of a scene.

    Raises:
        SimulationCreationError: robosuite cannot have the tables.

    """
    library()
    from robosuite.models import arenas

    if not tables:
        return arenas.EmptyArena()
    for table in tables:
        if abs(table.orientation.x) + abs(table.orientation.y) > 1e-6:
            raise SimulationCreationError(
                f"tables of robosuite stand upright, and {table!r} does not",
                help="use a RoboSuiteObject with `dynamics 'static'`",
            )
    sizes = [[float(table.width), float(table.length), float(table.height)] for table in tables]
    tops = [[float(table.x), float(table.y), float(table.z + table.height / 2)] for table in tables]
    frictions = [_triple(table.friction) for table in tables]
    kinds = {table.arena for table in tables}
    if len(tables) == 1 and kinds != {"table"}:
        return _special_arena(arenas, kinds.pop(), sizes[0], tops[0], frictions[0])
    if kinds != {"table"}:
        raise SimulationCreationError(
            "an arena of robosuite with bins or pegs has no other tables",
            help="use objects of the class Table alone, or one arena",
        )
    turns = [float(table.heading) for table in tables]
    if len(tables) == 1 and abs(turns[0]) < 1e-9:
        return arenas.TableArena(sizes[0], frictions[0], tops[0], has_legs=tables[0].has_legs)
    legs = [table.has_legs for table in tables]
    return arenas.MultiTableArena(np.array(tops), turns, sizes, frictions, legs)


def _special_arena(arenas: Any, kind: str, size: list[float], top: list[float], friction: list[float]) -> Any:
    if kind == "bins":
        made = arenas.BinsArena()
        made.set_origin([top[0] - 0.1, top[1], top[2] - 0.8])
        return made
    if kind == "pegs":
        return arenas.PegsArena(size, friction, top)
    raise SimulationCreationError(
        f"robosuite has no arena {kind!r} here", help="the property `arena` is 'table', 'bins' or 'pegs'"
    )


def _triple(friction: Any) -> list[float]:
    """Return sliding, torsional and rolling friction; the last two are MuJoCo's defaults if only the first is given."""
    if isinstance(friction, int | float):
        return [float(friction), 0.005, 0.0001]
    return [float(part) for part in friction]


def placed_statically(made: Any, position: Floats, turn: Floats) -> None:
    """Put an object without a joint at a pose: position ``(3,)`` of its body, orientation ``(w, x, y, z)``."""
    element: ET.Element = made.get_obj()
    element.set("pos", " ".join(map(repr, position.tolist())))
    element.set("quat", " ".join(map(repr, turn.tolist())))
