"""Objects as bodies of a MuJoCo model.

Boxes, ellipsoids and round cylinders are MuJoCo's own geoms, all other shapes meshes, which have the inertia of the whole mesh
and touch others with its convex parts. Of a cylinder, what is within our prism touches others: so things that do not collide in a
scene do not touch in its simulation. The frame of a body is that of the object: its middle, its front along +Y.
"""

import math
from collections.abc import Iterator
from dataclasses import field
from typing import Any, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.language.errors import SimulationCreationError
from scenic.runtime.geometry.meshes.convex_parts import convex_parts
from scenic.runtime.geometry.meshes.primitives import round_share
from scenic.simulators.cameras import carried
from scenic.simulators.commands import model_of
from scenic.simulators.mujoco.jointed import attach
from scenic.simulators.mujoco.library import library

__all__ = ["MODELS", "Builder", "ModelPart", "wheelbase", "wheels"]

MODELS: Final = (
    "point",
    "free",
    "static",
    "guided",
    "differential",
    "bicycle",
    "quadrotor",
    "articulated",
    "link",
)
DENSITY: Final = 1000.0
"""Of objects that say neither mass nor density, kilograms per cubic metre: that of water."""

_TRACK: Final = 0.98
"""Distance of a robot's wheels, as a part of its width: they stand within its box."""
_WHEEL_MASS: Final = 0.05
"""Of each wheel, as a part of the robot's mass."""
_BASE: Final = 0.6
"""Distance of a car's axles, as a part of its length, as in the kinematic simulator."""
_SERVO: Final = 0.05
"""Seconds in which the drive of a robot corrects most of a difference in speed."""
_STIFF: Final = (0.01, 1.0)
"""Time constant (seconds) and damping ratio of welds."""
_HARD: Final = (0.005, 1.0)
"""The same of wheels on the ground, into which they sink the less the smaller the first is."""
_NOT_DRAWN: Final = 3
"""The group of geoms that MuJoCo does not draw unless asked to."""
_COLOR: Final = (0.6, 0.62, 0.66)


@dataclass(slots=True)
class ModelPart:
    """An object of the model.

    Attributes:
        thing: the object.
        model: which of `MODELS`; ``point`` is ``free``.
        name: of its body.
        mass: kilograms; 0 of a static one.
        radius: of its wheels, metres.
        command: what is in force, by name.
        geoms: names of the geoms that touch others, if these are not the one of its name.

    """

    thing: Any
    model: str
    name: str
    mass: float
    radius: float = 0.0
    command: dict[str, float] = field(default_factory=dict)
    geoms: list[str] = field(default_factory=list)

    @property
    def moves(self) -> bool:
        """Return whether it is a body that moves freely in the world."""
        return self.model not in ("static", "articulated", "link")

    @property
    def track(self) -> float:
        """Distance of its wheels, metres."""
        return _TRACK * float(self.thing.width)


def wheelbase(thing: Any) -> float:
    """Return the distance between the axles of a car, metres."""
    return _BASE * float(thing.length)


def wheels(thing: Any, track: float) -> Iterator[tuple[str, float, float]]:
    """Yield the wheels of a car: their names, and where they are in its frame, metres to the right and forward."""
    for side, x in (("left", -0.5 * track), ("right", 0.5 * track)):
        for end, y in (("front", 0.5 * wheelbase(thing)), ("rear", -0.5 * wheelbase(thing))):
            yield f"{end} {side}", x, y


