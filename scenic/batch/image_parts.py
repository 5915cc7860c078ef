"""Labelled images as parts of data sets: encoded where their scenes are made, then in files of their own or in shards.

A part of the form ``images`` is an index ``part-N.json`` in the form of the COCO data sets, which names the files of its scenes
beside it; one of the form ``tar`` is a shard ``part-N.tar`` with such an index beside it. Every image of the index has the digest
of its scene's files.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, groupby
from pathlib import Path
from typing import Any, Final

from scenic.batch.manifest import DatasetError, Manifest, Part
from scenic.batch.source_files import texts_of
from scenic.formats.coco import INDEX, Photographer, index_of
from scenic.formats.files import Waiting, write, writing
from scenic.formats.mesh_files import digest_of
from scenic.formats.mesh_instances import MeshSurfaces
from scenic.formats.scene_cameras import AbsentCameraError
from scenic.formats.shards import END, encoded_row, member, members, rows_of
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

__all__ = [
    "IMAGE_FORMS",
    "ImageRows",
    "ImageSink",
    "copy_images",
    "damaged_files",
    "image_files",
    "image_rows",
    "join_indices",
]

IMAGE_FORMS: Final = ("images", "tar")
"""Images in files of their own in the folder, or in shards."""


class ImageRows:
    """Turns scenes into rows: for each scene two lengths, the members of a tar file, and its part of the index as JSON.

    Every camera gives the scene one image of the index; all images of a scene are one row.

    Args:
        scenario: the program.
        form: of `IMAGE_FORMS`.
        settings: see `Manifest.images`.

    """

    def __init__(self, scenario: Scenario, form: str, settings: Mapping[str, Any]) -> None:
        size = settings["size"]
        surfaces, classes = MeshSurfaces(), classes_of(scenario)
        self._photographers = [
            Photographer(
                camera,
                None if size is None else (size[0], size[1]),
                classes=classes,
                # Readers of shards take what stands behind the first dot for the kind of content.
                joint="." if form == "tar" else "-",
                previewed=settings["overlay"],
                surfaces=surfaces,
            )
            for camera in settings["cameras"]
        ]
        self._most = len(scenario.objects)

    def rows(self, scenes: Sequence[Scene]) -> bytes:
        """Return the rows of some scenes."""
        return b"".join(self._row(scene) for scene in scenes)

    def _row(self, scene: Scene) -> bytes:
        contents: list[bytes] = []
        images: list[dict[str, Any]] = []
        annotations: list[dict[str, Any]] = []
        for place, photographer in enumerate(self._photographers):
            number = scene.k * len(self._photographers) + place
            try:
                shot = photographer.shoot(scene)
            except AbsentCameraError:
                continue  # the scene has no image of this camera
            contents.append(b"".join(member(name, data) for name, data in shot.files.items()))
            images.append(
                {"id": number + 1, **shot.image, "files": list(shot.files), "sha256": _digest(contents[-1])}
            )
            annotations += [
                {"id": number * self._most + item["object"] + 1, "image_id": number + 1, **item}
                for item in shot.annotations
            ]
        return encoded_row(b"".join(contents), [images, annotations])


def classes_of(scenario: Scenario) -> list[str]:
    """Return the categories that a program's objects may have, in order: those that they name, else the names of their classes."""
    found: dict[str, None] = {}
    for thing in scenario.objects:
        categories = texts_of(thing.__dict__.get("category"))
        found |= dict.fromkeys(categories or [type(thing).__name__])
    return list(found)


class ImageSink:
    """The part that is being made: images are written at once, the shard and the index when it is complete."""

    def __init__(self, path: Path, scenario: Scenario, manifest: Manifest) -> None:
        assert manifest.images is not None
        self._path = path
        self._cameras = manifest.images["cameras"]
        self._categories = {name: number for number, name in enumerate(classes_of(scenario), 1)}
        self._shard = Waiting(path) if manifest.form == "tar" else None
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []
        self.skipped = 0
        """Number of images that there are not, since the camera's object does not take part in its scene."""

    def add(self, rows: memoryview) -> None:
        """Write the next rows."""
        for content, (images, annotations) in rows_of(rows):
            if self._shard is not None:
                self._shard.write(content)
            else:
                for name, data in members(content):
                    write(self._path.parent / name, data)
            self._images += images
            self.skipped += len(self._cameras) - len(images)
            self._annotations += annotations

    def finish(self) -> None:
        """Write the index, and the shard."""
        index = index_of(self._cameras, self._categories, self._images, self._annotations)
        write(self._path.with_suffix(".json"), index)
        if self._shard is not None:
            self._shard.write(END)
            with writing(self._path) as stream:
                self._shard.copy(stream)

    def close(self) -> None:
        """Give the shard up."""
        if self._shard is not None:
            self._shard.close()


