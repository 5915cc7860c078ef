"""Exact images of a scene from a camera, by pixel, with the facts about every object in them.

The label ``visible`` is the answer of `can see` for an observer in the camera's place with its view angles, its owner's
`visibleDistance` and one ray for each pixel (`viewRayCount`). Rays of `can see` stand evenly in azimuth and altitude and
those of a pinhole camera evenly in a plane; so an object of which an image shows a sliver may count as not visible, and
one that is only beyond the image's border, in a corner of the view window, as visible.
"""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.buffers import Lens, seen
from scenic.formats.mesh_instances import Array, Gallery, MeshInstance
from scenic.formats.poses import euler_angles
from scenic.formats.render import paint
from scenic.formats.scene_cameras import Viewpoint
from scenic.formats.scene_protocols import Scene, SceneObject
from scenic.formats.scenery import scenery_of
from scenic.formats.stage import Stage
from scenic.formats.textures import ImageTexture, placed_errors, texture_of
from scenic.runtime.geometry.meshes.bodies import Body
from scenic.runtime.geometry.meshes.mesh import Mesh
from scenic.runtime.geometry.poses import Poses
from scenic.runtime.geometry.views.hits import place
from scenic.runtime.geometry.views.observers import CORNERS, Views
from scenic.runtime.geometry.views.occluders import Occluder
from scenic.runtime.geometry.views.seen_bodies import sees_bodies

DEFAULT_RANGE = 50.0
"""Range of view of objects that give none, metres."""


@dataclass(frozen=True, slots=True)
class PixelBox:
    """A rectangle of pixels: left, top, width and height."""

    left: int
    top: int
    width: int
    height: int

    def as_list(self) -> list[int]:
        return [self.left, self.top, self.width, self.height]


@dataclass(frozen=True, slots=True)
class ImageLabel:
    """An object as a camera sees it.

    Attributes:
        index: its number among the scene's objects.
        instance: what is drawn of it.
        visible: whether the camera `can see` it.
        pixels: how many pixels show it.
        full_pixels: how many would if nothing stood before it.
        box: the least rectangle around the pixels that show it; ``None`` where none does.
        full_box: the same if nothing stood before it.
        corners: the corners of its box in the image: column, row and depth, ``(8, 3)``; no column and row (NaN) where
            they are behind the camera.
        depth: of its middle along the camera's axis, metres.
        nearest: least depth of the pixels that show it, metres; ``None`` where none does.

    """

    index: int
    instance: MeshInstance
    visible: bool
    pixels: int
    full_pixels: int
    box: PixelBox | None
    full_box: PixelBox | None
    corners: Array
    depth: float
    nearest: float | None

    @property
    def occluded(self) -> float | None:
        """The part of the pixels it would have that show something else; ``None`` where it would have none."""
        return None if not self.full_pixels else 1 - self.pixels / self.full_pixels


@dataclass(frozen=True, slots=True)
class Observation:
    """The images and facts that a camera sees of a scene.

    Attributes:
        viewpoint: the camera.
        rgb: colours, sRGB, ``(height, width, 3)``; ``None`` if not wanted.
        depth: along the camera's axis, metres, infinite where no object is, ``(height, width)``.
        objects: index of the object that each pixel shows, -1 where none is, ``(height, width)``.
        labels: of all drawn objects but the camera's owner.

    """

    viewpoint: Viewpoint
    rgb: npt.NDArray[np.uint8] | None
    depth: npt.NDArray[np.float32]
    objects: npt.NDArray[np.int32]
    labels: tuple[ImageLabel, ...]

    def mask(self, label: ImageLabel) -> npt.NDArray[np.bool_]:
        """Return the pixels that show an object, ``(height, width)``."""
        return np.asarray(self.objects == label.index)


def observe(
    scene: Scene,
    viewpoint: Viewpoint,
    *,
    gallery: Gallery | None = None,
    labelled: bool = True,
    painted: bool = False,
) -> Observation:
    """Observe a scene with a camera; a gallery shares what is known of meshes between scenes.

    Args:
        scene: the scene.
        viewpoint: the camera.
        gallery: shares what is known of meshes between scenes.
        labelled: whether to find labels, which cost more than the images.
        painted: whether to find colours also where the camera gives none.

    """
    gallery = Gallery() if gallery is None else gallery
    index = {id(thing): number for number, thing in enumerate(scene.objects)}
    instances = [item for item in gallery.add(scene) if item.thing is not viewpoint.owner]
    with placed_errors(scene):
        stage = Stage(gallery.surfaces, instances, scenery_of(scene.params))
    lens = Lens(viewpoint.camera, stage.center, viewpoint.size)
    buffer = seen(lens, stage.rays)
    numbers = np.array([index[id(item.thing)] for item in instances] + [-1], dtype=np.int32)
    owner = np.append(stage.owner, np.int32(len(instances)))
    objects = numbers[owner[buffer.triangle]]
    with np.errstate(divide="ignore"):
        depth = (np.float32(1) / buffer.nearness).astype(np.float32)
    rgb = paint(stage, lens, buffer) if painted or "rgb" in viewpoint.outputs else None
    labels = _labels(scene, viewpoint, instances, index, objects, depth) if labelled else ()
    return Observation(viewpoint, rgb, depth, objects, labels)


