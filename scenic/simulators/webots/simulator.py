"""Simulations inside Webots: a supervisor's controller gives its ``Supervisor``, and this moves the nodes of the world.

Only the documented interface of ``Supervisor``, ``Node`` and ``Field`` is used.
"""

import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from scenic.formats.files import make_folder, write
from scenic.formats.webots import solid
from scenic.language.errors import SimulationCreationError, SimulationError, UnsupportedError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator
from scenic.simulators.webots.axes import Axes, axis_angle, matrix_of, orientation_of
from scenic.simulators.webots.nodes import NodeNames, States, field_of, write_heights

__all__ = ["OutsideWebots", "WebotsSimulation", "WebotsSimulator"]

_DEFAULT_AXES: Final = "ENU"
_INSIDE: Final = (
    "write the world by `scenic sample FILE -o world.wbt`, and call WebotsSimulator().simulate(scene) in the controller of a"
    " supervisor"
)


class OutsideWebots(Simulator):
    """The simulator of programs for Webots that are run elsewhere: it can only say where to go."""

    def createSimulation(self, scene: Scene, **options: Any) -> Simulation:
        """Raises `UnsupportedError`."""
        raise UnsupportedError(
            "programs with the world model of Webots are simulated inside Webots", help=_INSIDE
        )


class WebotsSimulator(Simulator):
    """Simulates in a running Webots world.

    A simulation begins by returning the nodes that earlier ones have changed to the state that they had before.

    Args:
        supervisor: ``controller.Supervisor()`` of the controller that this runs in; made here if ``None``.

    Raises:
        UnsupportedError: this does not run in a controller of Webots.
        SimulationCreationError: the robot is not a supervisor, or the world's coordinate system is unknown.

    """

    def __init__(self, supervisor: Any = None) -> None:
        super().__init__()
        self.supervisor = _supervisor() if supervisor is None else supervisor
        self.axes = Axes(_coordinate_system(self.supervisor))
        self._states = States()

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> "WebotsSimulation":
        """Return a simulation that has run; the default step is the world's basic one."""
        basic = float(self.supervisor.getBasicTimeStep()) / 1000
        step = basic if timestep is None else timestep
        ratio = step / basic
        if ratio < 0.5 or abs(ratio - round(ratio)) > 1e-6:
            raise SimulationCreationError(
                f"a step of {step:g} s is no multiple of the world's basic step of {basic:g} s",
                help="give another timestep, or change WorldInfo.basicTimeStep",
            )
        self._states.load()
        return WebotsSimulation(scene, self.supervisor, self.axes, self._states, timestep=step, **options)


def _supervisor() -> Any:
    try:
        from controller import Supervisor  # type: ignore[import-not-found] # comes with Webots
    except ImportError as error:
        raise UnsupportedError(
            "this does not run in Webots: there is no module `controller` with a class `Supervisor`",
            help=_INSIDE,
        ) from error
    return Supervisor()


def _coordinate_system(supervisor: Any) -> str:
    """Return the value of ``WorldInfo.coordinateSystem``; raises `SimulationCreationError` if the robot is not a supervisor."""
    get_supervisor = getattr(supervisor, "getSupervisor", None)
    root = None if get_supervisor is not None and not get_supervisor() else supervisor.getRoot()
    if root is None:
        raise SimulationCreationError(
            "the robot of this controller is not a supervisor",
            help="set the field `supervisor` of its node to TRUE, and save the world",
        )
    children = root.getField("children")
    for number in range(children.getCount()):
        node = children.getMFNode(number)
        if node.getTypeName() == "WorldInfo":
            return str(node.getField("coordinateSystem").getSFString()) or _DEFAULT_AXES
    return _DEFAULT_AXES


