"""Operands that need parentheses, and temporal operators where they have no meaning."""

from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.mistakes.situation import Situation, insertion
from scenic.compiler.phrases import PREFIX_STARTS, TEMPORAL_FORMS
from scenic.compiler.precedence import FORMS, LADDERS, Fixity, Ladder, Slot

__all__ = [
    "after_degrees",
    "chained_temporal",
    "loose_operand",
    "loose_prefix_operator",
    "temporal_after_operand",
    "temporal_elsewhere",
    "temporal_operand",
]

_TIGHT_OPERATORS: Final = frozenset(
    form.words[-1]
    for form in FORMS
    if form.ladder is Ladder.ORDINARY
    and isinstance(form.parts[-1], Slot)
    and form.parts[-1].level > LADDERS[Ladder.ORDINARY]["prefix"]
    and form.node in ("BinOp", "UnaryOp", "Operation")
)
"""The operators whose last operand cannot be a prefix operator of Scenic."""

_LOOSER: Final = frozenset(
    [
        ",",
        ")",
        "]",
        "}",
        ":",
        ";",
        "=",
        "==",
        "!=",
        "<",
        "<=",
        ">",
        ">=",
        "and",
        "or",
        "if",
        "else",
        "for",
        "in",
        "is",
        "not",
        "as",
        "seconds",
        "steps",
        "relative",
        "offset",
        "can",
        "visible",
        "intersects",
        "|",
        "^",
        "&",
        "implies",
        "until",
    ]
)
"""Tokens that end the operand of a prefix operator."""

_TEMPORAL: Final = tuple(form.words[0] for form in TEMPORAL_FORMS if form.fixity is Fixity.PREFIX)


def loose_prefix_operator(at: Situation) -> SyntaxProblem | None:
    """Explain a prefix operator that is looser than the operator before it, as in ``5 + distance to a``."""
    first = at.token - 1
    follows = (at.before, at.found) in PREFIX_STARTS
    if not follows and at.before in ("follow", "visible") and at.starts_operand(at.token):
        follows = at.word(first - 1) in _TIGHT_OPERATORS
    if not follows:
        return None
    operator = at.word(first - 1)
    if operator not in _TIGHT_OPERATORS:
        return None
    changes = [insertion(first, "("), insertion(_end_of_operand(at), ")")]
    phrase = f"{at.before} {at.found}" if at.before not in ("follow", "visible") else at.before
    return at.problem(
        "SC125",
        at.place(first, at.token + 1) if phrase != at.before else at.place(first),
        f"`{phrase}` is looser than the `{operator}` before it",
        f"put parentheses around `{phrase} ...`",
        fix=("add parentheses", changes),
    )


def _end_of_operand(at: Situation) -> int:
    """Return the end of the expression before the mistake: a looser operator, a closing bracket, or the end of the line."""
    depth = 0
    follows = at.before == "follow"
    for index in range(at.token + 1, at.end):
        word = at.word(index)
        if word in ("(", "[", "{"):
            depth += 1
        elif depth and word in (")", "]", "}"):
            depth -= 1
        elif word == "for" and follows:
            follows = False
        elif not depth and word in _LOOSER:
            return index
    return at.end


def loose_operand(at: Situation) -> SyntaxProblem | None:
    """Explain an operand that is looser than the operator before it, as in ``a + not b``, ``x == lambda: 3``, ``1 + yield x``."""
    if at.before == "not" and at.expects("visible") and at.starts_operand(at.token):
        # The operator `not visible` could have stood here.
        first = at.token - 1
        changes = [insertion(first, "("), insertion(_end_of_operand(at), ")")]
        operator = at.word(first - 1)
        if not at.repairs(*changes):
            return None
        return at.problem(
            "SC125",
            at.place(first),
            f"`not` is looser than the `{operator}` before it",
            "put parentheses around `not ...`",
            fix=("add parentheses", changes),
        )
    if at.found not in ("not", "lambda", "yield") or not at.expects("an expression"):
        return None
    changes = [insertion(at.token, "("), insertion(_end_of_operand(at), ")")]
    wide = [insertion(at.token, "("), insertion(at.end - (at.word(at.end - 1) == ":"), ")")]
    if at.found != "not":
        changes = wide
    if not at.repairs(*changes):
        return None
    what = f"`{at.found}` is looser than the `{at.before}` before it"
    return at.problem(
        "SC125",
        at.here(),
        what,
        f"put parentheses around `{at.found} ...`",
        fix=("add parentheses", changes),
    )


