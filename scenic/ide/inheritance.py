"""Base and derived classes, and the definitions of members that replace each other."""

from typing import Any

from scenic.compiler.semantics.classes import Class, Classes
from scenic.compiler.semantics.symbols import Symbol, SymbolKind, symbols_of
from scenic.dataclass import dataclass
from scenic.project.index import Project

__all__ = ["Family", "family", "is_derived", "own_member", "owner_of", "subclasses"]

_MEMBERS = (SymbolKind.METHOD, SymbolKind.PROPERTY, SymbolKind.ATTRIBUTE)


@dataclass(frozen=True, slots=True)
class Family:
    """The definitions of a member by classes that derive from each other: they have one name, or none overrides another.

    ``provider`` is the class of the language that also defines it, if one does. What is no member of a class is a family
    of its own.
    """

    definitions: tuple[Symbol, ...]
    provider: str | None = None


def family(project: Project, symbol: Symbol) -> Family:
    """Return the family of a symbol."""
    owner = owner_of(symbol) if symbol.kind in _MEMBERS else None
    if owner is None:
        return Family((symbol,))
    provider = None
    definitions = {symbol: symbol}
    classes_done = {owner}
    pending = [owner]
    while pending:
        cls = Classes(project).of_symbol(pending.pop())
        if cls is None:
            continue
        member = own_member(cls, symbol.name)
        relatives = list(cls.bases)
        if member is not None:
            definitions.setdefault(member, member)
            relatives += subclasses(project, cls.symbol, deep=True)
        for each in relatives:
            class_here = Classes(project).of_symbol(each)
            if each in classes_done or class_here is None or class_here.member(symbol.name) is None:
                continue
            classes_done.add(each)
            if each.is_builtin:
                provider = each.name
            else:
                pending.append(each)
    return Family(tuple(definitions), provider)


def own_member(cls: Class, name: str) -> Symbol | None:
    """The definition of a name in a class itself."""
    member = cls.member(name)
    symbol = None if member is None else member.symbol
    if member is None or symbol is None or symbol.filename != cls.symbol.filename:
        return None
    return symbol if member.owner == cls.symbol.name else None


def subclasses(project: Project, symbol: Symbol, *, deep: bool) -> tuple[Symbol, ...]:
    """The classes of the workspace, and of its own file, that derive from a class.

    Directly, or if ``deep``, also through others.
    """
    classes: list[Symbol] = []
    home = [] if symbol.filename is None else [symbol.filename]
    for filename in dict.fromkeys([*home, *project.files()]):
        module = project.module(filename)
        for each in () if module is None else symbols_of(module):
            if each.kind is not SymbolKind.CLASS or each.filename != filename or each == symbol:
                continue
            if is_derived(project, each, symbol, deep=deep):
                classes.append(each)
    return tuple(classes)


def is_derived(project: Project, symbol: Symbol, base: Symbol, *, deep: bool) -> bool:
    """Return whether a class derives from another one."""
    classes_done: set[Symbol] = set()
    pending = [symbol]
    while pending:
        cls = Classes(project).of_symbol(pending.pop())
        for each in () if cls is None else cls.bases:
            if each == base:
                return True
            if deep and each not in classes_done:
                classes_done.add(each)
                pending.append(each)
    return False


def owner_of(symbol: Symbol) -> Symbol | None:
    """Return the class that a member is defined in."""
    module: Any = symbol.module
    if module is None:
        return None
    return next(
        (
            each
            for each in symbols_of(module)
            if each.kind is SymbolKind.CLASS and each.name == symbol.container
        ),
        None,
    )
