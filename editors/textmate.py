"""The TextMate grammar: Scenic's words where they are keywords, and Python's grammar for the rest."""

import json
from typing import Any

from scenic.ide.highlighting import PATTERNS, Category, Pattern

_SCOPES = {
    Category.STATEMENT: "keyword.control.scenic",
    Category.DEFINITION: "storage.type.scenic",
    Category.OPERATOR: "keyword.operator.word.scenic",
    Category.CONSTANT: "constant.language.scenic",
    Category.VARIABLE: "variable.language.scenic",
    Category.CLASS: "support.class.scenic",
    Category.FUNCTION: "support.function.scenic",
    Category.PROPERTY: "support.type.property-name.scenic",
    Category.DEFINED: "entity.name.type.scenic",
}


def grammar() -> str:
    """The grammar as JSON."""
    return (
        json.dumps(
            {
                "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
                "comment": "Generated from grammar/scenic.gram by editors/generate.py (make generate); do not edit.",
                "name": "Scenic",
                "scopeName": "source.scenic",
                "fileTypes": ["scenic"],
                "patterns": [*(_pattern(each) for each in PATTERNS), {"include": "source.python"}],
            },
            indent=2,
        )
        + "\n"
    )


def _pattern(pattern: Pattern) -> dict[str, Any]:
    captures = {
        str(number): {"name": _SCOPES[category]} for number, category in enumerate(pattern.categories, 1)
    }
    return {"match": pattern.regex, "captures": captures}
