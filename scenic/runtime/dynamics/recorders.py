"""Files that store recorded values: the extension selects the format, and a file holds either a series or one value."""

import json
import os
from array import array
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO, Final

import numpy as np

from scenic.dataclass import dataclass
from scenic.language.errors import ScenicValueError, UnsupportedError
from scenic.language.extras import installation
from scenic.runtime.dynamics.recorded import as_array, as_pixels, plain
from scenic.runtime.dynamics.series import Arrays, Film, Lines, Pickled, Series
from scenic.runtime.ground.context import here
from scenic.runtime.ground.files import whole

__all__ = ["File", "Filed", "Files", "Recorder", "for_pattern"]


class Recorder:
    """Base of what ``record ... to`` may name; a program may derive its own.

    For each simulation ``beginRecording`` is called first, then ``recordValue`` for each value, ``endRecording`` last.
    """

    def beginRecording(
        self, config: object, simulationName: str, timestep: float, globalParams: Mapping[str, Any]
    ) -> None:
        """A simulation begins."""
        self.config = config
        self.simulationName = simulationName
        self.timestep = timestep
        self.globalParams = globalParams

    def recordValue(self, value: object, step: int) -> None:
        """A value at a step."""

    def endRecording(self, canceled: bool) -> None:
        """The simulation has ended; ``canceled`` if it was rejected or failed: then nothing should remain."""


@dataclass(frozen=True, slots=True)
class Filed:
    """A reference to a series that is in a file, or in files: the file's name, or the pattern of their names."""

    name: str


class _Pattern(Recorder):
    """Writes to files named by a pattern with the fields ``simulation``, ``step`` and ``time``.

    Args:
        pattern: for example ``"frames/{simulation}-{step}.png"``.
        options: for what writes the format.

    """

    writers: Mapping[str, Callable[..., Any]] = MappingProxyType({})

    def __init__(self, pattern: str | os.PathLike[str], /, **options: Any) -> None:
        extension = Path(pattern).suffix.lower()
        if extension not in self.writers:
            endings = ", ".join(sorted(name for name in self.writers if name))
            raise ScenicValueError(
                f"nothing can be recorded to files of extension {extension or '(none)'!r}",
                span=here(),
                help=f"use one of {endings}",
            )
        self.pattern = os.fspath(pattern)
        self.options = options
        self._write = self.writers[extension]

    def path(self, step: int) -> Path:
        """The file for a step."""
        time = step * self.timestep
        name = self.pattern.format(
            self.simulationName, step, time, simulation=self.simulationName, step=step, time=time
        )
        return Path(self.globalParams.get("recordFolder", "."), name)

    def _place(self, step: int) -> Path:
        """Return the same, when its folder has been made."""
        path = self.path(step)
        path.parent.mkdir(parents=True, exist_ok=True)
        return path


class File(_Pattern):
    """One file for the whole series, which is not kept in memory but for pickles."""

    def beginRecording(self, *args: Any) -> None:
        """A simulation begins."""
        super().beginRecording(*args)
        self._series: Series | None = None
        self._is_whole = False

    @property
    def written(self) -> Filed:
        """The file."""
        return Filed(str(self.path(0)))

    def recordValue(self, value: object, step: int) -> None:
        """A value at a step."""
        if self._series is None:
            self._series = self._write(self._place(0), self.timestep, **self.options)
        self._series.add(step, value)

    def endRecording(self, canceled: bool) -> None:
        """Complete the file."""
        if canceled:
            self.discard()
        elif self._series is not None:
            self._series.save()
            self._series, self._is_whole = None, True

    def discard(self) -> None:
        """Remove what was written for this simulation."""
        if self._series is not None:
            self._series.drop()
            self._series = None
        if self._is_whole:
            self.path(0).unlink(missing_ok=True)
            self._is_whole = False


class Files(_Pattern):
    """One file for each value."""

    def beginRecording(self, *args: Any) -> None:
        """A simulation begins."""
        super().beginRecording(*args)
        self._steps = array("q")

    @property
    def written(self) -> Filed:
        """The files."""
        return Filed(str(Path(self.globalParams.get("recordFolder", "."), self.pattern)))

    def recordValue(self, value: object, step: int) -> None:
        """Write the value."""
        with whole(self._place(step)) as stream:
            self._write(stream, value, **self.options)
        self._steps.append(step)

    def endRecording(self, canceled: bool) -> None:
        """Remove what was written if nothing should remain."""
        if canceled:
            self.discard()

    def discard(self) -> None:
        """Remove what was written for this simulation."""
        for step in self._steps:
            self.path(step).unlink(missing_ok=True)
        self._steps = array("q")


def for_pattern(pattern: str | os.PathLike[str]) -> Recorder:
    """Return the recorder that a pattern of file names means: one file a value if the name depends on the step."""
    from string import Formatter  # slow to import

    fields = [field for _, field, _, _ in Formatter().parse(os.fspath(pattern)) if field is not None]
    automatic = [str(index) if field == "" else field for index, field in enumerate(fields)]
    for field in automatic:
        if field.partition(".")[0] not in ("0", "1", "2", "simulation", "step", "time"):
            raise ScenicValueError(
                f"unknown field {field!r} in the pattern {os.fspath(pattern)!r}",
                span=here(),
                help="fields are {simulation}, {step} and {time}",
            )
    depends = any(field in ("1", "2", "step", "time") for field in automatic)
    return Files(pattern) if depends else File(pattern)


# Formats of one value


def _npy(stream: BinaryIO, value: object) -> None:
    np.save(stream, as_array(value))


def _image(stream: BinaryIO, value: object, **options: Any) -> None:
    try:
        from PIL import Image  # optional, and slow to import
    except ImportError as error:
        raise UnsupportedError(
            "images cannot be recorded without the package Pillow",
            span=here(),
            help=f"install it: {installation('view')}",
        ) from error
    Image.fromarray(as_pixels(value)).save(stream, format=_image_format(stream), **options)


def _image_format(stream: BinaryIO) -> str:
    suffix = Path(str(stream.name).removesuffix(".part")).suffix[1:].lower()
    return {"jpg": "JPEG"}.get(suffix, suffix.upper())


def _json(stream: BinaryIO, value: object) -> None:
    stream.write(json.dumps(plain(value)).encode() + b"\n")


_IMAGES: Final = (".png", ".jpg", ".jpeg", ".bmp", ".tiff", ".webp")
Files.writers = MappingProxyType({**dict.fromkeys(_IMAGES, _image), ".npy": _npy, ".json": _json})
File.writers = MappingProxyType(
    {
        "": Arrays,
        ".npz": Arrays,
        ".jsonl": Lines,
        ".pickle": Pickled,
        ".pkl": Pickled,
        **dict.fromkeys((".mp4", ".mov", ".mkv"), Film),
    }
)
