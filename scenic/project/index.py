"""The modules of a project, each read and parsed once, and what they give to those that import them.

Nothing is run. What a module defines is found in its text, in Scenic as in Python; only the compiled modules of
Python's own library are asked for their names, which takes importing them.
"""

import ast
import importlib
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import field
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.loader import SUFFIXES
from scenic.compiler.scopes import Binding, Resolution
from scenic.compiler.semantics.modules import Exported, Exports, FoundModule, Module, ModuleKind, Unseen
from scenic.dataclass import dataclass
from scenic.language.errors import ScenicError
from scenic.language.source import Source, read_source
from scenic.project.module_search import ModuleFinder
from scenic.project.modules import read_module

__all__ = ["Project"]

_LARGEST: Final = 4_000_000
"""Bytes of the largest file that is looked into."""

_DEEPEST: Final = 100
"""Modules of so long a chain of imports are looked into."""

_PASSED_OVER: Final = frozenset({"__pycache__", "node_modules", "site-packages"})


_NOTHING: Final = Exports(MappingProxyType({}), frozenset())


@dataclass(slots=True)
class _Entry:
    """A file as it was last looked at."""

    stamp: tuple[int, int] | None
    module: Module | None


@dataclass(slots=True)
class _Gathering:
    """The state of one walk through modules that import each other."""

    done: dict[str, Exports] = field(default_factory=dict)
    pending: set[str] = field(default_factory=set)
    incomplete: bool = False


