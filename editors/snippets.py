"""Snippets for Visual Studio Code: the statements with blocks, in their declared forms.

What is written on one line, the server's completion offers where it may stand.
"""

import json
import re
from itertools import count
from typing import Any

from scenic.language.statements import STATEMENTS

_BLOCK = ": ..."
_OPERANDS = re.compile(r"\b(?:name|parameters|condition)\b")


def snippets() -> str:
    """The snippets as JSON, by the form that they write."""
    found: dict[str, Any] = {}
    for statement in STATEMENTS.values():
        for form in statement.forms:
            if form.endswith(_BLOCK):
                prefix = re.split(r"\W", form, maxsplit=1)[0]
                found[form] = {"prefix": prefix, "body": _body(form), "description": statement.documentation}
    return json.dumps(found, indent=2) + "\n"


def _body(form: str) -> list[str]:
    numbers = count(1)
    lines: list[str] = []
    depth = 0
    for clause in form.removesuffix(_BLOCK).split(_BLOCK):
        *outer, header = clause.strip().split(": ")
        for each in outer:
            lines.append("\t" * depth + _filled(each, numbers) + ":")
            depth += 1
        lines.append("\t" * depth + _filled(header, numbers) + ":")
        lines.append("\t" * (depth + 1) + f"${{{next(numbers)}:pass}}")
    return lines


def _filled(text: str, numbers: "count[int]") -> str:
    """A header with its operands as places to fill in."""
    return _OPERANDS.sub(lambda found: f"${{{next(numbers)}:{found[0]}}}", text)