def image_rows(source: Path | bytes, form: str) -> Iterator[dict[str, Any]]:
    """Yield the scenes of a part, or of encoded rows: ``k``, ``images`` and ``annotations`` of the index, and ``content``."""
    if isinstance(source, bytes):
        for content, (images, annotations) in rows_of(memoryview(source)):
            if images:
                yield _plain(images, annotations, content)
        return
    index = _index(source.with_suffix(".json"))
    archive = dict(members(source.read_bytes())) if form == "tar" else {}
    annotations_of_image = {
        number: list(items) for number, items in groupby(index["annotations"], lambda item: item["image_id"])
    }
    for _, group in groupby(index["images"], lambda image: image["k"]):
        images, content = list(group), b""
        for name in chain.from_iterable(image["files"] for image in images):
            data = archive.get(name) if form == "tar" else _read(source.parent / name)
            content += b"" if data is None else member(name, data)
        annotations = chain.from_iterable(annotations_of_image.get(image["id"], []) for image in images)
        yield _plain(images, list(annotations), content)


def _plain(images: list[dict[str, Any]], annotations: list[dict[str, Any]], content: bytes) -> dict[str, Any]:
    return {"k": images[0]["k"], "images": images, "annotations": annotations, "content": content}


def _read(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _index(path: Path) -> dict[str, Any]:
    try:
        found: dict[str, Any] = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise DatasetError(f"'{path}' cannot be read: {error}") from error
    return found


def image_files(index: Path) -> list[str]:
    """The names of the files that an index names."""
    return [name for image in _index(index)["images"] for name in image["files"]]


def damaged_files(folder: Path, part: Part, form: str) -> Iterator[tuple[str, str]]:
    """Yield files of a part, whose own file is whole, that are missing or changed, and what is wrong with them."""
    if form == "tar":
        index = (folder / part.file).with_suffix(".json")
        if not index.is_file():
            yield index.name, "the file is missing"
        elif digest_of(index) != part.index:
            yield index.name, "the content has changed since it was written"
        return
    for image in _index(folder / part.file)["images"]:
        names = image["files"]
        missing = [name for name in names if not (folder / name).is_file()]
        for name in missing:
            yield name, "the file is missing"
        content = b"".join(member(name, _read(folder / name) or b"") for name in names)
        if not missing and _digest(content) != image["sha256"]:
            yield (
                names[0],
                "the content of this file, or of another of its scene, has changed since it was written",
            )


def copy_images(source: Path, part: Part, form: str, target: Path) -> None:
    """Copy what belongs to a part to where ``target`` is to be, which is its own file.

    Raises:
        DatasetError: something of it is damaged.

    """
    for name, what in damaged_files(source, part, form):
        raise DatasetError(f"'{source / name}': {what}", help="make this part again")
    if form == "tar":
        write(target.with_suffix(".json"), (source / part.file).with_suffix(".json").read_bytes())
        return
    for image in _index(source / part.file)["images"]:
        for name in image["files"]:
            write(target.parent / name, (source / name).read_bytes())


def join_indices(folder: Path, manifest: Manifest) -> None:
    """Write one index of all images in a folder that belong to complete parts."""
    if manifest.images is None or not manifest.parts:
        return
    indices = [_index(folder / part.file) for part in manifest.parts]
    categories = {item["name"]: item["id"] for item in indices[0]["categories"]}
    images = [image for index in indices for image in index["images"]]
    annotations = [item for index in indices for item in index["annotations"]]
    write(folder / INDEX, index_of(manifest.images["cameras"], categories, images, annotations))
