"""Operators are parsed by the table of precedence, which the generator extracts from the grammar by other means."""

import ast
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from fuzz.properties.case import Case, Property, Violation, place
from fuzz.properties.differences import difference
from scenic.compiler import tree as scenic
from scenic.compiler.parser import parse
from scenic.compiler.precedence import Content, Form, Ladder, Slot, Word, form_of, forms_of

__all__ = ["OF_TEXTS", "operators_follow_the_table"]

_OPERATORS: Final = (
    ast.BinOp,
    ast.BoolOp,
    ast.Compare,
    ast.IfExp,
    ast.UnaryOp,
    scenic.Operation,
    scenic.SpecifierPhrase,
    scenic.Temporal,
)


@dataclass(frozen=True, slots=True)
class _Part:
    """A part of a node's text: a token, or an operand with the indices of the tokens around it if these are parentheses."""

    text: str
    operand: tuple[str, int | None] | None = None
    node: ast.AST | None = None
    parentheses: tuple[int, int] | None = None


def operators_follow_the_table(case: Case) -> None:
    """Each operator is written in one of its forms, its operands are in parentheses where the form needs that, and these matter.

    One pair of parentheses that is needed is left out: that must not give the same tree.
    """
    if case.has_error:
        return
    parentheses = _needed_parentheses(case)
    if parentheses:
        text = _without(case, parentheses[case.number % len(parentheses)])
        again = parse(text)
        if not again.diagnostics and difference(case.result.tree, again.tree) is None:
            raise Violation(f"the table says that this is no operand without parentheses:\n{text}")


def _needed_parentheses(case: Case) -> list[tuple[int, int]]:
    """The parentheses that are needed, as pairs of tokens; raises `Violation` if some are missing."""
    tokens = case.tokens
    parentheses: list[tuple[int, int]] = []
    starts = list(zip(tokens.lines, tokens.columns, strict=True))
    stack: list[tuple[ast.AST, Ladder]] = [(case.result.tree, Ladder.ORDINARY)]
    while stack:
        node, ladder = stack.pop()
        if isinstance(node, _OPERATORS):
            parts = _parts(node, starts, tokens.texts)
            stack.extend(_check(node, parts, ladder, parentheses))
        elif isinstance(node, scenic.Require):
            stack.append((node.condition, Ladder.TEMPORAL))
        else:
            stack.extend((part, Ladder.ORDINARY) for part in ast.iter_child_nodes(node))
    # Of two pairs around an operand none is.
    return [
        (first, last)
        for first, last in parentheses
        if (tokens.texts[first - 1], tokens.texts[last + 1]) != ("(", ")")
    ]


def _without(case: Case, pair: tuple[int, int]) -> str:
    """The text of a case without two of its tokens of one character."""
    tokens = case.tokens
    lines = [bytearray(line.encode("utf-8", "surrogatepass")) for line in tokens.text.split("\n")]
    for index in pair:
        lines[tokens.lines[index] - 1][tokens.columns[index]] = ord(" ")
    return b"\n".join(lines).decode("utf-8", "surrogatepass")


def _operands(node: ast.AST) -> Iterator[tuple[Any, tuple[str, int | None]]]:
    for name in node._fields:
        value = getattr(node, name)
        if isinstance(value, list):
            yield from (
                (part, (name, index)) for index, part in enumerate(value) if isinstance(part, ast.expr)
            )
        elif isinstance(value, ast.expr):
            yield value, (name, None)


def _parts(node: Any, starts: Sequence[tuple[int, int]], texts: Sequence[str]) -> list[_Part]:
    """The tokens and operands of a node, in order."""
    start, end = place(node)
    parts: list[tuple[_Part, int]] = []
    position = bisect_left(starts, start)
    for operand, target in sorted(_operands(node), key=lambda each: place(each[0])):
        first, last = place(operand)
        stop = bisect_left(starts, first)
        parts.extend((_Part(texts[index]), index) for index in range(position, stop))
        parts.append((_Part("", target, operand), stop))
        position = bisect_left(starts, last)
    parts.extend((_Part(texts[index]), index) for index in range(position, bisect_left(starts, end)))
    pieces: list[_Part] = []
    for index, (part, _) in enumerate(parts):
        if part.operand is not None:
            (before, opening), (after, closing) = (
                parts[max(0, index - 1)],
                parts[min(len(parts) - 1, index + 1)],
            )
            around = (opening, closing) if (before.text, after.text) == ("(", ")") else None
            pieces.append(_Part("", part.operand, part.node, around))
        elif part.text not in ("", "(", ")"):
            pieces.append(part)
    return pieces


