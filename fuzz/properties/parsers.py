"""The fast parser and the recording one, which are generated from the same grammar in different ways, read the same."""

from typing import Any, Final

from fuzz.properties.case import Case, Property, Violation
from fuzz.properties.differences import difference
from scenic.compiler.actions import Actions
from scenic.compiler.generated import build_parser, build_recording_parser
from scenic.compiler.shared_words import closed_operands, in_parentheses
from scenic.compiler.tokens import DEDENT, ENDMARKER, Tokens

__all__ = ["OF_TEXTS"]


def both_parsers_agree(case: Case) -> None:
    """A program is read by the fast parser, without recovery, and by the recording one, with the same tree."""
    if case.has_error:
        return
    tokens = case.tokens
    tree = _fast(tokens)
    if tree is None:
        operands = closed_operands(tokens)
        tokens = in_parentheses(tokens, operands) if operands else tokens
        tree = _fast(tokens) if operands else None
    if tree is None:
        raise Violation("the fast parser refuses what the recovery accepts")
    for name, other in (("the result", case.result.tree), ("the recording parser", _recorded(tokens))):
        where = difference(tree, other, places=True)
        if where is not None:
            raise Violation(f"another tree than that of {name}: {where}")


def _lists(tokens: Tokens, actions: Actions) -> tuple[Any, ...]:
    # The parsers look at a few tokens after the present one.
    kinds = [*tokens.kinds, 0, 0, 0, 0]
    return kinds, tokens.texts, tokens.lines, tokens.columns, tokens.end_lines, tokens.end_columns, actions


def _fast(tokens: Tokens) -> Any:
    return build_parser(*_lists(tokens, Actions(tokens)))("file", 0)[0]


def _recorded(tokens: Tokens) -> Any:
    """The tree that the recording parser makes, which is given the statements of blocks."""
    actions = Actions(tokens)
    lists = _lists(tokens, actions)
    kinds = lists[0]

    def statements(rule: str, position: int) -> tuple[list[Any], int]:
        body: list[Any] = []
        while kinds[position] not in (DEDENT, ENDMARKER):
            node, position, _, _ = run(rule, position)
            if node is None:
                raise Violation("the recording parser refuses what the fast one accepts")
            if isinstance(node, list) and rule != "specifier_line":
                body += node
            else:
                body.append(node)
        return body, position

    run = build_recording_parser(*lists, statements)
    return actions.module(statements("statement", 0)[0])


OF_TEXTS: Final = (Property.of(both_parsers_agree, one_in=3),)
