"""Reads the modules of a project: the text of a file becomes a tree with bound names."""

import ast
import warnings
from typing import Final

from scenic.compiler import tree as scenic
from scenic.compiler.parser import deep_recursion, parse
from scenic.compiler.resolver import bind
from scenic.compiler.scopes import Resolution
from scenic.compiler.semantics.modules import Module
from scenic.language.source import Source

__all__ = ["read_module"]

_EMPTY: Final = ast.Module(body=[], type_ignores=[])


def read_module(
    source: Source, *, tree: ast.Module | None = None, resolution: Resolution | None = None
) -> Module:
    """Parse and bind a module; the ending of the filename selects the language. Never raises.

    ``tree`` is the tree of the text, and ``resolution`` what its names are bound to, where that is already known.
    """
    is_scenic = not source.filename.endswith((".py", ".pyi"))
    is_broken = False
    try:
        with deep_recursion():
            if tree is None and is_scenic:
                result = parse(source.text, filename=source.filename)
                tree = result.tree
            elif tree is None:
                tree = _python(source)
            resolution = bind(tree) if resolution is None else resolution
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        tree, is_broken = _EMPTY, True
        resolution = bind(tree)
    is_broken = is_broken or bool(resolution.nodes(scenic.ErrorStatement))
    return Module(source, tree, resolution, is_scenic, is_broken)


def _python(source: Source) -> ast.Module:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Python's opinion of other people's modules is not asked for.
        return ast.parse(source.text, filename=source.filename)