class WebotsSimulation(Simulation):
    """One run in a world; see `WebotsSimulator`."""

    def __init__(
        self, scene: Scene, supervisor: Any, axes: Axes, states: States, *, timestep: float, **options: Any
    ) -> None:
        self.supervisor = supervisor
        self.axes = axes
        self._states = states
        self._names = NodeNames(supervisor)
        self._nodes: dict[int, Any] = {}
        self._made: list[Any] = []
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        super().__init__(scene, timestep=timestep, **options)

    # Set-up

    def createObjectInSimulator(self, obj: Any) -> None:
        """Find or make the object's node, and bring it into the object's state.

        Objects without a node, such as the parts of a terrain, stay as they are in the scene.
        """
        node = self._node(obj)
        if node is None:
            return
        self._nodes[id(obj)] = node
        obj.webotsObject = node
        self._write(obj, node)
        if not self._has_pose(obj):
            return
        self.move(obj, obj.position)
        self._turn(obj, obj.orientation)
        node.resetPhysics()
        if node.getField("physics") is not None:
            node.setVelocity([*self.axes.place(obj.velocity), *self.axes.spin(obj.angularVelocity)])
        self._start_controller(obj, node)

    def _write(self, obj: object, node: Any) -> None:
        """Write the fields of the node that the object has properties for."""
        density = getattr(obj, "density", None)
        physics = node.getField("physics")
        if density is not None and physics is not None and physics.getSFNode() is not None:
            physics.getSFNode().getField("density").setSFFloat(float(density))
        battery = getattr(obj, "battery", None)
        if battery is not None:
            numbers = [float(value) for value in battery]
            if len(numbers) != 3:
                raise SimulationCreationError(
                    f"the battery of {obj!r} must be three numbers, not {battery!r}",
                    help="the present energy, its maximum (joules), and how fast it is charged (watts)",
                )
            field = field_of(obj, node, "battery")
            for place, value in enumerate(numbers):
                if place < field.getCount():
                    field.setMFFloat(place, value)
                else:
                    field.insertMFFloat(-1, value)
        text = getattr(obj, "customData", None)
        if text is not None:
            field_of(obj, node, "customData").setSFString(str(text))
        if getattr(obj, "heights", None) is not None:
            write_heights(obj, node)

    def _start_controller(self, obj: object, node: Any) -> None:
        """Start the object's controller: Webots does so by itself where the field changes."""
        name = getattr(obj, "controller", None)
        if name is None:
            return
        field = field_of(obj, node, "controller")
        if field.getSFString() != str(name):
            field.setSFString(str(name))
        elif getattr(obj, "resetController", True):
            node.restartController()

    def _node(self, obj: object) -> Any:
        """Return the node of an object in the world; raises `SimulationCreationError`."""
        adhoc = getattr(obj, "webotsAdhoc", None)
        if adhoc is not None:
            return self._adhoc(obj, adhoc)
        node = self._names.node(obj, len(self.objects) - 1)
        if node is not None:
            self._states.save(node)
        return node

    def _adhoc(self, obj: Any, options: Any) -> Any:
        """Return a new node with the object's shape."""
        if not isinstance(options, Mapping):
            raise SimulationCreationError(
                f"the webotsAdhoc of {obj!r} must be a mapping, not {options!r}",
                help="`{}`, or `{'physics': False}` for what does not move",
            )
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="scenic-webots-")
        files: dict[str, bytes] = {}
        number = len(self.objects) - 1
        color = getattr(obj, "color", None) or (0.8, 0.8, 0.8)
        stem = str(Path(self._folder.name) / "adhoc")
        text = solid(
            obj,
            stem,
            files,
            f"SCENIC_ADHOC_{number}",
            f"scenic object {number}",
            color,
            physics=bool(options.get("physics", True)),
        )
        for name, content in files.items():
            make_folder(Path(name).parent)
            write(Path(name), content)
        children = self.supervisor.getRoot().getField("children")
        children.importMFNodeFromString(-1, text)
        node = children.getMFNode(-1)
        self._made.append(node)
        return node

    def _has_pose(self, obj: object) -> bool:
        return self._nodes[id(obj)].getField("translation") is not None

    def destroy(self) -> None:
        """Remove what was made."""
        for node in self._made:
            node.remove()
        self._made = []
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    # Commands

    def move(self, obj: object, position: Any) -> None:
        """Put an object at a position (metres)."""
        place = Vector(*position) + Vector(*getattr(obj, "positionOffset", (0, 0, 0)))
        self._moved(obj).getField("translation").setSFVec3f(self.axes.place(place))

    def _turn(self, obj: object, orientation: Orientation) -> None:
        turned = self.axes.turn(orientation_of(matrix_of(orientation) @ matrix_of(_offset(obj))))
        self._nodes[id(obj)].getField("rotation").setSFRotation(axis_angle(turned))

    def push(self, obj: Any, force: Any, relative: bool) -> None:
        """Apply a force (newtons) for one step."""
        node = self._moved(obj)
        if relative:
            # The node's own axes are those of the object, turned by the rotation offset.
            force = matrix_of(_offset(obj)).T @ np.array(tuple(force), dtype=np.float64)
        node.addForce(self.axes.place(force), relative)

    def _moved(self, obj: object) -> Any:
        """Return the node of an object that is to move; raises `SimulationError` if it has none."""
        node = self._nodes.get(id(obj))
        if node is None or node.getField("translation") is None:
            raise SimulationError(
                f"{obj!r} cannot be moved: it has no node with a translation in the world",
                help="name a node by `webotsName` or `webotsType`, or let the object be made: `with webotsAdhoc {}`",
            )
        return node

    # Steps

    def step(self) -> None:
        """Let Webots advance."""
        if self.supervisor.step(round(1000 * self.timestep)) == -1:
            raise SimulationError(
                "Webots ended the simulation", help="run it again: the world was reloaded or closed"
            )

    def getProperties(self, obj: object, properties: Any) -> Mapping[str, Any]:
        """Read the state of the object's node."""
        attributes, node = obj.__dict__, self._nodes.get(id(obj))
        if node is None or not self._has_pose(obj):
            return {name: attributes[name] for name in properties}
        offset = Vector(*getattr(obj, "positionOffset", (0, 0, 0)))
        position = Vector(*self.axes.place_here(node.getPosition()).tolist()) - offset
        numbers = list(node.getVelocity())
        velocity = Vector(*self.axes.place_here(numbers[:3]).tolist())
        spin = Vector(*self.axes.spin_here(numbers[3:]).tolist())
        angles = matrix_of(self.axes.turn_here(node.getOrientation()))
        orientation = orientation_of(angles @ matrix_of(_offset(obj)).T)
        yaw, pitch, roll = (attributes["parentOrientation"].inverse * orientation).eulerAngles
        values: dict[str, Any] = {
            "position": position,
            "velocity": velocity,
            "speed": velocity.norm(),
            "angularVelocity": spin,
            "angularSpeed": spin.norm(),
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
            "elevation": float(position.z),
        }
        battery = node.getField("battery") if "battery" in properties else None
        if battery is not None and attributes.get("battery") is not None:
            values["battery"] = tuple(battery.getMFFloat(place) for place in range(battery.getCount()))
        return {name: values[name] if name in values else attributes[name] for name in properties}


def _offset(obj: object) -> Orientation:
    yaw, pitch, roll = (float(angle) for angle in getattr(obj, "rotationOffset", (0, 0, 0)))
    if not all(map(math.isfinite, (yaw, pitch, roll))):
        raise SimulationCreationError(
            f"the rotationOffset of {obj!r} must be finite", help="yaw, pitch and roll in radians"
        )
    turn: Orientation = Orientation.fromEuler(yaw, pitch, roll)
    return turn
