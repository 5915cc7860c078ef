"""From a tree back to source text.

`unparse` writes any tree that the parser makes of a text without mistakes, such that parsing what it wrote gives the
same tree again, up to positions: with no more parentheses than that takes, one statement a line, and blank lines
around definitions. Comments and the original layout are not in a tree, and so not in the text.

Which operand needs parentheses is decided from the table of precedence that is read from the grammar
(`scenic.compiler.precedence`), made ready in `scenic.compiler.unparser.places`.
"""

import ast

from scenic.compiler.parser import DEEPEST, recursion_limit
from scenic.compiler.unparser.errors import UnparseError
from scenic.compiler.unparser.expressions import WRITERS
from scenic.compiler.unparser.places import PREFIX, YIELD
from scenic.compiler.unparser.scenic_statements import ProgramWriter

__all__ = ["UnparseError", "unparse"]


def unparse(node: ast.AST) -> str:
    """The text of a tree: of a program or a statement with a line end, of an expression without.

    Raises `UnparseError` where a tree has no text: for what was left out after a mistake
    (`scenic.compiler.tree.ErrorStatement`), and for trees that the parser never makes, such as an empty block.
    Names are written as they are.
    """
    writer = ProgramWriter()
    try:
        with recursion_limit(DEEPEST):
            if isinstance(node, ast.Module):
                writer.module(node)
            elif isinstance(node, ast.stmt):
                writer.statement(node, "")
            else:
                return WRITERS[node.__class__](writer, node, YIELD, "", "", PREFIX)
    except RecursionError:
        raise UnparseError("the tree is too deep to be written", node) from None
    return "\n".join([*writer.lines, ""])
