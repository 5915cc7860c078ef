"""Scenic for the page's editor: what to colour before the language server answers, what to do while one types."""

from typing import Any

from scenic.ide.highlighting import PATTERNS, Category, Pattern
from scenic.ide.language_configuration import language_configuration

__all__ = ["language"]

_TOKENS = {
    Category.STATEMENT: "keyword",
    Category.DEFINITION: "keyword",
    Category.OPERATOR: "keyword",
    Category.CONSTANT: "constant",
    Category.VARIABLE: "variable.predefined",
    Category.CLASS: "type",
    Category.FUNCTION: "predefined",
    Category.PROPERTY: "attribute.name",
    Category.DEFINED: "type.identifier",
}
_STRING = "[rRbBuUfF]{0,2}"


def language() -> dict[str, Any]:
    """Return the rules of Monaco's tokenizer (Monarch) and the configuration of the language, as JSON can hold them."""
    return {"tokens": _tokenizer(), "configuration": language_configuration()}


def _tokenizer() -> dict[str, Any]:
    rules: list[list[Any]] = [
        [r"#.*$", "comment"],
        *(
            [f"{_STRING}{quote * 3}", {"token": "string", "next": f"@text_{name}"}]
            for quote, name in (('"', "double"), ("'", "single"))
        ),
        [rf'{_STRING}"(?:[^"\\]|\\.)*"?', "string"],
        [rf"{_STRING}'(?:[^'\\]|\\.)*'?", "string"],
        [r"\d[\d_]*(?:\.[\d_]*)?(?:[eE][+-]?\d+)?[jJ]?", "number"],
        *(_rule(pattern) for pattern in PATTERNS if not pattern.before),
        [r"[A-Za-z_]\w*", "identifier"],
        [r"[{}()\[\]]", "@brackets"],
    ]
    texts = {
        f"text_{name}": [
            [quote * 3, {"token": "string", "next": "@pop"}],
            [rf"[^{quote}\\]+|\\.|{quote}", "string"],
        ]
        for quote, name in (('"', "double"), ("'", "single"))
    }
    return {"defaultToken": "", "tokenizer": {"root": rules, **texts}}


def _rule(pattern: Pattern) -> list[Any]:
    """A pattern, with a group for each of its pieces."""
    regex = "".join(f"({piece})" for piece, _ in pattern.pieces) + pattern.after
    actions = [_TOKENS[category] if category else "" for _, category in pattern.pieces]
    return [("^" if pattern.is_line_start else "") + regex, actions if len(actions) > 1 else actions[0]]
