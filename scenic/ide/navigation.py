"""From a name to where it is defined and used, in all files of a project; and giving it another name."""

import ast
import keyword
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from types import ModuleType
from unicodedata import normalize

from scenic.compiler import tree as scenic
from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.scopes import Binding, Resolution, ScopeKind
from scenic.compiler.semantics.classes import Classes
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Module
from scenic.compiler.semantics.symbols import Symbol, SymbolKind, symbol_of_binding
from scenic.dataclass import dataclass
from scenic.ide.inheritance import family, own_member, owner_of, subclasses
from scenic.ide.parameters import parameter_at, settings
from scenic.ide.snapshot import Snapshot
from scenic.language import names, operators, properties, specifiers
from scenic.language.names import RESERVED, TRACKED
from scenic.language.source import read_source
from scenic.language.spans import Span
from scenic.project.index import Project
from scenic.project.queries import Location, Occurrence, occurrence_at, occurrences, references, symbol_of

__all__ = [
    "Highlight",
    "Moniker",
    "RenameError",
    "Target",
    "declarations",
    "definitions",
    "highlights",
    "implementations",
    "linked",
    "moniker",
    "prepare_rename",
    "rename",
    "type_definitions",
    "usages",
]


@dataclass(frozen=True, slots=True)
class Target:
    """The destination of a jump from a name: ``origin`` is the name that the jump starts from, ``extent`` the
    whole definition.
    """

    filename: str
    span: Span
    extent: Span
    origin: Span


@dataclass(frozen=True, slots=True)
class Highlight:
    """A place in the same document that names the same thing; ``writes`` if it gives it a value."""

    span: Span
    writes: bool


@dataclass(frozen=True, slots=True)
class Moniker:
    """An identifier of a name that no other has: the file below its folder of the workspace, and the names on the way to it."""

    identifier: str
    is_local: bool
    is_import: bool


class RenameError(Exception):
    """The reason why a name cannot be changed, or cannot become the new name."""


def definitions(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Target, ...]:
    """Return the definitions of the name at a place; a name of the language is defined where it is declared
    with its documentation.

    A name that several places bind leads to all of them; a module to its file; a global parameter to where it is set.
    """
    module, occurrence = _occurrence(project, snapshot, line, column)
    parameter = parameter_at(snapshot, line, column)
    if module is not None and parameter is not None:
        name, origin = parameter
        set_here = [each for each in settings(project, module) if each.name == name]
        return tuple(Target(each.filename, each.span, each.extent, origin) for each in set_here)
    symbol = None if module is None or occurrence is None else symbol_of(Model(module, project), occurrence)
    if symbol is None or occurrence is None or symbol.is_builtin:
        return _ego(module, occurrence) or _provided(snapshot, line, column)
    return _targets(symbol, occurrence.span)


def _provided(snapshot: Snapshot, line: int, column: int) -> tuple[Target, ...]:
    """Return the declaration of what the language provides, which documents it."""
    index = snapshot.token_at(line, column)
    if index is None or not snapshot.is_word(index):
        return ()
    name = snapshot.tokens.texts[index]
    node = snapshot.path_to(line, column)[-1]
    declaring: ModuleType | None = None
    if isinstance(node, ast.Name) and name in names.NAMES:
        declaring = names
    elif name in properties.properties_of("Object") and not isinstance(node, ast.Name):
        declaring = properties
    elif isinstance(node, scenic.SpecifierPhrase):
        declaring, name = specifiers, node.specifier
    elif isinstance(node, scenic.Operation):
        declaring, name = operators, node.operator
    if declaring is None or declaring.__file__ is None:
        return ()
    for number, content in enumerate(read_source(declaring.__file__).lines, 1):
        match = re.search(rf'"{re.escape(name)}\b', content)
        if match is not None:
            span = Span(number, match.start() + 1, number, match.end())
            return (Target(declaring.__file__, span, span, snapshot.span_of_token(index)),)
    return ()