def _check(
    node: Any, parts: Sequence[_Part], ladder: Ladder, needed: list[tuple[int, int]]
) -> Iterator[tuple[ast.AST, Ladder]]:
    """Checks one operator; gives its operands, with the ladder that each belongs to. Adds the parentheses that are needed."""
    if isinstance(node, ast.BoolOp | ast.Compare):
        slots = _chain(node, parts, ladder)
    else:
        slots = next(
            (slots for form in _forms(node, ladder) if (slots := _matched(form, parts)) is not None), None
        )
    if slots is None:
        form_text = " ".join(part.text or "_" for part in parts)
        raise Violation(f"{_where(node)}: `{form_text}` is no form of it with these operands")
    for part, slot in zip((part for part in parts if part.operand is not None), slots, strict=True):
        assert part.node is not None
        form = form_of(part.node, slot.ladder) or form_of(part.node)
        fits = form is None or slot.accepts(form)
        if part.parentheses is not None:
            if not fits:
                needed.append(part.parentheses)
            yield part.node, slot.ladder
            continue
        if form is not None and not fits:
            raise Violation(f"{_where(node)}: its operand `{form.text}` needs parentheses")
        yield part.node, slot.ladder if form is None else form.ladder


def _forms(node: Any, ladder: Ladder) -> tuple[Form, ...]:
    name = type(node).__name__
    if isinstance(node, scenic.SpecifierPhrase):
        return forms_of(name, node.specifier, Ladder.SPECIFIER)
    operator = getattr(node, "op", None) or getattr(node, "operator", None)
    operator = operator if isinstance(operator, str) or operator is None else type(operator).__name__
    # What is in parentheses in a condition may be an ordinary expression.
    return (*forms_of(name, operator, ladder), *forms_of(name, operator, Ladder.ORDINARY))


def _matched(form: Form, parts: Sequence[_Part]) -> tuple[Slot, ...] | None:
    """The slots of a form, if this is how the parts are written."""
    if len(form.parts) != len(parts):
        return None
    for form_part, part in zip(form.parts, parts, strict=True):
        match form_part:
            case Word():
                if part.text != form_part.text:
                    return None
            case Slot():
                target = form_part.target
                if target is None or part.operand != (target.field, target.index):
                    return None
            case Content():
                if part.operand is not None:
                    return None
    words = [part.text for part in parts[:2]]
    if form.yields_to and (tuple(words) == form.yields_to or _begins(parts, form.yields_to)):
        return None
    return form.slots


def _begins(parts: Sequence[_Part], words: tuple[str, ...]) -> bool:
    """Return whether an operator and the first word of its operand are one operator."""
    operand = parts[1]
    if len(words) != 2 or parts[0].text != words[0] or operand.parentheses or operand.node is None:
        return False
    form = form_of(operand.node)
    return form is not None and isinstance(form.parts[0], Word) and form.parts[0].text == words[1]


def _chain(node: Any, parts: Sequence[_Part], ladder: Ladder) -> tuple[Slot, ...] | None:
    """The slots of `and`, `or` and comparisons, which have any number of operands."""
    operators = [node.op] * (len(node.values) - 1) if isinstance(node, ast.BoolOp) else node.ops
    name = type(node).__name__
    forms = [forms_of(name, type(each).__name__, ladder)[0] for each in operators]
    form_words = [part for form in forms for part in (*form.words, None)]
    words = [part.text or None for part in parts[1:]]
    if parts[0].operand is None or words != form_words:
        return None
    order = [part.operand for part in parts if part.operand is not None]
    if order != [target for _, target in _operands(node)]:
        return None
    return (forms[0].slots[0], *(form.slots[-1] for form in forms))


def _where(node: Any) -> str:
    name = getattr(node, "operator", None) or getattr(node, "specifier", None) or type(node).__name__
    return f"`{name}` at {node.lineno}:{node.col_offset}"


OF_TEXTS: Final = (Property.of(operators_follow_the_table, one_in=2),)
