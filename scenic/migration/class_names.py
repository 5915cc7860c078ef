"""The classes of objects that a program sees: its own, and those of the modules that it imports, read and not run."""

from collections.abc import Iterator, Sequence
from dataclasses import field
from typing import Final

from scenic.compiler.semantics.classes import is_of_library
from scenic.compiler.semantics.modules import FoundModule, ModuleKind
from scenic.compiler.tokens import NAME
from scenic.dataclass import dataclass
from scenic.language.errors import ScenicError
from scenic.language.properties import CLASSES
from scenic.language.source import Source, read_source
from scenic.migration.moved import MOVED_MODULES
from scenic.migration.texts import Token, tokens_of
from scenic.project.module_search import ModuleFinder

__all__ = ["ClassInfo", "Library", "ModuleNames", "definitions"]

_DEEPEST: Final = 50
_FLAT: Final = frozenset({"scenic.domains.driving.model"})
_DRIVING: Final = _FLAT | {
    f"scenic.simulators.{name}"
    for name in (
        "carla.model",
        "lgsvl.model",
        "metadrive.model",
        "newtonian.driving_model",
        "sumo.model",
        "gta.model",
    )
}
"""World models with a road map."""


@dataclass(frozen=True, slots=True)
class ClassInfo:
    """A class of objects.

    ``root`` is the class of the language that it derives from: ``Object``, ``OrientedPoint`` or ``Point``. ``pinned``
    tells whether it, or a class that it derives from, gives ``requireVisible``; ``filenames`` are the files of all
    classes on the way to the root, the nearest first.
    """

    root: str
    pinned: bool = False
    filenames: tuple[str, ...] = ()


@dataclass(slots=True)
class ModuleNames:
    """The names that a module has.

    ``unseen`` are the names that come from modules which were not found, and ``has_unseen`` is true if such a module was
    imported with all its names. ``others`` are names that mean something else than a class of objects.
    """

    classes: dict[str, ClassInfo] = field(default_factory=dict)
    others: set[str] = field(default_factory=set)
    unseen: set[str] = field(default_factory=set)
    has_unseen: bool = False
    is_driving: bool = False
    imported: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class DefinedClass:
    """A definition of a class in a text: its name, its bases, and whether it gives ``requireVisible``."""

    name: str
    bases: tuple[str, ...]
    line: int
    pinned: bool


def definitions(tokens: Sequence[Token]) -> Iterator[DefinedClass]:
    """Yield the classes that a text defines, of either dialect."""
    for index, token in enumerate(tokens):
        if token.text not in ("class", "constructor") or not _begins(tokens, index):
            continue
        name = tokens[index + 1]
        if name.kind < NAME or tokens[index + 2].text not in ("(", ":"):
            continue
        bases: list[str] = []
        place = index + 2
        while tokens[place].text != ":" and not tokens[place].is_layout:
            if tokens[place].kind >= NAME and tokens[place + 1].text in (",", ")"):
                bases.append(tokens[place].text)
            place += 1
        yield DefinedClass(name.text, tuple(bases), name.line, _gives_visibility(tokens, place))


def _begins(tokens: Sequence[Token], index: int) -> bool:
    return index == 0 or tokens[index - 1].is_layout


def _gives_visibility(tokens: Sequence[Token], place: int) -> bool:
    """Return whether the body of a class that begins after ``place`` gives ``requireVisible``."""
    column = tokens[place].line
    depth = 0
    for index in range(place + 1, len(tokens)):
        token = tokens[index]
        if token.kind == 2:
            depth += 1
        elif token.kind == 3:
            depth -= 1
            if depth == 0:
                return False
        elif depth == 0 and token.line != column and not token.is_layout:
            return False
        elif token.text == "requireVisible" and depth <= 1 and tokens[index + 1].text in (":", "["):
            return True
    return False


