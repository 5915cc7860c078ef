"""A simulation in MuJoCo: its steps, the commands of agents to their bodies, and the state that is read back."""

import math
from collections.abc import Mapping
from itertools import product
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from scenic.language.errors import SimulationCreationError, SimulationError
from scenic.runtime.scenes.scene import Scene
from scenic.runtime.values.values import Orientation, Vector
from scenic.simulators.commands import DRAG, GRAVITY
from scenic.simulators.mujoco.articulated import description_of, middle_of
from scenic.simulators.mujoco.images import Images
from scenic.simulators.mujoco.jointed import Jointed
from scenic.simulators.mujoco.library import library, quietly
from scenic.simulators.mujoco.model import Builder, ModelPart, grip_name, wheelbase, wheels
from scenic.simulators.simulation import Simulation

__all__ = ["MujocoSimulation"]

Floats = NDArray[np.float64]

_REACH: Final = 0.05
"""So far from its surface a gripper takes hold, metres."""
_STIFFNESS: Final = 100.0
"""Of a quadrotor's attitude: angular acceleration by angle, per second squared; critically damped."""
_UPRIGHT: Final = Orientation()
_SIDEWAYS: Final = 0.95
"""A contact is with the side of a body where the vertical part of its normal is smaller."""


class MujocoSimulation(Simulation):
    """One run; see `scenic.simulators.mujoco.simulator.MujocoSimulator` for the arguments.

    Attributes:
        model: ``mujoco.MjModel``, once the scene is set up; another one after objects were added.
        data: ``mujoco.MjData``, likewise.

    """

    def __init__(
        self,
        scene: Scene,
        *,
        timestep: float,
        physics_step: float = 0.002,
        gravity: float = GRAVITY,
        ground: float | str | None = "auto",
        images: str = "rays",
        sleep: bool = False,
        **options: Any,
    ) -> None:
        self._substeps = max(1, math.ceil(timestep / physics_step - 1e-9))
        self._builder = Builder(timestep / self._substeps, gravity, sleep=sleep)
        self._gravity = gravity
        self._ground = ground
        self._images = Images(images)
        self._parts: dict[int, ModelPart] = {}
        self._jointed: dict[int, Jointed] = {}
        """Things with joints, by the identity of their objects."""
        self._touches: dict[int, list[Vector]] = {}
        self.model: Any = None
        self.data: Any = None
        super().__init__(scene, timestep=timestep, **options)

    # Set-up

    def setup(self) -> None:
        """Make the model of the scene."""
        super().setup()
        if self._ground is not None:
            lowest = min((_bottom(obj) for obj in self.objects), default=0.0)
            self._builder.add_ground(min(0.0, lowest) if self._ground == "auto" else float(self._ground))
        self._compile()
        for part in self._parts.values():
            self._start(part)
        self._place_links()

    def _place_links(self) -> None:
        """Compute where links are, which is read before the first step."""
        if self._jointed:
            library().mj_kinematics(self.model, self.data)

    def createObjectInSimulator(self, obj: Any) -> None:
        """Add a body for the object; in a simulation that runs the other bodies stay as they are."""
        part = self._builder.add(obj)
        self._parts[id(obj)] = part
        if part.model == "articulated":
            self._jointed[id(obj)] = Jointed(self, description_of(obj.description), obj, f"{part.name} ")
        if self.model is not None:
            self._compile()
            self._start(part)
            self._place_links()

    def _compile(self) -> None:
        mujoco, spec = library(), self._builder.spec
        try:
            with quietly():
                if self.model is None:
                    self.model = spec.compile()
                    self.data = mujoco.MjData(self.model)
                else:
                    grips = self.model.eq_data.copy()
                    self.model, self.data = spec.recompile(self.model, self.data)
                    # How what is held stands to its gripper; welds of the new object come behind.
                    self.model.eq_data[: len(grips)] = grips
        except ValueError as error:
            what = " ".join(str(error).split())
            raise SimulationCreationError(
                f"MuJoCo cannot make the scene: {what}",
                help="a mesh must be a closed volume that is not thin as paper; "
                "a mass must not be vanishingly small",
            ) from error

    def _start(self, part: ModelPart) -> None:
        """Give a new body its velocity and first command."""
        if part.model == "articulated":
            self._jointed[id(part.thing)].start()
        if not part.moves:
            return
        if part.model not in ("differential", "bicycle"):
            part.mass = float(self.model.body(part.name).mass[0])
        place = self._joint(part)[1]
        obj = part.thing
        self.data.qvel[place : place + 3] = tuple(obj.velocity)
        turning = np.array(tuple(obj.angularVelocity), dtype=np.float64)
        self.data.qvel[place + 3 : place + 6] = _matrix(obj.orientation).T @ turning
        if part.model == "guided":
            part.command.update(zip(("vx", "vy", "vz"), tuple(obj.velocity), strict=True))
        elif part.model == "quadrotor":
            part.command.update(thrust=self._gravity, pitch=0.0, roll=0.0, turn=0.0, yaw=obj.orientation.yaw)
        elif part.model == "bicycle":
            part.command.update(
                speed=float(_matrix(obj.orientation)[:, 1] @ np.array(tuple(obj.velocity))),
                throttle=0.0,
                steering=0.0,
            )
            self._drive(part, 0.0)
            for name, _, _ in wheels(obj, part.track):
                self.data.qvel[self.model.joint(f"{part.name} {name}").dofadr[0]] = (
                    part.command["speed"] / part.radius
                )
        elif part.model == "differential":
            forward = float(_matrix(obj.orientation)[:, 1] @ np.array(tuple(obj.velocity)))
            self.command(obj, {"left": forward, "right": forward})
            for side in ("left", "right"):
                wheel = self.model.joint(f"{part.name} {side}").dofadr[0]
                self.data.qvel[wheel] = forward / part.radius

    def _joint(self, part: ModelPart) -> tuple[int, int]:
        """Return the indices at which the state of a body's free joint begins, in ``qpos`` and in ``qvel``."""
        body = self.model.body(part.name).id
        joint = self.model.body_jntadr[body]
        return int(self.model.jnt_qposadr[joint]), int(self.model.jnt_dofadr[joint])

    def destroy(self) -> None:
        """Free the graphics memory."""
        self._images.close()

    def sense(self) -> None:
        """Let cameras see."""
        self._images.deliver(self, self._builder.cameras)
        super().sense()

    # Commands

    def command(self, agent: Any, values: Mapping[str, float]) -> None:
        """Put commands in force."""
        part = self._parts[id(agent)]
        part.command.update(values)
        if part.model == "differential":
            # The speeds are meant where the object's sides are; its wheels stand a little further in.
            mean = (part.command["left"] + part.command["right"]) / 2
            half = (part.command["right"] - part.command["left"]) / 2 * part.track / float(agent.width)
            for side, speed in (("left", mean - half), ("right", mean + half)):
                self.data.ctrl[self.model.actuator(f"{part.name} {side}").id] = speed / part.radius
        elif part.model == "free" and "vx" in values:
            place = self._joint(part)[1]
            self.data.qvel[place : place + 3] = [values["vx"], values["vy"], values["vz"]]

    def grasp(self, gripper: object, target: object) -> None:
        """Let a gripper hold an object as it stands to it now, if it is within reach."""
        mujoco = library()
        hand, target_part = self._parts[id(gripper)], self._parts.get(id(target))
        if target_part is None or not target_part.moves or target_part is hand:
            return
        mujoco.mj_kinematics(self.model, self.data)
        reach = float(getattr(gripper, "reach", _REACH))
        if not any(self._within(reach, *pair) for pair in product(*map(self._geoms, (hand, target_part)))):
            return
        first, second = (self.data.body(part.name) for part in (hand, target_part))
        turn = first.xmat.reshape(3, 3)
        back, between = np.empty(4), np.empty(4)
        mujoco.mju_negQuat(back, first.xquat)
        mujoco.mju_mulQuat(between, back, second.xquat)
        weld = self.model.equality(grip_name(hand, target_part))
        weld.data[:3] = 0.0
        weld.data[3:6] = turn.T @ (second.xpos - first.xpos)
        weld.data[6:10] = between
        self.data.eq_active[weld.id] = True

    def _geoms(self, part: ModelPart) -> list[int]:
        """Numbers of the geoms with which a part touches others."""
        return [int(self.model.geom(name).id) for name in part.geoms or [part.name]]

    def _within(self, reach: float, first: int, second: int) -> bool:
        """Return whether two geoms are within a distance in metres."""
        ends = np.zeros(6)
        found: float = library().mj_geomDistance(self.model, self.data, first, second, reach + 1e-6, ends)
        return found <= reach

    def release(self, gripper: object) -> None:
        """Let a gripper open."""
        for number in self._grips(self._parts[id(gripper)]):
            self.data.eq_active[number] = False

    def _grips(self, hand: ModelPart) -> list[int]:
        """Numbers of the welds by which a gripper may hold others."""
        names = (
            grip_name(hand, other) for other in self._parts.values() if other.moves and other is not hand
        )
        return [self.model.equality(name).id for name in names] if hand.model == "guided" else []

    # Steps

    def step(self) -> None:
        """Advance by the steps of the physics that make a step of the simulation."""
        mujoco = library()
        jointed_things = list(self._jointed.values())
        steered_parts = [
            part for part in self._parts.values() if part.model in ("guided", "quadrotor", "bicycle")
        ]
        feeling = [part for part in self._parts.values() if part.moves and hasattr(part.thing, "touches")]
        self._touches = {id(part.thing): [] for part in feeling}
        self._push()
        with quietly():
            if steered_parts or jointed_things:
                for _ in range(self._substeps):
                    self._steer(steered_parts)
                    for thing in jointed_things:
                        thing.drive(self.model.opt.timestep)
                    mujoco.mj_step(self.model, self.data)
                    self._feel(feeling)
            elif feeling:
                for _ in range(self._substeps):
                    mujoco.mj_step(self.model, self.data)
                    self._feel(feeling)
            else:
                mujoco.mj_step(self.model, self.data, self._substeps)
        self._check()

    def _push(self) -> None:
        """Apply the forces that last."""
        for part in self._parts.values():
            command = part.command
            if part.model != "free" or not command:
                continue
            force = [
                command.get(f"f{axis}", 0.0) + part.mass * command.get(f"a{axis}", 0.0) for axis in "xyz"
            ]
            torque = [command.get(f"t{axis}", 0.0) for axis in "xyz"]
            self.data.body(part.name).xfrc_applied[:] = force + torque

    def _steer(self, parts: list[ModelPart]) -> None:
        """Update the commands of guided and flying bodies for the next step of the physics."""
        step = self.model.opt.timestep
        for part in parts:
            command = part.command
            if part.model == "guided":
                mocap = self.model.body(f"{part.name} guide").mocapid[0]
                self._accelerate(command, step)
                self.data.mocap_pos[mocap] += [command[name] * step for name in ("vx", "vy", "vz")]
            elif part.model == "bicycle":
                self._drive(part, step)
            else:
                command["yaw"] += command["turn"] * step
                self._fly(part)

    def _drive(self, part: ModelPart, step: float) -> None:
        """Let the wheels of a car roll, each along its own circle about the centre of the curve (R. Ackermann's steering)."""
        command, base = part.command, wheelbase(part.thing)
        before = command["speed"]
        after = before + command["throttle"] * step
        command["speed"] = 0.0 if before >= 0 > after else after  # braking ends in a stop
        curvature = math.tan(command["steering"]) / base
        for name, x, y in wheels(part.thing, part.track):
            across, along = 1 + curvature * x, curvature * (y + 0.5 * base)
            speed = command["speed"] * math.hypot(across, along)
            self.data.ctrl[self.model.actuator(f"{part.name} {name}").id] = speed / part.radius
            if y > 0:
                self.data.ctrl[self.model.actuator(f"{part.name} {name} steering").id] = math.atan2(
                    along, across
                )

    def _feel(self, parts: list[ModelPart]) -> None:
        """Note where others touch the sides of these bodies."""
        if not parts:
            return
        contacts = self.data.contact
        sideways = np.flatnonzero(np.abs(contacts.frame[:, 2]) < _SIDEWAYS)
        if not len(sideways):
            return
        bodies = self.model.body_rootid[self.model.geom_bodyid[contacts.geom[sideways]]]
        for part in parts:
            body = self.data.body(part.name)
            sides_of_body = sideways[(bodies == body.id).any(axis=1)]
            places = (contacts.pos[sides_of_body] - body.xpos) @ body.xmat.reshape(3, 3)
            self._touches[id(part.thing)] += [Vector.of(tuple(place)) for place in places.tolist()]

    def _accelerate(self, command: dict[str, float], step: float) -> None:
        for axis in "xyz":
            command[f"v{axis}"] += command.get(f"a{axis}", 0.0) * step

    def _fly(self, part: ModelPart) -> None:
        """Thrust along the own up axis, drag, and a torque towards the attitude that is wanted."""
        mujoco, data, command = library(), self.data, part.command
        position, velocity = self._joint(part)
        quaternion = data.qpos[position + 3 : position + 7]
        matrix, inertial = np.empty(9), np.empty(9)
        mujoco.mju_quat2Mat(matrix, quaternion)
        turn = matrix.reshape(3, 3)
        force = part.mass * (command["thrust"] * turn[:, 2] - DRAG * data.qvel[velocity : velocity + 3])
        attitude = Orientation.fromEuler(command["yaw"], command["pitch"], command["roll"])
        back, error, angle = np.empty(4), np.empty(4), np.empty(3)
        mujoco.mju_negQuat(back, quaternion)
        mujoco.mju_mulQuat(error, back, np.array([attitude.w, attitude.x, attitude.y, attitude.z]))
        mujoco.mju_quat2Vel(angle, error, 1.0)
        # All in the body's frame, as the velocity of a free joint is.
        rate = data.qvel[velocity + 3 : velocity + 6]
        aim = turn.T @ np.array([0.0, 0.0, command["turn"]])
        acceleration = _STIFFNESS * angle + 2 * math.sqrt(_STIFFNESS) * (aim - rate)
        body = self.model.body(part.name)
        mujoco.mju_quat2Mat(inertial, body.iquat)
        axes = inertial.reshape(3, 3)
        torque = axes @ (body.inertia * (axes.T @ acceleration))
        data.body(part.name).xfrc_applied[:] = [*force, *(turn @ torque)]

    def _check(self) -> None:
        """Raise `SimulationError` if the physics has gone wrong."""
        data, warning = self.data, library().mjtWarning
        finite = np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all()
        wild = (warning.mjWARN_BADQPOS, warning.mjWARN_BADQVEL, warning.mjWARN_BADQACC)
        full = (warning.mjWARN_CONTACTFULL, warning.mjWARN_CNSTRFULL)
        if not finite or any(data.warning[int(kind)].number for kind in wild):
            raise SimulationError(
                f"MuJoCo became unstable in step {self.currentTime}, {self._culprit()}",
                help="let objects not begin inside each other, make masses and forces less extreme, "
                "or take smaller steps: MujocoSimulator(physics_step=0.0005)",
            )
        if any(data.warning[int(kind)].number for kind in full):
            raise SimulationError(
                f"MuJoCo ran out of memory for contacts in step {self.currentTime}",
                help="let fewer objects touch, or give meshes a simpler form",
            )

    def _culprit(self) -> str:
        """Return words that name the body that moves fastest; empty if none moves."""
        speeds: dict[str, float] = {}
        for part in self._parts.values():
            if part.moves:
                place = self._joint(part)[1]
                speed = float(np.abs(self.data.qvel[place : place + 6]).max())
                speeds[self._name(part.thing)] = speed if math.isfinite(speed) else math.inf
        return f"where {max(speeds, key=lambda name: speeds[name])} moved fastest" if speeds else ""

    def _name(self, obj: object) -> str:
        number = next(index for index, other in enumerate(self.objects) if other is obj)
        originals = self._original.objects
        known = self._original.names.get(originals[number]) if number < len(originals) else None
        return f"object {number}" if known is None else f"`{known}`"

    # Reading back

    def getProperties(self, obj: Any, properties: Any) -> Mapping[str, Any]:
        """Read the body's state."""
        part, attributes = self._parts[id(obj)], obj.__dict__
        if part.model in ("articulated", "link"):
            return self._jointed_properties(part, properties)
        if not part.moves:
            return {name: attributes[name] for name in properties}
        position, velocity = self._joint(part)
        x, y, z, qw, qx, qy, qz = self.data.qpos[position : position + 7].tolist()
        vx, vy, vz = self.data.qvel[velocity : velocity + 3].tolist()
        turn = Orientation.of((qx, qy, qz, qw))
        wx, wy, wz = (_matrix(turn) @ self.data.qvel[velocity + 3 : velocity + 6]).tolist()
        parent = attributes["parentOrientation"]
        local = turn if parent == _UPRIGHT else parent.inverse * turn
        yaw, pitch, roll = local.eulerAngles
        values = {
            "position": Vector.of((x, y, z)),
            "velocity": Vector.of((vx, vy, vz)),
            "speed": math.sqrt(vx * vx + vy * vy + vz * vz),
            "angularVelocity": Vector.of((wx, wy, wz)),
            "angularSpeed": math.sqrt(wx * wx + wy * wy + wz * wz),
            "yaw": yaw,
            "pitch": pitch,
            "roll": roll,
        }
        if "holding" in properties:
            values["holding"] = any(self.data.eq_active[number] for number in self._grips(part))
        if "touches" in properties:
            values["touches"] = tuple(self._touches.get(id(obj), ()))
        return {name: values[name] if name in values else attributes[name] for name in properties}

    def _jointed_properties(self, part: ModelPart, properties: Any) -> Mapping[str, Any]:
        """Read the state of a thing with joints, or of one of its links."""
        attributes = part.thing.__dict__
        values: dict[str, Any] = {}
        if part.model == "articulated":
            joints = self._jointed[id(part.thing)]
            values = {
                "jointValues": joints.values(),
                "jointVelocities": joints.velocities(),
                "jointTorques": joints.torques(),
            }
            if "gripperContacts" in properties:
                values["gripperContacts"] = self._held(joints)
        elif (joints := self._jointed.get(id(part.thing.base))) is not None:  # type: ignore[assignment] # or none
            middle = middle_of(joints.description, part.thing.linkName)
            place, (x, y, z, w) = joints.place(part.thing.linkName, middle)
            parent = attributes["parentOrientation"]
            turn = parent.inverse * Orientation.of((float(x), float(y), float(z), float(w)))
            yaw, pitch, roll = turn.eulerAngles
            values = {"position": Vector.of(tuple(place.tolist())), "yaw": yaw, "pitch": pitch, "roll": roll}
        return {name: values[name] if name in values else attributes[name] for name in properties}

    def _held(self, jointed: Jointed) -> tuple[Any, ...]:
        """Return the objects that the links of a gripper touch."""
        fingers = jointed.gripper_bodies()
        contacts = self.data.contact
        if not fingers or not len(contacts.geom):
            return ()
        bodies = self.model.geom_bodyid[contacts.geom]
        one, other = bodies[:, 0], bodies[:, 1]
        among = [np.isin(side, fingers) for side in (one, other)]
        body_numbers = {
            int(body) for body in np.concatenate([other[among[0] & ~among[1]], one[among[1] & ~among[0]]])
        }
        return tuple(part.thing for part in self._parts.values() if body_numbers & self._bodies(part))

    def _bodies(self, part: ModelPart) -> set[int]:
        """Numbers of the bodies of the model that are an object; none for things with joints and their links."""
        if part.model in ("articulated", "link"):
            return set()
        return {int(self.model.body(part.name).id)}

    def jointed(self, agent: object) -> Jointed:
        """Return the joints of an agent."""
        return self._jointed[id(agent)]


def _matrix(turn: Any) -> Floats:
    """Return the rotation matrix ``(3, 3)`` of a unit quaternion."""
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _bottom(obj: Any) -> float:
    """The height of the lowest point of an object, metres."""
    size = np.array([obj.width, obj.length, obj.height], dtype=np.float64)
    heights = (np.asarray(obj.shape.mesh.vertices) * size) @ _matrix(obj.orientation)[2]
    return float(obj.position.z + heights.min())
