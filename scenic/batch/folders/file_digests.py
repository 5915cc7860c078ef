"""Digests of the files that decide the scenes of a program, beside its text.

These are modules that it imports, of Scenic and of Python, and what those import in turn, as far as they are the user's own; and
files that it names by ``localPath``, or as meshes, maps or textures. Installed packages are not among them, nor are files that are
opened in other ways.
"""

import ast
import hashlib
import os
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Final

import scenic.runtime
from scenic.batch.source_files import mesh_files, texture_files
from scenic.formats.mesh_files import digest_of
from scenic.runtime.scenes.scenario import Scenario

__all__ = ["MISSING", "digest_of_files", "file_digests", "files_of_origin", "module_files"]

MISSING: Final = "missing"
"""Stands in place of the digest of a file that cannot be read."""

_INSTALLED: Final = ("site-packages", "dist-packages")
_SUFFIXES: Final = (".py", *EXTENSION_SUFFIXES)
_PACKAGE: Final = Path(scenic.runtime.__file__).parents[1]


def file_digests(scenario: Scenario, *, modules: bool = True) -> dict[str, str]:
    """Return SHA-256 of the files that decide a scenario's scenes, by their paths relative to the program.

    Args:
        scenario: the scenario.
        modules: whether modules of Python are among them.

    """
    folder = Path(scenario.filename).absolute().parent
    record = scenario.program.context.record
    files = {*record.files, *mesh_files(scenario), *texture_files(scenario)}
    if modules:
        files.update(module_files(record.imports, folder))
    own_files = {path for path in files if not path.is_dir() and not _is_installed(path, folder)}
    return dict(sorted((_name(path, folder), _digest(path)) for path in own_files))


def files_of_origin(scenario: Scenario) -> dict[str, dict[str, str]]:
    """Return the entry ``files`` of a description of how to load a program; none where no file decides its scenes."""
    files = file_digests(scenario)
    return {"files": files} if files else {}


def digest_of_files(files: dict[str, str]) -> str:
    """One digest of all files, short; empty where there are none."""
    if not files:
        return ""
    return hashlib.sha256(
        "".join(f"{name}\0{digest}\n" for name, digest in sorted(files.items())).encode()
    ).hexdigest()[:16]


def _digest(path: Path) -> str:
    try:
        return digest_of(path)
    except OSError:
        return MISSING


def _name(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # on another drive
        return path.as_posix()


def _is_installed(path: Path, folder: Path) -> bool:
    """Return whether a file belongs to an installed package, Python's library or this package: their versions stand for them."""
    if path.is_relative_to(_PACKAGE):
        return True
    inner = path.relative_to(folder) if path.is_relative_to(folder) else path
    library = sysconfig.get_paths()["stdlib"]
    return any(part in _INSTALLED for part in inner.parts) or (inner is path and path.is_relative_to(library))


def module_files(names: Iterable[str], folder: Path) -> Iterator[Path]:
    """Yield the files of modules of Python and of all modules that they import, as far as they lie in a folder of the user's.

    Args:
        names: full names of modules, or of what is imported from them.
        folder: the program's folder, in which modules are looked for first.

    """
    places = [folder, *(Path(entry or ".").absolute() for entry in sys.path)]
    left, names_done = list(names), set()
    while left:
        name = left.pop()
        if (
            name in names_done
            or name.partition(".")[0] in sys.builtin_module_names
            or name.partition(".")[0] == "scenic"
        ):
            continue
        names_done.add(name)
        if "." in name:
            left.append(name.rpartition(".")[0])
        path = next((file for place in places if (file := _module_in(place, name)) is not None), None)
        if path is None or _is_installed(path, folder):
            continue
        yield path
        if path.suffix == ".py":
            package = name if path.name == "__init__.py" else name.rpartition(".")[0]
            left += _imports_of(path, package)


def _module_in(place: Path, name: str) -> Path | None:
    base = place.joinpath(*name.split("."))
    for file in (
        *(base / f"__init__{suffix}" for suffix in _SUFFIXES),
        *(base.with_name(base.name + suffix) for suffix in _SUFFIXES),
    ):
        if file.is_file():
            return file
    return None


def _imports_of(path: Path, package: str) -> Iterator[str]:
    """Full names of what a module imports, wherever in it."""
    try:
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (item.name for item in node.names)
        elif isinstance(node, ast.ImportFrom):
            home = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*filter(None, home), *([node.module] if node.module else [])])
            yield from filter(None, (base, *(f"{base}.{item.name}".strip(".") for item in node.names)))
