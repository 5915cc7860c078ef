"""Mistakes in the making of objects: `new`, its class, the list of specifiers."""

from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import SPECIFIER_KINDS
from scenic.compiler.mistakes.situation import Situation, insertion
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.tokens import DEDENT, NUMBER
from scenic.language.names import NAMES, NameKind
from scenic.language.specifiers import SPECIFIERS

__all__ = [
    "another_place",
    "call_of_class",
    "comma_after_class",
    "dotted_class",
    "equals_in_specifier",
    "foreign_clause",
    "missing_class",
    "missing_comma_between_lines",
    "missing_comma_between_specifiers",
    "missing_new",
    "new_as_operand",
    "unbracketed_coordinates",
]

_MOST_CLASSES: Final = 6
"""So many names of classes before a mistake are tried with `new`."""


def _specifier_at(at: Situation, index: int) -> str:
    """Return the words that a specifier starts with."""
    words = [at.word(index)]
    for word in (at.word(index + 1), at.word(index + 2)):
        if word not in ("of", "in", "by", "along", "visible", "facing", "toward", "away", "directly"):
            break
        words.append(word)
    return " ".join(words)


def _classes(at: Situation) -> list[int]:
    """The names of classes on the line that a specifier follows directly, and no `new` precedes."""
    return [
        index
        for index in range(at.first, at.end - 1)
        if at.is_class_name(index)
        and at.word(index - 1) not in (".", "new", "class")
        and at.tokens.kinds[index + 1] in SPECIFIER_KINDS
    ]


def missing_new(at: Situation) -> SyntaxProblem | None:
    """Explain a class without `new` before it, as in ``Object facing x``, ``ego = Car with width 2``."""
    attempts = 0
    for index in range(min(at.token, at.end - 1), at.first - 1, -1):
        if not at.is_class_name(index) or at.word(index - 1) in ("new", "class"):
            continue
        if at.word(index - 1) == ".":
            problem = _dotted_without_new(at, index)
            if problem is not None:
                return problem
            continue
        follower = at.tokens.kinds[index + 1]
        if follower not in SPECIFIER_KINDS and at.word(index + 1) != ",":
            continue
        attempts += 1
        if attempts > _MOST_CLASSES:
            break
        name = at.word(index)
        changes = [insertion(index, "new")]
        if at.word(index + 1) == ",":
            # The comma would be wrong, too.
            changes.append(Change(index + 1, index + 2, ()))
            follower = at.tokens.kinds[index + 2]
            if follower not in SPECIFIER_KINDS:
                continue
        if not at.repairs(*changes) and at.repairs(*(all_of := [insertion(i, "new") for i in _classes(at)])):
            changes = all_of
        if at.repairs(*changes):
            break
        if index == at.token - 1 and at.word(index + 1) not in ("at", "in", "not", ","):
            break
    else:
        return None
    specifier = _specifier_at(at, index + 2 if at.word(index + 1) == "," else index + 1)
    return at.problem(
        "SC111",
        at.place(index),
        f"`{name}` is followed by a specifier, but `new` is missing",
        f"write `new {name} {specifier} ...`",
        fix=("insert `new`", changes),
    )


def missing_comma_between_specifiers(at: Situation) -> SyntaxProblem | None:
    """Explain a missing comma between specifiers, as in ``new Object at x facing y``."""
    if at.at_end() or at.tokens.kinds[at.token] not in SPECIFIER_KINDS or at.before == ",":
        return None
    makers = [i for i in range(at.first, at.token) if at.word(i) in ("new", "override")]
    if not makers and at.context() != "specifiers":
        return None
    if at.token - 1 in makers or (makers and makers[-1] == at.token - 2):
        return None
    change = insertion(at.token, ",")
    if not at.helps(change):
        return None
    return at.problem(
        "SC113",
        at.here(),
        f"a comma is missing before the specifier `{at.found}`",
        f"write `{at.before}, {at.found} ...`",
        fix=("insert a comma", [change]),
    )


def missing_comma_between_lines(at: Situation) -> SyntaxProblem | None:
    """Explain a line of specifiers that does not end with a comma, although another follows."""
    if at.token != at.first or at.at_end() or at.tokens.kinds[at.token] not in SPECIFIER_KINDS:
        return None
    if DEDENT not in at.expected or at.token < 2:
        return None
    place = at.gap(at.token - 1)
    return SyntaxProblem(
        "SC113",
        place,
        "a comma is missing here, since the next line goes on with specifiers",
        "end the line with `,`",
        fix=("Insert a comma", ((place, ","),)),
    )