class Library:
    """Reads the modules that programs import, each once; ``roots`` are the folders of the project."""

    def __init__(self, roots: Sequence[str] = ()) -> None:
        self.finder = ModuleFinder(roots)
        self._known: dict[str, ModuleNames] = {}
        self._pending: set[str] = set()

    def names(self, source: Source, tokens: Sequence[Token]) -> ModuleNames:
        """The names of a program with this text."""
        names = ModuleNames()
        for name in CLASSES:
            names.classes[name] = ClassInfo(name)
        for module, imported_name, alias, star in _imports(tokens):
            self._bring(names, source.filename, module, imported_name, alias, star)
        for definition in definitions(tokens):
            info = _info(definition, names, source.filename)
            if info is None:
                names.classes.pop(definition.name, None)
                names.others.add(definition.name)
            else:
                names.classes[definition.name] = info
                names.others.discard(definition.name)
                names.unseen.discard(definition.name)
        return names

    def _bring(
        self, names: ModuleNames, importer: str, module: str, imported: str | None, alias: str, star: bool
    ) -> None:
        module = MOVED_MODULES.get(module, module)
        level = len(module) - len(module.lstrip("."))
        module_found = self.finder.find(module[level:], importer=importer, level=level)
        names.is_driving = names.is_driving or module in _DRIVING
        if not star and imported is None:
            names.others.add(alias)
            return
        inner = self._module(module_found)
        if inner is not None and module_found.filename is not None:
            names.imported.append(module_found.filename)
            names.is_driving = names.is_driving or inner.is_driving
        if star:
            if inner is not None:
                names.classes.update(inner.classes)
                names.has_unseen = names.has_unseen or inner.has_unseen
                names.unseen |= inner.unseen
                names.others |= inner.others
            elif module_found.is_missing:
                names.has_unseen = True
            return
        assert imported is not None
        if inner is None:
            (names.unseen if module_found.is_missing else names.others).add(alias)
        elif imported in inner.classes:
            names.classes[alias] = inner.classes[imported]
            names.others.discard(alias)
        elif imported in inner.unseen or (inner.has_unseen and imported not in inner.others):
            names.unseen.add(alias)
        else:
            names.others.add(alias)

    def _module(self, found: FoundModule) -> ModuleNames | None:
        """The names of a Scenic module; ``None`` for other modules."""
        filename = found.filename
        if found.kind is not ModuleKind.SCENIC or filename is None:
            return None
        names = self._known.get(filename)
        if names is not None:
            return names
        if filename in self._pending or len(self._pending) > _DEEPEST:
            return ModuleNames()
        self._pending.add(filename)
        try:
            source = read_source(filename)
            names = self.names(source, tokens_of(source))
        except ScenicError:
            names = ModuleNames(has_unseen=True)
        self._pending.discard(filename)
        if is_of_library(filename):
            names.imported.clear()
        self._known[filename] = names
        return names


def _info(definition: DefinedClass, names: ModuleNames, filename: str) -> ClassInfo | None:
    """Return the class of objects that a definition makes; ``None`` if it is a plain class of Python."""
    if not definition.bases:
        return ClassInfo("Object", definition.pinned, (filename,))
    for base in definition.bases:
        base_info = names.classes.get(base)
        if base_info is None and base in names.unseen:
            base_info = ClassInfo("Object", True)
        if base_info is not None:
            return ClassInfo(
                base_info.root, definition.pinned or base_info.pinned, (filename, *base_info.filenames)
            )
    if names.has_unseen and definition.bases[0][:1].isupper() and definition.bases[0] not in names.others:
        return ClassInfo("Object", True, (filename,))
    return None


def _imports(tokens: Sequence[Token]) -> Iterator[tuple[str, str | None, str, bool]]:
    """The imports of a text: module, name in it, name in the text, and whether all names are imported."""
    for index, token in enumerate(tokens):
        if not _begins(tokens, index):
            continue
        if token.text == "model" and tokens[index + 1].kind >= NAME and tokens[index + 2].text in (".", ""):
            module, _ = _dotted(tokens, index + 1)
            yield module, None, "", True
        elif token.text == "import":
            place = index + 1
            while not tokens[place].is_layout:
                module, place = _dotted(tokens, place)
                alias = module.partition(".")[0]
                if tokens[place].text == "as":
                    alias, place = tokens[place + 1].text, place + 2
                yield module, None, alias, False
                place += 1
        elif token.text == "from":
            module, place = _dotted(tokens, index + 1)
            if tokens[place].text != "import":
                continue
            yield from _imported(module, tokens, place + 1)


def _imported(
    module: str, tokens: Sequence[Token], place: int
) -> Iterator[tuple[str, str | None, str, bool]]:
    while not tokens[place].is_layout:
        token = tokens[place]
        if token.text == "*":
            yield module, None, "", True
        elif token.kind >= NAME:
            alias = token.text
            if tokens[place + 1].text == "as":
                alias, place = tokens[place + 2].text, place + 2
            yield module, token.text, alias, False
        place += 1


def _dotted(tokens: Sequence[Token], place: int) -> tuple[str, int]:
    """The dotted name that begins at a token, and the place after it."""
    pieces: list[str] = []
    while tokens[place].text in (".", "...") or (
        tokens[place].kind >= NAME and (not pieces or pieces[-1].endswith("."))
    ):
        pieces.append(tokens[place].text)
        place += 1
    return "".join(pieces), place
