"""Mistakes in what Scenic has from Python."""

from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.mistakes.situation import Situation, insertion
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.tokens import FSTRING_MIDDLE, FSTRING_START, NUMBER, STRING
from scenic.language.specifiers import SPECIFIERS

__all__ = [
    "assignment_in_condition",
    "bare_generator",
    "call_without_parentheses",
    "conditional_without_else",
    "except_of_several",
    "keyword_as_name",
    "keyword_assigned",
    "misplaced_walrus",
    "missing_comma",
    "missing_comma_of_import",
    "missing_dictionary_value",
    "missing_loop_word",
    "print_statement",
    "raise_of_two",
    "replacement_field",
    "trailing_comma",
    "two_commas",
]

_NAME_LABELS: Final = frozenset(
    {"a name", "a parameter", "a parameter's name", "the name of a module", "a type parameter"}
)
_SPECIFYING: Final = frozenset(name.split()[0] for name in SPECIFIERS)
"""Words that begin specifiers."""
_KEYWORD_KINDS: Final = frozenset(HARD_KEYWORDS.values())


# Assignments.


def assignment_in_condition(at: Situation) -> SyntaxProblem | None:
    """Explain `=` where `==` or `:` is meant, as in ``if x = 3:``, ``require a.b = 3``, ``f(a.b=3)``, ``{a = 3}``."""
    if at.found != "=" or at.expects("="):
        return None
    if at.word(at.first) in ("global", "nonlocal") and at.token > at.first + 1:
        return at.problem(
            "SC110",
            at.here(),
            f"`{at.word(at.first)}` only names variables",
            "assign to them in a statement after it",
        )
    if not at.expects("=="):
        return None
    opener = at.opener(at.token)
    bracket = at.word(opener) if opener is not None else ""
    double = [Change(at.token, at.token + 1, ("==",))]
    colon = [Change(at.token, at.token + 1, (":",))]
    if bracket == "{" and at.expects(":") and at.helps(*colon):
        return at.problem(
            "SC122",
            at.here(),
            "in a dictionary, `:` stands between a key and its value, not `=`",
            "write `key: value`",
            fix=("replace `=` by `:`", colon),
        )
    message = "`=` assigns a value and cannot stand here"
    advice = "use `==` to compare two values"
    first = at.word(at.first)
    if bracket == "(" and opener is not None and at.is_name(opener - 1):
        message = "what stands before `=` in a call has to be a plain name"
        advice = "write `name=value`, or use `==` to compare two values"
    elif first in ("if", "elif", "while", "assert", "require", "terminate", "until", "wait"):
        message = f"`=` assigns a value, but `{first}` needs a condition"
    name = [Change(at.token, at.token + 1, ("as",))]
    if first == "record" and bracket == "" and at.helps(*name):
        return at.problem(
            "SC122",
            at.here(),
            "a record is named after its value, by `as`",
            "write `record value as name`",
            fix=("replace `=` by `as`", name),
        )
    if not at.helps(*double):
        advice = "an assignment is a statement of its own"
    return at.problem("SC122", at.here(), message, advice, fix=("replace `=` by `==`", double))


def misplaced_walrus(at: Situation) -> SyntaxProblem | None:
    """Explain `:=` where it cannot stand, as in ``x := 3`` as a statement, or ``a.b := 3``."""
    if at.found != ":=":
        return None
    change = Change(at.token, at.token + 1, ("=",))
    if at.token == at.first + 1 and at.repairs(change):
        return at.problem(
            "SC110",
            at.here(),
            "`:=` assigns inside an expression; a statement assigns with `=`",
            f"write `{at.before} = ...`",
            fix=("replace `:=` by `=`", [change]),
        )
    return at.problem(
        "SC110",
        at.here(),
        "`:=` can stand only after a plain name, inside parentheses",
        "put parentheses around `name := value`",
    )


# Commas.


