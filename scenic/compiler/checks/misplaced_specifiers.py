"""Lines of specifiers that are not indented below the object that they belong to."""

import re
from typing import Final

from scenic.language.source import Source
from scenic.language.specifiers import SPECIFIERS

__all__ = ["continuation_after"]

_WORDS: Final = "|".join(sorted({name.split()[0] for name in SPECIFIERS} | {"with"}))
_SPECIFIER: Final = re.compile(rf"({_WORDS})\b(?!\s*(?:=(?!=)|[.,]|$))")


def continuation_after(source: Source, line: int) -> int | None:
    """Return the next line with text after ``line``, if it begins with a specifier and has the same indentation."""
    first = source.line(line)
    indentation = first[: len(first) - len(first.lstrip())]
    number = line + 1
    while number <= len(source.lines):
        text = source.line(number)
        if text.strip() and not text.lstrip().startswith("#"):
            indentation_here = text[: len(text) - len(text.lstrip())]
            return number if indentation_here == indentation and _SPECIFIER.match(text.lstrip()) else None
        number += 1
    return None
