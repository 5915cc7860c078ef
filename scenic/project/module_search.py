"""Search for the modules of a program: the rules of ``import`` and ``model``, applied to file names only.

A Scenic module anywhere on the search path wins over a Python module, as when a program runs. Folders are listed once
and remembered until `ModuleFinder.forget`.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from scenic import language
from scenic.compiler.loader import SUFFIXES
from scenic.compiler.semantics.modules import FoundModule, ModuleKind
from scenic.language.spelling import nearest

__all__ = ["ModuleFinder"]

_INITIAL: Final = (*SUFFIXES, ".py")
"""The endings of ``__init__`` in packages."""

_LIBRARY: Final = str(Path(language.__path__[0]).parent.parent)
"""The folder that holds the package ``scenic`` itself, and with it our own library."""


class ModuleFinder:
    """Finds modules. ``roots`` are the folders of the workspace, ``python_path`` those that the project's settings name.

    A program finds the modules beside it, and those in the folders above it up to the innermost root, or farther as long as
    these are packages; then those of
    ``python_path``, of Python's own path (``interpreter_path``) and of our own library.
    """

    def __init__(
        self,
        roots: Sequence[str] = (),
        python_path: Sequence[str] = (),
        interpreter_path: Sequence[str] | None = None,
    ) -> None:
        self.roots = tuple(dict.fromkeys(os.path.abspath(root) for root in roots))
        self._given = tuple(os.path.abspath(folder) for folder in python_path)
        installed_paths = sys.path if interpreter_path is None else interpreter_path
        self._hooks = interpreter_path is None
        # An empty entry is the current folder, which a hostile one could fill: programs say what is beside them.
        self._installed = tuple(dict.fromkeys([*(each for each in installed_paths if each), _LIBRARY]))
        self._entries: dict[str, frozenset[str]] = {}
        self._stamps: dict[str, int] = {}
        """By folder that was listed: when something in it was last made, renamed or removed."""
        self._found: dict[tuple[str, str, int], FoundModule] = {}
        self._folders: dict[str, tuple[str, ...]] = {}
        self._folder_of: dict[str, str] = {}

    def forget(self) -> None:
        """Look at the folders again from now on."""
        self._entries = {}
        self._stamps = {}
        self._found = {}

    def is_stale(self, importer: str) -> bool:
        """Return whether there may be other files beside one than were found when its folder was listed."""
        folders = self._beside(os.path.dirname(os.path.abspath(importer)))
        return any(folder in self._stamps and self._stamps[folder] != _stamp(folder) for folder in folders)

    def find(self, name: str, *, importer: str, level: int = 0) -> FoundModule:
        """Return the module that ``name`` means in the file ``importer``; ``level`` counts the dots before it."""
        folder = self._folder_of.get(importer)
        if folder is None:
            folder = self._folder_of[importer] = os.path.dirname(os.path.abspath(importer))
        key = (folder, name, level)
        found = self._found.get(key)
        if found is None:
            found = self._found[key] = self._find(name, folder, level)
        return found

    def importable(self, folder: str, prefix: str = "") -> frozenset[str]:
        """The names that may follow ``prefix`` (a dotted name) in an import in a file of ``folder``."""
        names: set[str] = set()
        parts = prefix.split(".") if prefix else []
        for base in (*self._beside(folder), *self._given, *self._installed):
            names.update(self._modules(os.path.join(base, *parts)))
        if not parts:
            names.update(name for name in sys.stdlib_module_names if not name.startswith("_"))
        return frozenset(names)

    def _find(self, name: str, folder: str, level: int) -> FoundModule:
        parts = name.split(".") if name else []
        if not all(part.isidentifier() for part in parts):
            return FoundModule(name, ModuleKind.MISSING)
        if level:
            for _ in range(level - 1):
                folder = os.path.dirname(folder)
            own_paths: tuple[str, ...] = (folder,)
            rest: tuple[str, ...] = ()
        else:
            own_paths = (*self._beside(folder), *self._given)
            rest = self._installed
        everywhere = (*own_paths, *rest)
        for base in everywhere:
            file = self._scenic(base, parts)
            if file is not None:
                return FoundModule(name, ModuleKind.SCENIC, file)
        if not level and name in sys.builtin_module_names:
            return FoundModule(name, ModuleKind.COMPILED)
        namespace: str | None = None
        for base in everywhere:
            place_and_kind = self._python(base, parts)
            if place_and_kind is not None and place_and_kind[1] is not ModuleKind.NAMESPACE:
                return FoundModule(name, place_and_kind[1], place_and_kind[0])
            if place_and_kind is not None and namespace is None:
                namespace = place_and_kind[0]
        if namespace is not None:
            return FoundModule(name, ModuleKind.NAMESPACE, namespace)
        if not level and parts[0] in sys.stdlib_module_names and name in sys.modules:
            return FoundModule(name, ModuleKind.COMPILED)  # `os.path` is no file.
        if not level and self._hooks:
            home = _hooked(parts[0])
            place_and_kind = None if home is None else self._python(home, parts)
            if place_and_kind is not None:
                return FoundModule(name, place_and_kind[1], place_and_kind[0])
        return self._missing(name, parts, own_paths, rest, level)

    def _missing(
        self, name: str, parts: list[str], own: tuple[str, ...], rest: tuple[str, ...], level: int
    ) -> FoundModule:
        depth = 0
        homes: list[str] = list(own)
        while depth < len(parts) - 1:
            inner = [
                os.path.join(base, *parts[: depth + 1])
                for base in (*own, *rest)
                if self._is_folder(base, parts[: depth + 1])
            ]
            if not inner:
                break
            depth, homes = depth + 1, inner
        beginning = ".".join(parts[:depth])
        candidates = {each for home in homes for each in self._modules(home)}
        if not depth:
            candidates |= {each for base in rest for each in self._modules(base)}
            if not level:
                candidates |= sys.stdlib_module_names
        wrong = parts[depth] if parts else ""
        near = nearest(wrong, (each for each in candidates if not each.startswith("_")))
        if near is not None:
            near = ".".join([*parts[:depth], near, *parts[depth + 1 :]])
        within = bool(depth) and any(home.startswith(_closed(base)) for home in homes for base in own)
        return FoundModule(name, ModuleKind.MISSING, None, tuple(homes), beginning, within, near)

    def _beside(self, folder: str) -> tuple[str, ...]:
        """Return a folder, and those above it up to the innermost root that holds it.

        Where that is a package, up to the one that holds the outermost package: what imports the package will find that.
        """
        chain_of_folders = self._folders.get(folder)
        if chain_of_folders is None:
            inside = [root for root in self.roots if folder == root or folder.startswith(_closed(root))]
            chain = [folder]
            if inside:
                root = max(inside, key=len)
                while chain[-1] != root:
                    chain.append(os.path.dirname(chain[-1]))
            while self._initial(chain[-1], _INITIAL) is not None and os.path.dirname(chain[-1]) != chain[-1]:
                chain.append(os.path.dirname(chain[-1]))
            chain_of_folders = self._folders[folder] = tuple(chain)
        return chain_of_folders

    def _list(self, folder: str) -> frozenset[str]:
        entries = self._entries.get(folder)
        if entries is None:
            self._stamps[folder] = _stamp(folder)
            try:
                entries = frozenset(os.listdir(folder))
            except (OSError, ValueError):
                entries = frozenset()  # A folder that may not be read holds no modules for us.
            self._entries[folder] = entries
        return entries

    def _is_folder(self, base: str, parts: list[str]) -> bool:
        """Return whether ``parts`` lead from ``base`` to a folder, of exactly these names also where case does not matter."""
        for part in parts:
            if part not in self._list(base):
                return False
            base = os.path.join(base, part)
        return os.path.isdir(base)

    def _scenic(self, base: str, parts: list[str]) -> str | None:
        if not parts:
            return self._initial(base, SUFFIXES)
        if not self._enters(base, parts):
            return None
        home = os.path.join(base, *parts[:-1])
        entries = self._list(home)
        for suffix in SUFFIXES:
            if parts[-1] + suffix in entries:
                return os.path.join(home, parts[-1] + suffix)
        return self._initial(os.path.join(home, parts[-1]), SUFFIXES) if parts[-1] in entries else None

    def _enters(self, base: str, parts: list[str]) -> bool:
        """Return whether the folders exist that a dotted name goes through."""
        for part in parts[:-1]:
            if part not in self._list(base):
                return False
            base = os.path.join(base, part)
        return True

    def _initial(self, folder: str, suffixes: Sequence[str]) -> str | None:
        entries = self._list(folder)
        name = next((f"__init__{suffix}" for suffix in suffixes if f"__init__{suffix}" in entries), None)
        return None if name is None else os.path.join(folder, name)

    def _python(self, base: str, parts: list[str]) -> tuple[str, ModuleKind] | None:
        if not parts:
            initial = self._initial(base, (".py",))
            return (base, ModuleKind.NAMESPACE) if initial is None else (initial, ModuleKind.PYTHON)
        if not self._enters(base, parts):
            return None
        home = os.path.join(base, *parts[:-1])
        entries = self._list(home)
        last = parts[-1]
        if last in entries:
            initial = self._initial(os.path.join(home, last), (".py",))
            if initial is not None:
                return initial, ModuleKind.PYTHON
        for suffix in EXTENSION_SUFFIXES:
            if last + suffix in entries:
                return os.path.join(home, last + suffix), ModuleKind.COMPILED
        if last + ".py" in entries:
            return os.path.join(home, last + ".py"), ModuleKind.PYTHON
        if last in entries and os.path.isdir(os.path.join(home, last)):
            return os.path.join(home, last), ModuleKind.NAMESPACE
        return None

    def _modules(self, folder: str) -> Iterator[str]:
        """The names of the modules directly in a folder."""
        endings = (*SUFFIXES, ".py", *EXTENSION_SUFFIXES)
        for entry in self._list(folder):
            ending = next((each for each in endings if entry.endswith(each)), None)
            if ending is not None:
                name = entry.removesuffix(ending)
            elif "." not in entry and entry != "__pycache__" and os.path.isdir(os.path.join(folder, entry)):
                name = entry
            else:
                continue
            if name.isidentifier() and name != "__init__":
                yield name


def _hooked(package: str) -> str | None:
    """Return the folder of a package that is installed so that Python finds it by a hook and not on its path.

    Looking for a module that lies in no package runs nothing of it.
    """
    try:
        spec = find_spec(package)
    except (ImportError, ValueError, AttributeError):
        return None
    if spec is None or spec.origin is None or not os.path.isabs(spec.origin):
        return None
    home = os.path.dirname(spec.origin)
    return os.path.dirname(home) if spec.submodule_search_locations is not None else home


def _stamp(folder: str) -> int:
    try:
        return os.stat(folder).st_mtime_ns
    except (OSError, ValueError):
        return 0


def _closed(folder: str) -> str:
    return folder if folder.endswith(os.sep) else folder + os.sep