def _labels(
    scene: Scene,
    viewpoint: Viewpoint,
    instances: list[MeshInstance],
    index: dict[int, int],
    objects: npt.NDArray[np.int32],
    depth: npt.NDArray[np.float32],
) -> tuple[ImageLabel, ...]:
    distance = viewpoint.owner.properties.get("visibleDistance", DEFAULT_RANGE)
    views = Views.fixed(
        viewpoint.camera.eye,
        viewpoint.quaternion,
        angles=viewpoint.angles,
        distance=float(distance),  # type: ignore[arg-type] # a number, as the property is
        count=viewpoint.size,
    )
    bodies = {id(thing): body_of(thing) for thing in scene.objects}
    hiding = [
        thing
        for thing in scene.objects
        if thing is not viewpoint.owner and thing.properties.get("occluding", True)
    ]
    counts = np.bincount(objects.reshape(-1) + 1, minlength=len(index) + 1)
    labels = []
    for item in instances:
        body, number = bodies[id(item.thing)], index[id(item.thing)]
        occluders = [Occluder(bodies[id(thing)]) for thing in hiding if thing is not item.thing]
        mask = objects == number
        full_pixels, full_box = _alone(views, viewpoint, body)
        image_corners = viewpoint.project(body.poses.to_world(CORNERS))
        middle = viewpoint.project(body.poses.position)
        pixels = int(counts[number + 1])
        labels.append(
            ImageLabel(
                index=number,
                instance=item,
                visible=bool(sees_bodies(views, body, occluders, 1)[0]),
                pixels=pixels,
                # Single precision may show a pixel of an outline that double precision does not.
                full_pixels=max(full_pixels, pixels),
                box=_box(mask),
                full_box=full_box,
                corners=image_corners,
                depth=float(middle[0, 2]),
                nearest=float(depth[mask].min()) if pixels else None,
            )
        )
    return tuple(labels)


def body_of(thing: SceneObject) -> Body:
    """Return an object of a scene as visibility sees it."""
    mesh = thing.shape.mesh
    unit = mesh if isinstance(mesh, Mesh) else Mesh(mesh.vertices, np.asarray(mesh.faces, dtype=np.intp))
    turn = thing.orientation
    poses = Poses.fixed(
        [float(value) for value in thing.position],
        [turn.x, turn.y, turn.z, turn.w],
        [thing.width, thing.length, thing.height],
    )
    return Body((unit,), None, poses)


def _alone(views: Views, viewpoint: Viewpoint, body: Body) -> tuple[int, PixelBox | None]:
    """Return the number of pixels that a body would have without other bodies, and the rectangle around them."""
    width, height = viewpoint.size
    points = viewpoint.project(body.poses.to_world(body.meshes[0].vertices))
    if (points[:, 2] <= 0).all():
        return 0, None
    left, top, right, bottom = 0, 0, width, height
    if (points[:, 2] > 0).all():
        left, top = (max(0, math.floor(value) - 1) for value in points[:, :2].min(axis=0))
        low, high = (math.ceil(value) + 1 for value in points[:, :2].max(axis=0))
        right, bottom = min(width, low), min(height, high)
    if left >= right or top >= bottom:
        return 0, None
    column, row = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
    across, upward = viewpoint.camera.tangents
    directions = np.stack(
        [
            (2 * column / width - 1).reshape(-1) * across,
            np.ones(column.size),
            (1 - 2 * row / height).reshape(-1) * upward,
        ],
        axis=-1,
    )
    distances = place(body, views, np.zeros(1, dtype=np.intp)).first(
        np.zeros(len(directions), dtype=np.intp), directions
    )
    mask = np.isfinite(distances).reshape(column.shape)
    box = _box(mask)
    if box is not None:
        box = PixelBox(box.left + left, box.top + top, box.width, box.height)
    return int(mask.sum()), box


def _box(mask: npt.NDArray[np.bool_]) -> PixelBox | None:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return None
    left, top = int(columns[0]), int(rows[0])
    return PixelBox(left, top, int(columns[-1]) - left + 1, int(rows[-1]) - top + 1)


def document(observation: Observation, scene: Scene) -> dict[str, Any]:
    """Return the labels as plain data that JSON can hold (``docs/howto/cameras.md`` describes every field)."""
    viewpoint = observation.viewpoint
    camera = viewpoint.camera
    to_camera = np.eye(4)
    to_camera[:3, :3] = [camera.right, -camera.up, camera.ahead]
    to_camera[:3, 3] = -to_camera[:3, :3] @ camera.eye
    return {
        "format": "scenic-labels",
        "version": 1,
        "seed": scene.seed,
        "k": scene.k,
        "camera": {
            "name": viewpoint.name,
            "size": list(viewpoint.size),
            "position": camera.eye.tolist(),
            "quaternion": viewpoint.quaternion.tolist(),
            "view_angles": list(viewpoint.angles),
            "intrinsics": viewpoint.intrinsics.tolist(),
            "extrinsics": to_camera.tolist(),
        },
        "objects": [_entry(label) for label in observation.labels],
    }


def _texture(item: MeshInstance) -> dict[str, Any]:
    """Return the image on an object, as plain data; nothing where there is none."""
    texture = texture_of(item.thing.properties.get("texture"), item.color, item.folder)
    if not isinstance(texture, ImageTexture):
        return {}
    return {"texture": {"image": texture.name, "sha256": texture.digest()}}


def _entry(label: ImageLabel) -> dict[str, Any]:
    item = label.instance
    return {
        "index": label.index,
        "class": item.class_name,
        **({} if item.category == item.class_name else {"category": item.category}),
        "name": item.name,
        "position": list(item.position),
        "quaternion": list(item.quaternion),
        "euler": list(euler_angles(item.quaternion)),
        "size": list(item.size),
        **_texture(item),
        "visible": label.visible,
        "pixels": label.pixels,
        "full_pixels": label.full_pixels,
        "occluded": label.occluded,
        "box": None if label.box is None else label.box.as_list(),
        "full_box": None if label.full_box is None else label.full_box.as_list(),
        "corners": [
            [*((None, None) if math.isnan(column) else (column, row)), depth]
            for column, row, depth in label.corners.tolist()
        ],
        "depth": label.depth,
        "nearest": label.nearest,
    }
