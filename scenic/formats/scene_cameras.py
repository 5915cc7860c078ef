"""The cameras of a scene: where each stands, its lens, and whose it is."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from scenic.dataclass import dataclass
from scenic.formats.camera import Camera
from scenic.formats.mesh_instances import Array
from scenic.formats.poses import quaternion_of
from scenic.formats.scene_protocols import Scene, SceneObject
from scenic.language.errors import Located
from scenic.runtime.elements.sensors import DEFAULT_FIELD_OF_VIEW, CameraSensor

ALL_OUTPUTS = ("rgb", "depth", "semantic", "instance")

_WIDEST = math.radians(170)
"""View angles above this are not taken for those of a pinhole camera."""


class CameraError(Located):
    """A camera that a scene does not have."""

    code = "SC604"


class AbsentCameraError(CameraError):
    """The camera of an object that does not take part in a scene."""


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """A camera in a scene.

    Attributes:
        name: as it was asked for.
        owner: the object that carries it, which it does not see.
        camera: its place, axes and lens.
        quaternion: orientation (x, y, z, w): ahead is +Y, up +Z.
        size: columns and rows of its images, pixels.
        outputs: the images it gives, of `ALL_OUTPUTS`.

    """

    name: str
    owner: SceneObject
    camera: Camera
    quaternion: Array
    size: tuple[int, int]
    outputs: tuple[str, ...]

    @property
    def angles(self) -> tuple[float, float]:
        """Horizontal and vertical opening angle, radians."""
        across, upward = self.camera.tangents
        return 2 * math.atan(across), 2 * math.atan(upward)

    @property
    def intrinsics(self) -> Array:
        """The matrix ``(3, 3)`` from (right, down, ahead) to pixels; the upper left corner of the image is (0, 0)."""
        width, height = self.size
        across, upward = self.camera.tangents
        return np.array([[width / 2 / across, 0, width / 2], [0, height / 2 / upward, height / 2], [0, 0, 1]])

    def project(self, points: Array) -> Array:
        """World points ``(n, 3)`` as column, row and depth along the axis, ``(n, 3)``; what is behind has no pixel."""
        offset = points - self.camera.eye
        right, up, ahead = (
            (offset * axis).sum(axis=-1) for axis in (self.camera.right, self.camera.up, self.camera.ahead)
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            across = self.size[0] * 0.5 * (1 + right / (ahead * self.camera.tangents[0]))
            down = self.size[1] * 0.5 * (1 - up / (ahead * self.camera.tangents[1]))
        is_ahead = ahead > 0
        return np.stack(
            [np.where(is_ahead, across, np.nan), np.where(is_ahead, down, np.nan), ahead], axis=-1
        )


def viewpoint(scene: Scene, name: str, size: tuple[int, int] | None) -> Viewpoint:
    """Return the camera of that name: a sensor of some object, the ego's first, or an object itself.

    Raises:
        CameraError: the scene has no such camera.

    """
    sensors = _sensors(scene)
    if name in sensors:
        owner, sensor = sensors[name]
        _check_one(scene, name, owner)
        return sensor_viewpoint(name, owner, sensor, size)
    objects = {label: thing for thing, label in scene.names.items()}
    if scene.egoObject is not None:
        objects.setdefault("ego", scene.egoObject)
    if name in objects:
        return _of_object(name, objects[name], size or (640, 480))
    if name in _of_program(scene):
        raise AbsentCameraError(f"the camera {name!r} does not take part in scene {scene.k}")
    names = ", ".join(repr(item) for item in [*sensors, *objects]) or "none"
    raise CameraError(
        f"the scene has no camera {name!r}",
        help=f"cameras are sensors and objects by the names of their variables; here: {names}",
    )


def _check_one(scene: Scene, name: str, owner: SceneObject) -> None:
    """Raise `CameraError` if the name of a sensor is that of an object, too."""
    thing = next((thing for thing, label in scene.names.items() if label == name), None)
    if thing is None and name == "ego":
        thing = scene.egoObject
    if thing is not None:
        carrier = scene.names.get(owner) or f"an object of the class {type(owner).__name__}"
        raise CameraError(
            f"two cameras are called {name!r}: the object {name!r}, and a sensor of {carrier}",
            help="give the sensor another name in `sensors`, or the object another variable",
        )


def _of_program(scene: Scene) -> set[str]:
    """The names of cameras of all objects that the program creates, in whichever scenes they take part."""
    names: set[str] = set()
    scenario: Any = getattr(scene, "scenario", None)  # the states of a simulation have none
    if scenario is None:
        return set()
    for thing in scenario.objects:
        variable = scenario.variable(thing)
        names.update([variable] if variable is not None else [])
        sensors = thing.__dict__.get("sensors")
        if isinstance(sensors, Mapping):
            names.update(map(str, sensors))
    return names


def _sensors(scene: Scene) -> dict[str, tuple[SceneObject, CameraSensor]]:
    found: dict[str, tuple[SceneObject, CameraSensor]] = {}
    for thing in scene.objects:
        sensors = thing.properties.get("sensors")
        if isinstance(sensors, Mapping):
            for name, sensor in sensors.items():
                if isinstance(sensor, CameraSensor):
                    found.setdefault(str(name), (thing, sensor))
    return found


def viewpoints(scene: Scene) -> list[Viewpoint]:
    """Return all cameras of a scene that are sensors, each of their own size; of one name the first."""
    return [sensor_viewpoint(name, owner, sensor) for name, (owner, sensor) in _sensors(scene).items()]


def sensor_viewpoint(
    name: str, owner: SceneObject, sensor: CameraSensor, size: tuple[int, int] | None = None
) -> Viewpoint:
    """Return the camera that is a sensor of an object; ``size`` in pixels instead of its own."""
    offset = sensor.offset
    if offset is None:
        offset = _triple(owner.properties.get("visionSensorOffset", (0.0, owner.length / 2, 0.0)))
    width, height = size or (sensor.width, sensor.height)
    across = math.tan(sensor.fieldOfView / 2)
    tangents = (across, across * height / width)
    return _placed(name, owner, offset, sensor.rotation, tangents, (width, height), sensor.outputs)


def _of_object(name: str, owner: SceneObject, size: tuple[int, int]) -> Viewpoint:
    """An object's own view; one too wide for a plane image is narrowed."""
    angles = owner.properties.get("viewAngles", (2 * math.pi, math.pi))
    horizontal, vertical = (float(value) for value in angles)  # type: ignore[attr-defined] # a property of any type
    if horizontal > _WIDEST:
        horizontal = math.radians(DEFAULT_FIELD_OF_VIEW)
    across = math.tan(horizontal / 2)
    upward = across * size[1] / size[0] if vertical > _WIDEST else math.tan(vertical / 2)
    mounted = _triple(owner.properties.get("cameraOffset", (0.0, 0.0, 0.0)))
    return _placed(name, owner, mounted, (0.0, 0.0, 0.0), (across, upward), size, ALL_OUTPUTS)


def _placed(
    name: str,
    owner: SceneObject,
    offset: tuple[float, float, float],
    rotation: tuple[float, float, float],
    tangents: tuple[float, float],
    size: tuple[int, int],
    outputs: tuple[str, ...],
) -> Viewpoint:
    from scipy.spatial.transform import Rotation

    body = Rotation.from_quat(quaternion_of(owner))
    orientation = body * Rotation.from_euler("ZXY", rotation)
    right, ahead, up = orientation.as_matrix().T
    eye = np.array(_triple(owner.position)) + body.apply(offset)
    return Viewpoint(
        name, owner, Camera(eye, right, up, ahead, tangents), orientation.as_quat(), size, outputs
    )


def _triple(values: object) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)  # type: ignore[attr-defined] # any three numbers
    return x, y, z
