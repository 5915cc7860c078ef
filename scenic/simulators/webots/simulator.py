"""Simulations inside Webots: a supervisor's controller gives its ``Supervisor``, and this moves the nodes of the world.

Only the documented interface of ``Supervisor``, ``Node`` and ``Field`` is used.
"""

import math
import tempfile
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from scenic.formats.files import make_folder, write
from scenic.formats.webots import solid
from scenic.language.errors import SimulationCreationError, UnsupportedError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.simulation import Simulation
from scenic.simulators.simulator import Simulator
from scenic.simulators.webots.axes import Axes, axis_angle, matrix_of, orientation_of

__all__ = ["OutsideWebots", "WebotsSimulation", "WebotsSimulator"]

_DEFAULT_AXES: Final = "ENU"


class OutsideWebots(Simulator):
    """The simulator of programs for Webots that are run elsewhere: it can only say where to go."""

    def createSimulation(self, scene: Scene, **options: Any) -> Simulation:
        """Raises `UnsupportedError`."""
        raise UnsupportedError(
            "programs with the world model of Webots are simulated inside Webots",
            help="write the world by `scenic sample FILE -o world.wbt`, and call WebotsSimulator(Supervisor()).simulate(scene)"
            " in the controller of a supervisor",
        )


class WebotsSimulator(Simulator):
    """Simulates in a running Webots world.

    Args:
        supervisor: ``controller.Supervisor()`` of the controller that this runs in.

    Raises:
        SimulationCreationError: the world's coordinate system is unknown.

    """

    def __init__(self, supervisor: Any) -> None:
        super().__init__()
        self.supervisor = supervisor
        self.axes = Axes(_coordinate_system(supervisor))

    def createSimulation(
        self, scene: Scene, *, timestep: float | None = None, **options: Any
    ) -> "WebotsSimulation":
        """A simulation that has run; the default step is the world's basic one."""
        basic = float(self.supervisor.getBasicTimeStep()) / 1000
        step = basic if timestep is None else timestep
        ratio = step / basic
        if ratio < 0.5 or abs(ratio - round(ratio)) > 1e-6:
            raise SimulationCreationError(
                f"a step of {step:g} s is no multiple of the world's basic step of {basic:g} s",
                help="give another timestep, or change WorldInfo.basicTimeStep",
            )
        return WebotsSimulation(scene, self.supervisor, self.axes, timestep=step, **options)


def _coordinate_system(supervisor: Any) -> str:
    children = supervisor.getRoot().getField("children")
    for number in range(children.getCount()):
        node = children.getMFNode(number)
        if node.getTypeName() == "WorldInfo":
            return str(node.getField("coordinateSystem").getSFString()) or _DEFAULT_AXES
    return _DEFAULT_AXES


