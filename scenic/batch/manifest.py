"""Manifests: how a data set was made, and what its files must be."""

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, field, replace
from pathlib import Path
from typing import Any, Final, Self

from scenic.batch.portable import versions
from scenic.batch.source_files import mesh_digests, texture_digests
from scenic.dataclass import dataclass
from scenic.formats.files import write
from scenic.language.errors import Located
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["FORMAT", "NAME", "VERSION", "DatasetError", "Manifest", "Part"]

FORMAT: Final = "scenic-dataset"
VERSION: Final = 2
NAME: Final = "manifest.json"
"""Name of the manifest in the folder of its data set."""


class DatasetError(Located):
    """A data set that cannot be read, continued, verified or merged."""

    code = "SC612"


class NoDatasetError(DatasetError):
    """The error for a folder without a data set."""

    code = "SC600"


@dataclass(frozen=True, slots=True)
class Part:
    """A complete file of a data set.

    Attributes:
        file: its name in the folder.
        first: the number of its first scene.
        last: one more than the number of its last scene.
        rows: how many scenes it holds.
        attempts: candidates tried for them, and for those that were not found.
        missing: the numbers of the scenes that were not found.
        sha256: digest of its bytes.
        index: digest of the index beside a shard of images.

    """

    file: str
    first: int
    last: int
    rows: int
    attempts: int
    missing: tuple[int, ...]
    sha256: str
    index: str = ""


@dataclass(frozen=True, slots=True)
class Manifest:
    """The settings of a data set. Everything but ``parts``, ``seconds`` and ``approximation`` decides what its rows are.

    Attributes:
        program: name of the program's file.
        options: the keyword arguments of `scenic.load`, as JSON has them.
        source: the program's file, relative to the folder of the data set.
        digest: digest of the program's tree and options.
        fingerprint: digest of its graph and of the narrowed domain.
        seed: the seed of all scenes.
        first: the number of the first scene.
        count: how many scenes were wanted.
        form: format of the parts, ``parquet`` or ``jsonl``; ``images`` or ``tar`` for labelled images; ``usd``, ``mjcf`` or ``sdf`` for files of scenes.
        part_size: scenes of a part.
        points: ``sobol`` where scenes are rows of Sobol's sequence, ``approximate N`` where N were made together, of nearly the program's law.
        max_attempts: candidates tried for one scene, at most.
        properties: which properties of objects are told, ``all`` or ``changed``.
        images: of labelled images, the ``cameras``, their ``size`` (each its own if ``None``), and whether there is an ``overlay``.
        meshes: digests of the mesh files that the program names.
        textures: digests of the image files that objects may have as textures.
        versions: versions of Python and of libraries that may change a scene.
        command: the command line or call, for people.
        seconds: time spent so far.
        approximation: of approximate scenes, how those made last came about, with a warning where they still depend on each other.
        parts: the complete files, in order.

    """

    program: str
    digest: str
    fingerprint: str
    seed: int
    first: int
    count: int
    form: str
    part_size: int
    points: str | None = None
    max_attempts: int | None = None
    properties: str = "changed"
    images: Mapping[str, Any] | None = None
    meshes: Mapping[str, str] = field(default_factory=dict)
    textures: Mapping[str, str] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=versions)
    options: Mapping[str, Any] = field(default_factory=dict)
    source: str = ""
    command: str = ""
    seconds: float = 0.0
    approximation: str = ""
    parts: tuple[Part, ...] = ()

    @classmethod
    def of(cls, scenario: Scenario, *, seed: int, count: int, **settings: Any) -> Self:
        """The manifest of a data set of a scenario's scenes, of which nothing is made yet."""
        return cls(
            Path(scenario.filename).name,
            scenario.digest,
            scenario.fingerprint,
            seed,
            settings.pop("first", 0),
            count,
            settings.pop("form", "parquet"),
            settings.pop("part_size", 65536),
            meshes=mesh_digests(scenario),
            textures=texture_digests(scenario),
            options=json.loads(json.dumps(dict(scenario.options), default=repr)),
            **settings,
        )

    @property
    def is_complete(self) -> bool:
        """Return whether all parts are there."""
        return sum(part.last - part.first for part in self.parts) == self.count

    @property
    def rows(self) -> int:
        """Number of scenes in the parts."""
        return sum(part.rows for part in self.parts)

    def ranges(self) -> list[tuple[int, int]]:
        """The numbers of the first scene of each part, and of the scene after its last."""
        end = self.first + self.count
        return [(k, min(k + self.part_size, end)) for k in range(self.first, end, self.part_size)]

    def file_of(self, first: int) -> str:
        """The name of the part that begins with a scene."""
        return self.file_name((first - self.first) // self.part_size)

    def file_name(self, number: int) -> str:
        """The name of a part; that of images and files in the folder is the index of its scenes."""
        is_index = self.form not in ("parquet", "jsonl", "tar")
        return f"part-{number:05d}.{'json' if is_index else self.form}"

    def difference(self, other: "Manifest") -> str | None:
        """The first setting in which data sets differ that cannot be continued by each other; their counts may differ."""
        for name in _SETTINGS:
            if getattr(self, name) != getattr(other, name):
                return f"{name} {getattr(self, name)!r}, not {getattr(other, name)!r}"
        return None

    def beside(self, folder: Path, program: str) -> "Manifest":
        """The manifest of a data set in ``folder``, which contains the place of its program."""
        try:
            source = os.path.relpath(Path(program).absolute(), folder.absolute())
        except ValueError:  # on another drive
            source = str(Path(program).absolute())
        return replace(self, source=Path(source).as_posix())

    def with_part(self, part: Part, seconds: float) -> "Manifest":
        """The manifest with one more complete part."""
        parts = sorted([*self.parts, part], key=lambda item: item.first)
        return replace(self, parts=tuple(parts), seconds=round(self.seconds + seconds, 3))

    def save(self, folder: Path) -> None:
        """Write it into the folder of its data set; raises ``OutputError``."""
        write(folder / NAME, (json.dumps(self.document(), indent=1) + "\n").encode())

    def document(self) -> dict[str, Any]:
        """The manifest as plain data."""
        return {"format": FORMAT, "version": VERSION, **asdict(self)}

    @classmethod
    def load(cls, folder: Path) -> Self:
        """The manifest of a data set; raises `DatasetError` where there is none, or it is damaged."""
        path = folder / NAME
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if content.pop("format") != FORMAT:
                raise ValueError("it is not the manifest of a data set")
            if content.pop("version") > VERSION:
                raise ValueError("a later version of scenic wrote it")
            if content.get("images") and "camera" in content["images"]:  # of version 1
                content["images"] = {"cameras": [content["images"].pop("camera")], **content["images"]}
            parts = [Part(**{**part, "missing": tuple(part["missing"])}) for part in content.pop("parts")]
            return cls(**content, parts=tuple(parts))
        except FileNotFoundError:
            raise NoDatasetError(
                f"there is no data set in '{folder}': it has no {NAME}",
                help="give the folder that `scenic sample -o FOLDER/` has made",
            ) from None
        except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
            raise DatasetError(f"'{path}' cannot be read: {error}") from error


_SETTINGS: Final = (
    "program", "digest", "fingerprint", "seed", "first", "form", "part_size", "points", "max_attempts", "properties",
    "images", "meshes", "textures", "versions",
)  # fmt: skip