def after_degrees(at: Situation) -> SyntaxProblem | None:
    """Explain an operator after `deg` that is tighter than it, as in ``a deg ** 2``, ``a deg.x``."""
    if at.before != "deg" or at.found not in ("**", ".", "(", "[") or at.token - 2 < at.first:
        return None
    operand = at.token - 2
    changes = [insertion(operand, "("), insertion(at.token, ")")]
    return at.problem(
        "SC125",
        at.here(),
        f"`{at.found}` is tighter than the `deg` before it",
        f"put parentheses around `{at.word(operand)} deg`",
        fix=("add parentheses", changes),
    )


# Temporal operators.


def _requirement(at: Situation) -> bool:
    return at.word(at.first) == "require"


def temporal_elsewhere(at: Situation) -> SyntaxProblem | None:
    """Explain a temporal operator outside a requirement, as in ``x = always y``, ``if a until b:``."""
    if _requirement(at):
        return None
    if at.before in _TEMPORAL and at.starts_operand(at.token):
        word, place = at.before, at.place(at.token - 1)
        if (
            not at.helps(insertion(at.token, "("))
            and at.word(at.token - 2) not in _CONTEXT
            and at.token > at.first + 1
        ):
            return None
    elif at.found in ("until", "implies") and at.expects("and") and at.word(at.first) not in ("do", "wait"):
        word, place = at.found, at.here()
    else:
        return None
    return at.problem(
        "SC117",
        place,
        f"the temporal operator `{word}` can stand only in the condition of `require`",
        f"write `require {'... ' if word in ('until', 'implies') else ''}{word} ...`",
    )


_CONTEXT: Final = frozenset(
    ["=", "==", "and", "or", "not", "if", "when", "(", ",", ":", "while", "return", "assert", "in"]
) | {""}


def chained_temporal(at: Situation) -> SyntaxProblem | None:
    """Explain a temporal operator with three operands, as in ``require a until b until c``."""
    if not _requirement(at) or at.found not in ("until", "implies"):
        return None
    earlier = [index for index in range(at.first, at.token) if at.word(index) == at.found]
    if not earlier:
        return None
    labels = ((at.place(earlier[-1]), f"this `{at.found}` has its operands"),)
    return at.problem(
        "SC117",
        at.here(),
        f"`{at.found}` takes exactly two operands",
        "put parentheses around two of them",
        labels=labels,
    )


def temporal_after_operand(at: Situation) -> SyntaxProblem | None:
    """Explain a missing operator before a temporal one, as in ``require a always b``."""
    if not _requirement(at) or at.found not in _TEMPORAL or not at.helps(insertion(at.token, "and")):
        return None
    return at.problem(
        "SC117",
        at.here(),
        f"an operator is missing before `{at.found}`",
        f"join the conditions with `and`, `or`, `implies` or `until`: `{at.before} implies {at.found} ...`",
    )


def temporal_operand(at: Situation) -> SyntaxProblem | None:
    """Explain a temporal operator where an ordinary expression has to stand, as in ``require 3 < always x``."""
    if not _requirement(at):
        return None
    if at.before in _TEMPORAL and at.starts_operand(at.token):
        word, place, operator = at.before, at.place(at.token - 1), at.word(at.token - 2)
    elif at.found in ("until", "implies") and at.opener(at.token) is not None:
        word, place, operator = at.found, at.here(), "("
    else:
        return None
    if operator in ("(", "[", "{", ",", "if", "else", ":"):
        message = f"the temporal operator `{word}` cannot be part of an ordinary expression"
    else:
        message = f"the temporal operator `{word}` cannot be an operand of `{operator}`"
    return at.problem(
        "SC117",
        place,
        message,
        "temporal operators join conditions only with `and`, `or`, `not` and each other",
    )
