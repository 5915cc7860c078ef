"""Labelled images of many scenes in one folder, with an index in the form of the COCO data sets.

For scene k there are images named after what they hold, and ``NAME-k.json`` with everything known of the objects.
``annotations.json`` lists all images with a box, a mask and a class for each object that has pixels; masks are run
lengths down the columns, which COCO's tools read.
"""

import json
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from scenic.formats.files import write
from scenic.formats.instances import Gallery
from scenic.formats.labels import Observation, document, observe
from scenic.formats.png import encoded
from scenic.formats.scenes import Scene
from scenic.formats.sensors import viewpoint

INDEX: Final = "annotations.json"

_MILLIMETRES: Final = 1000.0
_MOST: Final = 65535


class LabelledImages:
    """A folder of labelled images in the making."""

    def __init__(self, folder: Path, camera: str, size: tuple[int, int] | None) -> None:
        self._folder = folder
        self._camera = camera
        self._size = size
        self._gallery = Gallery()
        self._categories: dict[str, int] = {}
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []

    def add(self, scene: Scene) -> None:
        """Write the images and labels of a scene."""
        point = viewpoint(scene, self._camera, self._size)
        found = observe(scene, point, gallery=self._gallery)
        for label in found.labels:
            self._categories.setdefault(label.instance.class_name, len(self._categories) + 1)
        stem = f"{self._camera}-{scene.k:06d}"
        files = {}
        for output in point.outputs:
            files[output] = f"{stem}-{output}.png"
            write(self._folder / files[output], self._picture(found, output))
        labels = document(found, scene)
        labels["images"] = files
        labels["categories"] = dict(self._categories)
        write(self._folder / f"{stem}.json", (json.dumps(labels, allow_nan=False) + "\n").encode())
        self._index(found, scene, files)

    def finish(self) -> None:
        """Write the index."""
        index = {
            "info": {"description": f"scenes seen by {self._camera}", "version": "1"},
            "images": self._images,
            "categories": [{"id": number, "name": name} for name, number in self._categories.items()],
            "annotations": self._annotations,
        }
        write(self._folder / INDEX, (json.dumps(index, allow_nan=False) + "\n").encode())

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
                        numbers[label.index + 1] = self._categories[label.instance.class_name]
                return encoded(numbers[found.objects + 1])

    def _index(self, found: Observation, scene: Scene, files: dict[str, str]) -> None:
        width, height = found.viewpoint.size
        number = len(self._images) + 1
        self._images.append(
            {
                "id": number,
                "file_name": files.get("rgb") or next(iter(files.values())),
                "width": width,
                "height": height,
                "seed": str(scene.seed),
                "k": scene.k,
            }
        )
        for label in found.labels:
            if label.box is None:
                continue
            mask = found.mask(label)
            self._annotations.append(
                {
                    "id": len(self._annotations) + 1,
                    "image_id": number,
                    "category_id": self._categories[label.instance.class_name],
                    "bbox": label.box.as_list(),
                    "area": label.pixels,
                    "segmentation": {"size": [height, width], "counts": run_lengths(mask)},
                    "iscrowd": 0,
                    "object": label.index,
                    "visible": label.visible,
                    "occluded": label.occluded,
                }
            )


def millimetres(depth: npt.NDArray[np.float32]) -> npt.NDArray[np.uint16]:
    """Depth in metres as whole millimetres; 0 where no object is, 65,535 for all that is that far or farther."""
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
