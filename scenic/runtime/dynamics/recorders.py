"""Where recorded values go: files by their extension, one for a series or one for each value.

A file is written when it is whole, under a name of its own first, so that there are no half ones.
"""

import json
import os
import pickle
import string
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO, Final

import numpy as np

from scenic.language.errors import ScenicValueError, UnsupportedError
from scenic.runtime.context import here

__all__ = ["File", "Files", "Recorder", "for_pattern"]


class Recorder:
    """Base of what ``record ... to`` may name; a program may derive its own.

    For each simulation ``beginRecording`` is called first, then ``recordValue`` for each value, ``endRecording`` last.
    """

    def beginRecording(
        self, config: Any, simulationName: str, timestep: float, globalParams: Mapping[str, Any]
    ) -> None:
        """A simulation begins."""
        self.config = config
        self.simulationName = simulationName
        self.timestep = timestep
        self.globalParams = globalParams

    def recordValue(self, value: Any, step: int) -> None:
        """A value at a step."""

    def endRecording(self, canceled: bool) -> None:
        """The simulation has ended; ``canceled`` if it was rejected or failed: then nothing should remain."""


class _Pattern(Recorder):
    """Writes to files named by a pattern with the fields ``simulation``, ``step`` and ``time``.

    Args:
        pattern: for example ``"frames/{simulation}-{step}.png"``.
        options: for what writes the format.

    """

    writers: Mapping[str, Callable[..., None]] = MappingProxyType({})

    def __init__(self, pattern: str, /, **options: Any) -> None:
        extension = Path(pattern).suffix.lower()
        if extension not in self.writers:
            known = ", ".join(sorted(name for name in self.writers if name))
            raise ScenicValueError(
                f"nothing can be recorded to files of extension {extension or '(none)'!r}",
                span=here(),
                help=f"use one of {known}",
            )
        self.pattern = pattern
        self.options = options
        self._write = self.writers[extension]

    def path(self, step: int) -> Path:
        """The file for a step."""
        time = step * self.timestep
        name = self.pattern.format(
            self.simulationName, step, time, simulation=self.simulationName, step=step, time=time
        )
        return Path(self.globalParams.get("recordFolder", "."), name)

    def beginRecording(self, *args: Any) -> None:
        """A simulation begins."""
        super().beginRecording(*args)
        self._series: list[tuple[int, Any]] = []
        self._written: list[Path] = []

    def discard(self) -> None:
        """Remove what was written for this simulation."""
        for path in self._written:
            path.unlink(missing_ok=True)
        self._series, self._written = [], []


class File(_Pattern):
    """One file for the whole series."""

    def recordValue(self, value: Any, step: int) -> None:
        """A value at a step."""
        self._series.append((step, value))

    def endRecording(self, canceled: bool) -> None:
        """Write the file."""
        if canceled:
            self.discard()
        elif self._series:
            path = self.path(0)
            with _whole(path) as stream:
                self._write(stream, self._series, self.timestep, **self.options)
            self._written.append(path)


class Files(_Pattern):
    """One file for each value."""

    def recordValue(self, value: Any, step: int) -> None:
        """Write the value."""
        path = self.path(step)
        with _whole(path) as stream:
            self._write(stream, value, **self.options)
        self._written.append(path)

    def endRecording(self, canceled: bool) -> None:
        """Remove what was written if nothing should remain."""
        if canceled:
            self.discard()


def for_pattern(pattern: str) -> Recorder:
    """The recorder that a pattern of file names means: one file a value if the name depends on the step."""
    fields = [field for _, field, _, _ in string.Formatter().parse(pattern) if field is not None]
    automatic = [str(index) if field == "" else field for index, field in enumerate(fields)]
    for field in automatic:
        if field.partition(".")[0] not in ("0", "1", "2", "simulation", "step", "time"):
            raise ScenicValueError(
                f"unknown field {field!r} in the pattern {pattern!r}",
                span=here(),
                help="fields are {simulation}, {step} and {time}",
            )
    depends = any(field in ("1", "2", "step", "time") for field in automatic)
    return Files(pattern) if depends else File(pattern)


