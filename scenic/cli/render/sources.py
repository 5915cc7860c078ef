"""The source texts that diagnostics refer to, read when they are first shown."""

from collections.abc import Iterable

from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source

__all__ = ["Sources"]


class Sources:
    """Source texts by filename; those given are shown as they were checked, others are read from disk."""

    def __init__(self, known: Iterable[Source] = ()) -> None:
        self._texts: dict[str, Source | None] = {source.filename: source for source in known}

    def add(self, source: Source) -> None:
        """Show this text for its filename."""
        self._texts[source.filename] = source

    def get(self, filename: str | None) -> Source | None:
        """Return the text of a file, or ``None`` if it cannot be shown."""
        if filename is None:
            return None
        if filename not in self._texts:
            try:
                self._texts[filename] = read_source(filename)
            except ScenicError:
                self._texts[filename] = None
        return self._texts[filename]
