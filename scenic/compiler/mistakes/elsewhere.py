"""Forms of other languages."""

from collections.abc import Sequence
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.mistakes.situation import Situation
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.tokens import NUMBER

__all__ = [
    "OTHER_WORDS",
    "block_comment",
    "comment",
    "declaration",
    "else_if",
    "first_word",
    "import_from",
    "increment",
    "operator",
    "unit",
]

_PAIRS: Final = {
    ("&", "&"): "and",
    ("|", "|"): "or",
    ("=", ">"): ">=",
    ("=", "<"): "<=",
    ("==", "="): "==",
    ("!=", "="): "!=",
    ("<", ">"): "!=",
}
"""Operators of other languages, as they are read here, and what they are here."""

_FIRST_WORDS: Final = {
    "function": ("def",),
    "func": ("def",),
    "fn": ("def",),
    "fun": ("def",),
    "sub": ("def",),
    "define": ("def",),
    "switch": ("match",),
    "select": ("match",),
    "foreach": ("for",),
    "catch": ("except",),
    "throw": ("raise",),
    "using": ("with", "import"),
    "include": ("import",),
    "unless": ("if", "not"),
    "loop": ("while",),
    "struct": ("class",),
    "agent": ("class",),
}
"""The first words of statements of other languages, and those of ours that mean the same."""

OTHER_WORDS: Final = frozenset(_FIRST_WORDS)
"""The first words of statements of other languages, which are not misspelt words of Scenic."""

_TYPES: Final = frozenset(
    ("var", "let", "const", "auto", "int", "float", "double", "string", "bool", "str", "def")
)


def else_if(at: Situation) -> SyntaxProblem | None:
    """Explain `else if` instead of `elif`, as in ``else if x:``."""
    if at.found != "if" or at.before != "else":
        return None
    change = Change(at.token - 1, at.token + 1, ("elif",))
    return at.problem(
        "SC129",
        at.place(at.token - 1, at.token + 1),
        "a further condition is introduced by `elif`, not by `else if`",
        "write `elif`",
        fix=("replace `else if` by `elif`", [change]),
    )


def operator(at: Situation) -> SyntaxProblem | None:
    """Explain an operator of another language, as in ``a && b``, ``a => b``, ``a === b``."""
    for first in (at.token - 1, at.token):
        replacement = _PAIRS.get((at.word(first), at.word(first + 1)))
        if replacement is None or not at.adjacent(first):
            continue
        change = Change(first, first + 2, (replacement,))
        if not at.helps(change):
            continue
        symbol = at.word(first) + at.word(first + 1)
        return at.problem(
            "SC129",
            at.place(first, first + 2),
            f"there is no operator `{symbol}`",
            f"write `{replacement}`",
            fix=(f"replace `{symbol}` by `{replacement}`", [change]),
        )
    return None


_UNITS: Final = {
    **dict.fromkeys(("km", "m", "cm", "mm", "ft", "meters", "metres"), "lengths are in metres"),
    **dict.fromkeys(("km/h", "kmh", "kph", "mph", "mps", "m/s"), "speeds are in metres per second"),
    **dict.fromkeys(("rad", "radian", "radians"), "angles are in radians, or written `30 deg`"),
    "kg": "masses are in kilograms",
}
"""Explanations of units that somebody may write after a number."""


def unit(at: Situation) -> SyntaxProblem | None:
    """Explain a number with a unit, as in ``10 km/h``, ``3 m``."""
    if at.token == 0 or at.tokens.kinds[at.token - 1] != NUMBER or not at.is_plain_name(at.token):
        return None
    rate = f"{at.found}/{at.word(at.token + 2)}" if at.word(at.token + 1) == "/" else ""
    advice = _UNITS.get(rate) or _UNITS.get(at.found)
    if advice is None:
        return None
    return at.problem(
        "SC129",
        at.here(),
        f"numbers have no units: {advice}",
        f"convert the number, and leave `{rate or at.found}` out",
    )


