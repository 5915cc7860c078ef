"""The questions of analysis: conditions that every scene must meet."""

from scenic.dataclass import dataclass
from scenic.graph.node import Node
from scenic.language.spans import Span


@dataclass(frozen=True, slots=True, eq=False)
class Fact:
    """A hard requirement whose truth value is a node.

    ``label`` names it in reports (``"requirement on line 3"``); ``span`` is its place in the program, in the file ``filename`` if
    that is known. The language's own requirements (``built_in``) are named in messages, too: that place is of what they are about.
    """

    node: Node
    label: str
    span: Span | None = None
    built_in: bool = False
    filename: str | None = None