def comma_after_class(at: Situation) -> SyntaxProblem | None:
    """Explain a comma between the class and the specifiers of one line, as in ``new Object, at x``."""
    index = at.token - 1
    while index > at.first and at.word(index) != ",":
        index -= 1
    if index < at.first + 2 or at.word(index - 2) != "new":
        return None
    change = Change(index, index + 1, ())
    if at.tokens.kinds[index + 1] not in SPECIFIER_KINDS or not at.helps(change):
        return None
    name = at.word(index - 1)
    return at.problem(
        "SC110",
        at.place(index),
        "no comma stands between the class and its first specifier",
        f"write `new {name} {at.word(index + 1)} ...`",
        fix=("remove the comma", [change]),
    )


def dotted_class(at: Situation) -> SyntaxProblem | None:
    """Explain a class after `new` with a dot in its name, as in ``new module.Class``."""
    if at.found != "." or at.word(at.token - 2) != "new" or not at.is_name(at.token + 1):
        return None
    last = at.token + 1
    while at.word(last + 1) == "." and at.is_name(last + 2):
        last += 2
    return at.problem(
        "SC110",
        at.place(at.token - 1, last + 1),
        "the class after `new` has to be a plain name",
        f"give it a name first: `{at.word(last)} = {at.words(at.token - 1, last + 1)}`, or import it with `from`",
    )


def _dotted_without_new(at: Situation, index: int) -> SyntaxProblem | None:
    """Explain a class of a module without `new`, as in ``module.Class facing x``."""
    if index != at.token - 1 or at.tokens.kinds[at.token] not in SPECIFIER_KINDS:
        return None
    first = index
    while at.word(first - 1) == "." and at.is_name(first - 2):
        first -= 2
    name = at.word(index)
    return at.problem(
        "SC111",
        at.place(first, index + 1),
        f"`{name}` is followed by a specifier, but `new` is missing",
        f"write `{name} = {at.words(first, index + 1)}`, then `new {name} {_specifier_at(at, at.token)} ...`",
    )


def missing_class(at: Situation) -> SyntaxProblem | None:
    """Explain a missing class after `new`, as in ``new at x``."""
    if at.before != "new" or not (at.at_end() or at.tokens.kinds[at.token] in SPECIFIER_KINDS):
        return None
    rest = "" if at.at_end() else f" {_specifier_at(at, at.token)} ..."
    return at.problem(
        "SC110", at.here(), "the class of the new object is missing", f"write `new Object{rest}`"
    )


def foreign_clause(at: Situation) -> SyntaxProblem | None:
    """Explain a word that the specifier before it does not take, as in ``new C at x by 3``."""
    if at.found not in ("by", "from", "for", "to", "of") or at.before == "with":
        return None
    for index in range(at.token - 1, at.first - 1, -1):
        if at.tokens.kinds[index] in SPECIFIER_KINDS and at.word(index - 1) in {"new", ","} | _classes_of_new(
            at
        ):
            break
        if at.word(index) == "new":
            return at.problem(
                "SC110",
                at.here(),
                f"no specifier starts with `{at.found}`",
                f"`{at.found}` stands at the end of one",
            )
    else:
        return None
    name = next((each for each in _NAMES if each == at.words(index, index + len(each.split()))), None)
    if name is None:
        return None
    forms = " or ".join(f"`{form}`" for form in SPECIFIERS[name].forms)
    return at.problem(
        "SC110", at.here(), f"the specifier `{name}` takes no `{at.found}` here", f"the form is {forms}"
    )


def _classes_of_new(at: Situation) -> set[str]:
    return {at.word(i + 1) for i in range(at.first, at.token) if at.word(i) == "new"}


_NAMES: Final = sorted(SPECIFIERS, key=lambda name: -len(name.split()))
"""The names of the specifiers, those of several words first."""


def call_of_class(at: Situation) -> SyntaxProblem | None:
    """Explain a class after `new` that is called, as in ``new Object(width=2)``."""
    if at.found != "(" or at.word(at.token - 2) != "new":
        return None
    name = at.before
    declaration = NAMES.get(name)
    if declaration is not None and declaration.kind is NameKind.DISTRIBUTION:
        return at.problem(
            "SC135",
            at.here(),
            "the class of an object cannot be drawn at random",
            f"draw what differs: `with shape {name}(...)`, `with category {name}(...)`",
        )
    if at.word(at.token + 1) == ")":
        fix = ("remove the parentheses", [Change(at.token, at.token + 2, ())])
        return at.problem("SC135", at.here(), "`new` takes no parentheses", f"write `new {name}`", fix=fix)
    example = f"new {name} at (1, 2), with width 3"
    if at.is_name(at.token + 1) and at.word(at.token + 2) == "=" and at.starts_operand(at.token + 3):
        example = f"new {name} with {at.word(at.token + 1)} {at.word(at.token + 3)}"
        if at.word(at.token + 4) not in (")", ","):
            example += " ..."
    return at.problem(
        "SC135",
        at.here(),
        "an object is made with specifiers, not with arguments",
        f"write `{example}`",
    )


