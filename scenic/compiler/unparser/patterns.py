"""The text of the patterns of `match`."""

import ast
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler.unparser.errors import UnparseError
from scenic.compiler.unparser.expressions import WRITERS, ExpressionWriter
from scenic.compiler.unparser.places import YIELD

_WHOLE: Final = 0
_ALTERNATIVES: Final = 1
_CLOSED: Final = 2


class PatternWriter(ExpressionWriter):
    """Writes patterns. The levels are: everything, what can stand before `as`, what can stand between `|`."""

    __slots__ = ()

    def top_pattern(self, node: ast.pattern) -> str:
        """The pattern of a `case`, where a sequence needs no brackets."""
        if isinstance(node, ast.MatchSequence) and node.patterns:
            text = self.patterns(node.patterns)
            return f"{text}," if len(node.patterns) == 1 else text
        return self.pattern(node, _WHOLE)

    def patterns(self, nodes: Sequence[ast.pattern]) -> str:
        """Patterns with commas in between."""
        return ", ".join([self.pattern(node, _WHOLE) for node in nodes])

    def pattern(self, node: ast.pattern, level: int) -> str:
        """A pattern, in parentheses if it is looser than ``level``."""
        writer = _PATTERNS.get(node.__class__)
        if writer is None:
            raise UnparseError(f"a `{type(node).__name__}` has no text as a pattern", node)
        return writer(self, node, level)

    def value(self, node: ast.expr) -> str:
        """The value of a pattern or the key of a mapping, which never are in parentheses."""
        return WRITERS[node.__class__](self, node, YIELD, "", "", 0)

    def match_value(self, node: ast.MatchValue, level: int) -> str:
        return self.value(node.value)

    def match_singleton(self, node: ast.MatchSingleton, level: int) -> str:
        return repr(node.value)

    def match_sequence(self, node: ast.MatchSequence, level: int) -> str:
        return f"[{self.patterns(node.patterns)}]"

    def match_star(self, node: ast.MatchStar, level: int) -> str:
        return f"*{node.name or '_'}"

    def match_mapping(self, node: ast.MatchMapping, level: int) -> str:
        items = [
            f"{self.value(key)}: {self.pattern(pattern, _WHOLE)}"
            for key, pattern in zip(node.keys, node.patterns, strict=True)
        ]
        if node.rest is not None:
            items.append(f"**{node.rest}")
        return f"{{{', '.join(items)}}}"

    def match_class(self, node: ast.MatchClass, level: int) -> str:
        items = [self.pattern(pattern, _WHOLE) for pattern in node.patterns]
        items += [
            f"{name}={self.pattern(pattern, _WHOLE)}"
            for name, pattern in zip(node.kwd_attrs, node.kwd_patterns, strict=True)
        ]
        return f"{self.value(node.cls)}({', '.join(items)})"

    def match_as(self, node: ast.MatchAs, level: int) -> str:
        if node.pattern is None:
            return node.name or "_"
        text = f"{self.pattern(node.pattern, _ALTERNATIVES)} as {node.name}"
        return f"({text})" if level > _WHOLE else text

    def match_or(self, node: ast.MatchOr, level: int) -> str:
        text = " | ".join([self.pattern(pattern, _CLOSED) for pattern in node.patterns])
        return f"({text})" if level > _ALTERNATIVES else text


_PATTERNS: Final[Mapping[type[ast.AST], Callable[[PatternWriter, Any, int], str]]] = MappingProxyType(
    {
        ast.MatchAs: PatternWriter.match_as,
        ast.MatchClass: PatternWriter.match_class,
        ast.MatchMapping: PatternWriter.match_mapping,
        ast.MatchOr: PatternWriter.match_or,
        ast.MatchSequence: PatternWriter.match_sequence,
        ast.MatchSingleton: PatternWriter.match_singleton,
        ast.MatchStar: PatternWriter.match_star,
        ast.MatchValue: PatternWriter.match_value,
    }
)
