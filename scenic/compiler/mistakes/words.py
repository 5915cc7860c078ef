"""Words that are missing, misspelt, or in the wrong order, in what keywords make."""

from collections.abc import Iterator, Sequence
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.compiler.mistakes.elsewhere import OTHER_WORDS
from scenic.compiler.mistakes.situation import Situation, insertion
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.phrases import BEFORE_CONNECTORS, CONNECTORS
from scenic.compiler.tokens import NAME
from scenic.language.properties import properties_of
from scenic.language.spelling import distance

__all__ = [
    "SYNONYMS",
    "between",
    "kind_of_heading",
    "missing_operand",
    "missing_word",
    "misspelt",
    "needless_word",
    "negated_sight",
    "operator_without_left_side",
    "order_of_corners",
    "other_word",
    "perhaps_misspelt",
    "wrong_word",
]

_KEYWORDS: Final = {
    word: kind for table in (HARD_KEYWORDS, SOFT_KEYWORDS) for word, kind in table.items() if len(word) > 1
}

_CONNECTORS: Final = (*CONNECTORS, "when", "import", "as", "after", "until")
"""The words in the middle of forms, of which one may be forgotten: those of statements last."""

_PHRASES: Final = BEFORE_CONNECTORS | {
    "terminate", "simulation", "interrupt", "wait", "do", "for", "from", "mutate", "import", "with", "except",
}  # fmt: skip
"""The words whose forms have a connector further on."""

_CORNERS: Final = ("top", "bottom", "front", "back", "left", "right")
_CORNER_STEP: Final = {"top": 0, "bottom": 0, "front": 1, "back": 1, "left": 2, "right": 2}


# Misspelt words.


