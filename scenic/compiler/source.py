"""From places in bytes, as nodes and tokens have them, to spans in characters, as diagnostics have them."""

from scenic.compiler.lexer import Tokens
from scenic.language.spans import Span


class Source:
    """The lines of a text."""

    def __init__(self, tokens: Tokens) -> None:
        self._ascii = tokens.text.isascii()
        self._lines = tokens.text.split("\n")

    def span(self, place: tuple[int, int, int, int]) -> Span:
        """The span of a place; one that lies behind the end of the text is moved to the end."""
        line, column, end_line, end_column = place
        start = self._position(line, column)
        end = max(start, self._position(end_line, end_column))
        return Span(*start, *end)

    def _position(self, line: int, column: int) -> tuple[int, int]:
        if line > len(self._lines):
            return (len(self._lines), len(self._lines[-1]))
        text = self._lines[line - 1]
        if self._ascii:
            return (line, min(column, len(text)))
        return (line, len(text.encode("utf-8", "surrogatepass")[:column].decode("utf-8", "replace")))
