"""The exception for trees that have no text."""

import ast


class UnparseError(ValueError):
    """A tree has no text: it holds what was left out after a mistake, or what no text is parsed to.

    ``node`` is where.
    """

    def __init__(self, message: str, node: ast.AST) -> None:
        line = getattr(node, "lineno", None)
        super().__init__(
            message if line is None else f"{message} (line {line} of the text it was parsed from)"
        )
        self.node = node
