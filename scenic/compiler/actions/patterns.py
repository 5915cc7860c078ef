"""Actions of the patterns of `match`."""

import ast
from collections.abc import Sequence
from typing import Any, Final

from scenic.compiler.actions.common import CommonActions, Place, make, place_of

_UNNAMED: Final = "`_` stands for any value and is no name: leave out `as _`"
_NO_REST: Final = "leave out `**_`: other keys than those named are allowed anyway"


class PatternActions(CommonActions):
    """Patterns whose parts need a check."""

    def capture(self, index: int) -> str | None:
        text = self._texts[index]
        return None if text == "_" else text

    def capturable(self, index: int) -> bool:
        if self._texts[index] == "_":
            self.fail(self.place_of_token(index), "`_` cannot be the name of a pattern", help=_UNNAMED)
            return False
        return True

    def rest_name(self, index: int) -> bool:
        if self._texts[index] == "_":
            self.fail(self.place_of_token(index), "`_` cannot be the name of the rest", help=_NO_REST)
            return False
        return True

    def pattern_string(self, node: ast.expr) -> bool:
        if isinstance(node, ast.JoinedStr):
            self.fail(place_of(node), "an f-string cannot be a pattern")
            return False
        return True

    def is_complex(self, real: Any, imaginary: Any) -> bool:
        while isinstance(real, ast.UnaryOp):
            real = real.operand
        if isinstance(real.value, complex):
            self.fail(place_of(real), "a real number has to stand before the imaginary one")
            return False
        if not isinstance(imaginary.value, complex):
            self.fail(place_of(imaginary), "an imaginary number has to stand here")
            return False
        return True

    def not_starred_pattern(self, node: ast.pattern) -> ast.pattern | None:
        if isinstance(node, ast.MatchStar):
            self.fail(place_of(node), "a starred pattern has to be part of a sequence", help="add a comma")
            return None
        return node

    def class_pattern(
        self, cls: ast.expr, items: Sequence[Any] | None, place: Place
    ) -> ast.MatchClass | None:
        names: list[str] = []
        patterns: list[ast.pattern] = []
        keyword_patterns: list[ast.pattern] = []
        for name, pattern in items or ():
            if name is not None:
                names.append(name)
                keyword_patterns.append(pattern)
            elif names:
                self.fail(place_of(pattern), "a positional pattern cannot follow a keyword pattern")
                return None
            else:
                patterns.append(pattern)
        return make(
            ast.MatchClass,
            place,
            cls=cls,
            patterns=patterns,
            kwd_attrs=names,
            kwd_patterns=keyword_patterns,
        )

    def mapping_pattern(self, items: Sequence[Any], place: Place) -> ast.MatchMapping | None:
        rest = None
        keys: list[ast.expr] = []
        patterns: list[ast.pattern] = []
        for position, (key, pattern) in enumerate(items, start=1):
            if key is not None:
                keys.append(key)
                patterns.append(pattern)
            elif position < len(items):
                self.fail(self.place_of_token(pattern), "the rest, with `**`, has to stand last")
                return None
            else:
                rest = self._texts[pattern]
        return make(ast.MatchMapping, place, keys=keys, patterns=patterns, rest=rest)
