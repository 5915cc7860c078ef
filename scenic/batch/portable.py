"""Functions that other processes call, perhaps on other machines, and that refuse where their results would be others.

A function takes its programs along as text. Whoever calls it first in a process compiles them, and compares versions, graph,
narrowed domain and mesh files with those of the process that the function comes from.
"""

import hashlib
import io
import pickle
import platform
import sys
import threading
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, Final

from scenic.batch.folders.file_digests import file_digests
from scenic.language.errors import Located
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["ClusterError", "Portable", "versions"]

_LIBRARIES: Final = ("numpy", "scipy", "trimesh", "manifold3d", "embreex", "shapely")
"""Libraries whose version may change a scene."""


_LOADING: Final = threading.Lock()
"""Held while a program is compiled, so that one of the threads of a worker does it for all."""


class ClusterError(Located):
    """A cluster that cannot be reached, is lost, or whose workers differ from this process."""

    code = "SC611"


class Portable:
    """A function of this process as other processes call it; returns pickled results.

    Args:
        function: the function, which can be pickled.

    Raises:
        ClusterError: when called in a process whose versions or programs differ from those of this one.

    """

    def __init__(self, function: Callable[[Any], Any]) -> None:
        stream = io.BytesIO()
        _Pickler(stream, protocol=5).dump(function)
        self._payload = pickle.dumps((versions(), stream.getvalue()), protocol=5)

    def __call__(self, argument: object) -> bytes:
        with _LOADING:  # a worker may have many threads
            function = _unpacked(self._payload)
        return pickle.dumps(function(argument), protocol=5)


class _Pickler(pickle.Pickler):
    """Pickles scenarios with digests that show whether another process has the same files."""

    def reducer_override(self, value: object) -> Any:
        if not isinstance(value, Scenario):
            return NotImplemented
        make, given = value.__reduce__()
        return _same, (make, given, value.filename, _marks(value))


@lru_cache(maxsize=2)
def _unpacked(payload: bytes) -> Callable[[Any], Any]:
    """Return the function, with its programs compiled once in each process."""
    wanted, data = pickle.loads(payload)
    check_versions(wanted)
    function: Callable[[Any], Any] = pickle.loads(data)
    return function


def _same(
    make: Callable[..., Scenario], given: tuple[Any, ...], filename: str, wanted: Mapping[str, str]
) -> Scenario:
    """Return the scenario, compiled in this process and compared with that of the sender."""
    name = Path(filename).name
    try:
        scenario = make(*given)
    except Exception as error:  # noqa: BLE001 - whatever the program raises, told where it can be shown
        raise ClusterError(
            f"a worker cannot load '{name}': {error}",
            help="modules, maps, meshes and textures must lie at the same place on all machines",
        ) from None
    own_marks = _marks(scenario)
    for mark in wanted:
        mine, theirs = own_marks.get(mark, "missing"), wanted[mark]
        # Processes need not have loaded the same modules: their own scripts may lie beside the program.
        if mine != theirs and (mark in own_marks or not mark.startswith("module")):
            raise ClusterError(
                f"a worker makes another program of '{name}': its {mark} is {mine[:12]}, in this process {theirs[:12]}",
                help="give all machines the same files (modules, meshes and textures of the program, the package itself), and start "
                "workers again that have loaded earlier ones",
            )
    return scenario


def _marks(scenario: Scenario) -> dict[str, str]:
    """Return digests of the scenario's files, of the modules beside it that are loaded, and of its graph."""
    files = {f"file '{name}'": digest for name, digest in file_digests(scenario, modules=False).items()}
    folder = Path(scenario.filename).absolute().parent
    modules = {f"module '{module.__name__}'": _module_digest(module) for module in _modules_in(folder)}
    return {**files, **modules, "graph": scenario.fingerprint}


def _modules_in(folder: Path) -> list[ModuleType]:
    """Return the modules of a folder that this process has loaded, those of packages in it included."""

    def is_there(name: str) -> bool:
        origin = getattr(getattr(sys.modules.get(name), "__spec__", None), "origin", None)
        path = Path(str(origin))
        return (path.parent.parent if path.name == "__init__.py" else path.parent) == folder

    tops = {name for name in list(sys.modules) if "." not in name and is_there(name)} - {"scenic"}
    return [module for name, module in sorted(sys.modules.items()) if name.partition(".")[0] in tops]


def _module_digest(module: ModuleType) -> str:
    """Digest of a module as it was loaded, which its file may no longer say: functions, classes, constants in capitals.

    Other variables may have changed since.
    """
    digest = hashlib.sha256()

    def add(value: object) -> None:
        if isinstance(value, CodeType):
            digest.update(f"{value.co_code!r}{value.co_names}{value.co_varnames}".encode())
            for item in value.co_consts:
                add(item)
        elif isinstance(value, FunctionType):
            add(value.__code__)
            add(value.__defaults__)
        elif isinstance(value, type) and value.__module__ == module.__name__:
            for name, item in sorted(vars(value).items()):
                digest.update(name.encode())
                add(item)
        elif isinstance(value, (staticmethod, classmethod)):
            add(value.__func__)
        elif isinstance(value, (tuple, list)):
            for item in value:
                add(item)
        elif isinstance(value, (int, float, str, bytes, type(None))):
            digest.update(repr(value).encode())

    for name, item in sorted(vars(module).items()):
        if not name.startswith("__") and (name.isupper() or isinstance(item, (FunctionType, type))):
            digest.update(name.encode())
            add(item)
    return digest.hexdigest()


def versions() -> dict[str, str]:
    """Return the versions of Python, of this package and of the libraries that may change a scene."""
    found = {"python": platform.python_version(), "scenic": _version("scenic-lang")}
    return found | {name: _version(name) for name in _LIBRARIES}


def _version(name: str) -> str:
    from importlib import metadata  # slow to import

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "none"


def check_versions(wanted: Mapping[str, str]) -> None:
    """Raise `ClusterError` where this process has other versions than ``wanted``."""
    mine = versions()
    for name, version in wanted.items():
        if mine.get(name) != version:
            raise ClusterError(
                f"a worker has {name} {mine.get(name)}, this process has {name} {version}",
                help="install the same versions everywhere: other versions may give other scenes",
            )