@contextmanager
def _whole(path: Path) -> Iterator[BinaryIO]:
    """A file that is there when it is whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    temporary = Path(name)
    try:
        os.close(handle)
        with temporary.open("w+b") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    except BaseException as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename is None:
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


# Formats of one value


def _npy(stream: BinaryIO, value: Any) -> None:
    np.save(stream, _array(value))


def _image(stream: BinaryIO, value: Any, **options: Any) -> None:
    try:
        from PIL import Image  # optional, and slow to import
    except ImportError as error:
        raise UnsupportedError(
            "images cannot be recorded without the package Pillow",
            span=here(),
            help="install scenic-lang[view]",
        ) from error
    Image.fromarray(_pixels(value)).save(stream, format=_image_format(stream), **options)


def _image_format(stream: BinaryIO) -> str:
    return {"jpg": "JPEG"}.get(suffix := Path(str(stream.name)).suffix[1:].lower(), suffix.upper())


def _json(stream: BinaryIO, value: Any) -> None:
    stream.write(json.dumps(plain(value)).encode() + b"\n")


# Formats of a series


def _npz(stream: BinaryIO, series: Sequence[tuple[int, Any]], timestep: float) -> None:
    steps = np.array([step for step, _ in series])
    np.savez(stream, steps=steps, times=steps * timestep, values=_array([value for _, value in series]))


def _lines(stream: BinaryIO, series: Sequence[tuple[int, Any]], timestep: float) -> None:
    for step, value in series:
        row = {"step": step, "time": step * timestep, "value": plain(value)}
        stream.write(json.dumps(row).encode() + b"\n")


def _pickle(stream: BinaryIO, series: Sequence[tuple[int, Any]], _timestep: float) -> None:
    pickle.dump([(step, plain(value)) for step, value in series], stream)


def _video(
    stream: BinaryIO, series: Sequence[tuple[int, Any]], timestep: float, fps: float | None = None
) -> None:
    try:
        import imageio_ffmpeg  # optional
    except ImportError as error:
        raise UnsupportedError(
            "films cannot be recorded without the package imageio-ffmpeg",
            span=here(),
            help="install scenic-lang[video]",
        ) from error
    frames = [_pixels(value) for _, value in series]
    frames = [np.stack([frame] * 3, axis=-1) if frame.ndim == 2 else frame for frame in frames]
    # The usual coding of colours has pairs of columns and of rows.
    even = [(0, frames[0].shape[axis] % 2) for axis in (0, 1)]
    frames = [np.pad(frame[:, :, :3], (*even, (0, 0)), mode="edge") for frame in frames]
    height, width = frames[0].shape[:2]
    steps = series[1][0] - series[0][0] if len(series) > 1 else 1
    writer = imageio_ffmpeg.write_frames(
        str(stream.name), (width, height), fps=fps or 1 / (timestep * steps), macro_block_size=1
    )
    with closing(writer):
        writer.send(None)
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))


def plain(value: Any) -> Any:
    """A recorded value as data of JSON: numbers, text, lists and dictionaries; anything else as text."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list | set | frozenset) or hasattr(value, "toVector"):
        items = value.toVector() if hasattr(value, "toVector") else value
        return [plain(item) for item in items]
    if all(hasattr(value, name) for name in "xyzw"):
        return [value.x, value.y, value.z, value.w]
    return repr(value)


def _array(value: Any) -> Any:
    array = value if isinstance(value, np.ndarray) else np.asarray(plain(value))
    if array.dtype == object:
        raise ScenicValueError("only numbers can be recorded as an array", span=here())
    return array


def _pixels(value: Any) -> Any:
    """An image as bytes: intensities or RGB, integers from 0 to 255 or floats from 0 to 1."""
    array = np.asarray(value)
    if not (array.ndim == 2 or (array.ndim == 3 and array.shape[2] in (3, 4))):
        raise ScenicValueError(
            f"an image is an array of shape (height, width) or (height, width, 3), not {array.shape}",
            span=here(),
        )
    if np.issubdtype(array.dtype, np.floating):
        array = np.round(np.clip(array, 0, 1) * 255)
    return array.astype(np.uint8)


_IMAGES: Final = (".png", ".jpg", ".jpeg", ".bmp", ".tiff", ".webp")
Files.writers = MappingProxyType({**dict.fromkeys(_IMAGES, _image), ".npy": _npy, ".json": _json})
File.writers = MappingProxyType(
    {
        "": _npz,
        ".npz": _npz,
        ".jsonl": _lines,
        ".pickle": _pickle,
        ".pkl": _pickle,
        **dict.fromkeys((".mp4", ".mov", ".mkv"), _video),
    }
)
