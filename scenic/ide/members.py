"""Completions after a dot: members of modules, of instances, and of values whose kind the text shows."""

from collections.abc import Iterator

from scenic.compiler.semantics.classes import ClassMember
from scenic.compiler.semantics.symbols import Symbol, SymbolKind, symbol_of_exported
from scenic.ide.expressions import expression, operand_before
from scenic.ide.parameters import settings
from scenic.ide.possibilities import Completion, CompletionKind, kind_of_symbol
from scenic.ide.snapshot import Snapshot
from scenic.language.members import MEMBERS
from scenic.language.names import LIFTED_METHODS, NAMES
from scenic.language.types import INSTANCES
from scenic.project.index import Project

__all__ = ["members"]


def members(
    project: Project, snapshot: Snapshot, before: tuple[str, ...], line: int, column: int
) -> Iterator[Completion]:
    """Yield completions after the dot that follows ``before``; nothing if the value there is not known."""
    text = operand_before(before)
    owner_expression = expression(project, snapshot, text, line, column) if text else None
    if owner_expression is None:
        return
    model, node = owner_expression
    if text == "globalParameters":
        for setting in settings(project, model.module):
            yield Completion(setting.name, CompletionKind.PARAMETER, setting.name, 1, setting.value)
        return
    home = model.module_behind(node)
    if home is not None:
        exports = project.exports_of(home)
        for name in sorted(exports.public & exports.names.keys()):
            imported_symbol = symbol_of_exported(project, exports.names[name])
            place = ("name", imported_symbol.filename or "", imported_symbol.name)
            yield Completion(
                name, kind_of_symbol(imported_symbol), name, 1, imported_symbol.kind.value, key=place
            )
        return
    symbol = model.meaning(node)
    owner = symbol if symbol is not None and symbol.kind is SymbolKind.CLASS else model.class_of(node)
    kind = None
    if owner is None or owner.name in NAMES:
        kind = model.kind_of(node)
        if owner is None and ((kind is not None and kind.name in INSTANCES) or text == "self"):
            owner = Symbol("Object", SymbolKind.CLASS)  # Of whatever class, it is an object.
    cls = model.class_of_symbol(owner)
    if cls is not None and cls.members:
        yield from (_of_class(snapshot, member) for member in cls.members)
    elif kind is not None:
        of_kind = "region" if kind.name == "workspace" else kind.name
        for name in MEMBERS.get(of_kind, ()):
            completion_kind = CompletionKind.METHOD if name in LIFTED_METHODS else CompletionKind.ATTRIBUTE
            yield Completion(name, completion_kind, name, 3, of_kind)


def _of_class(snapshot: Snapshot, member: ClassMember) -> Completion:
    kind = {
        SymbolKind.PROPERTY: CompletionKind.PROPERTY,
        SymbolKind.METHOD: CompletionKind.METHOD,
    }.get(member.kind, CompletionKind.ATTRIBUTE)
    own = member.symbol is not None
    key = ("member", snapshot.filename, member.owner, member.name) if own else ("property", member.name)
    rank = 8 if member.name.startswith("_") else 1 if own else 2
    return Completion(member.name, kind, member.name, rank, member.type or member.owner, key=key)
