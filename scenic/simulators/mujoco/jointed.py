"""Things with joints in a simulation: their description in the model, targets of their joints, inverse kinematics."""

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.graph import quaternions
from scenic.language.errors import ScenicValueError
from scenic.simulators.mujoco.articulated import description_of, origin_of
from scenic.simulators.mujoco.library import library
from scenic.simulators.mujoco.robot_descriptions import Description

__all__ = ["Jointed", "attach"]

Floats = NDArray[np.float64]

_STIFFNESS: Final = {False: 200.0, True: 2000.0}
"""Of servos of joints without actuators: newton metres per radian, and newtons per metre of slides."""
_DAMPING: Final = 0.05
"""Squared, of least squares."""
_ROUNDS: Final = 120
_NEAR: Final = 1e-4
"""Distance (metres) and angle (radians) at which inverse kinematics ends."""
_TURN: Final = 0.25
"""Weight of the orientation against the position, metres per radian."""


def attach(spec: Any, thing: Any, prefix: str) -> None:
    """Put the description of a thing into a model, at the pose of its base.

    Joints without actuators get servos. Weight is taken off its links, as controllers of arms do.
    """
    mujoco = library()
    description = description_of(thing.description)
    child = mujoco.MjSpec.from_file(str(description.path))
    for item in [item for item in child.joints if item.type == mujoco.mjtJoint.mjJNT_FREE]:
        child.delete(item)
    for key in list(child.keys):
        child.delete(key)
    driven_joints = {actuator.target for actuator in child.actuators}
    for name, joint in description.joints.items():
        if name not in driven_joints and getattr(thing, "servos", True):
            servo = child.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            servo.set_to_position(kp=_STIFFNESS[joint.slides], dampratio=1.0)
    if getattr(thing, "weightless", True):
        for body in child.bodies[1:]:
            body.gravcomp = 1.0
    turn = thing.orientation
    row = np.array([turn.x, turn.y, turn.z, turn.w])
    place = np.array(tuple(thing.position)) - quaternions.rotate(row, origin_of(description))
    frame = spec.worldbody.add_frame(pos=place.tolist(), quat=[turn.w, turn.x, turn.y, turn.z])
    spec.attach(child, prefix=prefix, frame=frame)


