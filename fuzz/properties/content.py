"""Nothing is lost: what is written in a program is in its tree, and that in its code, at its place."""

import ast
from collections import Counter
from collections.abc import Iterator
from typing import Any, Final

from fuzz.properties.case import Case, Property, Violation, place
from fuzz.properties.lowering import lowered
from scenic.compiler import tree as scenic
from scenic.compiler.tokens import NAME, NUMBER

__all__ = ["OF_TEXTS"]


def lowering_loses_nothing(case: Case) -> None:
    """All names and constants of a program are in its lowered tree, and what stands at the place of each expression.

    Behaviors are not looked into: what they do is compiled only where there are simulations.
    """
    lowering = lowered(case)
    if lowering is None:
        return
    there: Counter[str] = Counter()
    places = set()
    for node in ast.walk(lowering.module):
        there.update(_words(node))
        if isinstance(node, ast.expr):
            places.add(place(node))
    words_of_program: Counter[str] = Counter()
    for node in _compiled(lowering.tree):
        words_of_program.update(_words(node))
        if isinstance(node, ast.expr) and place(node) not in places:
            raise Violation(f"nothing stands at the place of {type(node).__name__}, {place(node)}")
    missing_words = words_of_program - there
    if missing_words:
        raise Violation(f"lost: {', '.join(sorted(missing_words))}")


def _compiled(tree: ast.Module) -> Iterator[ast.AST]:
    """The nodes of a tree that have code."""
    stack: list[ast.AST] = [tree]
    while stack:
        node = stack.pop()
        yield node
        match node:
            case scenic.BehaviorDef():
                stack.append(node.args)
            case scenic.ScenarioDef():
                stack.extend(node.setup or ())
                if node.args is not None:
                    stack.append(node.args)
            case _:
                stack.extend(ast.iter_child_nodes(node))


def _words(node: Any) -> Iterator[str]:
    """The names in a node itself, and its value if it is a constant."""
    if isinstance(node, ast.Constant):
        yield node.value if isinstance(node.value, str) else repr(node.value)
        return
    for name in node._fields:
        value = getattr(node, name, None)
        if (
            isinstance(value, str)
            and not isinstance(node, scenic.Temporal)
            and name not in ("moment", "unit")
        ):
            yield value
        elif isinstance(value, list):
            yield from (each for each in value if isinstance(each, str))


def parsing_loses_nothing(case: Case) -> None:
    """All names of a program are in its tree, and as many numbers as it has."""
    if case.has_error:
        return
    words_of_program: Counter[str] = Counter()
    numbers = 0
    for kind, text in zip(case.tokens.kinds, case.tokens.texts, strict=True):
        # Soft keywords may be names, or not.
        if kind == NAME:
            words_of_program[text] += 1
        numbers += kind == NUMBER
    there: Counter[str] = Counter()
    for node in ast.walk(case.result.tree):
        for word in _words(node):
            there.update(word.split("."))
        if isinstance(node, ast.FormattedValue) and node.conversion >= 0:
            there[chr(node.conversion)] += 1
        values = (getattr(node, name, None) for name in _NUMBERS)
        numbers -= sum(
            isinstance(value, int | float | complex) and not isinstance(value, bool) for value in values
        )
        numbers -= isinstance(name := getattr(node, "name", None), str) and name[:1] in "0123456789."
    missing_words = words_of_program - there
    if missing_words or numbers > 0:
        raise Violation(f"not in the tree: {', '.join(sorted(missing_words)) or f'{numbers} numbers'}")


_NUMBERS: Final = ("value", "probability")

OF_TEXTS: Final = (Property.of(parsing_loses_nothing), Property.of(lowering_loses_nothing, one_in=2))
