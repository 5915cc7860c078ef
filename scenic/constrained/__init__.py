"""Grammars for constrained decoding: which texts a language model may write.

They are made of the rules of the parser, without ordered choice (`scenic.constrained.grammar_rules`), with the blanks and line
ends between tokens (`scenic.constrained.layout`), in the notations of the engines (`scenic.constrained.writing`).
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from types import MappingProxyType
from typing import Any, Final

from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.syntax import Choice, Item, ListOf, Many, Optional, Row, RuleReference, TokenKind, Word
from scenic.constrained.grammar_rules import read_rules
from scenic.constrained.layout import Laid, lay_out
from scenic.constrained.terminals import TokenDefinitions, tokens
from scenic.constrained.worlds import read_world, restricted, restricted_tokens, worlds
from scenic.constrained.writing import write_ebnf, write_gbnf, write_lark

__all__ = ["FORMATS", "grammar_text", "worlds"]

_START: Final = "file"

_WRITERS: Final[Mapping[str, Callable[[Laid, TokenDefinitions], str]]] = MappingProxyType(
    {"lark": write_lark, "gbnf": write_gbnf, "ebnf": write_ebnf}
)

FORMATS: Final = (*_WRITERS, "json")
"""The notations: Lark for llguidance, GBNF for llama.cpp, EBNF for xgrammar, and the rules as data."""


def grammar_text(notation: str, world: str | None = None) -> str:
    """Return the grammar in one of `FORMATS`, of all programs or of those for one of `worlds`.

    Raises `KeyError` for others. Lark, GBNF and EBNF describe texts with four blanks for each of at most eight levels of
    indentation; in JSON the rules consist of tokens, and the layout is left to the reader.
    """
    rules, kinds = read_rules(), tokens()
    place = None if world is None else read_world(world)
    if place is not None:
        rules, kinds = restricted(rules, place), restricted_tokens(place)
    if notation == "json":
        data = {
            "start": _START,
            "keywords": sorted(HARD_KEYWORDS),
            "world": None if place is None else asdict(place),
            "rules": {name: [_row_data(row) for row in rows] for name, rows in rules.items()},
        }
        return json.dumps(data, indent=1) + "\n"
    return _WRITERS[notation](lay_out(rules, _START), kinds)


def _row_data(row: Row) -> list[dict[str, Any]]:
    return [_item_data(item) for item in row]


def _item_data(item: Item) -> dict[str, Any]:
    match item:
        case Word():
            return {"word": item.text}
        case TokenKind():
            return {"kind": item.name}
        case RuleReference():
            return {"rule": item.rule}
        case Optional():
            return {"optional": _row_data(item.row)}
        case Many():
            return {"many": _row_data(item.row)}
        case ListOf():
            return {"list": _row_data(item.row), "separator": _row_data(item.separator)}
        case Choice():
            return {"choice": [_row_data(row) for row in item.rows]}
