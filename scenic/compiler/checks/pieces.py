"""Rules that examine one stretch of the top level at a time, and run again only for changed stretches."""

import ast
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import cached_property
from typing import Any, TypeAlias

from scenic.compiler.checks.blocks import Block, blocks
from scenic.compiler.checks.context import Context
from scenic.compiler.checks.kept import Said
from scenic.compiler.scopes import Binding, Scope, Stretch
from scenic.language.diagnostics import Diagnostic

__all__ = ["Piece", "PieceRule", "piecewise"]


class Piece:
    """A stretch of a program under examination.

    ``follows_error`` tells whether the last thing before it that could be the header of its first statements could not be
    parsed.
    """

    def __init__(self, context: Context, stretch: Stretch, *, follows_error: bool = False) -> None:
        self._tree = context.tree
        self._stretch = stretch
        self.follows_error = follows_error

    def nodes(self, cls: type[ast.AST]) -> Sequence[tuple[Any, Scope]]:
        """Its nodes of a class, with their scopes."""
        return self._stretch.nodes(cls)

    @property
    def scopes(self) -> Collection[Scope]:
        """The scopes in it."""
        return self._stretch.scopes.values()

    @property
    def loaded(self) -> Collection[Binding]:
        """Names of scopes within the module that the piece reads."""
        return self._stretch.loaded

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """Its lists of statements, outer ones before those in them; the first is a part of the module's."""
        return tuple(blocks(self._tree, self._stretch.statements))

    @property
    def inner_blocks(self) -> tuple[Block, ...]:
        """The lists of statements that are complete: all but the first."""
        return self.blocks[1:]


PieceRule: TypeAlias = Callable[[Piece, Context], Iterator[Diagnostic]]
"""A rule about a piece of a program, which depends on the statements around it only through names."""


def piecewise(
    context: Context, group: str, rules: Sequence[PieceRule], go_on: Callable[[], None]
) -> Iterator[Diagnostic]:
    """The findings of a group of rules about all pieces; of unchanged pieces, the findings of the version before."""
    before = context.before
    for stretch in context.resolution.stretches:
        go_on()
        known = (
            before.said.get((group, stretch.keys))
            if before is not None and context.is_unchanged(stretch)
            else None
        )
        follows_error = context.follows_error(stretch)
        if known is not None and (
            known.follows_error is not follows_error
            or any(context.fact(name) != value for name, value in known.facts)
        ):
            known = None
        if known is not None:
            known = context.moves.of(known, context.source.filename)
        if known is None:
            context.asked.clear()
            piece = Piece(context, stretch, follows_error=follows_error)
            found = tuple(item for rule in rules for item in rule(piece, context))
            known = Said(
                found, tuple((name, context.fact(name)) for name in sorted(context.asked)), follows_error
            )
        context.said[group, stretch.keys] = known
        yield from known.found
