"""Labelled images of scenes, with an index in the form of the COCO data sets.

For a scene there are images named after what they hold, and a JSON file with everything known of the objects. The index lists
images with a box, a mask and a class for each object that has pixels; masks are run lengths down the columns, which COCO's tools
read.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.dataclass import dataclass
from scenic.formats.files import safe_name, write
from scenic.formats.labels import Observation, document, observe
from scenic.formats.mesh_instances import Gallery, MeshSurfaces
from scenic.formats.overlay import overlay
from scenic.formats.png import encoded
from scenic.formats.scene_cameras import viewpoint
from scenic.formats.scene_protocols import Scene

__all__ = ["INDEX", "LabelledImages", "Photographer", "Shot", "index_of", "millimetres", "run_lengths"]

INDEX: Final = "annotations.json"

_MILLIMETRES: Final = 1000.0
_MOST: Final = 65535


@dataclass(frozen=True, slots=True)
class Shot:
    """The images of one scene from a camera.

    Attributes:
        files: contents by names: the images, then the labels.
        image: the entry of the index, without its ``id``.
        annotations: those of the index, without ``id`` and ``image_id``.

    """

    files: Mapping[str, bytes]
    image: dict[str, Any]
    annotations: Sequence[dict[str, Any]]


class Photographer:
    """Takes labelled images of scenes; if all classes are given, the entries of an image depend on its scene alone.

    Args:
        camera: a sensor of some object, or the variable of an object.
        size: columns and rows, in place of the camera's own.
        classes: those of the objects, in order; classes that are not among them are added when they are met.
        joint: what stands between the name of a scene and that of an output.
        previewed: whether to draw the labels into an image of their own, too.
        surfaces: meshes that other cameras have met.

    Attributes:
        categories: the numbers of the classes that have been told or seen, from 1.

    """

    def __init__(
        self,
        camera: str,
        size: tuple[int, int] | None,
        *,
        classes: Iterable[str] = (),
        joint: str = "-",
        previewed: bool = False,
        surfaces: MeshSurfaces | None = None,
    ) -> None:
        self._camera = camera
        self._size = size
        self._classes = tuple(dict.fromkeys(classes))
        self.categories = {name: number for number, name in enumerate(self._classes, 1)}
        self._joint = joint
        self._previewed = previewed
        self._surfaces = MeshSurfaces() if surfaces is None else surfaces

    def shoot(self, scene: Scene) -> Shot:
        """Return the images and labels of a scene."""
        point = viewpoint(scene, self._camera, self._size)
        gallery = Gallery(self._classes, self._surfaces)
        observation = observe(scene, point, gallery=gallery, painted=self._previewed)
        self._classes = gallery.classes
        for label in observation.labels:
            self.categories.setdefault(label.instance.category, len(self.categories) + 1)
        stem = f"{safe_name(self._camera)}-{scene.k:06d}"
        names = {output: f"{stem}{self._joint}{output}.png" for output in point.outputs}
        files = {names[output]: self._picture(observation, output) for output in point.outputs}
        if self._previewed:
            names["overlay"] = f"{stem}{self._joint}overlay.png"
            files[names["overlay"]] = encoded(overlay(observation))
        labels = document(observation, scene)
        labels["images"] = names
        labels["categories"] = dict(self.categories)
        files[f"{stem}.json"] = (json.dumps(labels, allow_nan=False) + "\n").encode()
        width, height = observation.viewpoint.size
        image = {
            "file_name": names.get("rgb") or next(iter(names.values())),
            "width": width,
            "height": height,
            "seed": scene.seed,
            "k": scene.k,
            "camera": self._camera,
        }
        return Shot(files, image, list(self._annotations(observation)))

    def _picture(self, found: Observation, output: str) -> bytes:
        match output:
            case "rgb":
                assert found.rgb is not None
                return encoded(found.rgb)
            case "depth":
                return encoded(millimetres(found.depth))
            case "instance":
                return encoded((found.objects + 1).astype(np.uint16))
            case _:
                numbers = np.zeros(int(found.objects.max(initial=0)) + 2, np.uint16)
                for label in found.labels:
                    if label.pixels:
                        numbers[label.index + 1] = self.categories[label.instance.category]
                return encoded(numbers[found.objects + 1])

    def _annotations(self, found: Observation) -> Iterable[dict[str, Any]]:
        width, height = found.viewpoint.size
        for label in found.labels:
            if label.box is not None:
                mask = found.mask(label)
                yield {
                    "category_id": self.categories[label.instance.category],
                    "bbox": label.box.as_list(),
                    "area": label.pixels,
                    "segmentation": {"size": [height, width], "counts": run_lengths(mask)},
                    "iscrowd": 0,
                    "object": label.index,
                    "visible": label.visible,
                    "occluded": label.occluded,
                }


def index_of(
    cameras: Sequence[str],
    categories: Mapping[str, int],
    images: Sequence[Mapping[str, Any]],
    annotations: Sequence[Mapping[str, Any]],
) -> bytes:
    """Return the index of images and their annotations, as JSON."""
    index = {
        "info": {"description": f"scenes seen by {', '.join(cameras)}", "version": "1"},
        "images": images,
        "categories": [{"id": number, "name": name} for name, number in categories.items()],
        "annotations": annotations,
    }
    return (json.dumps(index, allow_nan=False) + "\n").encode()


class LabelledImages:
    """A folder of labelled images in the making."""

    def __init__(self, folder: Path, camera: str, size: tuple[int, int] | None) -> None:
        self._folder = folder
        self._camera = camera
        self._photographer = Photographer(camera, size)
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []

    def add(self, scene: Scene) -> None:
        """Write the images and labels of a scene."""
        shot = self._photographer.shoot(scene)
        for name, content in shot.files.items():
            write(self._folder / name, content)
        number = len(self._images) + 1
        self._images.append({"id": number, **shot.image})
        for annotation in shot.annotations:
            place = len(self._annotations) + 1
            self._annotations.append({"id": place, "image_id": number, **annotation})

    def finish(self) -> None:
        """Write the index."""
        categories = self._photographer.categories
        write(self._folder / INDEX, index_of((self._camera,), categories, self._images, self._annotations))


def millimetres(depth: npt.NDArray[np.float32]) -> npt.NDArray[np.uint16]:
    """Return depth in metres as whole millimetres; 0 where no object is, 65,535 for all that is that far or farther."""
    finite = np.isfinite(depth)
    scaled = np.round(np.where(finite, depth, 0) * _MILLIMETRES)
    return np.where(finite, np.clip(scaled, 1, _MOST), 0).astype(np.uint16)


def run_lengths(mask: npt.NDArray[np.bool_]) -> list[int]:
    """Lengths of runs down the columns of a mask, alternately of pixels not in it and in it, the former first."""
    flat = mask.T.reshape(-1)
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    bounds = np.concatenate([[0], changes, [len(flat)]])
    lengths = np.diff(bounds).tolist()
    return [0, *lengths] if flat[0] else lengths
