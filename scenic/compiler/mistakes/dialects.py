"""Forms that other notations have and Scenic has not, as people and language models write them from memory."""

from itertools import pairwise
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import SPECIFIER_KINDS
from scenic.compiler.mistakes.situation import Situation
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.tokens import DEDENT, NEWLINE, NUMBER
from scenic.language.properties import properties_of

__all__ = [
    "bound_of_condition",
    "braces",
    "continuation",
    "duration_of_action",
    "number_between",
    "setting_of_property",
    "side_of_object",
]

_INDENTATION: Final = "    "
_OWN_SPECIFIERS: Final = {
    "heading": "facing",
    "orientation": "facing",
    "rotation": "facing",
    "position": "at",
    "location": "at",
    "pos": "at",
}
"""Properties, and words for them, that have a specifier of their own."""


def continuation(at: Situation) -> SyntaxProblem | None:
    """Explain a line of specifiers that is not indented: ``new Object at x,`` and on the next line ``with width 2``."""
    kinds, previous = at.tokens.kinds, at.first - 1
    while previous > 0 and kinds[previous] in (NEWLINE, DEDENT):
        previous -= 1
    if previous < 1 or previous == at.first - 1 or kinds[at.first] not in SPECIFIER_KINDS:
        return None
    if at.tokens.texts[previous] != ",":
        return None
    start, end = at.trials.line(previous)
    maker = any(at.tokens.texts[index] in ("new", "override") for index in range(start, end))
    if not (maker or kinds[start] in SPECIFIER_KINDS) or not at.repairs(context="specifiers"):
        return None
    line, column = at.place(at.first)[:2]
    return SyntaxProblem(
        "SC102",
        at.place(at.first, at.end),
        "this line goes on with specifiers of the line before, and is not indented",
        "indent it by four spaces",
        fix=("Indent the line", (((line, column, line, column), _INDENTATION),)),
    )


def setting_of_property(at: Situation) -> SyntaxProblem | None:
    """Explain a property that is set without `with`, or by another sign, as in ``new Object at x, width 2``, ``heading 30 deg``, ``width=2``, ``speed: 3``."""
    sign = at.found in ("=", ":")
    first = at.token - 1
    if not at.is_name(first) or at.tokens.kinds[first] in SPECIFIER_KINDS:
        return None
    if at.is_plain_name(at.token) and at.word(at.token - 2) in ("new", "override") and not sign:
        first = at.token
    makes = [index for index in range(at.first, first) if at.word(index) in ("new", "override")]
    begins = at.word(first - 1) == "," or at.word(first - 2) in ("new", "override") or first == at.first
    if not begins or not (makes or at.context() == "specifiers"):
        return None
    name = at.word(first)
    specifier = _OWN_SPECIFIERS.get(name)
    end = first + 1 if first == at.token else at.token + sign
    change = Change(first, end, ("with", name) if specifier is None else (specifier,))
    if not at.repairs(change):
        return None
    replacement = f"with {name} ..." if specifier is None else f"{specifier} ..."
    reason = f"a property is set by `with`: `{name}` is no specifier"
    if specifier is not None:
        reason = f"there is no specifier `{name}`"
    title = "insert `with`" if specifier is None else f"write `{specifier}`"
    is_known = (
        specifier is not None or name in properties_of("Object") or (name, ":") in pairwise(at.tokens.texts)
    )
    fix = (title, [change]) if is_known else None
    return at.problem("SC114", at.place(first), reason, f"write `{replacement}`", fix=fix)


_SIDES: Final = {"front": ("ahead", "of"), "back": ("behind",), "rear": ("behind",)}


def side_of_object(at: Situation) -> SyntaxProblem | None:
    """Explain a side of an object in the words of other languages, as in ``new Object in front of ego by 3``."""
    for first in range(at.token, at.first, -1):
        side = _SIDES.get(at.word(first))
        if side is None or at.word(first - 1) not in ("in", "at", "on") or at.word(first + 1) != "of":
            continue
        change = Change(first - 1, first + 2, side)
        if not at.repairs(change):
            return None
        phrase, replacement = at.words(first - 1, first + 2), " ".join(side)
        return at.problem(
            "SC114",
            at.place(first - 1, first + 2),
            f"there is no specifier `{phrase}` with a distance",
            f"write `{replacement}`",
            fix=(f"replace it by `{replacement}`", [change]),
        )
    return None