def comment(at: Situation) -> SyntaxProblem | None:
    """Explain a comment that begins with `//`, as in ``x = 3 // a note``, or a line that starts with ``//``."""
    first = next((i for i in range(at.first, min(at.token, at.end - 1) + 1) if at.word(i) == "//"), None)
    if first is None or not (at.word(first + 1) or first == at.first):
        return None
    if first > at.first and not at.repairs(Change(first, at.end, ())):
        return None
    return SyntaxProblem(
        "SC129",
        at.place(first),
        "a comment begins with `#`, not with `//`",
        "write `#`",
        fix=("Write `#`", ((at.place(first), "#"),)),
    )


def block_comment(at: Situation) -> SyntaxProblem | None:
    """Explain a comment between `/*` and `*/`, as in ``x = 3 /* a note */``."""
    first = next(
        (
            index
            for index in range(at.first, min(at.token, at.end - 1) + 1)
            if at.word(index) == "/" and at.word(index + 1) in ("*", "**") and at.adjacent(index)
        ),
        None,
    )
    if first is None or (first > at.first and not at.repairs(Change(first, at.end, ()))):
        return None
    is_closed = at.word(at.end - 1) == "/" and at.word(at.end - 2) in ("*", "**")
    opening = (*at.place(first)[:2], *at.place(first + 1)[2:])
    closing = (*at.gap(at.end - 2)[:2], *at.place(at.end - 1)[2:])
    return SyntaxProblem(
        "SC129",
        opening,
        "a comment begins with `#` and ends with its line; `/*` begins none",
        "write `#`, and leave `*/` out",
        fix=("Write `#`", ((opening, "#"), (closing, ""))) if is_closed else None,
    )


def increment(at: Situation) -> SyntaxProblem | None:
    """Explain an operator that increments, as in ``x++``."""
    first = at.token - 2
    mark = at.before
    if not at.at_end() or mark not in ("+", "-") or at.word(first) != mark or not at.adjacent(first):
        return None
    change = Change(first, at.token, (f"{mark}=", "1"))
    return at.problem(
        "SC129",
        at.place(first, at.token),
        f"there is no operator `{mark}{mark}`",
        f"write `{at.words(at.first, first)} {mark}= 1`",
        fix=(f"replace it by `{mark}= 1`", [change]),
    )


def first_word(at: Situation) -> SyntaxProblem | None:
    """Explain a statement that begins with a word of another language, as in ``function f():``, ``switch x:``, ``throw E()``."""
    word = at.word(at.first)
    keywords = _FIRST_WORDS.get(word.lower())
    if keywords is None or at.token > at.first + 2:
        return None
    choices: Sequence[tuple[str, ...]] = [keywords] if word == "unless" else [(each,) for each in keywords]
    for words in choices:
        change = Change(at.first, at.first + 1, words)
        if at.repairs(change) or (at.word(at.end - 1) == ":" and at.repairs(change, context="block")):
            replacement = " ".join(words)
            return at.problem(
                "SC129",
                at.place(at.first),
                f"there is no statement `{word}`",
                f"write `{replacement}`",
                fix=(f"replace it by `{replacement}`", [change]),
            )
    return None


def declaration(at: Situation) -> SyntaxProblem | None:
    """Explain a declaration of a variable with its type, as in ``var x = 3``, ``float y = 2``."""
    declares = at.token == at.first + 1 and at.word(at.token + 1) == "="
    if at.word(at.first) not in _TYPES or not (declares or at.found == "="):
        return None
    change = Change(at.first, at.first + 1, ())
    if not at.repairs(change):
        return None
    name = at.word(at.first + 1)
    return at.problem(
        "SC129",
        at.place(at.first),
        "variables are not declared: assigning one makes it",
        f"write `{name} = ...`",
        fix=(f"remove `{at.word(at.first)}`", [change]),
    )


def import_from(at: Situation) -> SyntaxProblem | None:
    """Explain an import with the module at its end, as in ``import x from y``."""
    if at.word(at.first) != "import" or at.found != "from":
        return None
    names, module = at.words(at.first + 1, at.token), at.words(at.token + 1, at.end)
    changes = [
        Change(at.first, at.first + 1, ("from", *module.split(), "import")),
        Change(at.token, at.end, ()),
    ]
    return at.problem(
        "SC116",
        at.here(),
        "the module has to stand before the names that are imported from it",
        f"write `from {module} import {names}`",
        fix=("put the module first", changes) if module.isidentifier() else None,
    )
