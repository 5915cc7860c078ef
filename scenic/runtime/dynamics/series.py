"""Files that hold a series of recorded values: they grow with it, and get their names when they are whole.

What grows has no name, so that nothing of it remains however the process ends; only films do, which another program writes.
"""

import json
import pickle
from array import array
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from scenic.language.errors import ScenicValueError, UnsupportedError
from scenic.language.extras import installation
from scenic.runtime.dynamics.recorded import as_array, as_pixels, plain
from scenic.runtime.ground.context import here
from scenic.runtime.ground.files import named, naming, unnamed, whole

__all__ = ["Arrays", "Film", "Lines", "Pickled", "Series"]


class Series(Protocol):
    """A file for a series, made for a path and the seconds in a step."""

    def add(self, step: int, value: object) -> None:
        """Go on by a value."""

    def save(self) -> None:
        """Complete the file."""

    def drop(self) -> None:
        """Let nothing remain."""


class Lines:
    """JSON Lines: step, time and value."""

    def __init__(self, path: Path, timestep: float) -> None:
        self._path = path
        self._timestep = timestep
        self._stream = unnamed(path)

    def add(self, step: int, value: object) -> None:
        """Go on by a line."""
        row = {"step": step, "time": step * self._timestep, "value": plain(value)}
        with naming(self._path):
            self._stream.write(json.dumps(row).encode() + b"\n")

    def save(self) -> None:
        """Complete the file."""
        from shutil import copyfileobj  # slow to import

        with whole(self._path) as stream, self._stream:
            self._stream.seek(0)
            copyfileobj(self._stream, stream)

    def drop(self) -> None:
        """Let nothing remain."""
        with suppress(OSError):
            self._stream.close()


class Arrays:
    """NumPy's archive of the arrays ``steps``, ``times`` and ``values``."""

    def __init__(self, path: Path, timestep: float) -> None:
        self._path = path
        self._timestep = timestep
        self._steps = array("q")
        self._shape: tuple[int, ...] = ()
        self._kind: np.dtype[Any] | None = None
        self._stream = unnamed(path)

    def add(self, step: int, value: object) -> None:
        """Go on by a value, of the same shape as the others."""
        array = as_array(value)
        if self._kind is None:
            self._shape, self._kind = array.shape, array.dtype
        elif array.shape != self._shape:
            raise ScenicValueError(
                f"values of one shape can be recorded as an array, not one of {array.shape} after {self._shape}",
                help="record to a .jsonl file",
            )
        common_kind = np.result_type(self._kind, array.dtype)
        with naming(self._path):
            if common_kind != self._kind:
                self._convert(common_kind)
            self._stream.write(np.ascontiguousarray(array, dtype=common_kind).tobytes())
        self._steps.append(step)

    def _convert(self, wanted: np.dtype[Any]) -> None:
        """Convert the values written so far to numbers of the kind ``wanted``, in the file as well."""
        with self._stream:
            values = self._values()
            self._stream = unnamed(self._path)
            for value in values:
                self._stream.write(np.asarray(value, dtype=wanted).tobytes())
        self._kind = wanted

    def _values(self) -> Any:
        assert self._kind is not None
        self._stream.flush()
        shape = (len(self._steps), *self._shape)
        if 0 in shape:
            return np.empty(shape, self._kind)
        return np.memmap(self._stream, self._kind, "r", shape=shape)

    def save(self) -> None:
        """Complete the file."""
        steps = np.array(self._steps)
        with whole(self._path) as stream, self._stream:
            np.savez(stream, steps=steps, times=steps * self._timestep, values=self._values())

    def drop(self) -> None:
        """Let nothing remain."""
        with suppress(OSError):
            self._stream.close()


class Pickled:
    """A list of steps and values, pickled."""

    def __init__(self, path: Path, _timestep: float) -> None:
        self._path = path
        self._series: list[tuple[int, Any]] = []

    def add(self, step: int, value: object) -> None:
        """Go on by a value."""
        self._series.append((step, plain(value)))

    def save(self) -> None:
        """Write the file."""
        with whole(self._path) as stream:
            pickle.dump(self._series, stream)

    def drop(self) -> None:
        """Forget the series."""
        self._series = []


class Film:
    """A film of images. By default it plays as fast as what it shows."""

    def __init__(self, path: Path, timestep: float, fps: float | None = None) -> None:
        self._path = path
        self._timestep = timestep
        self._fps = fps
        self._first: tuple[int, Any] | None = None
        self._writer: Any = None
        self._file: Path | None = None

    def add(self, step: int, value: object) -> None:
        """Go on by an image, of the same size as the others."""
        frame = _even(as_pixels(value))
        if self._first is None:
            # How long it is seen is known with the next one.
            self._first = step, frame
            return
        before, first = self._first
        if frame.shape != first.shape:
            raise ScenicValueError(
                f"images of one size make a film, not one of {frame.shape[:2]} after {first.shape[:2]}"
            )
        if self._writer is None:
            self._open(step - before)
        self._writer.send(frame)

    def _open(self, steps: int) -> None:
        try:
            import imageio_ffmpeg  # optional
        except ImportError as error:
            raise UnsupportedError(
                "films cannot be recorded without the package imageio-ffmpeg",
                span=here(),
                help=f"install it: {installation('video')}",
            ) from error
        assert self._first is not None
        _, first = self._first
        height, width = first.shape[:2]
        self._file = named(self._path, self._path.suffix)
        fps = self._fps or 1 / (self._timestep * steps)
        self._writer = imageio_ffmpeg.write_frames(
            str(self._file), (width, height), fps=fps, macro_block_size=1
        )
        self._writer.send(None)
        self._writer.send(first)

    def save(self) -> None:
        """Complete the file."""
        if self._writer is None:
            self._open(1)
        self._writer.close()
        assert self._file is not None
        self._file.replace(self._path)

    def drop(self) -> None:
        """Let nothing remain."""
        if self._writer is not None:
            self._writer.close()
        if self._file is not None:
            self._file.unlink(missing_ok=True)


def _even(frame: Any) -> Any:
    """An image in colours of an even number of columns and of rows: the usual coding of colours has pairs of them."""
    if frame.ndim == 2:
        frame = np.stack([frame] * 3, axis=-1)
    even = [(0, frame.shape[axis] % 2) for axis in (0, 1)]
    return np.ascontiguousarray(np.pad(frame[:, :, :3], (*even, (0, 0)), mode="edge"))
