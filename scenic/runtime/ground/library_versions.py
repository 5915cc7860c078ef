"""Versions of installed libraries, told without importing them, or Python's module of metadata, which takes as long as many of them."""

from importlib.util import find_spec
from pathlib import Path

__all__ = ["library_version", "own_version"]


def library_version(library: str) -> str:
    """Return a text that differs between versions of a library: names of its metadata, and size and time of the file that is imported.

    Reading metadata as `importlib.metadata` does takes 20 ms, most of them for its import.
    """
    spec = find_spec(library)
    if spec is None or spec.origin is None:
        return f"{library} absent"
    file = Path(spec.origin)
    home = file.parents[1] if file.name == "__init__.py" else file.parent
    names = sorted(folder.name for folder in home.glob(f"{library}-*.dist-info"))
    status = file.stat()
    return f"{library} {names} {status.st_size} {status.st_mtime_ns}"


def own_version() -> str | None:
    """Return the version of this library; ``None`` where it is not installed."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("scenic-lang")
    except PackageNotFoundError:
        return None
