"""Comparison of trees with CPython's, and what Scenic reads otherwise than Python."""

import ast
import io
import keyword
import sys
import tokenize
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeAlias

from scenic.compiler.generated import HARD_KEYWORDS

PLACES: Final = frozenset({"lineno", "col_offset", "end_lineno", "end_col_offset"})

EXACT_IN_FORMATTED_STRINGS: Final = sys.version_info >= (3, 12)
"""Before Python 3.12, places inside f-strings were those of something else."""

Difference: TypeAlias = str | None


def difference(found: ast.AST, expected: ast.AST) -> Difference:
    """Where two trees differ, ``None`` if `ast.dump` with positions would show them alike.

    Some fifteen times faster than `ast.dump`; positions inside f-strings count only where CPython's are exact.
    """
    stack: list[tuple[Any, Any, bool]] = [(found, expected, True)]
    pop = stack.pop
    while stack:
        left, right, placed = pop()
        kind = type(left)
        if kind is not type(right):
            return f"{place(right)}: {kind.__name__} is not {type(right).__name__}"
        mine, theirs = left.__dict__, right.__dict__
        if len(mine) != len(theirs) and (extra := (mine.keys() - theirs.keys()) & set(kind._fields)):
            return f"{place(right)}: {kind.__name__}: unexpected fields {sorted(extra)}"
        for name, value in theirs.items():
            own = mine.get(name, stack)
            if own is value:
                continue
            if type(own) is not type(value):
                return f"{place(right)}: {kind.__name__}.{name}: {own!r} is not {value!r}"
            if isinstance(value, ast.AST):
                stack.append(
                    (own, value, placed and (EXACT_IN_FORMATTED_STRINGS or kind is not ast.JoinedStr))
                )
            elif type(value) is list:
                if len(own) != len(value):
                    return f"{place(right)}: {kind.__name__}.{name}: {len(own)} elements are not {len(value)}"
                inner = placed and (EXACT_IN_FORMATTED_STRINGS or kind is not ast.JoinedStr)
                for one, other in zip(own, value, strict=True):
                    if one is not other:
                        if isinstance(other, ast.AST):
                            stack.append((one, other, inner))
                        elif one != other:
                            return f"{place(right)}: {kind.__name__}.{name}: {one!r} is not {other!r}"
            elif name in PLACES:
                if own != value and placed:
                    return f"{place(right)}: {kind.__name__}.{name}: {own!r} is not {value!r}"
            elif own != value or repr(own) != repr(value):
                return f"{place(right)}: {kind.__name__}.{name}: {own!r} is not {value!r}"
    return None


def place(node: ast.AST) -> str:
    return f"line {getattr(node, 'lineno', '?')}"


# What Scenic reads otherwise. Each rule looks at CPython's tokens or tree and says whether it applies to a module.

OWN_WORDS: Final = HARD_KEYWORDS.keys() - set(keyword.kwlist)
STATEMENT_WORDS: Final = frozenset({"take", "record", "simulator"})
"""Soft keywords that begin a statement before any expression."""

LAYOUT: Final = (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)

Words: TypeAlias = Sequence[tokenize.TokenInfo]


def words_of(text: str) -> Words:
    """The tokens of a module without comments and empty lines."""
    found = tokenize.generate_tokens(io.StringIO(text).readline)
    return [each for each in found if each.type not in (tokenize.COMMENT, tokenize.NL)]


def keyword_as_name(words: Words, tree: ast.Module) -> bool:
    """A hard keyword of Scenic as a name."""
    return any(each.type == tokenize.NAME and each.string in OWN_WORDS for each in words)


def at_between_operands(words: Words, tree: ast.Module) -> bool:
    """`@` between operands makes a vector; the node is another."""
    return any(isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult) for node in ast.walk(tree))


def annotation_in_class(words: Words, tree: ast.Module) -> bool:
    """`name: value` in a class defines a property."""
    classes = (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    return any(isinstance(each, ast.AnnAssign) for node in classes for each in node.body)


def statement_of_soft_keyword(words: Words, tree: ast.Module) -> bool:
    """A soft keyword before a bracket or a sign is a name in Python, and begins a statement or operation in Scenic."""
    for before, word, after in zip([None, *words], words, words[1:], strict=False):
        if after.string in ("(", "[", "+", "-"):
            begins = before is None or before.string in (";", ":") or before.type in LAYOUT
            if (begins and word.string in STATEMENT_WORDS) or word.string == "visible":
                return True
    return False


RULES: Final[Sequence[Callable[[Words, ast.Module], bool]]] = (
    keyword_as_name,
    at_between_operands,
    annotation_in_class,
    statement_of_soft_keyword,
)


def reasons(text: str, tree: ast.Module) -> Iterator[str]:
    """The rules by which Scenic reads a module otherwise."""
    words = words_of(text)
    for rule in RULES:
        if rule(words, tree):
            yield rule.__name__


@cache
def modules(folder: Path) -> list[Path]:
    """The modules in a folder, those of other packages and of the tests of Python 2's converter left out."""
    return sorted(
        path
        for path in folder.rglob("*.py")
        if not {"site-packages", "lib2to3", "__pycache__"} & set(path.relative_to(folder).parts)
    )
