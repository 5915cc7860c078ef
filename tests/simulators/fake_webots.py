"""The documented interface of Webots's ``controller`` module, as far as a supervisor of ours uses it.

https://cyberbotics.com/doc/reference/supervisor: nodes have fields, and move with the velocities that were set.
"""

import math
import re
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation


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
        assert isinstance(value, float)
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
        self.value[place] = value

    def insertMFFloat(self, place: int, value: float) -> None:
        assert place == -1
        self.value.append(value)

    def importMFNodeFromString(self, place: int, text: str) -> None:
        assert place == -1
        found = re.search(r"DEF (\w+) (\w+) \{", text)
        assert found is not None
        node = Node(found[1], found[2], physics="physics Physics" in text)
        node.text = text
        node.siblings = self.value
        self.value.append(node)


class Node:
    def __init__(self, name: str, kind: str = "Robot", *, physics: bool = True, **fields: Any) -> None:
        self.name, self.kind, self.text = name, kind, ""
        self.siblings: list[Any] = []
        self.velocity = [0.0] * 6
        self.restarts = self.resets = 0
        self.forces: list[tuple[list[float], bool]] = []
        self.fields = {name: Field(value) for name, value in fields.items()}
        if kind not in ("WorldInfo", "Physics"):
            self.fields["translation"] = Field([0.0, 0.0, 0.0])
            self.fields["rotation"] = Field([0.0, 0.0, 1.0, 0.0])
            self.fields["physics"] = Field(Node("", "Physics", density=1000.0) if physics else None)

    def getTypeName(self) -> str:
        return self.kind

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

    def resetPhysics(self) -> None:
        self.resets += 1

    def restartController(self) -> None:
        self.restarts += 1

    def remove(self) -> None:
        self.siblings.remove(self)

    def advance(self, seconds: float) -> None:
        """Move with the velocity, in the world's axes: the right hand rule holds in them, whatever they are called."""
        place = np.array(self.fields["translation"].value) + np.array(self.velocity[:3]) * seconds
        self.fields["translation"].value = place.tolist()
        x, y, z, angle = self.fields["rotation"].value
        turned = Rotation.from_rotvec(np.array(self.velocity[3:]) * seconds) * Rotation.from_rotvec(
            np.array([x, y, z]) * angle
        )
        vector = turned.as_rotvec()
        size = float(np.linalg.norm(vector))
        self.fields["rotation"].value = [*(vector / size).tolist(), size] if size else [0.0, 0.0, 1.0, 0.0]


class Supervisor:
    def __init__(self, *nodes: Node, axes: str = "ENU", step: int = 16) -> None:
        self.basic = step
        self.children = [Node("", "WorldInfo", coordinateSystem=axes), *nodes]
        self.root = Node("", "Group", children=self.children)
        self.milliseconds = 0

    def getRoot(self) -> Node:
        return self.root

    def getFromDef(self, name: str) -> Node | None:
        return next((node for node in self.children if node.name == name), None)

    def getBasicTimeStep(self) -> float:
        return float(self.basic)

    def step(self, milliseconds: int) -> int:
        assert isinstance(milliseconds, int)
        assert milliseconds % self.basic == 0
        self.milliseconds += milliseconds
        for node in self.children:
            if node.kind != "WorldInfo":
                node.advance(milliseconds / 1000)
        return 0