class Builder:
    """A model in the making.

    Args:
        step: seconds of a step of the physics.
        gravity: metres per second squared, downwards.
        sleep: whether bodies at rest are left out of the computation.

    """

    def __init__(self, step: float, gravity: float, *, sleep: bool = False) -> None:
        mujoco = library()
        self._mj = mujoco
        self.spec = mujoco.MjSpec()
        option = self.spec.option
        option.timestep = step
        option.gravity = [0.0, 0.0, -gravity]
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        # Friction that does not depend on the direction, and keeps what rests on a slope from creeping down.
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        option.impratio = 10.0
        # What has gone wrong is to be told, not undone by a fresh start.
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        if sleep:
            option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        self.spec.visual.headlight.ambient = [0.5, 0.5, 0.5]
        self.spec.worldbody.add_light(pos=[0, 0, 20], dir=[0.3, 0.2, -1.0], castshadow=True)
        self.parts: list[ModelPart] = []
        self.cameras: dict[tuple[int, str], str] = {}
        """Names of cameras in the model, by the identity of their owner and their own name."""
        self._meshes: dict[tuple[int, tuple[float, ...]], tuple[Any, str]] = {}
        self._parted: dict[tuple[int, tuple[float, ...]], tuple[Any, tuple[str, ...]]] = {}

    def add_ground(self, height: float) -> None:
        """Add an endless plane at a height (metres)."""
        self.spec.worldbody.add_geom(
            name="ground",
            type=self._mj.mjtGeom.mjGEOM_PLANE,
            pos=[0, 0, height],
            size=[0, 0, 1],
            rgba=[0.80, 0.81, 0.83, 1],
        )

    def add(self, thing: Any) -> ModelPart:
        """Return an object; raises `SimulationCreationError` for one that cannot be made."""
        model = model_of(thing)
        if model not in MODELS:
            raise SimulationCreationError(
                f"MuJoCo has no dynamics {model!r}", help=f"use one of {', '.join(MODELS)}"
            )
        part = ModelPart(thing, "free" if model == "point" else model, f"object {len(self.parts)}", 0.0)
        if model in ("articulated", "link"):
            if model == "articulated":
                attach(self.spec, thing, f"{part.name} ")
            self.parts.append(part)
            return part
        body = self.spec.worldbody.add_body(name=part.name, pos=list(thing.position), quat=_quaternion(thing))
        if not part.moves:
            self._form(body, part, {"density": 0.0})
        else:
            body.add_freejoint()
            weight = self._weight(thing)
            if model == "differential":
                self._robot(body, part, weight)
            elif model == "bicycle":
                self._car(body, part, weight)
            else:
                self._form(body, part, {**weight, "priority": 1})
            if model == "guided":
                self._guide(body, part)
                for other in self.parts:
                    self._possible_grip(part, other)
            for other in self.parts:
                if other.model == "guided":
                    self._possible_grip(other, part)
        for number, (_, name, sensor) in enumerate(carried((thing,))):
            self.cameras[id(thing), name] = f"{part.name} camera {number}"
            self._camera(body, f"{part.name} camera {number}", thing, sensor)
        self.parts.append(part)
        return part

    # Forms

    def _weight(self, thing: object) -> dict[str, float]:
        """Return mass or density as arguments of a geom."""
        for name in ("mass", "density"):
            value = getattr(thing, name, None)
            if value is None:
                continue
            if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < math.inf:
                raise SimulationCreationError(
                    f"the {name} of {thing!r} must be a positive number, not {value!r}",
                    help="`mass` is in kilograms, `density` in kilograms per cubic metre; for what cannot be moved "
                    "say `with dynamics 'static'`",
                )
            return {name: float(value)}
        return {"density": DENSITY}

    def _form(
        self,
        body: Any,
        part: ModelPart,
        options: dict[str, Any],
        *,
        bottom: float = 0.0,
    ) -> Any:
        """Return the object's shape as a geom of a body; ``bottom`` metres are taken off below."""
        thing, kinds = part.thing, self._mj.mjtGeom
        size = (float(thing.width), float(thing.length), float(thing.height) - bottom)
        half = [0.5 * extent for extent in size]
        source = thing.shape.source
        common: dict[str, Any] = {"pos": [0, 0, 0.5 * bottom], **options, **self._surface(thing)}
        if source.initial_rotation is None:
            if source.kind == "box":
                return body.add_geom(name=part.name, type=kinds.mjGEOM_BOX, size=half, **common)
            if source.kind == "spheroid":
                # The mesh of the shape has the volume of a polyhedron, and density means that of the ideal form.
                kind = kinds.mjGEOM_SPHERE if half[0] == half[1] == half[2] else kinds.mjGEOM_ELLIPSOID
                return body.add_geom(name=part.name, type=kind, size=half, **common)
            if source.kind == "cylinder" and half[0] == half[1] and _is_round(source):
                inner = thing.shape.mesh.derived(round_share) * half[0]
                form, touching = (
                    {"type": kinds.mjGEOM_CYLINDER, "size": [radius, half[2], 0]}
                    for radius in (half[0], inner)
                )
                return self._whole(body, part, {**common, **form}, [touching])
        meshes = self._pieces(thing, size)
        return self._whole(
            body,
            part,
            {**common, "type": kinds.mjGEOM_MESH, "meshname": self._mesh(thing, size)},
            [{"type": kinds.mjGEOM_MESH, "meshname": name} for name in meshes],
        )

    def _whole(self, body: Any, part: ModelPart, whole: dict[str, Any], pieces: list[dict[str, Any]]) -> Any:
        """Return a geom that is seen and has the inertia; its pieces touch others in its place, if there are any."""
        if not pieces or not getattr(part.thing, "collides", True):
            return body.add_geom(name=part.name, **whole)
        weightless = {key: value for key, value in whole.items() if key not in ("mass", "density")}
        for number, piece in enumerate(pieces):
            name = f"{part.name} piece {number}"
            part.geoms.append(name)
            body.add_geom(name=name, **{**weightless, **piece}, mass=0, group=_NOT_DRAWN)
        return body.add_geom(name=part.name, **{**whole, "contype": 0, "conaffinity": 0})

    def _pieces(self, thing: Any, size: tuple[float, ...]) -> tuple[str, ...]:
        """The names of the meshes of the convex parts of an object's shape at a size, metres; none for convex ones."""
        mesh = thing.shape.mesh
        key = (id(mesh), size)
        if key not in self._parted:
            names: list[str] = []
            for vertices in mesh.derived(convex_parts):
                names.append(f"pieces {len(self._parted)}, {len(names)}")
                self.spec.add_mesh(
                    name=names[-1],
                    uservert=(vertices * size).ravel().tolist(),
                    inertia=self._mj.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
                )
            self._parted[key] = (mesh, tuple(names))
        return self._parted[key][1]

    def _surface(self, thing: object) -> dict[str, Any]:
        """Return friction, contacts and colour as arguments of a geom."""
        color = getattr(thing, "color", None)
        red, green, blue, *alpha = _COLOR if color is None else (float(part) for part in color)
        arguments: dict[str, Any] = {"rgba": [red, green, blue, alpha[0] if alpha else 1.0]}
        friction = getattr(thing, "friction", None)
        if friction is not None:
            if isinstance(friction, bool) or not isinstance(friction, int | float) or not 0 <= friction < 100:
                raise SimulationCreationError(
                    f"the friction of {thing!r} must be a coefficient from 0, not {friction!r}",
                    help="0 is ice, 1 is rubber",
                )
            arguments["friction"] = [float(friction), 0.005, 0.0001]
        if not getattr(thing, "collides", True):
            arguments["contype"] = arguments["conaffinity"] = 0
        return arguments

    def _mesh(self, thing: Any, size: tuple[float, ...]) -> str:
        """The name of the mesh of an object's shape at a size, metres."""
        mesh = thing.shape.mesh
        key = (id(mesh), size)
        if key not in self._meshes:
            name = f"mesh {len(self._meshes)}"
            vertices = np.asarray(mesh.vertices, dtype=np.float64) * size
            self.spec.add_mesh(
                name=name,
                uservert=vertices.ravel().tolist(),
                userface=np.asarray(mesh.faces, dtype=np.int32).ravel().tolist(),
                inertia=self._mj.mjtMeshInertia.mjMESH_INERTIA_EXACT,
            )
            # The mesh is kept beside its name: its identity stays taken while the table lives.
            self._meshes[key] = (mesh, name)
        return self._meshes[key][1]

    # What moves by itself

    def _robot(self, body: Any, part: ModelPart, weight: dict[str, float]) -> None:
        """Add a body on two driven wheels and two frictionless casters, all within the object's box."""
        thing, mujoco = part.thing, self._mj
        width, length, height = float(thing.width), float(thing.length), float(thing.height)
        radius = getattr(thing, "wheelRadius", None)
        part.radius = min(0.5 * height, 0.25 * length) if radius is None else float(radius)
        if not 0 < 2 * part.radius <= min(height, length) * (1 + 1e-9):
            raise SimulationCreationError(
                f"the wheels of {thing!r} do not fit into it: wheelRadius is {part.radius:g}",
                help="`wheelRadius` (metres) is at most half of the object's height and length",
            )
        clearance = 0.25 * part.radius
        volume = width * length * (height - clearance)
        mass = weight["mass"] if "mass" in weight else weight["density"] * volume
        share = {"mass": mass * (1 - 2 * _WHEEL_MASS), "priority": 1}
        self._form(body, part, share, bottom=clearance)
        low = -0.5 * height
        for side, x in (("left", -0.5 * part.track), ("right", 0.5 * part.track)):
            thickness = 0.5 * (width - part.track)
            place = (x, 0.0, low + part.radius)
            self._wheel(body, part, side, place, thickness, mass, drive=mass * part.radius**2 / (2 * _SERVO))
        ball = 0.5 * clearance
        # A little above the ground, so that the wheels carry the robot.
        for y in (-0.5 * length + ball, 0.5 * length - ball):
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                size=[ball, 0, 0],
                pos=[0, y, low + ball + 0.02 * part.radius],
                density=0,
                friction=[0, 0, 0],
                condim=1,
                priority=2,
                rgba=[0.3, 0.3, 0.3, 1],
            )
        part.mass = mass

    def _wheel(
        self,
        holder: Any,
        part: ModelPart,
        name: str,
        place: tuple[float, float, float],
        thickness: float,
        mass: float,
        *,
        drive: float,
    ) -> None:
        """A wheel of an object of a mass (kilograms), with a drive that corrects differences in speed."""
        kinds, full = self._mj, f"{part.name} {name}"
        wheel = holder.add_body(name=full, pos=list(place))
        joint = wheel.add_joint(name=full, type=kinds.mjtJoint.mjJNT_HINGE, axis=[-1, 0, 0])
        joint.armature = 0.01 * mass * part.radius**2
        wheel.add_geom(
            type=kinds.mjtGeom.mjGEOM_ELLIPSOID,
            size=[thickness, part.radius, part.radius],
            mass=mass * _WHEEL_MASS,
            solref=list(_HARD),
            friction=[1.0, 0.005, 0.0001],
            priority=2,
            rgba=[0.15, 0.15, 0.16, 1],
        )
        motor = self.spec.add_actuator(name=full, target=full, trntype=kinds.mjtTrn.mjTRN_JOINT)
        motor.set_to_velocity(kv=drive)

    def _car(self, body: Any, part: ModelPart, weight: dict[str, float]) -> None:
        """Add a body on four driven wheels, of which the front ones are steered."""
        thing = part.thing
        width, length, height = float(thing.width), float(thing.length), float(thing.height)
        radius = getattr(thing, "wheelRadius", None)
        part.radius = 0.22 * height if radius is None else float(radius)
        if not 0 < 2 * part.radius <= min(height, 0.5 * length) * (1 + 1e-9):
            raise SimulationCreationError(
                f"the wheels of {thing!r} do not fit into it: wheelRadius is {part.radius:g}",
                help="`wheelRadius` (metres) is at most half of the object's height and a quarter of its length",
            )
        clearance = 0.6 * part.radius
        tall = height - clearance
        part.mass = mass = weight["mass"] if "mass" in weight else weight["density"] * width * length * tall
        self._form(body, part, {"mass": mass, "priority": 1}, bottom=clearance)
        # Most of a car's mass is low, or it would tip over in curves.
        body.explicitinertial = True
        body.mass = mass * (1 - 4 * _WHEEL_MASS)
        body.ipos = [0.0, 0.0, -0.5 * height + 1.2 * part.radius]
        body.inertia = [
            body.mass / 12 * sum(extent**2 for extent in extents)
            for extents in ((length, tall), (width, tall), (width, length))
        ]
        thickness = 0.1 * width
        drive = mass * part.radius**2 / (4 * _SERVO)
        for name, x, y in wheels(thing, part.track - thickness):
            place = (x, y, part.radius - 0.5 * height)
            if y > 0:
                holder, place = self._steering(body, part, name, place), (0.0, 0.0, 0.0)
                self._wheel(holder, part, name, place, thickness, mass, drive=drive)
                # Things touch their parents' parents otherwise.
                self.spec.add_exclude(bodyname1=part.name, bodyname2=f"{part.name} {name}")
            else:
                self._wheel(body, part, name, place, thickness, mass, drive=drive)

    def _steering(self, body: Any, part: ModelPart, name: str, place: tuple[float, float, float]) -> Any:
        """Return the body that holds a steered wheel, with the drive that turns it."""
        kinds, full = self._mj, f"{part.name} {name} steering"
        holder = body.add_body(name=full, pos=list(place))
        holder.add_geom(
            type=kinds.mjtGeom.mjGEOM_SPHERE,
            size=[0.2 * part.radius, 0, 0],
            mass=0.01 * part.mass,
            contype=0,
            conaffinity=0,
            group=_NOT_DRAWN,
        )
        joint = holder.add_joint(name=full, type=kinds.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        joint.armature = 0.01 * part.mass * part.radius**2
        servo = self.spec.add_actuator(name=full, target=full, trntype=kinds.mjtTrn.mjTRN_JOINT)
        servo.set_to_position(kp=5 * part.mass * wheelbase(part.thing) * part.radius, dampratio=1.0)
        return holder

    def _guide(self, body: Any, part: ModelPart) -> None:
        """Add a floating body, welded to a frame that moves by commands."""
        body.gravcomp = 1.0
        name = f"{part.name} guide"
        self.spec.worldbody.add_body(
            name=name, mocap=True, pos=list(part.thing.position), quat=_quaternion(part.thing)
        )
        self._weld(name, part.name, name, active=True)

    def _possible_grip(self, gripper: ModelPart, other: ModelPart) -> None:
        if other.moves:
            self._weld(grip_name(gripper, other), gripper.name, other.name, active=False)

    def _weld(self, name: str, first: str, second: str, *, active: bool) -> None:
        equality = self.spec.add_equality(
            name=name,
            type=self._mj.mjtEq.mjEQ_WELD,
            objtype=self._mj.mjtObj.mjOBJ_BODY,
            name1=first,
            name2=second,
            active=active,
        )
        equality.solref = list(_STIFF)
        # At the middle of the second body, in the pose of the model; the default is meant for another type.
        equality.data = [0.0] * 10 + [1.0, 0.0]

    # Cameras

    def _camera(self, body: Any, name: str, thing: Any, sensor: Any) -> None:
        from scipy.spatial.transform import Rotation  # slow to import

        offset = sensor.offset
        if offset is None:
            offset = getattr(thing, "visionSensorOffset", (0.0, float(thing.length) / 2, 0.0))
        # MuJoCo's cameras look along -Z, with +Y up.
        turn = Rotation.from_euler("ZXY", sensor.rotation) * Rotation.from_euler("X", math.pi / 2)
        x, y, z, w = turn.as_quat().tolist()
        upward = math.tan(sensor.fieldOfView / 2) * sensor.height / sensor.width
        body.add_camera(
            name=name,
            pos=[float(value) for value in offset],
            quat=[w, x, y, z],
            fovy=math.degrees(2 * math.atan(upward)),
        )


def grip_name(gripper: ModelPart, other: ModelPart) -> str:
    """The name of the weld by which a gripper holds another body."""
    return f"{gripper.name} holds {other.name}"


def _is_round(source: Any) -> bool:
    return int(dict(source.parameters).get("sections", 64)) >= 16


def _quaternion(thing: Any) -> list[float]:
    turn = thing.orientation
    return [turn.w, turn.x, turn.y, turn.z]