def moniker(project: Project, snapshot: Snapshot, line: int, column: int) -> Moniker | None:
    """The moniker of the name at a place; ``None`` if the language provides it."""
    module, occurrence = _occurrence(project, snapshot, line, column)
    symbol = None if module is None or occurrence is None else symbol_of(Model(module, project), occurrence)
    if module is None or symbol is None or symbol.filename is None:
        return None
    homes = [root for root in project.finder.roots if symbol.filename.startswith(os.path.join(root, ""))]
    home = max(homes, key=len, default=os.path.dirname(symbol.filename))
    path = os.path.relpath(symbol.filename, home).replace(os.sep, "/")
    inner = symbol.binding is not None and symbol.binding.scope.kind not in (
        ScopeKind.MODULE,
        ScopeKind.CLASS,
    )
    inside = [] if symbol.kind is SymbolKind.MODULE else [symbol.container, symbol.name]
    identifier = ":".join([path, ".".join(filter(None, inside))]) if inside else path
    return Moniker(identifier, inner, symbol.filename != module.filename)


def declarations(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Target, ...]:
    """Return the place at which the name at a place enters its module: the import of an imported name, else its definition."""
    module, occurrence = _occurrence(project, snapshot, line, column)
    if module is None or occurrence is None:
        return ()
    if isinstance(occurrence.node, ast.Name):
        reference = module.resolution.references.get(occurrence.node)
        binding = None if reference is None else reference.binding
        if binding is not None:
            symbol = symbol_of_binding(module, binding)
            return _targets(symbol, occurrence.span)
    return definitions(project, snapshot, line, column)


def type_definitions(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Target, ...]:
    """Return the definition of the class of the value that the name at a place has."""
    module, occurrence = _occurrence(project, snapshot, line, column)
    if module is None or occurrence is None:
        return ()
    symbol: Symbol | None = None
    if isinstance(occurrence.node, ast.expr):
        symbol = Model(module, project).class_of(occurrence.node)
    if symbol is None:
        named_symbol = symbol_of(Model(module, project), occurrence)
        symbol = named_symbol if named_symbol is not None and named_symbol.kind is SymbolKind.CLASS else None
    return () if symbol is None else _targets(symbol, occurrence.span)


def implementations(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Target, ...]:
    """The classes derived from the class at a place, or what they define under the name of the member at a place."""
    module, occurrence = _occurrence(project, snapshot, line, column)
    symbol = None if module is None or occurrence is None else symbol_of(Model(module, project), occurrence)
    if symbol is None or occurrence is None:
        return ()
    if symbol.kind is SymbolKind.CLASS:
        subclasses_of_symbol = subclasses(project, symbol, deep=True)
        return tuple(
            target for each in subclasses_of_symbol for target in _targets(each, occurrence.span)
        ) or _targets(symbol, occurrence.span)
    members = (SymbolKind.METHOD, SymbolKind.PROPERTY, SymbolKind.ATTRIBUTE)
    targets = list(_targets(symbol, occurrence.span))
    if symbol.kind in members and symbol.container is not None:
        owner = owner_of(symbol)
        for each in () if owner is None else subclasses(project, owner, deep=True):
            cls = Classes(project).of_symbol(each)
            member = None if cls is None else own_member(cls, symbol.name)
            if member is not None:
                targets += _targets(member, occurrence.span)
    return tuple(targets)


def usages(
    project: Project,
    snapshot: Snapshot,
    line: int,
    column: int,
    *,
    with_definitions: bool,
    go_on: Callable[[], None] = lambda: None,
) -> Iterator[Location]:
    """Every place of the workspace that names the same as the name at a place, file by file.

    ``go_on`` is called before each file, and may raise.
    """
    module, occurrence = _occurrence(project, snapshot, line, column)
    if module is None or occurrence is None:
        return
    symbol = symbol_of(Model(module, project), occurrence)
    places: Iterable[Location]
    if symbol is None or symbol.is_builtin:
        places = (
            Location(module.filename, each.span, each.defines) for each in _same(project, module, occurrence)
        )
    else:
        places = references(project, *family(project, symbol).definitions, go_on=go_on)
    yield from (place for place in places if with_definitions or not place.defines)


def highlights(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Highlight, ...]:
    """The places of the same document that name the same as the name at a place."""
    module, found = _occurrence(project, snapshot, line, column)
    if module is None or found is None:
        return ()
    symbol = symbol_of(Model(module, project), found)
    wanted = () if symbol is None or symbol.is_builtin else family(project, symbol).definitions
    return tuple(Highlight(each.span, each.defines) for each in _same(project, module, found, *wanted))