def missing_comma(at: Situation) -> SyntaxProblem | None:
    """Explain a missing comma in a list, as in ``[1 2]``, ``f(a b)``, ``import a b``."""
    if not at.starts_operand(at.token) or at.token == at.first:
        return None
    opener = at.opener(at.token)
    if opener is None and at.word(at.first) not in _LISTS:
        return None
    if opener is not None and at.tokens.kinds[opener - 1] in (FSTRING_START, FSTRING_MIDDLE):
        return None
    if at.before in (",", "(", "[", "{", "=", ":"):
        return None
    change = insertion(at.token, ",")
    if not at.helps(change) and not (at.is_long() and at.expects(",")):
        return None
    return at.problem(
        "SC113",
        at.here(),
        f"a comma is missing between `{at.before}` and {_shown(at)}",
        "separate them by `,`",
        fix=("insert a comma", [change]),
    )


def missing_comma_of_import(at: Situation) -> SyntaxProblem | None:
    """Explain a missing comma between imported modules, as in ``import a b``."""
    if at.word(at.first) not in ("import", "from") or not at.expects("as") or at.opener(at.token) is not None:
        return None
    if not at.is_name(at.token) or not at.repairs(insertion(at.token, ",")):
        return None
    return at.problem(
        "SC113",
        at.here(),
        f"`,` or `as` is missing between `{at.before}` and `{at.found}`",
        f"write `{at.before}, {at.found}`, or `{at.before} as {at.found}`",
    )


_LISTS: Final = frozenset({"param", "global", "nonlocal", "take", "mutate", "do", "del", "with"})


def _shown(at: Situation) -> str:
    return "the f-string" if at.tokens.kinds[at.token] == FSTRING_START else f"`{at.found}`"


def two_commas(at: Situation) -> SyntaxProblem | None:
    """Explain two commas in a row, as in ``f(a,, b)``."""
    if at.found != "," or at.before != ",":
        return None
    change = Change(at.token, at.token + 1, ())
    return at.problem(
        "SC110", at.here(), "there is a comma too many", "remove it", fix=("remove the comma", [change])
    )


def bare_generator(at: Situation) -> SyntaxProblem | None:
    """Explain a generator without parentheses beside another argument, as in ``f(x for x in y, 1)``."""
    opener = at.opener(at.token)
    if at.found != "," or opener is None or at.word(opener) != "(" or not at.expects("for"):
        return None
    first = at.token
    while first > opener + 1 and at.word(first - 1) != ",":
        first -= 1
    changes = [insertion(first, "("), insertion(at.token, ")")]
    if not any(at.word(i) == "for" for i in range(first, at.token)) or not at.repairs(*changes):
        return None
    return at.problem(
        "SC125",
        at.place(first, at.token),
        "a generator that is not the only argument needs parentheses",
        "put parentheses around it",
        fix=("add parentheses", changes),
    )


def call_without_parentheses(at: Situation) -> SyntaxProblem | None:
    """Explain a call without parentheses, as in ``x = Range 1, 2``."""
    if not at.is_plain_name(at.token - 1) or at.tokens.kinds[at.token] not in (NUMBER, STRING):
        return None
    if not at.before[:1].isupper():
        return None
    changes = [insertion(at.token, "("), insertion(at.end, ")")]
    if not at.repairs(*changes):
        return None
    return at.problem(
        "SC110",
        at.here(),
        f"what `{at.before}` is given has to stand in parentheses",
        f"write `{at.before}({at.words(at.token, at.end)})`",
        fix=("add parentheses", [Change(at.token, at.token, ("(",), tight=True), changes[1]]),
    )


def trailing_comma(at: Situation) -> SyntaxProblem | None:
    """Explain a comma that nothing follows, as in ``from m import a,``, ``param x = 1,``, ``do A(), until x``."""
    if at.before != ",":
        return None
    change = Change(at.token - 1, at.token, ())
    if not at.repairs(change):
        return None
    return at.problem(
        "SC110",
        at.place(at.token - 1),
        "something has to follow the comma",
        "remove the comma, or go on after it",
        fix=("remove the comma", [change]),
    )


