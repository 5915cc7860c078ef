"""Places in a source text."""

from scenic.dataclass import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A stretch of source text, end exclusive.

    Lines count from 1 and columns from 0, in characters (code points, not UTF-8 bytes as in ``ast``).
    """

    line: int
    column: int
    end_line: int
    end_column: int

    def __post_init__(self) -> None:
        if self.line < 1 or self.column < 0 or (self.end_line, self.end_column) < (self.line, self.column):
            raise ValueError(f"not a span: {self.line}:{self.column}-{self.end_line}:{self.end_column}")

    def contains(self, other: "Span") -> bool:
        """Return whether ``other`` lies within this span."""
        return (self.line, self.column) <= (other.line, other.column) and (
            other.end_line,
            other.end_column,
        ) <= (self.end_line, self.end_column)