def new_as_operand(at: Situation) -> SyntaxProblem | None:
    """Explain an operator that cannot be applied to `new`, as in ``new Object ** 2``."""
    if at.word(at.token - 2) != "new" or at.found not in ("**", "["):
        return None
    changes = [insertion(at.token - 2, "("), insertion(at.token, ")")]
    return at.problem(
        "SC125",
        at.here(),
        f"`{at.found}` cannot follow `new {at.before}` directly",
        f"put parentheses around `new {at.before}`",
        fix=("add parentheses", changes),
    )


def equals_in_specifier(at: Situation) -> SyntaxProblem | None:
    """Explain a sign between a specifier and its value, as in ``with width = 2``, ``facing: 3``."""
    if at.found not in ("=", ":"):
        return None
    first = at.token - 2 if at.word(at.token - 2) == "with" else at.token - 1
    if at.tokens.kinds[first] not in SPECIFIER_KINDS or at.word(first - 1) == ".":
        return None
    if not at.word(first - 1) and at.context() != "specifiers":
        return None
    change = Change(at.token, at.token + 1, ())
    if not at.helps(change):
        return None
    words = at.words(first, at.token)
    return at.problem(
        "SC110",
        at.here(),
        f"`{at.found}` cannot stand in a specifier",
        f"write `{words} value`",
        fix=(f"remove `{at.found}`", [change]),
    )


_PLACES: Final = {
    ("front", "of"): ("ahead", "of"),
    ("back", "of"): ("behind",),
    ("infront", "of"): ("ahead", "of"),
    ("in", "front", "of"): ("ahead", "of"),
    ("on", "top", "of"): ("on",),
    ("inside", "of"): ("in",),
    ("inside",): ("in",),
    ("within",): ("in",),
    ("upon",): ("on",),
    ("atop",): ("on",),
    ("under",): ("below",),
    ("underneath",): ("below",),
    ("beneath",): ("below",),
    ("over",): ("above",),
    ("next", "to"): ("left", "of"),
    ("close", "to"): ("left", "of"),
    ("beside",): ("left", "of"),
    ("near",): ("left", "of"),
}
"""Common phrases for places, with the specifier for each."""

_VAGUE: Final = frozenset({"next", "close", "beside", "near"})
"""The first words of those that do not say which side is meant."""


def another_place(at: Situation) -> SyntaxProblem | None:
    """Explain a place that no specifier names so, as in ``new C front of x``, ``new C next to x``."""
    for first in (at.token, at.token - 1):
        words = next(
            (each for each in _PLACES if each == tuple(at.word(first + i) for i in range(len(each)))), None
        )
        if words is not None and (
            at.word(first - 1) == "," or at.word(first - 2) == "new" or first == at.first
        ):
            break
    else:
        return None
    replacement = _PLACES[words]
    change = Change(first, first + len(words), replacement)
    if not at.helps(change):
        return None
    phrase, right = " ".join(words), " ".join(replacement)
    place = at.place(first, first + len(words))
    if words[0] in _VAGUE:
        return at.problem(
            "SC114",
            place,
            f"there is no specifier `{phrase}`, which does not say on which side",
            "write `left of`, `right of`, `ahead of` or `behind`, with `by` for the distance",
        )
    return at.problem(
        "SC114",
        place,
        f"there is no specifier `{phrase}`",
        f"write `{right}`",
        fix=(f"replace it by `{right}`", [change]),
    )


def unbracketed_coordinates(at: Situation) -> SyntaxProblem | None:
    """Explain coordinates without parentheses, as in ``new Object at 1 2``."""
    kinds = at.tokens.kinds
    if kinds[at.token] != NUMBER or kinds[at.token - 1] != NUMBER:
        return None
    if at.word(at.token - 2) not in ("at", "by", "to", "from", "toward"):
        return None
    last = at.token
    while kinds[last + 1] == NUMBER:
        last += 1
    numbers = range(at.token - 1, last + 1)
    if not at.helps(insertion(at.token, "@")) and len(numbers) != 3:
        return None
    commas = [insertion(index, ",") for index in numbers[1:]]
    changes = [insertion(at.token - 1, "("), *commas, insertion(last + 1, ")")]
    coordinates = ", ".join(at.word(index) for index in numbers)
    return at.problem(
        "SC113",
        at.here(),
        "the coordinates of a vector need parentheses and commas",
        f"write `({coordinates})`",
        fix=("write them as a vector", changes),
    )
