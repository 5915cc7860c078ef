"""Files and modules that decide a program's scenes, noted while the program runs for the first time."""

from pathlib import Path

from scenic.runtime.ground.context import current

__all__ = ["note_file", "note_import"]


def note_file(path: str | Path) -> None:
    """Note that the running program depends on the content of a file, if there is one."""
    context = current.get()
    if context is not None and context.is_symbolic and Path(path).is_file():
        context.record.files.setdefault(Path(path).absolute())


def note_import(name: str) -> None:
    """Note that the running program imports a module of Python."""
    context = current.get()
    if context is not None and context.is_symbolic:
        context.record.imports.setdefault(name)