def missing_dictionary_value(at: Situation) -> SyntaxProblem | None:
    """Explain a key of a dictionary without a value, as in ``{a: 1, b}``."""
    opener = at.opener(at.token)
    if opener is None or at.word(opener) != "{" or not at.expects(":") or at.found not in (",", "}"):
        return None
    return at.problem(
        "SC110",
        at.here(),
        f"the key `{at.before}` has no value",
        f"write `{at.before}: value`; every item of a dictionary is a key and a value",
    )


# Words.


def missing_loop_word(at: Situation) -> SyntaxProblem | None:
    """Explain a loop without `in`, as in ``for x y:``, ``for x of y:``."""
    if not at.expects("in") or not any(at.word(i) == "for" for i in range(at.first, at.token)):
        return None
    if at.word(at.first) not in ("for", "async") and at.opener(at.token) is None:
        return None
    targets = max(i for i in range(at.first, at.token) if at.word(i) == "for")
    words = at.words(targets, at.token)
    if at.found in ("of", "on", "from", "to", "=", ":=", ":", "at"):
        change = Change(at.token, at.token + 1, ("in",))
        message = f"`{words}` is followed by `in`, not by `{at.found}`"
        title = f"replace `{at.found}` by `in`"
    elif at.starts_operand(at.token):
        change = insertion(at.token, "in")
        message = f"`in` is missing after `{words}`"
        title = "insert `in`"
    else:
        return None
    if not at.helps(change):
        return None
    return at.problem("SC114", at.here(), message, f"write `{words} in ...`", fix=(title, [change]))


def conditional_without_else(at: Situation) -> SyntaxProblem | None:
    """Explain a conditional expression without `else`, as in ``x = a if b``."""
    if not at.expects("else") or at.found == ":":
        return None
    conditions = [i for i in range(at.first, at.token) if at.word(i) == "if"]
    if not conditions or conditions[-1] == at.first:
        return None
    if not at.at_end() and at.found not in (")", "]", "}", ",", ";"):
        return None
    place = at.place(conditions[-1])
    return at.problem(
        "SC114",
        at.here(),
        "`else` is missing: an expression with `if` needs a value for the other case",
        f"write `{at.words(conditions[-1], at.token)} else ...`",
        labels=((place, "the `if` of the expression"),),
    )


def keyword_assigned(at: Situation) -> SyntaxProblem | None:
    """Explain an assignment to a keyword, which is noticed only behind it, as in ``class = 3``, ``param at = 3``."""
    if at.found != "=" or at.tokens.kinds[at.token - 1] not in _KEYWORD_KINDS or at.expects("=="):
        return None
    if at.token - 1 != at.first and at.word(at.token - 2) not in ("param", ","):
        return None
    if at.before in ("None", "True", "False"):
        return None
    return at.problem(
        "SC119",
        at.place(at.token - 1),
        f"`{at.before}` is a keyword and cannot be a name",
        f"choose another name, such as `{at.before}_`",
    )


def keyword_as_name(at: Situation) -> SyntaxProblem | None:
    """Explain a keyword where a name has to stand, as in ``def f(at)``, ``p.to``, ``in = 3``."""
    if at.at_end() or at.tokens.kinds[at.token] not in _KEYWORD_KINDS:
        return None
    names = (
        at.expected & _NAME_LABELS
        or at.expected == {256}
        or (256 in at.expected and at.before in (".", "as"))
    )
    argument = at.expects("an argument") and at.word(at.token + 1) == "="
    target = at.expects("a target") and at.word(at.first) == "for" and at.found != "in"
    is_target = at.token == at.first == at.start and at.word(at.token + 1) == "="
    if not (names or argument or target or is_target) or (at.found == "import" and at.before == "from"):
        return None
    opener = at.opener(at.token)
    if argument and opener is not None and at.is_class_name(opener - 1) and at.found in _SPECIFYING:
        return at.problem(
            "SC135",
            at.here(),
            f"objects are made with `new` and specifiers, and `{at.found}` is a specifier",
            f"write `new {at.word(opener - 1)} {at.found} {at.words(at.token + 2, at.token + 3)}`",
        )
    return at.problem(
        "SC119",
        at.here(),
        f"`{at.found}` is a keyword and cannot be a name",
        f"choose another name, such as `{at.found}_`",
    )


