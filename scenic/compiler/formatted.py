"""The nodes of f-strings, and of strings that stand side by side.

The parser hands over the tokens in order: an index for a plain string or for the literal text within an f-string, a
list of nodes for a replacement field, and a triple (start, parts, end) for an f-string.
"""

import ast
import sys
from collections.abc import Iterable, Sequence
from typing import Any, Protocol

from scenic.compiler import literals
from scenic.compiler.tokens import FSTRING_END, FSTRING_START, Tokens

Place = tuple[int, int, int, int]


class Reader(Protocol):
    """The part of `scenic.compiler.actions.Actions` that is needed here."""

    def fail(self, place: Place, message: str, *, help: str | None = None, code: str = ...) -> None: ...

    def literal_problem(self, index: int, message: str) -> None: ...

    def place_of_token(self, index: int) -> Place: ...

    def string_kind(self, index: int) -> str | None: ...

    def string_value(self, index: int) -> str | bytes: ...


def joined(actions: Reader, tokens: Tokens, pieces: Sequence[Any], place: Place) -> ast.expr | None:
    """Return the node of adjacent strings, of which ``pieces`` are f-strings (triples) or plain ones (indices)."""
    plain = [piece for piece in pieces if not isinstance(piece, tuple)]
    values = {index: actions.string_value(index) for index in plain}
    has_bytes = any(isinstance(value, bytes) for value in values.values())
    if has_bytes:
        text_pieces = [piece for piece in pieces if not isinstance(values.get(_first(piece)), bytes)]
        if text_pieces:
            actions.fail(
                actions.place_of_token(_first(text_pieces[0])),
                "bytes and text cannot be joined",
                help="use one prefix",
            )
            return None
    if len(plain) == len(pieces):
        parts: Any = [values[index] for index in plain]
        node: Any = ast.Constant(
            value=b"".join(parts) if has_bytes else "".join(parts), kind=actions.string_kind(plain[0])
        )
    else:
        values_found: list[ast.expr] = []
        for piece in pieces:
            if isinstance(piece, tuple):
                start, inner, _ = piece
                raw = "r" in tokens.texts[start].lower().split(tokens.texts[start][-1])[0]
                values_found += _parts(actions, tokens, inner, raw=raw)
            else:
                values_found.append(
                    _constant(values[piece], actions.place_of_token(piece), actions.string_kind(piece))
                )
        values_of_node = _merged(values_found)
        if sys.version_info < (3, 12):
            # Here the prefix of the first string is that of all.
            kind = None if isinstance(pieces[0], tuple) else actions.string_kind(pieces[0])
            for part in values_of_node:
                if isinstance(part, ast.Constant):
                    part.kind = kind
        node = ast.JoinedStr(values=values_of_node)
    _put(node, place)
    return node  # type: ignore[no-any-return] # `node` is one of two classes of `ast`


def _first(piece: Any) -> int:
    return int(piece[0] if isinstance(piece, tuple) else piece)


def _put(node: Any, place: Place) -> None:
    node.lineno, node.col_offset, node.end_lineno, node.end_col_offset = place


def _constant(value: Any, place: Place, kind: str | None = None) -> ast.Constant:
    node = ast.Constant(value=value, kind=kind)
    _put(node, place)
    return node


def _parts(actions: Reader, tokens: Tokens, parts: Iterable[Any], *, raw: bool) -> list[ast.expr]:
    nodes: list[ast.expr] = []
    for part in parts:
        if isinstance(part, list):
            nodes += part
            continue
        text = tokens.texts[part]
        if "\\" in text and not raw:
            try:
                text = literals.decoded(text)
            except literals.LiteralError as problem:
                actions.literal_problem(part, str(problem))
        nodes.append(_constant(text, actions.place_of_token(part)))
    return nodes


def _merged(nodes: Iterable[ast.expr]) -> list[ast.expr]:
    """Join neighbouring constants, and drop empty ones."""
    result: list[ast.expr] = []
    for node in nodes:
        if isinstance(node, ast.Constant):
            if not node.value:
                continue
            last = result[-1] if result else None
            if isinstance(last, ast.Constant):
                result[-1] = _constant(
                    f"{last.value!s}{node.value!s}",
                    (last.lineno, last.col_offset, node.end_lineno or 0, node.end_col_offset or 0),
                    last.kind,
                )
                continue
        result.append(node)
    return result


def _between(tokens: Tokens, first: int, last: int) -> tuple[int, int, int, int]:
    """The place of some tokens."""
    return (tokens.lines[first], tokens.columns[first], tokens.end_lines[last], tokens.end_columns[last])


def _check_conversion(actions: Reader, tokens: Tokens, conversion: int) -> bool:
    """Report a conversion that is none, or does not follow its mark; return whether it is right."""
    mark_end = (tokens.end_lines[conversion - 1], tokens.end_columns[conversion - 1])
    if (tokens.lines[conversion], tokens.columns[conversion]) != mark_end:
        message = "the conversion of an f-string has to come right after the `!`"
        advice = "remove the space between them"
    elif tokens.texts[conversion] not in ("s", "r", "a"):
        message = f"`{tokens.texts[conversion]}` is no conversion of an f-string"
        advice = "use `!s`, `!r` or `!a`"
    else:
        return True
    actions.fail(actions.place_of_token(conversion), message, help=advice, code="SC105")
    return False


def replacement_field(
    actions: Reader,
    tokens: Tokens,
    opening: int,
    value: ast.expr,
    equals: int | None,
    conversion: int | None,
    specification: tuple[int, list[Any]] | None,
    closing: int,
) -> list[ast.expr] | None:
    """Return the nodes of ``{value=!conversion:specification}``: a constant first if it has the ``=``."""
    code = -1
    if conversion is not None:
        if not _check_conversion(actions, tokens, conversion):
            return None
        code = ord(tokens.texts[conversion])
    elif equals is not None and specification is None:
        code = ord("r")
    format_spec = None
    if specification is not None:
        colon, parts = specification
        format_spec = ast.JoinedStr(
            values=_merged(_parts(actions, tokens, parts, raw=_is_raw(tokens, opening)))
        )
        _put(format_spec, _between(tokens, colon, closing - 1))
    node = ast.FormattedValue(value=value, conversion=code, format_spec=format_spec)
    _put(node, _between(tokens, opening, closing))
    if equals is None:
        return [node]
    if conversion is not None:
        end = conversion - 1
    elif specification is not None:
        end = specification[0]
    else:
        end = closing
    place = (tokens.end_lines[opening], tokens.end_columns[opening], tokens.lines[end], tokens.columns[end])
    return [_constant(_source(tokens, place), place), node]


def _is_raw(tokens: Tokens, index: int) -> bool:
    """Return whether the f-string around the token ``index`` is raw."""
    depth = 0
    while index >= 0:
        kind = tokens.kinds[index]
        if kind == FSTRING_END:
            depth += 1
        elif kind == FSTRING_START:
            if depth == 0:
                return "r" in tokens.texts[index].lower()
            depth -= 1
        index -= 1
    return False


def _source(tokens: Tokens, place: Place) -> str:
    """The text at a place."""
    line, column, end_line, end_column = place
    lines = tokens.text.split("\n")[line - 1 : end_line]
    encoded = [each.encode("utf-8", "surrogatepass") for each in lines]
    if len(encoded) == 1:
        return encoded[0][column:end_column].decode("utf-8", "surrogatepass")
    encoded[0] = encoded[0][column:]
    encoded[-1] = encoded[-1][:end_column]
    return b"\n".join(encoded).decode("utf-8", "surrogatepass")
