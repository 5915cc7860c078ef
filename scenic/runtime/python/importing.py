"""Python modules that lie beside a program: importable by it, whatever the working directory is."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.machinery import PathFinder
from pathlib import Path


@contextmanager
def beside(folder: Path) -> Iterator[None]:
    """Python finds modules in ``folder`` first; afterwards its search path is as it was."""
    entry = str(folder.absolute())
    if entry in sys.path:
        yield
        return
    sys.path.insert(0, entry)
    try:
        yield
    finally:
        sys.path.remove(entry)


def forget_stranger(name: str, folder: Path) -> None:
    """Forget a loaded module of this name that lay beside another program, where this one has its own.

    Modules on Python's usual path stay: they are the same for every program.
    """
    top = name.partition(".")[0]
    module = sys.modules.get(top)
    origin = getattr(getattr(module, "__spec__", None), "origin", None)
    if module is None or origin in (None, "built-in", "frozen"):
        return
    spec = PathFinder.find_spec(top, [str(folder.absolute())])
    if spec is None or spec.origin is None or spec.origin == origin:
        return
    home = Path(str(origin)).parent
    if Path(str(origin)).name == "__init__.py":
        home = home.parent
    if any(Path(entry or ".").absolute() == home for entry in sys.path if entry != str(folder.absolute())):
        return
    for key in [key for key in sys.modules if key == top or key.startswith(f"{top}.")]:
        del sys.modules[key]


__all__ = ["beside", "forget_stranger"]
