"""Scenes as the bytes of a part: encoded where they are made, taken apart where the part is written."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from scenic.batch.image_parts import ImageRows
from scenic.batch.manifest import Manifest
from scenic.batch.scene_file_parts import FORMS, SceneFileRows
from scenic.batch.scenes import LONGEST
from scenic.dataclass import dataclass
from scenic.formats.json_lines import SceneLines
from scenic.runtime.scenes.scenario import Scenario
from scenic.runtime.scenes.scene import Scene

__all__ = ["Encoder", "RowBlock", "blocks_of"]

_IMAGES: Final = 16
"""Scenes whose images are kept in memory together, and lost together where a run ends."""


class Encoder:
    """Encodes blocks of scenes for a part: numbers and attempts, then the rows.

    Args:
        form: ``parquet`` or ``jsonl``, or of `IMAGE_FORMS` or `FORMS`.
        changed: whether JSON Lines tell only the properties that the program gives.
        points: see `Manifest`.
        images: see `Manifest`.

    """

    def __init__(
        self,
        form: str,
        *,
        changed: bool = True,
        points: str | None = None,
        images: Mapping[str, Any] | None = None,
    ) -> None:
        self._form = form
        self._images = images
        self._changed = changed
        self._points = points
        self._writer: Any = None

    @classmethod
    def of(cls, manifest: Manifest) -> Self:
        """The encoder of a data set."""
        return cls(
            manifest.form,
            changed=manifest.properties == "changed",
            points=manifest.points,
            images=manifest.images,
        )

    @property
    def most(self) -> int:
        """Number of scenes that are encoded together, at most."""
        return LONGEST if self._images is None and self._form not in FORMS else _IMAGES

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_writer": None}  # belongs to one process

    def __call__(self, scenario: Scenario, scenes: Sequence[Scene]) -> bytes:
        """Return the block of some scenes."""
        rows = self.rows(scenario, scenes)
        head = [len(scenes), len(rows), *(scene.k for scene in scenes), *(scene.attempts for scene in scenes)]
        return np.array(head, dtype=np.int64).tobytes() + rows

    def rows(self, scenario: Scenario, scenes: Sequence[Scene]) -> bytes:
        """Return the rows of some scenes: text, the stream of an Arrow record batch, or those of `ImageRows`."""
        if self._images is not None:
            if self._writer is None:
                self._writer = ImageRows(scenario, self._form, self._images)
            return bytes(self._writer.rows(scenes))
        if self._form in FORMS:
            if self._writer is None:
                self._writer = SceneFileRows(scenario, self._form)
            return bytes(self._writer.rows(scenes))
        if self._form == "jsonl":
            if self._writer is None:
                program = Path(scenario.filename)
                self._writer = SceneLines(
                    (program.name, scenario.digest),
                    changed=self._changed,
                    points=self._points,
                    folder=program.parent,
                )
            return bytes(self._writer.block(scenario, scenes))
        from scenic.formats.scene_tables import SceneTable

        if self._writer is None:
            self._writer = SceneTable(scenario)
        return bytes(self._writer.encoded(scenes))


@dataclass(frozen=True, slots=True)
class RowBlock:
    """An encoded block taken apart: scene numbers ``(n,)``, attempts ``(n,)``, and rows."""

    numbers: NDArray[np.int64]
    attempts: NDArray[np.int64]
    rows: memoryview


def blocks_of(encoded: Any) -> Iterator[RowBlock]:
    """Yield the blocks in the bytes of an `Encoder`."""
    view, place = memoryview(encoded).cast("B"), 0
    while place < len(view):
        count, size = (int(word) for word in np.frombuffer(view[place : place + 16], dtype=np.int64))
        heads = np.frombuffer(view[place + 16 : place + 16 + 16 * count], dtype=np.int64)
        place += 16 + 16 * count
        yield RowBlock(heads[:count], heads[count:], view[place : place + size])
        place += size