def _near(word: str) -> Iterator[str]:
    """Yield the keywords that ``word`` may have been meant to be, nearest first."""
    if word.lower() in OTHER_WORDS:
        return iter(())
    reach = max(1, len(word) // 3) if len(word) > 1 else 0
    candidates = []
    for keyword in _KEYWORDS:
        edits = distance(word.lower(), keyword.lower(), limit=reach)
        if edits <= reach and keyword != word and (len(word) > 2 or sorted(word.lower()) == sorted(keyword)):
            candidates.append((edits, keyword))
    return (keyword for _, keyword in sorted(candidates))


def _synonyms(word: str) -> Iterator[str]:
    """Yield the synonyms of a keyword in other languages and in common speech."""
    yield from SYNONYMS.get(word.lower(), ())


SYNONYMS: Final = {
    "behaviour": ("behavior",),
    "elseif": ("elif",),
    "elsif": ("elif",),
    "elsewhen": ("elif",),
    "towards": ("toward",),
    "sec": ("seconds",),
    "secs": ("seconds",),
    "second": ("seconds",),
    "s": ("seconds",),
    "step": ("steps",),
    "params": ("param",),
    "parameter": ("param",),
    "degrees": ("deg",),
    "degree": ("deg",),
    "degs": ("deg",),
    "assume": ("require",),
    "requires": ("require",),
    "infront": ("ahead",),
    "looking": ("facing",),
    "oriented": ("facing",),
    "pointing": ("facing",),
    "rotated": ("facing",),
    "nw": ("new",),
    **dict.fromkeys(("add", "create", "instantiate", "make", "place", "put", "spawn"), ("new",)),
    **dict.fromkeys(("constrain", "constraint", "demand", "enforce", "ensure", "must"), ("require",)),
    **dict.fromkeys(("execute", "perform", "run"), ("do", "take")),
    **dict.fromkeys(("pause", "sleep"), ("wait",)),
}


def misspelt(at: Situation) -> SyntaxProblem | None:
    """Explain a misspelt keyword, which alone makes the line wrong, as in ``requier x``, ``new C facng x``, ``a reltive to b``."""
    for index in (at.token, at.token - 1, at.first, at.token - 2):
        # What is a keyword already is not a misspelt one, unless it is one of those nobody would suspect.
        if not at.is_name(index) or at.word(index - 1) == ".":
            continue
        if at.tokens.kinds[index] != NAME and at.word(index) not in SYNONYMS:
            continue
        words = _parted(at.word(index))
        if words and at.repairs(Change(index, index + 1, words)):
            return _misspelt(at, index, *words)
        for keyword in (*_synonyms(at.word(index)), *_near(at.word(index))):
            change = Change(index, index + 1, (keyword,))
            context = "block" if at.word(at.end - 1) == ":" else None
            if at.repairs(change) or (context and at.repairs(change, context=context)):
                return _misspelt(at, index, keyword)
    return None


def _parted(word: str) -> tuple[str, ...]:
    """Return the two keywords that a word joins: ``leftof``, ``offset_by``."""
    for connector in CONNECTORS:
        first = word.lower().removesuffix(connector).rstrip("_")
        if word.lower().endswith(connector) and first in _KEYWORDS:
            return first, connector
    return ()


_PROPERTIES: Final = frozenset(properties_of("Object"))
"""Names that are right as they are: `width` is no misspelt `with`."""


def perhaps_misspelt(at: Situation) -> SyntaxProblem | None:
    """Explain a misspelt keyword in a line that has a further mistake."""
    for index in (at.token, at.token - 1, at.first):
        if not at.is_plain_name(index) or at.word(index - 1) == "." or len(at.word(index)) < 4:
            continue
        if at.word(index) in _PROPERTIES:
            continue
        for keyword in (*_synonyms(at.word(index)), *_near(at.word(index))):
            if at.reads([Change(index, index + 1, (keyword,))]).reached > at.token:
                return _misspelt(at, index, keyword)
    return None


def _misspelt(at: Situation, index: int, *keywords: str) -> SyntaxProblem:
    meant = " ".join(keywords)
    return at.problem(
        "SC118",
        at.place(index),
        f"unknown keyword `{at.word(index)}`",
        f"did you mean `{meant}`?",
        fix=(f"replace it by `{meant}`", [Change(index, index + 1, keywords)]),
    )


_OTHER_WORDS: Final = {
    ("facing", "at"): "toward",
    ("facing", "to"): "toward",
    ("interrupt", "if"): "when",
    ("interrupt", "while"): "when",
    ("terminate", "if"): "when",
    ("terminate", "once"): "when",
    ("simulation", "if"): "when",
}
"""Words after which another one is often written than the form has, and that one."""


def other_word(at: Situation) -> SyntaxProblem | None:
    """Explain a word that another one is mistaken for, as in ``terminate if c``, ``interrupt if c:``, ``facing at x``."""
    for index in range(at.first + 1, min(at.token, at.end - 1) + 1):
        replacement = _OTHER_WORDS.get((at.word(index - 1), at.word(index)))
        if replacement is None or (at.word(index - 1) != "facing" and index > at.first + 2):
            continue
        change = Change(index, index + 1, (replacement,))
        if at.repairs(change) or at.word(index - 1) == "interrupt":
            return at.problem(
                "SC114",
                at.place(index),
                f"`{at.word(index - 1)}` is followed by `{replacement}`, not by `{at.word(index)}`",
                f"write `{at.word(index - 1)} {replacement} ...`",
                fix=(f"replace `{at.word(index)}` by `{replacement}`", [change]),
            )
    return None


def negated_sight(at: Situation) -> SyntaxProblem | None:
    """Explain a negation inside `can see`, as in ``a can not see b``, ``a cannot see b``."""
    if at.found == "cannot" and at.word(at.token + 1) == "see":
        first, last = at.token, at.token + 1
    elif (at.before, at.found, at.word(at.token + 1)) == ("can", "not", "see"):
        first, last = at.token - 1, at.token + 1
    else:
        return None
    start = first
    while at.word(start - 1) not in ("", "require", "=", "(", ",", "and", "or", "not", "if", "when", "until"):
        start -= 1
    left, right = at.words(start, first), at.word(last + 1) or "..."
    changes = [insertion(start, "not"), Change(first, last + 1, ("can", "see"))]
    return at.problem(
        "SC114",
        at.place(first, last + 1),
        "there is no operator `can not see`: `not` stands before the whole",
        f"write `not {left} can see {right}`",
        fix=("put `not` in front", changes),
    )


# Missing words.


def missing_word(at: Situation) -> SyntaxProblem | None:
    """Explain one missing word of a form, as in ``left ego``, ``distance from a b``, ``relative heading a``."""
    if at.at_end() or not (at.starts_operand(at.token) or at.before in _PHRASES or at.found in _KEYWORDS):
        return None
    phrase = _phrase(at)
    if phrase is None:
        return None
    good = []
    for word in _CONNECTORS:
        if not at.expects(word):
            continue
        if word in ("in", "as", "import", "for", "until", "after") and not _fits(at, word):
            continue
        if at.helps(insertion(at.token, word)):
            good.append(word)
    good = [word for word in good if at.repairs(insertion(at.token, word))] or good
    if not good:
        return None
    form = at.words(phrase, at.token)
    if len(good) > 1:
        return at.problem(
            "SC114",
            at.here(),
            f"{_either(good)} is missing after `{form}`",
            f"write `{form} {good[0]} {at.found}`",
        )
    (word,) = good
    return at.problem(
        "SC114",
        at.here(),
        f"`{word}` is missing after `{form}`",
        f"write `{form} {word} {at.found}`",
        fix=(f"insert `{word}`", [insertion(at.token, word)]),
    )


def _fits(at: Situation, word: str) -> bool:
    """Return whether a word that has several uses can be meant."""
    first = at.word(at.first)
    if word == "as":
        return first in ("with", "except")
    if word == "import":
        return first == "from"
    if word == "in":
        return at.before == "contained"
    if word == "for":
        return first in ("do", "wait") or any(
            at.word(i) in ("follow", "following") for i in range(at.first, at.token)
        )
    if word in ("until", "after"):
        return first in ("wait", "terminate") and at.token == at.first + 1
    return True


def _phrase(at: Situation) -> int | None:
    """Return the first token of the form that continues at the mistake."""
    depth, position = 0, None
    for index in range(at.token - 1, at.first - 1, -1):
        word = at.word(index)
        if word in (")", "]", "}"):
            depth += 1
        elif depth:
            depth -= word in ("(", "[", "{")
        elif word in (",", "=", "(", "[", "{"):
            break
        elif word in _PHRASES:
            position = index
            # A word in the middle of a form is not its beginning.
            if word not in ("from", "for", "to", "along") and at.word(index - 1) not in _PHRASES:
                break
    return position


def wrong_word(at: Situation) -> SyntaxProblem | None:
    """Explain a small word that the form does not have, as in ``ahead from x``, ``distance of x``."""
    phrase = _phrase(at)
    if at.found not in _SMALL or phrase is None:
        return None
    changes = {
        word: Change(at.token, at.token + 1, (word,))
        for word in _CONNECTORS
        if at.expects(word) and word != at.found and (word not in ("as", "import", "in") or _fits(at, word))
    }
    good = [word for word, change in changes.items() if at.repairs(change)]
    if not good:
        return None
    form = at.words(phrase, at.token)
    # Between two operands, the word may be right and a clause may be missing before it.
    certain = len(good) == 1 and (at.before in _PHRASES or at.found in ("by", "of", "for"))
    return at.problem(
        "SC114",
        at.here(),
        f"`{form}` is followed by {_either(good)}, not by `{at.found}`",
        f"write `{form} {good[0]} ...`",
        fix=(f"replace `{at.found}` by `{good[0]}`", [changes[good[0]]]) if certain else None,
    )


_SMALL: Final = frozenset(["of", "by", "to", "from", "for", "in", "on", "at", "with", "as", "past"])


def _either(words: Sequence[str]) -> str:
    quoted = [f"`{word}`" for word in words]
    return quoted[0] if len(quoted) == 1 else ", ".join(quoted[:-1]) + f" or {quoted[-1]}"


def needless_word(at: Situation) -> SyntaxProblem | None:
    """Explain a small word that the form does not need, as in ``behind of x``, ``distance to to x``."""
    if at.found not in _SMALL or (at.tokens.kinds[at.token - 1] < NAME and at.before not in _SMALL):
        return None
    if (
        at.before not in _KEYWORDS
        or at.before == "with"
        or not at.repairs(Change(at.token, at.token + 1, ()))
    ):
        return None
    return at.problem(
        "SC110",
        at.here(),
        f"`{at.before}` is not followed by `{at.found}`",
        f"remove `{at.found}`",
        fix=(f"remove `{at.found}`", [Change(at.token, at.token + 1, ())]),
    )


def between(at: Situation) -> SyntaxProblem | None:
    """Explain `between` after `distance`, `angle` or `altitude`, as in ``distance between a and b``."""
    if at.found != "between" or at.before not in ("distance", "angle", "altitude"):
        return None
    joint = next((i for i in range(at.token + 1, at.end) if at.word(i) == "and"), None)
    changes = [Change(at.token, at.token + 1, ("from",))]
    if joint is not None:
        changes.append(Change(joint, joint + 1, ("to",)))
    return at.problem(
        "SC114",
        at.here(),
        f"`{at.before}` is followed by `from` or `to`, not by `between`",
        f"write `{at.before} from ... to ...`",
        fix=("write `from ... to`", changes),
    )


def kind_of_heading(at: Situation) -> SyntaxProblem | None:
    """Explain a heading or position without the word for its kind, as in ``heading of x``, ``relative x``, ``apparent x``."""
    if at.found == "of" and at.before in ("heading", "position"):
        kinds = ["relative", "apparent"] if at.before == "heading" else ["relative"]
        good = [kind for kind in kinds if at.helps(insertion(at.token - 1, kind))]
        if not good:
            return None
        alternatives = _either(good)
        return at.problem(
            "SC114",
            at.place(at.token - 1),
            f"{alternatives} is missing before `{at.before} of`",
            f"write `{good[0]} {at.before} of ...`, or `{at.word(at.token + 1)}.{at.before}`",
        )
    if at.before not in ("relative", "apparent") or not at.starts_operand(at.token):
        return None
    kinds = ["heading", "position"] if at.before == "relative" else ["heading"]
    good = [kind for kind in kinds if at.helps(insertion(at.token, kind, "of"))]
    if not good:
        return None
    alternatives = _either([f"{kind} of" for kind in good])
    return at.problem(
        "SC114",
        at.here(),
        f"{alternatives} is missing after `{at.before}`",
        f"write `{at.before} {good[0]} of {at.found}`",
        fix=None if len(good) > 1 else (f"insert {alternatives[1:-1]}", [insertion(at.token, good[0], "of")]),
    )


def operator_without_left_side(at: Situation) -> SyntaxProblem | None:
    """Explain an operator without its left operand, as in ``x = relative to b``, ``x = can see b``."""
    form = f"{at.before} {at.found}"
    if form not in ("relative to", "can see", "offset by", "offset along", "visible from"):
        return None
    first = at.token - 1
    if not at.repairs(insertion(first, "_")):
        return None
    return at.problem(
        "SC110",
        at.place(first, at.token + 1),
        f"something is missing before `{form}`",
        f"`{form}` stands between two values",
    )


def missing_operand(at: Situation) -> SyntaxProblem | None:
    """Explain a missing clause before a word of a form, as in ``beyond x from y``, ``follow f for 3``."""
    for opening, keyword, clause in (
        ("beyond", "by", "by distance"),
        ("follow", "from", "from position"),
        ("follow", "for", "for distance"),
        ("following", "for", "for distance"),
        ("along", "by", "by offset"),
    ):
        if not at.expects(keyword) or at.word(at.token) == keyword:
            continue
        for index in range(at.token - 2, at.first - 1, -1):
            word = at.word(index)
            if word in (",", "=") or word == keyword:
                break
            if word == opening:
                phrase = "offset along" if word == "along" else word
                where = f"before `{at.found}`" if not at.at_end() else "at the end"
                changes = [insertion(at.token, keyword, "1")]
                if not at.helps(*changes) and not at.at_end():
                    break
                return at.problem(
                    "SC114",
                    at.here(),
                    f"`{phrase}` needs `{clause}` {where}",
                    f"write `{at.words(index, at.token)} {keyword} ...`",
                )
    return None


def order_of_corners(at: Situation) -> SyntaxProblem | None:
    """Explain the words of a corner in the wrong order, as in ``top left of x``, ``left front of x``."""
    last = at.token
    while at.word(last) in _CORNERS:
        last += 1
    first = at.token
    while at.word(first - 1) in _CORNERS:
        first -= 1
    words = [at.word(index) for index in range(first, last)]
    if at.word(last) != "of" or len(words) < 2:
        return None
    phrase = " ".join(words)
    place = at.place(first, last)
    words_in_order = sorted(words, key=lambda word: _CORNER_STEP[word])
    steps = [_CORNER_STEP[word] for word in words_in_order]
    if words_in_order == words and steps in ([1, 2], [0, 1, 2]):
        return None
    if steps in ([1, 2], [0, 1, 2]):
        return at.problem(
            "SC116",
            place,
            f"there is no operator `{phrase} of`",
            f"write `{' '.join(words_in_order)} of`",
            fix=("put the words in order", [Change(first, last, tuple(words_in_order))]),
        )
    if steps == [0, 2]:
        high, side = words_in_order
        return at.problem(
            "SC114",
            place,
            f"there is no operator `{phrase} of`: it does not say whether front or back",
            f"write `{high} front {side} of` or `{high} back {side} of`",
        )
    if steps == [0, 1]:
        high, side = words_in_order
        return at.problem(
            "SC114",
            place,
            f"there is no operator `{phrase} of`: it does not say whether left or right",
            f"write `{high} {side} left of` or `{high} {side} right of`",
        )
    return at.problem("SC110", place, f"there is no operator `{phrase} of`", "name each direction once")
