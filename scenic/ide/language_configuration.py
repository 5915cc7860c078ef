"""Behavior of an editor while one types: comments, brackets, indentation. In the terms of Visual Studio Code,
which other editors have taken over; regular expressions are JavaScript's.
"""

from typing import Any, Final

from scenic.compiler.probing import CLAUSES
from scenic.compiler.syntax import BLOCK_STARTERS
from scenic.ide.highlighting import any_of

__all__ = ["language_configuration"]

_FIRST_IN_BLOCKS: Final = frozenset({"case", "compose", "setup"})
"""Clauses that may be the first ones of a block, and so keep its indentation."""
_PAIRS: Final = (("{", "}"), ("[", "]"), ("(", ")"))


def language_configuration() -> dict[str, Any]:
    """The configuration, to be written as JSON."""
    return {
        "comments": {"lineComment": "#"},
        "brackets": [list(pair) for pair in _PAIRS],
        "autoClosingPairs": [
            *({"open": left, "close": right} for left, right in _PAIRS),
            *({"open": quote, "close": quote, "notIn": ["string", "comment"]} for quote in ('"', "'")),
        ],
        "surroundingPairs": [list(pair) for pair in (*_PAIRS, ('"', '"'), ("'", "'"))],
        "folding": {
            "offSide": True,
            "markers": {"start": r"^\s*#\s*region\b", "end": r"^\s*#\s*endregion\b"},
        },
        "wordPattern": r"[A-Za-z_\u0080-\uffff][\w\u0080-\uffff]*|\d[\w.]*",
        "indentationRules": {
            # A line that begins a block, and one that goes on with specifiers.
            "increaseIndentPattern": rf"^\s*(?:{any_of(BLOCK_STARTERS)}\b.*:|.*\bnew\b.*,)\s*(?:#.*)?$",
            "decreaseIndentPattern": rf"^\s*{any_of(CLAUSES - _FIRST_IN_BLOCKS)}\b.*:\s*(?:#.*)?$",
        },
    }