def linked(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Span, ...]:
    """The places that change together while the name at a place is edited: those of a local name of a function."""
    module, occurrence = _occurrence(project, snapshot, line, column)
    if module is None or occurrence is None:
        return ()
    symbol = symbol_of(Model(module, project), occurrence)
    if symbol is None or symbol.binding is None or symbol.container is None:
        return ()
    if symbol.kind not in (SymbolKind.VARIABLE, SymbolKind.PARAMETER) or symbol.filename != module.filename:
        return ()
    places = tuple(each.span for each in _same(project, module, occurrence))
    return places if len(places) > 1 else ()


def prepare_rename(project: Project, snapshot: Snapshot, line: int, column: int) -> tuple[Span, str] | None:
    """The name at a place, if it can be changed; ``None`` where there is no name.

    Raises `RenameError` for a name that cannot be changed.
    """
    module, occurrence = _occurrence(project, snapshot, line, column)
    if module is None or occurrence is None:
        return None
    if _alias(module, occurrence) is not None:
        return occurrence.span, occurrence.name  # Whatever it means: the name is the program's own.
    symbol = symbol_of(Model(module, project), occurrence)
    if (
        occurrence.name in RESERVED
        or occurrence.name in TRACKED
        or (symbol is not None and symbol.is_builtin)
    ):
        raise RenameError(f"`{occurrence.name}` belongs to the language and cannot be renamed")
    if symbol is None:
        raise RenameError(f"it is not known what `{occurrence.name}` means here")
    if symbol.kind is SymbolKind.MODULE:
        raise RenameError("rename the file of a module to give it another name")
    if symbol.filename is not None and not _is_own(project, symbol.filename, snapshot.filename):
        raise RenameError(f"`{occurrence.name}` is defined outside the workspace, in {symbol.filename}")
    relatives = family(project, symbol)
    if relatives.provider is not None:
        raise RenameError(
            f"`{symbol.name}` is defined by `{relatives.provider}`, which belongs to the language"
        )
    for each in relatives.definitions:
        if not _is_own(project, each.filename, snapshot.filename):
            raise RenameError(f"`{symbol.name}` is also defined outside the workspace, in {each.filename}")
    return occurrence.span, occurrence.name


def rename(
    project: Project, snapshot: Snapshot, line: int, column: int, name: str
) -> tuple[tuple[Location, str], ...]:
    """The places that change when the name at a place becomes ``name``, each with its new text.

    Raises `RenameError` if that is impossible, or would change what the program means.
    """
    preparation = prepare_rename(project, snapshot, line, column)
    if preparation is None:
        raise RenameError("there is no name here")
    _refuse_word(name)
    module, occurrence = _occurrence(project, snapshot, line, column)
    assert module is not None
    assert occurrence is not None
    alias_binding = _alias(module, occurrence)
    if alias_binding is not None:
        if name != occurrence.name and name in module.resolution.names:
            raise RenameError(f"there is a `{name}` already in the same scope")
        _refuse_capture(module.resolution, alias_binding, name)
        same = _same(project, module, occurrence)
        return tuple(
            (Location(module.filename, each.span, each.defines), name)
            for each in same
            if each.name == occurrence.name and not isinstance(each.node, ast.Attribute)
        )
    symbol = symbol_of(Model(module, project), occurrence)
    assert symbol is not None
    binding = symbol.binding
    names = (symbol.module or module).resolution
    if name != occurrence.name and binding is not None and name in binding.scope.bindings:
        raise RenameError(f"there is a `{name}` already in the same scope")
    relatives = family(project, symbol)
    if name != occurrence.name:
        _refuse_clash(project, relatives.definitions, name)
        if binding is not None:
            _refuse_capture(names, binding, name)
    places = references(project, *relatives.definitions)
    # A place that names it differently (`import a as b`) keeps its own name.
    changes = [(place, name) for place in places if _text(project, place) == symbol.name]
    if occurrence.name != symbol.name:
        # Another name was asked about that an import gave: only that one changes.
        changes = [
            (Location(module.filename, each.span, each.defines), name)
            for each in _same(project, module, occurrence)
            if each.name == occurrence.name
        ]
    return tuple(changes)


