"""The conversion of a document of Scenic 2, which an editor offers."""

from collections.abc import Sequence

from scenic.ide.repairs import difference
from scenic.ide.snapshot import Snapshot
from scenic.language.diagnostics import Diagnostic, Edit
from scenic.migration.converting import Converter
from scenic.project.index import Project

__all__ = ["is_old", "migrated"]


def is_old(found: Sequence[Diagnostic]) -> bool:
    """Return whether the diagnostics of a document say that it is Scenic 2."""
    return any(item.code == "SC136" for item in found)


def migrated(snapshot: Snapshot, project: Project) -> Edit | None:
    """Return the conversion of a document as one edit; ``None`` if nothing changes."""
    converted = Converter(project.finder.roots).convert(snapshot.text, snapshot.filename)
    return difference(snapshot.text, converted.text)