def number_between(at: Situation) -> SyntaxProblem | None:
    """Explain a range of numbers in words, as in ``(between 0 and 5, 0)``, ``random 0 to 5``."""
    first = at.token - 1
    if at.word(first) not in ("between", "random") or at.tokens.kinds[at.token] != NUMBER:
        return None
    low, joint = at.token, at.token + 1
    if at.word(joint) not in ("and", "to") or at.tokens.kinds[joint + 1] != NUMBER:
        return None
    low_text, high_text = at.word(low), at.word(joint + 1)
    change = Change(first, joint + 2, ("Range", "(", low_text, ",", high_text, ")"))
    place = at.place(first, joint + 2)
    replacement = f"Range({low_text}, {high_text})"
    return SyntaxProblem(
        "SC129",
        place,
        "a random number between two bounds is a distribution, with parentheses",
        f"write `{replacement}`",
        fix=(f"Write `{replacement}`", ((place, replacement),)) if at.repairs(change) else None,
    )


def duration_of_action(at: Situation) -> SyntaxProblem | None:
    """Explain a duration of an action, as in ``take X for 3 seconds``, ``take X until c``."""
    if at.word(at.first) != "take" or at.found not in ("for", "until", "while"):
        return None
    action = at.words(at.first + 1, at.token)
    if len(action) > 40:
        action = "..."
    return at.problem(
        "SC117",
        at.here(),
        f"`take` acts in one step of the simulation, and has no duration: no `{at.found}` can follow",
        f"take it again in each step: put `while True: take {action}` into a behavior `B`, and run it with "
        f"`do B() {'for 3 seconds' if at.found == 'for' else 'until condition'}`",
    )


def bound_of_condition(at: Situation) -> SyntaxProblem | None:
    """Explain a duration of a temporal condition, as in ``require always c for 5 seconds``, ``require eventually within 5 seconds c``."""
    first = at.word(at.first)
    temporal = any(at.word(index) in _TEMPORAL for index in range(at.first + 1, at.token))
    if first != "require" or not temporal:
        return None
    bracket = next(
        (i for i in range(at.first, at.token) if at.word(i) in _TEMPORAL and at.word(i + 1) == "["), None
    )
    if bracket is not None:
        return _no_bound(at, bracket + 1)
    word = at.found if at.found in ("for", "within", "after", "during", "in") else at.before
    if word not in ("for", "within", "after", "during", "in", "[", "until"):
        return None
    if not any(at.word(index) in ("seconds", "steps", "s", "]", "sec") for index in range(at.token, at.end)):
        return None
    place = at.token if word == at.found else at.token - 1
    return _no_bound(at, place)


_TEMPORAL: Final = frozenset({"always", "eventually", "next", "until"})


def _no_bound(at: Situation, token: int) -> SyntaxProblem:
    return at.problem(
        "SC117",
        at.place(token),
        "temporal operators have no time bound: a condition is watched as long as the simulation lasts",
        "leave the bound out, and bound the simulation: `terminate after 5 seconds`; for a bound of this condition "
        "alone write a monitor that counts steps",
    )


_HEADERS: Final = frozenset(
    ["behavior", "class", "compose", "def", "elif", "else", "for", "if", "monitor", "scenario", "setup", "try", "while"]
)  # fmt: skip


def braces(at: Situation) -> SyntaxProblem | None:
    """Explain a block in braces, as in ``behavior Go() {``."""
    if at.found != "{" or at.word(at.first) not in _HEADERS:
        return None
    closer = at.end - 1
    alone = (
        at.word(closer) == "}"
        and at.tokens.lines[closer] > at.tokens.end_lines[closer - 1]
        and at.tokens.lines[at.token] < at.tokens.lines[at.token + 1]
    )
    opening = (*at.gap(at.token)[:2], *at.place(at.token)[2:])
    end = at.gap(closer)[:2]
    return SyntaxProblem(
        "SC129",
        at.place(at.token),
        "a block begins with `:` and is indented; braces make dictionaries and sets",
        "write `:` for `{`, and leave `}` out",
        fix=("Write `:`, and remove the braces", ((opening, ":"), ((*end, *at.place(closer)[2:]), "")))
        if alone
        else None,
    )
