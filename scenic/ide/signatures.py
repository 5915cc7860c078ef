"""The signature of the function whose arguments are being written, and the parameter that is next."""

import ast
from typing import Final

from scenic.compiler.semantics.signatures import Signature
from scenic.compiler.tokens import DEDENT, INDENT, NEWLINE, Tokens
from scenic.dataclass import dataclass
from scenic.ide.expressions import expression, operand_before
from scenic.ide.snapshot import Snapshot
from scenic.project.index import Project
from scenic.project.queries import call_signature

__all__ = ["Help", "signature_help"]

_MOST_TOKENS: Final = 5_000
_DEFINING: Final = frozenset({"behavior", "class", "def", "monitor", "scenario"})
_CLOSERS: Final = frozenset({")", "]", "}"})
_OPENERS: Final = frozenset({"(", "[", "{"})


@dataclass(frozen=True, slots=True)
class Help:
    """A signature; ``parameters`` are the places of its parameters in ``label``, ``active`` is the index of the present one.

    ``active`` is ``None`` where there is none for the argument.
    """

    label: str
    documentation: str | None
    parameters: tuple[tuple[int, int], ...]
    active: int | None


def signature_help(project: Project, snapshot: Snapshot, line: int, column: int) -> Help | None:
    """Help for the innermost call around a place; ``None`` outside of calls and where nothing is known."""
    call = _call_around(snapshot, line, column)
    if call is None:
        return None
    text, index, name = call
    call_expression = expression(project, snapshot, f"{text}()", line, column)
    if call_expression is None or not isinstance(call_expression[1], ast.Call):
        return None
    signature = call_signature(call_expression[0], call_expression[1])
    return None if signature is None else _help(signature, index, name)


def _call_around(snapshot: Snapshot, line: int, column: int) -> tuple[str, int, str | None] | None:
    """Return the callee of the call around a place, the number of commas before the place, and the name of the
    argument, if it has one.
    """
    tokens = snapshot.tokens
    byte = snapshot.source.byte(line, column)
    last = snapshot.tokens_of_line(line).stop - 1
    while last >= 0 and (tokens.lines[last], tokens.columns[last]) >= (line, byte):
        last -= 1
    depth = commas = 0
    name: str | None = None
    argument: list[str] = []
    for index in range(last, max(-1, last - _MOST_TOKENS), -1):
        text = tokens.texts[index]
        if tokens.kinds[index] in (NEWLINE, INDENT, DEDENT) and tokens.lines[index] < line:
            return None
        inside = tokens.end_lines[index] > line or (
            tokens.end_lines[index] == line and tokens.end_columns[index] > byte and index == last
        )
        if inside and text[:1] in "'\"":
            argument.append(text)
            continue
        if text in _CLOSERS:
            depth += 1
        elif text in _OPENERS:
            if depth:
                depth -= 1
            elif (
                text == "("
                and index
                and (tokens.texts[index - 1].isidentifier() or tokens.texts[index - 1] in _CLOSERS)
            ):
                callee = operand_before(tokens.texts[max(0, index - 200) : index])
                if _is_defined(tokens, index - 1):
                    return None
                return (callee, commas, name or _keyword(argument)) if callee else None
            else:
                # Brackets of another kind: the call is further out.
                commas, argument, name = 0, [], None
        elif text == "," and not depth:
            if not commas:
                name = _keyword(argument)
            commas += 1
        elif not commas and not depth:
            argument.append(text)
    return None


def _is_defined(tokens: Tokens, name: int) -> bool:
    """Return whether a name is not called but defined: the word before it begins the line."""
    if name < 1 or tokens.texts[name - 1] not in _DEFINING:
        return False
    return (
        name < 2 or tokens.kinds[name - 2] in (NEWLINE, INDENT, DEDENT) or tokens.texts[name - 2] == "async"
    )


def _keyword(backwards: list[str]) -> str | None:
    """The name in ``name = ...``; the tokens of the argument come last first."""
    return backwards[-1] if len(backwards) > 1 and backwards[-2] == "=" else None


def _help(signature: Signature, index: int, name: str | None) -> Help:
    label = str(signature)
    places = []
    position = label.index("(") + 1
    for parameter in signature.parameters:
        text = str(parameter)
        start = label.index(text, position)
        places.append((start, start + len(text)))
        position = start + len(text)
    active: int | None = None
    if name is not None:
        active = next((at for at, each in enumerate(signature.parameters) if each.name == name), None)
        if active is None:
            active = next((at for at, each in enumerate(signature.parameters) if each.prefix == "**"), None)
    else:
        for at, parameter in enumerate(signature.parameters):
            if parameter.prefix == "*" and index >= at:
                active = at
                break
            if at == index and not parameter.keyword_only and not parameter.prefix:
                active = at
                break
    return Help(label, signature.documentation, tuple(places), active)