class Project:
    """The modules of a project, found and parsed on first use.

    ``roots`` are the folders of the workspace, ``python_path`` the folders that its settings name besides. Files that an
    editor holds are given by `open`; those on disk are taken to stay as they are until `refresh`. `Module` objects are
    immutable, and a module is the same object as long as its text is the same. Reading from several threads is safe (at
    worst a module is parsed twice); `open`, `close` and `refresh` are for one thread at a time.
    """

    def __init__(
        self,
        roots: Sequence[str] = (),
        python_path: Sequence[str] = (),
        *,
        interpreter_path: Sequence[str] | None = None,
    ) -> None:
        self.finder = ModuleFinder(roots, python_path, interpreter_path)
        self._entries: dict[str, _Entry] = {}
        self._opened: dict[str, Module] = {}
        self._exports: dict[str, Exports] = {}
        self._compiled: dict[str, Exports] = {}
        self.derived: dict[object, Any] = {}
        """Results that others compute from the modules; emptied when any of them changes."""
        self._files = object()
        self._absolute: dict[str, str] = {}

    # Texts

    def open(
        self,
        filename: str,
        text: str,
        *,
        tree: ast.Module | None = None,
        resolution: Resolution | None = None,
    ) -> Module:
        """Take the text of a file from an editor, until `close`.

        ``tree`` is its tree, and ``resolution`` what its names are bound to, if that is known already.
        """
        filename = os.path.abspath(filename)
        source = Source(text, filename)
        module = self._opened.get(filename)
        if module is None and filename in self._entries:
            module = self._entries[filename].module
        if module is None or module.source.text != source.text:
            module = read_module(source, tree=tree, resolution=resolution)
            self._forget()
        self._opened[filename] = module
        return module

    def close(self, filename: str) -> None:
        """Take the text of a file from disk again."""
        if self._opened.pop(os.path.abspath(filename), None) is not None:
            self._files = object()
            self._forget()

    def refresh(self) -> bool:
        """Check the files again, and read the changed ones; return whether any has changed."""
        has_changes = False
        for filename, entry in list(self._entries.items()):
            if _stamp(filename) != entry.stamp:
                text = None if entry.module is None else entry.module.source.text
                fresh = self._read(filename)
                same = text is not None and fresh.module is not None and fresh.module.source.text == text
                if same:
                    entry.stamp = fresh.stamp
                else:
                    self._entries[filename] = fresh
                    has_changes = True
        self.finder.forget()
        self._files = object()
        self._forget()
        return has_changes

    def state_beside(self, filename: str) -> object:
        """Return a value that equals another such state as long as no module but the one in this file has changed."""
        own = os.path.abspath(filename)
        return self._files, tuple(module for name, module in sorted(self._opened.items()) if name != own)

    def _forget(self) -> None:
        """Forget what was computed from modules of which one has changed."""
        self._exports = {}
        self.derived = {}

    def module(self, filename: str) -> Module | None:
        """Return the module in a file; ``None`` if it cannot be read, or is too large to look into."""
        absolute_path = self._absolute.get(filename)
        if absolute_path is None:
            absolute_path = self._absolute[filename] = os.path.abspath(filename)
        filename = absolute_path
        open_module = self._opened.get(filename)
        if open_module is not None:
            return open_module
        entry = self._entries.get(filename)
        if entry is None:
            entry = self._entries[filename] = self._read(filename)
        return entry.module

    @staticmethod
    def _read(filename: str) -> _Entry:
        stamp = _stamp(filename)
        if stamp is None or stamp[1] > _LARGEST:
            return _Entry(stamp, None)
        try:
            return _Entry(stamp, read_module(read_source(filename)))
        except ScenicError:
            return _Entry(stamp, None)

    def files(self) -> Iterator[str]:
        """Yield the Scenic and Python files of the workspace, and those that are open; no hidden folders."""
        open_files = set(self._opened)
        yield from sorted(open_files)
        for root in self.finder.roots:
            for folder, folders, names in os.walk(root):
                folders[:] = sorted(
                    each
                    for each in folders
                    if not each.startswith(".")
                    and each not in _PASSED_OVER
                    and not os.path.exists(os.path.join(folder, each, "pyvenv.cfg"))
                )
                for name in sorted(names):
                    filename = os.path.join(folder, name)
                    if name.endswith((*SUFFIXES, ".py")) and filename not in open_files:
                        open_files.add(filename)
                        yield filename

    # Modules

    def find(self, name: str, *, importer: str, level: int = 0) -> FoundModule:
        """Return the module that an import in a file means; ``level`` counts the dots before the name."""
        return self.finder.find(name, importer=importer, level=level)

    def found_module(self, found: FoundModule) -> Module | None:
        """Return the module that was found, if it can be looked into."""
        if found.filename is None or found.kind not in (ModuleKind.SCENIC, ModuleKind.PYTHON):
            return None
        return self.module(found.filename)

    def exports_of(self, found: FoundModule) -> Exports:
        """The names of the module that an import found; of one that cannot be looked into, none and `Exports.unseen`."""
        if found.kind is ModuleKind.NAMESPACE:
            return _NOTHING
        if found.kind is ModuleKind.COMPILED:
            exports = self._compiled.get(found.name)
            if exports is None:
                exports = self._compiled[found.name] = _compiled(found)
            return exports
        if found.is_missing:
            return _unknown(found.name, "it is not found")
        module = self.found_module(found)
        return _unknown(found.name, "its file cannot be read") if module is None else self.exports(module)

    def exports(self, module: Module) -> Exports:
        """The names of a module, with those that it imports."""
        earlier = self._exports.get(module.filename)
        current = self._is_current(module)
        if earlier is not None and current:
            return earlier
        gathering = _Gathering()
        new_exports = self._gather(module, gathering)
        if not gathering.incomplete:
            self._exports.update(gathering.done)
        elif current:
            self._exports[module.filename] = new_exports
        return new_exports

    def _gather(self, module: Module, gathering: "_Gathering") -> Exports:
        filename = module.filename
        if self._is_current(module) and filename in self._exports:
            return self._exports[filename]
        if filename in gathering.done:
            return gathering.done[filename]
        if filename in gathering.pending:
            gathering.incomplete = True
            return _NOTHING  # Modules that import each other: this one's names are being gathered.
        if len(gathering.pending) >= _DEEPEST:
            gathering.incomplete = True
            return _unknown(os.path.basename(filename), "it is reached through too many imports")
        gathering.pending.add(filename)
        names: dict[str, Exported] = {}
        unseen_names: dict[Unseen, None] = {}
        for node in module.stars:
            module_found = self.found_by(node, filename)
            inner = self.found_module(module_found)
            imported_exports = (
                self.exports_of(module_found) if inner is None else self._gather(inner, gathering)
            )
            names.update(
                (name, imported_exports.names[name])
                for name in imported_exports.public
                if name in imported_exports.names
            )
            unseen_names.update(dict.fromkeys(imported_exports.unseen))
        sets_ego = module.is_scenic and (
            module.sets_ego
            or any(self._gather(other, gathering).sets_ego for other in self._imported(module))
        )
        own_names = module.resolution.names
        names.update((name, Exported(name, module, binding)) for name, binding in own_names.items())
        if module.is_dynamic:
            reason = "parts of it cannot be parsed" if module.broken else "it binds names while it runs"
            unseen_names[Unseen(os.path.basename(filename), reason)] = None
        public_names = module.public
        if public_names is not None:
            public = public_names
        elif "__all__" in own_names:
            public = frozenset(names)
        else:
            public = frozenset(name for name in names if not name.startswith("_"))
        gathering.pending.remove(filename)
        exports = Exports(MappingProxyType(names), public, tuple(unseen_names), sets_ego)
        if self._is_current(module):
            gathering.done[filename] = exports
        return exports

    def _is_current(self, module: Module) -> bool:
        entry = self._entries.get(module.filename)
        current = self._opened.get(module.filename) or (None if entry is None else entry.module)
        return current is module

    def _imported(self, module: Module) -> Iterator[Module]:
        """Yield the Scenic modules that a module imports."""
        for level, name in _imports(module):
            found = self.find(name, importer=module.filename, level=level)
            if found.kind is ModuleKind.SCENIC:
                other = self.found_module(found)
                if other is not None:
                    yield other

    def found_by(self, node: ast.ImportFrom | scenic.Model, importer: str) -> FoundModule:
        """Return the module that ``from m import ...`` or ``model m`` means."""
        if isinstance(node, scenic.Model):
            return self.find(node.name, importer=importer)
        return self.find(node.module or "", importer=importer, level=node.level)

    def member(
        self, found: FoundModule, name: str, *, importer: str, level: int = 0
    ) -> Exported | FoundModule | None:
        """Return the meaning of ``from m import name``: a name of the module, else a module in it; ``None`` if it has neither."""
        exported = self.exports_of(found).names.get(name)
        if exported is not None and not self._is_own_module(exported, found):
            return exported
        inner = self.find(f"{found.name}.{name}" if found.name else name, importer=importer, level=level)
        # Of what is not found nothing is said: it may be made when the package is built.
        return exported if inner.is_missing else inner

    def _is_own_module(self, exported: Exported, found: FoundModule) -> bool:
        """Return whether ``from . import name`` in a package itself binds a name: it can only bring the module of that name."""
        module, binding = exported.module, exported.binding
        if module is None or binding is None or module.filename != found.filename:
            return False
        alias, statement = self._import_of(module, binding)
        if alias is None or alias.name != exported.name or not isinstance(statement, ast.ImportFrom):
            return False
        return self.found_by(statement, module.filename).filename == found.filename

    def follow(self, exported: Exported) -> Exported | FoundModule:
        """The definition behind an imported name, through all modules that pass it on.

        What is no plain import, or leads to where nothing is known, is its own definition.
        """
        bindings_done: set[Binding] = set()
        while exported.module is not None and exported.binding is not None:
            if exported.binding in bindings_done:
                break
            bindings_done.add(exported.binding)
            alias, statement = self._import_of(exported.module, exported.binding)
            if alias is None or statement is None:
                break
            importer = exported.module.filename
            if isinstance(statement, ast.Import):
                name = alias.name if alias.asname else alias.name.partition(".")[0]
                module_found = self.find(name, importer=importer)
                return exported if module_found.is_missing else module_found
            module_found = self.found_by(statement, importer)
            target = self.member(module_found, alias.name, importer=importer, level=statement.level)
            if target is None:
                break
            if isinstance(target, FoundModule):
                return target
            exported = target
        return exported

    @staticmethod
    def _import_of(
        module: Module, binding: Binding
    ) -> tuple[ast.alias | None, ast.Import | ast.ImportFrom | None]:
        """The import that alone binds a name."""
        if len(binding.sites) != 1 or not isinstance(binding.sites[0], ast.alias):
            return None, None
        alias = binding.sites[0]
        return alias, module.import_of.get(alias)