class Jointed:
    """The joints of a thing while a simulation runs.

    Args:
        simulation: it has ``model`` and ``data``.
        description: of the thing.
        thing: the object; ``None`` for inverse kinematics alone.
        prefix: of the names of its parts in the model.

    """

    def __init__(self, simulation: Any, description: Description, thing: Any, prefix: str) -> None:
        self._simulation = simulation
        self._thing = thing
        self._prefix = prefix
        self.description = description
        self._targets: dict[str, float] = {}
        self._speeds: dict[str, float] = {}
        self._torques: dict[str, float] = {}
        self._known: tuple[Any, dict[str, tuple[int, int, list[int]]]] | None = None

    def start(self) -> None:
        """Give the joints the values of the scene."""
        for name, value in self._thing.jointValues.items():
            self._joint(name).qpos[0] = value
            self._targets[name] = float(value)
        self.drive(0.0)

    def values(self) -> dict[str, float]:
        """Return the present values of the joints, radians or metres."""
        return {name: float(self._joint(name).qpos[0]) for name in self.description.joints}

    def velocities(self) -> dict[str, float]:
        """Return the present speeds of the joints, radians or metres per second."""
        return {name: float(self._joint(name).qvel[0]) for name in self.description.joints}

    def torques(self) -> dict[str, float]:
        """Return the torques (newton metres) or forces (newtons) that drives exert on the joints."""
        data = self._simulation.data
        dofs = {
            name: int(self._simulation.model.joint(self._prefix + name).dofadr[0])
            for name in self.description.joints
        }
        return {name: float(data.qfrc_actuator[dof] + data.qfrc_applied[dof]) for name, dof in dofs.items()}

    def gripper_bodies(self) -> list[int]:
        """Numbers of the bodies that the joints of the thing's gripper move."""
        model = self._simulation.model
        roots = {
            int(model.jnt_bodyid[model.joint(self._prefix + name).id])
            for name in getattr(self._thing, "gripper", ())
        }
        bodies: list[int] = []
        for body in range(model.nbody):  # parents come first
            if body in roots or int(model.body_parentid[body]) in bodies:
                bodies.append(body)
        return bodies

    def place(self, link: str, middle: Floats) -> tuple[Floats, Floats]:
        """The place of a point of a link ``(3,)``, and the link's orientation ``(x, y, z, w)``."""
        body = self._simulation.data.body(self._prefix + link)
        w, x, y, z = body.xquat
        turn = np.array([x, y, z, w])
        return body.xpos + quaternions.rotate(turn, middle), turn

    # Commands

    def aim(self, targets: Mapping[str, float]) -> None:
        """Move joints to values at the thing's ``jointSpeed``; a value beyond a limit is the limit."""
        for name, value in targets.items():
            joint = self.description.joint(name)
            self._speeds.pop(name, None)
            self._torques.pop(name, None)
            self._targets[name] = min(max(float(value), joint.low), joint.high)

    def run(self, speeds: Mapping[str, float]) -> None:
        """Let joints move at speeds until the next command."""
        for name, speed in speeds.items():
            self.description.joint(name)
            self._torques.pop(name, None)
            self._speeds[name] = float(speed)

    def push(self, torques: Mapping[str, float]) -> None:
        """Let torques (newton metres) or forces (newtons) act on joints, instead of their servos, until the next command."""
        for name, torque in torques.items():
            self.description.joint(name)
            self._torques[name] = float(torque)

    def drive(self, step: float) -> None:
        """Set the controls for a step of the physics, in seconds."""
        data = self._simulation.data
        most = float(getattr(self._thing, "jointSpeed", 1.5)) * step
        for name, (dof, slot, actuators) in self._places().items():
            if name not in self._targets:
                continue
            torque = self._torques.get(name)
            data.qfrc_applied[dof] = torque or 0.0
            if torque is not None:
                data.ctrl[actuators] = data.qpos[slot]
                continue
            target, joint = self._targets[name], self.description.joints[name]
            if name in self._speeds:
                target = min(max(target + self._speeds[name] * step, joint.low), joint.high)
                self._targets[name] = target
            elif step:
                limit = most * (0.2 if joint.slides else 1.0)
                for number in actuators:
                    present = float(data.ctrl[number])
                    data.ctrl[number] = present + min(max(target - present, -limit), limit)
                continue
            data.ctrl[actuators] = target

    def _places(self) -> dict[str, tuple[int, int, list[int]]]:
        """Of each joint its numbers in the model: of its speed, of its value, and of the actuators that drive it."""
        model = self._simulation.model
        if self._known is None or self._known[0] is not model:  # it is another one after objects were added
            drives = model.actuator_trntype == int(library().mjtTrn.mjTRN_JOINT)
            places = {}
            for name in self.description.joints:
                joint = model.joint(self._prefix + name)
                actuators = np.flatnonzero(drives & (model.actuator_trnid[:, 0] == joint.id)).tolist()
                places[name] = (int(joint.dofadr[0]), int(joint.qposadr[0]), actuators)
            self._known = model, places
        return self._known[1]

    def _joint(self, name: str) -> Any:
        return self._simulation.data.joint(self._prefix + name)

    # Inverse kinematics

    def solve(
        self, frame: str, position: Floats, down: Floats | None = None
    ) -> tuple[dict[str, float], float]:
        """Return values of the joints that move a frame to a place, and the distance that is left, metres.

        The method is damped least squares over the joints of the frame's chain, from their present values.

        Args:
            frame: name of a body or site.
            position: the place in the world ``(3,)``, metres.
            down: the direction of the frame's Z axis ``(3,)``; any if ``None``.

        """
        mujoco, model = library(), self._simulation.model
        chain = self.description.frame(frame)
        names = [joint.name for segment in chain for joint in segment.joints]
        if not names:
            raise ScenicValueError(f"no joint moves the frame {frame!r}")
        joints = [self.description.joints[name] for name in names]
        scratch = mujoco.MjData(model)
        scratch.qpos[:] = self._simulation.data.qpos
        dofs = np.array([int(model.joint(self._prefix + name).dofadr[0]) for name in names])
        slots = np.array([int(model.joint(self._prefix + name).qposadr[0]) for name in names])
        low, high = (np.array([getattr(joint, end) for joint in joints]) for end in ("low", "high"))
        kind, number = self._target_of(frame)
        moves, turns = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        best, least = scratch.qpos[slots].copy(), math.inf
        for _ in range(_ROUNDS):
            mujoco.mj_kinematics(model, scratch)
            mujoco.mj_comPos(model, scratch)
            place, matrix = (
                (scratch.site_xpos[number], scratch.site_xmat[number])
                if kind == "site"
                else (scratch.xpos[number], scratch.xmat[number])
            )
            (mujoco.mj_jacSite if kind == "site" else mujoco.mj_jacBody)(model, scratch, moves, turns, number)
            error, jacobian = position - place, moves[:, dofs]
            if down is not None:
                axis = matrix.reshape(3, 3)[:, 2]
                tilt = np.cross(axis, down)
                if axis @ down < -0.999:  # the other way: any way round
                    tilt = matrix.reshape(3, 3)[:, 0]
                error, jacobian = (
                    np.concatenate([error, _TURN * tilt]),
                    np.concatenate([jacobian, _TURN * turns[:, dofs]]),
                )
            size = float(np.linalg.norm(error))
            if size < least:
                best, least = scratch.qpos[slots].copy(), size
            if size < _NEAR:
                break
            damping = _DAMPING**2 * min(1.0, size)
            change = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping * np.eye(len(error)), error)
            change *= min(1.0, 0.3 / max(float(np.abs(change).max()), 1e-12))
            scratch.qpos[slots] = np.clip(scratch.qpos[slots] + change, low, high)
        return dict(zip(names, best.tolist(), strict=True)), least

    def _target_of(self, frame: str) -> tuple[str, int]:
        mujoco, model = library(), self._simulation.model
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, self._prefix + frame)
        if number >= 0:
            return "site", int(number)
        return "body", int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, self._prefix + frame))
