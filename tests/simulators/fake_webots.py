"""The documented interface of Webots's ``controller`` module, as far as a supervisor of ours uses it.

https://cyberbotics.com/doc/reference/supervisor: nodes have fields, and move with the velocities that were set.
"""

import math
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.simulators.webots_worlds import read_nodes


class Field:
    def __init__(self, value: Any) -> None:
        self.value = value

    def getSFString(self) -> str:
        assert isinstance(self.value, str)
        return self.value

    def setSFString(self, value: str) -> None:
        assert isinstance(value, str)
        self.value = value

    def setSFFloat(self, value: float) -> None:
        assert type(value) is float
        self.value = value

    def setSFInt32(self, value: int) -> None:
        assert type(value) is int
        self.value = value

    def setSFVec3f(self, values: list[float]) -> None:
        assert len(values) == 3
        assert all(isinstance(value, float) for value in values)
        self.value = list(values)

    def setSFRotation(self, values: list[float]) -> None:
        assert len(values) == 4
        assert math.hypot(*values[:3]) == 1 or abs(math.hypot(*values[:3]) - 1) < 1e-12
        self.value = list(values)

    def getSFNode(self) -> Any:
        return self.value

    def getCount(self) -> int:
        return len(self.value)

    def getMFNode(self, place: int) -> Any:
        return self.value[place]

    def getMFFloat(self, place: int) -> float:
        return float(self.value[place])

    def setMFFloat(self, place: int, value: float) -> None:
        assert type(value) is float
        self.value[place] = value

    def removeMF(self, place: int) -> None:
        del self.value[place]

    def insertMFFloat(self, place: int, value: float) -> None:
        assert place == -1
        self.value.append(value)

    def importMFNodeFromString(self, place: int, text: str) -> None:
        assert place == -1
        (read,) = read_nodes(text)
        node = Node(read["DEF"], read["type"], physics="physics" in read)
        node.text = text
        node.siblings = self.value
        node.fields["translation"].value = read["translation"]
        node.fields["rotation"].value = read["rotation"]
        self.value.append(node)


class Node:
    def __init__(
        self, name: str, kind: str = "Robot", *, physics: bool = True, mass: float = math.inf, **fields: Any
    ) -> None:
        self.name, self.kind, self.text = name, kind, ""
        self.mass = mass
        self.pushed = np.zeros(3)
        self.siblings: list[Any] = []
        self.velocity = [0.0] * 6
        self.restarts = self.resets = 0
        self.joints = [0.0]
        self.states: dict[str, Any] = {}
        self.forces: list[tuple[list[float], bool]] = []
        self.fields = {name: Field(value) for name, value in fields.items()}
        if kind in ("Robot", "Solid"):
            self.fields["translation"] = Field([0.0, 0.0, 0.0])
            self.fields["rotation"] = Field([0.0, 0.0, 1.0, 0.0])
            self.fields["physics"] = Field(Node("", "Physics", density=1000.0) if physics else None)

    def getTypeName(self) -> str:
        return self.kind

    def getId(self) -> int:
        return id(self)

    def _state(self) -> tuple[list[float], ...]:
        battery = self.fields["battery"].value if "battery" in self.fields else []
        return (
            list(self.fields["translation"].value),
            list(self.fields["rotation"].value),
            list(battery),
            list(self.joints),
        )

    def saveState(self, name: str) -> None:
        self.states[name] = self._state()

    def loadState(self, name: str) -> None:
        """Load places, battery and joints, and stop; a name that was not saved ends the controller."""
        translation, rotation, battery, joints = self.states[name]
        self.fields["translation"].value = list(translation)
        self.fields["rotation"].value = list(rotation)
        if "battery" in self.fields:
            self.fields["battery"].value = list(battery)
        self.joints = list(joints)
        self.velocity = [0.0] * 6

    def getField(self, name: str) -> Field | None:
        return self.fields.get(name)

    def getPosition(self) -> list[float]:
        return list(self.fields["translation"].value)

    def getOrientation(self) -> list[float]:
        x, y, z, angle = self.fields["rotation"].value
        return Rotation.from_rotvec(np.array([x, y, z]) * angle).as_matrix().ravel().tolist()

    def getVelocity(self) -> list[float]:
        return list(self.velocity)

    def setVelocity(self, values: list[float]) -> None:
        assert len(values) == 6
        self.velocity = list(values)

    def addForce(self, force: list[float], relative: bool) -> None:
        self.forces.append((list(force), relative))
        turned = np.array(self.getOrientation()).reshape(3, 3) if relative else np.eye(3)
        self.pushed = self.pushed + turned @ np.array(force)

    def resetPhysics(self) -> None:
        self.resets += 1

    def restartController(self) -> None:
        self.restarts += 1

    def remove(self) -> None:
        self.siblings.remove(self)

    def advance(self, seconds: float) -> None:
        """Move with the velocity, after the forces of one step, in the world's axes: the right hand rule holds in them, whatever they are called."""
        self.velocity[:3] = (np.array(self.velocity[:3]) + self.pushed / self.mass * seconds).tolist()
        self.pushed = np.zeros(3)
        place = np.array(self.fields["translation"].value) + np.array(self.velocity[:3]) * seconds
        self.fields["translation"].value = place.tolist()
        x, y, z, angle = self.fields["rotation"].value
        turned = Rotation.from_rotvec(np.array(self.velocity[3:]) * seconds) * Rotation.from_rotvec(
            np.array([x, y, z]) * angle
        )
        vector = turned.as_rotvec()
        size = float(np.linalg.norm(vector))
        self.joints = [angle + seconds for angle in self.joints]
        self.fields["rotation"].value = [*(vector / size).tolist(), size] if size else [0.0, 0.0, 1.0, 0.0]


def node_of(read: Any) -> Node:
    """The node that was read from a world, with its fields and the nodes in them."""
    names = {name: value for name, value in read.items() if name not in ("DEF", "type")}
    made = {name: node_of(value) if isinstance(value, dict) else value for name, value in names.items()} | {
        "children": [node_of(value) for value in names.get("children", [])]
    }
    node = Node(read.get("DEF", ""), read["type"])
    if "translation" in made:
        node.fields |= Node("", "Solid", physics=False).fields
    node.fields |= {name: Field(value) for name, value in made.items()}
    return node


class Supervisor:
    def __init__(
        self,
        *nodes: Node,
        axes: str = "ENU",
        step: int = 16,
        is_one: bool = True,
        ends_after: float = math.inf,
    ) -> None:
        self.basic = step
        self.is_one = is_one
        self.ends_after = ends_after
        self.children = [*nodes]
        if not any(node.kind == "WorldInfo" for node in nodes):
            self.children.insert(0, Node("", "WorldInfo", coordinateSystem=axes))
        self.root = Node("", "Group", children=self.children)
        self.milliseconds = 0

    def getSupervisor(self) -> bool:
        return self.is_one

    def getRoot(self) -> Node | None:
        return self.root if self.is_one else None

    def getFromDef(self, name: str) -> Node | None:
        return next((node for node in self.children if node.name == name), None)

    def getBasicTimeStep(self) -> float:
        return float(self.basic)

    def step(self, milliseconds: int) -> int:
        assert isinstance(milliseconds, int)
        assert milliseconds % self.basic == 0
        self.milliseconds += milliseconds
        for node in self.children:
            if "translation" in node.fields:
                node.advance(milliseconds / 1000)
        return 0 if self.milliseconds < self.ends_after else -1