def _imports(module: Module) -> Iterator[tuple[int, str]]:
    """Yield each module that a module may import: the dots before its name, and the name."""
    nodes = module.resolution.nodes
    for node, _ in nodes(ast.Import):
        for alias in node.names:
            yield 0, alias.name
    for node, _ in nodes(ast.ImportFrom):
        yield node.level, node.module or ""
        # Each name may be that of a module in it.
        for alias in node.names:
            yield node.level, f"{node.module}.{alias.name}" if node.module else alias.name
    for node, _ in nodes(scenic.Model):
        yield 0, node.name


def _compiled(found: FoundModule) -> Exports:
    """The names of a compiled module: known only of those that belong to Python itself."""
    head = found.name.partition(".")[0]
    if head in sys.stdlib_module_names and not _is_foreign(found):
        try:
            names = dir(importlib.import_module(found.name))
        except ImportError:
            names = []
        if names:
            public = frozenset(name for name in names if not name.startswith("_"))
            return Exports(MappingProxyType({name: Exported(name) for name in names}), public)
    return _unknown(found.name, "it is compiled")


def _is_foreign(found: FoundModule) -> bool:
    """Return whether a compiled module lies outside of Python's own library, whatever its name."""
    library = os.path.dirname(os.path.abspath(os.__file__))
    inside = found.filename is None or found.filename.startswith(library + os.sep)
    return not inside or "site-packages" in (found.filename or "")


def _unknown(name: str, reason: str) -> Exports:
    return Exports(MappingProxyType({}), frozenset(), (Unseen(name, reason),))


def _stamp(filename: str) -> tuple[int, int] | None:
    try:
        status = os.stat(filename)
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size