# Helpers


def _refuse_word(name: str) -> None:
    """Raise `RenameError` if a text is no name that a program may bind."""
    if not name.isidentifier():
        raise RenameError(f"`{name}` is not a name")
    if keyword.iskeyword(name) or name in HARD_KEYWORDS:
        raise RenameError(f"`{name}` is a keyword")
    if name in RESERVED:
        raise RenameError(f"`{name}` belongs to the language")


def _refuse_capture(names: Resolution, binding: Binding, name: str) -> None:
    """Raise `RenameError` if a name of another scope would come between a binding and its uses, or the binding between
    another one of that name and the uses of that.
    """
    scope = binding.scope
    for reference in names.references.values():
        around = tuple(reference.scope.ancestors())
        if scope not in around:
            continue
        within = around[: around.index(scope)]
        if reference.binding is binding:
            other = reference.scope.lookup(name)
            if other is not None and other.scope in within:
                raise RenameError(f"`{name}` means something else where `{binding.name}` is used")
        elif reference.node.id == name and (
            reference.binding is None or reference.binding.scope not in within
        ):
            raise RenameError(f"there is a `{name}` already that is used in the same scope")


def _refuse_clash(project: Project, members: Sequence[Symbol], name: str) -> None:
    """Raise `RenameError` if a class that defines one of the members has one of another name already."""
    for each in members:
        owner = owner_of(each)
        cls = None if owner is None else Classes(project).of_symbol(owner)
        if cls is not None and cls.member(name) is not None:
            raise RenameError(f"`{cls.symbol.name}` has a `{name}` already")


def _occurrence(
    project: Project, snapshot: Snapshot, line: int, column: int
) -> tuple[Module | None, Occurrence | None]:
    module = project.module(snapshot.filename)
    return module, None if module is None else occurrence_at(module, line, column)


def _alias(module: Module, found: Occurrence) -> Binding | None:
    """Return the binding of an import's alias, as in ``import a as b``; ``None`` for all other names."""
    binding = module.resolution.names.get(found.name)
    if binding is None or isinstance(found.node, ast.Attribute) or len(binding.sites) != 1:
        return None
    [site] = binding.sites
    is_alias = isinstance(site, ast.alias) and site.asname == found.name != site.name
    if isinstance(found.node, ast.Name) and module.resolution.binding(found.node) is not binding:
        return None
    return binding if is_alias else None


def _same(project: Project, module: Module, found: Occurrence, *related: Symbol) -> Sequence[Occurrence]:
    """Return the words of a module that mean the same as one of them, or one of ``related``.

    Without a meaning, those that are the same.
    """
    model = Model(module, project)
    symbol = symbol_of(model, found)
    names = {found.name} | ({symbol.name} if symbol is not None else set())
    alias_names = {alias.asname for alias in module.import_of if alias.asname}
    same = [each for each in occurrences(module) if each.name in names or each.name in alias_names]
    if symbol is None:
        return [each for each in same if each.name == found.name and type(each.node) is type(found.node)]
    targets = {symbol, *related}
    return [each for each in same if symbol_of(model, each) in targets]


def _targets(symbol: Symbol, origin: Span) -> tuple[Target, ...]:
    if symbol.filename is None or symbol.span is None:
        return ()
    return (Target(symbol.filename, symbol.span, _around(symbol.extent, symbol.span), origin),)


def _around(extent: Span | None, span: Span) -> Span:
    return extent if extent is not None and extent.contains(span) else span


def _ego(module: Module | None, found: Occurrence | None) -> tuple[Target, ...]:
    """Return the places where the ego or the workspace is set, which is not a binding."""
    if module is None or found is None or found.name not in TRACKED:
        return ()
    return tuple(
        Target(module.filename, each.span, each.span, found.span)
        for each in occurrences(module)
        if each.name == found.name and each.defines
    )


def _is_own(project: Project, filename: str | None, beside: str) -> bool:
    """Return whether a file belongs to the workspace; without one, whether it is the document itself."""
    return filename == beside or filename in set(project.files())


def _text(project: Project, place: Location) -> str:
    module = project.module(place.filename)
    if module is None:
        return ""
    return normalize("NFKC", module.source.line(place.span.line)[place.span.column : place.span.end_column])
