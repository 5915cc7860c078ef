"""Manifests: how a data set was made, and what its files must be."""

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import asdict, field, replace
from pathlib import Path
from typing import Any, Final, Self

from scenic.batch.folders.file_digests import file_digests
from scenic.batch.folders.folder import NAME, FolderKind
from scenic.batch.folders.ranges import Range, part_name, ranges_to_make
from scenic.batch.portable import versions
from scenic.dataclass import dataclass
from scenic.language.errors import Located
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["DATASET", "NAME", "DatasetError", "Manifest", "NoDatasetError", "Part"]


class DatasetError(Located):
    """A data set that cannot be read, continued, verified or merged."""

    code = "SC612"


class NoDatasetError(DatasetError):
    """The error for a folder without a data set."""

    code = "SC600"


DATASET: Final = FolderKind(
    "scenic-dataset", 3, "data set", "`scenic sample -o FOLDER/`", DatasetError, NoDatasetError
)
"""Folders of data sets."""


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
        size: number of its bytes.
        index: digest of the index beside a shard of images.
        skipped: images that are not there, since the object of the camera does not take part in the scene.

    """

    file: str
    first: int
    last: int
    rows: int
    attempts: int
    missing: tuple[int, ...]
    sha256: str
    size: int
    index: str = ""
    skipped: int = 0

    @property
    def numbers(self) -> Range:
        """The range of its scenes."""
        return self.first, self.last


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
        files: digests of the files that decide the scenes beside the program's text, by their paths from it: modules, meshes, textures,
            maps, and other files that it names by ``localPath``.
        accepted: changes of ``files`` that were accepted, each with the first ``scene`` that was not complete then, and the ``changes`` in words.
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
    files: Mapping[str, str] = field(default_factory=dict)
    accepted: tuple[Mapping[str, Any], ...] = ()
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
            files=file_digests(scenario),
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

    @property
    def numbers(self) -> Range:
        """The range of the scenes that were wanted."""
        return self.first, self.first + self.count

    def ranges(self) -> list[Range]:
        """Return the ranges of scenes that no part holds for good, as the parts to be made."""
        lasting = [part.numbers for part in self.parts if not self.is_cut_short(part)]
        return ranges_to_make(self.numbers, self.part_size, lasting)

    def is_cut_short(self, part: Part) -> bool:
        """Return whether a part ended where the data set did before more scenes were wanted: then it is made again, longer."""
        start = part.first - (part.first - self.first) % self.part_size
        end = min(start + self.part_size, self.numbers[1])
        others = (item for item in self.parts if item is not part)
        return (
            start == part.first and part.last < end and not any(start <= item.first < end for item in others)
        )

    def file_of(self, numbers: Range) -> str:
        """The name of the part of a range of scenes; that of images and files in the folder is the index of its scenes."""
        is_index = self.form not in ("parquet", "jsonl", "tar")
        return f"{part_name(numbers)}.{'json' if is_index else self.form}"

    def difference(self, other: "Manifest") -> str | None:
        """Return the first setting in which data sets differ that cannot be continued by each other; their counts and files may differ."""
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

    def table_part(self, file: str, rows: int) -> Part:
        """Return the part that a single file of the whole is: its candidates and digest are not known."""
        return Part(file, *self.numbers, rows, 0, (), "", 0)

    def with_part(self, part: Part, seconds: float) -> "Manifest":
        """The manifest with one more complete part, in place of a shorter one."""
        others = (item for item in self.parts if item.last <= part.first or item.first >= part.last)
        parts = sorted([*others, part], key=lambda item: item.first)
        return replace(self, parts=tuple(parts), seconds=round(self.seconds + seconds, 3))

    def document(self) -> dict[str, Any]:
        """Return the manifest as plain data, with its format."""
        return {"format": DATASET.format, "version": DATASET.version, **asdict(self)}

    @classmethod
    def load(cls, folder: Path) -> Self:
        """The manifest of a data set; raises `DatasetError` where there is none, or it is damaged."""
        return cls.from_document(DATASET.document(folder), folder / NAME)

    @classmethod
    def from_document(cls, content: Mapping[str, Any], path: Path) -> Self:
        """The manifest in plain data, read from a file; raises `DatasetError` where it is damaged."""
        values = {name: content[name] for name in _FIELDS if name in content}
        _check(values, _FIELDS, path, "")
        parts = []
        for place, part in enumerate(values["parts"]):
            _check(part, _PART_FIELDS, path, f"parts[{place}].")
            parts.append(
                Part(
                    **{
                        **{name: part[name] for name in _PART_FIELDS if name in part},
                        "missing": tuple(part["missing"]),
                    }
                )
            )
        return cls(**{**values, "parts": tuple(parts), "accepted": tuple(values.get("accepted", ()))})


def _check(content: object, fields: "Mapping[str, _FieldRule]", path: Path, where: str) -> None:
    """Raise `DatasetError` for a field that is missing or of the wrong kind."""
    if not isinstance(content, dict):
        raise DatasetError(
            f"the manifest '{path}' is damaged: `{where.rstrip('.')}` is not an object", help=_MEND
        )
    for name, (is_right, words, is_needed) in fields.items():
        if name not in content:
            if is_needed:
                raise DatasetError(f"the manifest '{path}' is damaged: it has no `{where}{name}`", help=_MEND)
        elif not is_right(content[name]):
            text = json.dumps(content[name])
            text = text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
            raise DatasetError(
                f"the manifest '{path}' is damaged: `{where}{name}` is {text}, not {words}", help=_MEND
            )


_MEND: Final = "put the file back as it was written, or make the data set again in another folder"
_SHOWN: Final = 60
"""Characters of a wrong value that a message shows."""

_FieldRule = tuple[Callable[[Any], bool], str, bool]
"""A test of a value, words for the values that pass it, and whether there has to be one."""


def _is_count(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _is_name(value: object) -> bool:
    return isinstance(value, str) and value not in ("", ".", "..") and not set(value) & {"/", "\\"}


_TEXT: Final = (lambda value: isinstance(value, str), "text")
_COUNT: Final = (_is_count, "a number of things")
_OBJECT: Final = (lambda value: isinstance(value, dict), "an object")
_INTEGER: Final = (lambda value: isinstance(value, int) and not isinstance(value, bool), "an integer")
_LIST: Final = (lambda value: isinstance(value, list), "a list")
_NATURAL: Final = (lambda value: _is_count(value) and value > 0, "a positive integer")

_PART_FIELDS: Final[Mapping[str, _FieldRule]] = {
    "file": (_is_name, "the name of a file", True),
    "first": (*_COUNT, True),
    "last": (*_NATURAL, True),
    "rows": (*_COUNT, True),
    "attempts": (*_COUNT, True),
    "missing": (
        lambda value: isinstance(value, list) and all(map(_is_count, value)),
        "a list of numbers",
        True,
    ),
    "sha256": (*_TEXT, True),
    "size": (*_COUNT, True),
    "index": (*_TEXT, False),
    "skipped": (*_COUNT, False),
}

_FIELDS: Final[Mapping[str, _FieldRule]] = {
    "program": (*_TEXT, True),
    "digest": (*_TEXT, True),
    "fingerprint": (*_TEXT, True),
    "seed": (*_INTEGER, True),
    "first": (*_COUNT, True),
    "count": (*_COUNT, True),
    "form": (*_TEXT, True),
    "part_size": (*_NATURAL, True),
    "points": (lambda value: value is None or isinstance(value, str), "text or null", True),
    "max_attempts": (
        lambda value: value is None or (_is_count(value) and value > 0),
        "a positive integer or null",
        True,
    ),
    "properties": (*_TEXT, True),
    "images": (
        lambda value: value is None or (isinstance(value, dict) and "cameras" in value),
        "an object with `cameras`, or null",
        True,
    ),
    "files": (*_OBJECT, True),
    "accepted": (*_LIST, False),
    "versions": (*_OBJECT, True),
    "options": (*_OBJECT, True),
    "source": (*_TEXT, True),
    "command": (*_TEXT, True),
    "seconds": (
        lambda value: isinstance(value, (int, float)) and not isinstance(value, bool),
        "a number",
        True,
    ),
    "approximation": (*_TEXT, True),
    "parts": (*_LIST, True),
}


_SETTINGS: Final = (
    "program", "digest", "fingerprint", "seed", "first", "form", "part_size", "points", "max_attempts", "properties",
    "images", "versions",
)  # fmt: skip
