"""The program that the rules about trees work on: a parsed text, with the places of its nodes and the edits so far."""

import ast
import re
from collections.abc import Iterator
from dataclasses import field

from scenic.compiler import tree as scenic
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.language.source import Source
from scenic.migration.class_names import ClassInfo, ModuleNames
from scenic.migration.migration_rules import Note, decision
from scenic.migration.moved_files import MapFiles
from scenic.migration.texts import TextEdit, line_starts

__all__ = ["TextPiece"]


@dataclass(slots=True, eq=False)
class TextPiece:
    """A program that is read as Scenic 3, and is being converted.

    ``is_old`` tells whether it is known to be Scenic 2: only then are its meanings changed. ``flat`` says that it will
    run in the 2D mode. ``monitors`` are the lines of the monitors that nothing starts yet.
    """

    source: Source
    tree: ast.Module
    names: ModuleNames
    is_old: bool
    flat: bool
    maps: MapFiles
    monitors: frozenset[int] = frozenset()
    edits: list[TextEdit] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)
    nodes: list[ast.AST] = field(init=False)
    parents: dict[ast.AST, ast.AST] = field(init=False)
    starts: list[int] = field(init=False)

    def __post_init__(self) -> None:
        self.nodes = list(walk(self.tree))
        self.parents = {child: node for node in self.nodes for child in ast.iter_child_nodes(node)}
        self.starts = line_starts(self.source)

    def place(self, node: ast.AST) -> tuple[int, int]:
        """Return the offsets at which a node begins and ends."""
        span = self.source.span(node)
        return (
            self.starts[span.line - 1] + span.column,
            self.starts[span.end_line - 1] + span.end_column,
        )

    def text(self, node: ast.AST) -> str:
        """Return the text of a node."""
        start, end = self.place(node)
        return self.source.text[start:end]

    def line(self, node: ast.AST) -> int:
        """Return the line on which a node begins."""
        return self.source.span(node).line

    def edit(self, rule: str, node: ast.AST, start: int, end: int, text: str) -> None:
        """Replace a part of the text because of a node."""
        self.edits.append(TextEdit(start, end, text))
        self.notes.append(Note(self.line(node), rule))

    def rewords(self, rule: str, node: ast.AST, words: str, text: str) -> bool:
        """Replace the words that a node begins with; return whether it begins with them."""
        start, end = self.place(node)
        found = re.compile(r"(?:\s|\\\n)+".join(map(re.escape, words.split()))).match(
            self.source.text, start, end
        )
        if found is None:
            return False
        self.edit(rule, node, start, found.end(), text)
        return True

    def decide(self, rule: str, node: ast.AST, *names: str) -> None:
        """Note that a person must decide about a node."""
        self.notes.append(decision(rule, self.line(node), *names))

    def decide_once(self, rule: str, node: ast.AST, *names: str) -> None:
        """Note it for the first node of a program only."""
        if not any(note.rule == rule for note in self.notes):
            self.decide(rule, node, *names)

    def of(self, *kinds: type[ast.AST]) -> Iterator[ast.AST]:
        """The nodes of some kinds, in the order of the tree."""
        return (node for node in self.nodes if isinstance(node, kinds))

    def cls(self, new: scenic.New) -> ClassInfo | None:
        """Return the class of a new object, as far as it is known."""
        return self.names.classes.get(new.cls.id)

    def ancestors(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the nodes around a node, the innermost first."""
        while node in self.parents:
            node = self.parents[node]
            yield node

    def indentation(self, line: int) -> str:
        """Return the white space at the beginning of a line."""
        text = self.source.line(line)
        return text[: len(text) - len(text.lstrip())]

    def statement_after(self, rule: str, statement: ast.stmt, text: str, *, blank: bool = False) -> None:
        """Add a statement after another one of the same block."""
        span = self.source.span(statement)
        first = self.source.line(span.line)
        indent = self.indentation(span.line) if not first[: span.column].strip() else None
        line = max(span.end_line, last_line(self.source, statement))
        end = self.starts[line - 1] + len(self.source.line(line))
        if indent is None:
            indent = self.indentation(span.line)
        gap = "\n\n" if blank else "\n"
        self.edit(rule, statement, end, end, f"{gap}{indent}{text}")


def last_line(source: Source, statement: ast.stmt) -> int:
    """The last line of a statement, with those of the strings and brackets in it."""
    return max(source.span(node).end_line for node in walk(statement))