# Python 2.


def print_statement(at: Situation) -> SyntaxProblem | None:
    """Explain `print` as a statement, as in ``print x``."""
    if (
        at.word(at.first) not in ("print", "exec")
        or at.token != at.first + 1
        or not at.starts_operand(at.token)
    ):
        return None
    changes = [Change(at.token, at.token, ("(",), tight=True), insertion(at.end, ")")]
    if not at.repairs(*changes):
        return None
    word = at.before
    return at.problem(
        "SC124",
        at.place(at.first),
        f"`{word}` is a function, and what it is given stands in parentheses",
        f"write `{word}({at.words(at.token, at.end)})`" if at.end - at.token < 8 else f"write `{word}(...)`",
        fix=("add parentheses", changes),
    )


def except_of_several(at: Situation) -> SyntaxProblem | None:
    """Explain several exceptions without parentheses, as in ``except A, B:``."""
    if at.word(at.first) != "except" or at.found != ",":
        return None
    stop = next((i for i in range(at.token, at.end) if at.word(i) in (":", "as")), at.end)
    changes = [insertion(at.first + 1, "("), insertion(stop, ")")]
    return at.problem(
        "SC124",
        at.here(),
        "several exceptions after `except` need parentheses",
        "write `except (A, B):`, or `except A as name:`",
        fix=("add parentheses", changes),
    )


def raise_of_two(at: Situation) -> SyntaxProblem | None:
    """Explain `raise` with two values, as in ``raise E, "message"``."""
    if at.word(at.first) != "raise" or at.found != ",":
        return None
    return at.problem(
        "SC124",
        at.here(),
        "`raise` takes one exception, to which its message belongs",
        f"write `raise {at.words(at.first + 1, at.token)}(...)`",
    )


# Strings.


def replacement_field(at: Situation) -> SyntaxProblem | None:
    """Explain a mistake in a replacement field of an f-string, as in ``f"{}"``, ``f"{a b}"``, ``f"{lambda: x}"``."""
    opener = at.opener(at.token)
    if opener is not None and at.tokens.kinds[opener - 1] in (FSTRING_START, FSTRING_MIDDLE):
        if at.tokens.kinds[at.token] == FSTRING_MIDDLE and "lambda" in (
            at.word(i) for i in range(opener, at.token)
        ):
            return at.problem(
                "SC105",
                at.place(opener + 1, at.token),
                "a lambda in a replacement field of an f-string needs parentheses",
                "put parentheses around it; the colon ends the expression otherwise",
            )
        if at.expects("}") and at.starts_operand(at.token) and at.before != "{":
            return at.problem(
                "SC105",
                at.here(),
                f"the replacement field of the f-string should end before {_shown(at)}",
                "write one expression between the braces",
            )
    if at.before != "{" or at.found not in ("}", "!", ":", "="):
        return None
    if FSTRING_START not in at.tokens.kinds[at.first : at.token]:
        return None
    if at.tokens.kinds[at.token - 2] not in (FSTRING_START, FSTRING_MIDDLE) and at.word(at.token - 2) != ":":
        return None
    return at.problem(
        "SC105",
        at.place(at.token - 1, at.token + 1),
        f"a replacement field of an f-string needs an expression before `{at.found}`",
        "write `{{}}` for braces in the text" if at.found == "}" else "write the expression",
    )
