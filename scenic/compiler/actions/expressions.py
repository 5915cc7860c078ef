"""Actions of calls, subscripts and literals."""

import ast
from collections.abc import Sequence
from typing import Any

from scenic.compiler import formatted, literals
from scenic.compiler.actions.common import LOAD, CommonActions, Place, make, place_of


class ExpressionActions(CommonActions):
    """Expressions whose parts need a check."""

    def is_direction(self, side: int) -> bool:
        """Return whether the token ``left`` or ``right`` is not the end of ``front left of`` and the like."""
        words = self._tokens.texts
        before = words[side - 1]
        if words[side - 2 : side - 1] == ["."]:
            return True  # an attribute of that name
        if before in ("front", "back"):
            self.fail(
                (*self.place_of_token(side - 1)[:2], *self.place_of_token(side)[2:]),
                f"`{before} {words[side]} of` cannot follow an operator that is tighter",
                help=f"put parentheses around `{before} {words[side]} of ...`",
                code="SC125",
            )
            return False
        if before in ("top", "bottom"):
            self.fail(
                (*self.place_of_token(side - 1)[:2], *self.place_of_token(side)[2:]),
                f"there is no operator `{before} {words[side]} of`: it does not say whether front or back",
                help=f"write `{before} front {words[side]} of` or `{before} back {words[side]} of`",
                code="SC114",
            )
            return False
        return True

    def arguments(self, items: Sequence[Any]) -> tuple[list[Any], list[Any], Any] | None:
        """Split what a call is given into positional and keyword arguments, and check the order."""
        for item in items:
            kind = type(item)
            if kind is ast.keyword or kind is tuple:
                break
        else:
            return (items, [], None)  # type: ignore[return-value] # the parser gives lists; a copy would cost every call
        if kind is tuple and len(items) == 1:
            return ([items[0][0]], [], items[0][0])
        positional: list[Any] = []
        keywords: list[Any] = []
        has_unpacking = False
        for item in items:
            kind = type(item)
            if kind is ast.keyword:
                keywords.append(item)
                has_unpacking = has_unpacking or item.arg is None
            elif kind is tuple:
                self.fail(
                    place_of(item[0]),
                    "a generator that is not the only argument needs parentheses",
                    help="put parentheses around it",
                    code="SC125",
                )
                return None
            elif has_unpacking and kind is ast.Starred:
                self.fail(
                    place_of(item),
                    "an argument with `*` cannot follow one with `**`",
                    help="move it to the front",
                    code="SC126",
                )
                return None
            elif keywords and kind is not ast.Starred:
                after = "an argument with `**`" if has_unpacking else "a keyword argument"
                self.fail(
                    place_of(item),
                    f"a positional argument cannot follow {after}",
                    help="move it to the front",
                    code="SC126",
                )
                return None
            else:
                positional.append(item)
        return (positional, keywords, None)

    def generator_argument(
        self, element: ast.expr, parts: list[ast.comprehension], start: int, end: int
    ) -> tuple[ast.GeneratorExp]:
        """A generator in a call, from ``start`` to ``end``; if it is all, the call's parentheses are its own."""
        tokens = self._tokens
        place = (
            tokens.lines[start - 1],
            tokens.columns[start - 1],
            tokens.end_lines[end + 1],
            tokens.end_columns[end + 1],
        )
        return (make(ast.GeneratorExp, place, elt=element, generators=parts),)

    def one_subscript(self, node: ast.expr) -> ast.expr:
        """Return a lone subscript; one with a star becomes a tuple."""
        if type(node) is not ast.Starred:
            return node
        return make(ast.Tuple, place_of(node), elts=[node], ctx=LOAD)

    def not_starred(self, node: ast.expr) -> ast.expr | None:
        if isinstance(node, ast.Starred):
            self.fail(place_of(node), "a starred expression cannot stand here")
            return None
        return node

    def number_value(self, index: int) -> int | float | complex:
        text = self._texts[index]
        value = self._numbers.get(text)
        if value is not None:
            return value
        try:
            return self._numbers.setdefault(text, literals.number_value(text))
        except literals.LiteralError as problem:
            self._report(self.place_of_token(index), str(problem), code="SC104")
            return 0

    def string_value(self, index: int) -> str | bytes:
        text = self._texts[index]
        if text[0] in "\"'" and "\\" not in text and text[:3] != '"""' and text[:3] != "'''":
            return text[1:-1]
        try:
            return literals.string_value(text)
        except literals.LiteralError as problem:
            self._report(self.place_of_token(index), str(problem), code="SC105")
            return text

    def string_kind(self, index: int) -> str | None:
        return "u" if self._texts[index][0] == "u" else None

    def strings(self, pieces: Sequence[object], place: Place) -> ast.expr | None:
        """Join adjacent strings and f-strings in one node."""
        return formatted.joined(self, self._tokens, pieces, place)

    def replacement_field(
        self,
        opening: int,
        value: ast.expr,
        equals: int | None,
        conversion: int | None,
        specification: tuple[int, list[Any]] | None,
        closing: int,
    ) -> list[ast.expr] | None:
        """Return the nodes of a replacement field of an f-string."""
        return formatted.replacement_field(
            self, self._tokens, opening, value, equals, conversion, specification, closing
        )

    def literal_problem(self, index: int, message: str) -> None:
        """Report an impossible literal."""
        self._report(self.place_of_token(index), message, code="SC105")