class WebotsSimulation(Simulation):
    """One run in a world; see `WebotsSimulator`."""

    def __init__(self, scene: Scene, supervisor: Any, axes: Axes, *, timestep: float, **options: Any) -> None:
        self.supervisor = supervisor
        self.axes = axes
        self._nodes: dict[int, Any] = {}
        self._made: list[Any] = []
        self._types: Counter[str] = Counter()
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        super().__init__(scene, timestep=timestep, **options)

    # Set-up

    def createObjectInSimulator(self, obj: Any) -> None:
        """Find or make the object's node, and bring it into the object's state."""
        node = self._node(obj)
        obj.webotsObject = node
        self._nodes[id(obj)] = node
        density = getattr(obj, "density", None)
        physics = _field(node, "physics")
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
            field = self._field(obj, node, "battery")
            for place, value in enumerate(numbers):
                if place < field.getCount():
                    field.setMFFloat(place, value)
                else:
                    field.insertMFFloat(-1, value)
        for name in ("customData", "controller"):
            text = getattr(obj, name, None)
            if text is not None:
                self._field(obj, node, name).setSFString(str(text))
        if not self._has_pose(obj):
            return
        self.move(obj, obj.position)
        self._turn(obj, obj.orientation)
        node.resetPhysics()
        if _field(node, "physics") is not None:
            node.setVelocity([*self.axes.place(obj.velocity), *self.axes.spin(obj.angularVelocity)])
        if getattr(obj, "controller", None) is not None and getattr(obj, "resetController", True):
            node.restartController()

    def _node(self, obj: Any) -> Any:
        """The node of an object in the world; raises `SimulationCreationError` if there is none."""
        adhoc = getattr(obj, "webotsAdhoc", None)
        if adhoc is not None:
            return self._adhoc(obj, adhoc)
        name, kind = getattr(obj, "webotsName", None), getattr(obj, "webotsType", None)
        wanted = f"object_{len(self._nodes)}" if name is None else str(name)
        if name is None and kind is not None:
            wanted = self._next_of(str(kind))
        node = self.supervisor.getFromDef(wanted)
        if node is None:
            raise SimulationCreationError(
                f"the world has no node with the DEF name {wanted}, for {obj!r}",
                help="name a node by `webotsName` or `webotsType`, or let the object be made: `with webotsAdhoc {}`",
            )
        return node

    def _next_of(self, kind: str) -> str:
        """The next name of a type: ``KIND`` if there is a node of that name, then ``KIND_0``, ``KIND_1`` and so on."""
        place = self._types[kind]
        self._types[kind] += 1
        if self.supervisor.getFromDef(kind) is not None:
            place -= 1
        return kind if place < 0 else f"{kind}_{place}"

    def _adhoc(self, obj: Any, options: Mapping[str, Any]) -> Any:
        """A new node with the object's shape."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="scenic-webots-")
        files: dict[str, bytes] = {}
        number = len(self._nodes)
        color = getattr(obj, "color", None) or (0.8, 0.8, 0.8)
        stem = str(Path(self._folder.name) / "adhoc")
        label = f"scenic object {number}"
        text = solid(obj, None, stem, files, number, label, color, physics=bool(options.get("physics", True)))
        for name, content in files.items():
            make_folder(Path(name).parent)
            write(Path(name), content)
        children = self.supervisor.getRoot().getField("children")
        children.importMFNodeFromString(-1, text)
        node = children.getMFNode(-1)
        self._made.append(node)
        return node

    def _field(self, obj: Any, node: Any, name: str) -> Any:
        field = _field(node, name)
        if field is None:
            raise SimulationCreationError(
                f"the node of {obj!r} ({node.getTypeName()}) has no field {name!r}",
                help=f"leave `{name}` out, or name another node",
            )
        return field

    def _has_pose(self, obj: Any) -> bool:
        return _field(self._nodes[id(obj)], "translation") is not None

    def destroy(self) -> None:
        """Remove what was made."""
        for node in self._made:
            node.remove()
        self._made = []
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    # Commands

    def move(self, obj: Any, position: Any) -> None:
        """Put an object at a position (metres)."""
        place = Vector(*position) + Vector(*getattr(obj, "positionOffset", (0, 0, 0)))
        self._nodes[id(obj)].getField("translation").setSFVec3f(self.axes.place(place))

    def _turn(self, obj: Any, orientation: Orientation) -> None:
        turned = self.axes.turn(orientation_of(matrix_of(orientation) @ matrix_of(_offset(obj))))
        self._nodes[id(obj)].getField("rotation").setSFRotation(axis_angle(turned))

    def push(self, obj: Any, force: Any, relative: bool) -> None:
        """Apply a force (newtons) for one step."""
        self._nodes[id(obj)].addForce(self.axes.place(force), relative)

    # Steps

    def step(self) -> None:
        """Let Webots advance."""
        if self.supervisor.step(round(1000 * self.timestep)) == -1:
            raise SimulationCreationError(
                "Webots ended the simulation", help="run it again: the world was reset or closed"
            )

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """Read the state of the object's node."""
        stored, node = obj.__dict__, self._nodes[id(obj)]
        if not self._has_pose(obj):
            return {name: stored[name] for name in properties}
        offset = Vector(*getattr(obj, "positionOffset", (0, 0, 0)))
        position = Vector(*self.axes.place_here(node.getPosition()).tolist()) - offset
        numbers = list(node.getVelocity())
        velocity = Vector(*self.axes.place_here(numbers[:3]).tolist())
        spin = Vector(*self.axes.spin_here(numbers[3:]).tolist())
        turned = matrix_of(self.axes.turn_here(node.getOrientation()))
        orientation = orientation_of(turned @ matrix_of(_offset(obj)).T)
        yaw, pitch, roll = (stored["parentOrientation"].inverse * orientation).eulerAngles
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
        battery = _field(node, "battery") if "battery" in properties else None
        if battery is not None and stored.get("battery") is not None:
            values["battery"] = tuple(battery.getMFFloat(place) for place in range(battery.getCount()))
        return {name: values[name] if name in values else stored[name] for name in properties}


def _field(node: Any, name: str) -> Any:
    """A field of a node, ``None`` if it has none of the name."""
    return node.getField(name)


def _offset(obj: Any) -> Orientation:
    yaw, pitch, roll = (float(angle) for angle in getattr(obj, "rotationOffset", (0, 0, 0)))
    if not all(map(math.isfinite, (yaw, pitch, roll))):
        raise SimulationCreationError(
            f"the rotationOffset of {obj!r} must be finite", help="yaw, pitch and roll in radians"
        )
    turn: Orientation = Orientation.fromEuler(yaw, pitch, roll)
    return turn
