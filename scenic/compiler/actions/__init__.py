"""Functions that the grammar's actions call: the parts of building a tree that are more than making a node.

A method that returns ``None`` makes its alternative fail; before that it notes why with `Actions.fail`, which the
messages prefer to what the parser expected. What is wrong without making the text unreadable is reported instead.

Positions here are those of tokens and nodes: lines from 1, columns in UTF-8 bytes. A *place* is a quadruple of them.
"""

from scenic.compiler.actions.common import Place, SyntaxProblem, make, place_of
from scenic.compiler.actions.patterns import PatternActions
from scenic.compiler.actions.statements import StatementActions

__all__ = ["Actions", "Place", "SyntaxProblem", "make", "place_of"]


class Actions(StatementActions, PatternActions):
    """The functions that the grammar's actions call, for the tokens of one text."""
