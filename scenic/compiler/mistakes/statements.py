"""Mistakes in Scenic's statements and definitions: clauses, durations, guards, forms of older dialects."""

from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import SPECIFIER_KINDS
from scenic.compiler.mistakes.situation import Situation, insertion
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.mistakes.words import misspelt
from scenic.compiler.syntax import SOFT_STATEMENT_WORDS, STATEMENT_WORDS
from scenic.compiler.tokens import NUMBER, STRING
from scenic.language.spelling import nearest

__all__ = [
    "annotated_property",
    "attribute_of_property",
    "clauses_out_of_order",
    "constructor",
    "definition_without_name",
    "definition_without_parentheses",
    "initial_or_final_clause",
    "message_of_requirement",
    "missing_unit",
    "monitor_without_parentheses",
    "not_a_plain_name",
    "parts_of_scenario",
    "probability",
    "quoted_module",
    "setting_of_parameter",
    "statement_in_expression",
    "stray_specifier",
    "target_first",
]

_ORDERS: Final = {
    "record": (("every", "after", "as", "to"), "record value every 2 steps after 3 steps as name"),
    "beyond": (("by", "from"), "beyond reference by offset from viewpoint"),
    "following": (("from", "for"), "following field from start for distance"),
    "follow": (("from", "for"), "follow field from start for distance"),
    "along": (("along", "by"), "offset along direction by offset"),
}
"""The clauses of forms in their order, and how the form is written."""


_BINDING_LESS: Final = frozenset({"and", "or", "if", "implies", "until", "lambda"})
"""Operators whose operands `not` does not reach over."""


def clauses_out_of_order(at: Situation) -> SyntaxProblem | None:
    """Explain clauses of a statement in the wrong order, as in ``record x to y every 3 steps``, ``follow f for 3 from p``."""
    for index in range(at.token - 1, at.first - 1, -1):
        word = at.word(index)
        if word not in _ORDERS:
            continue
        order, form = _ORDERS[word]
        if at.found not in order:
            return None
        later = order[order.index(at.found) + 1 :]
        positions = [i for i in range(index + 1, at.token) if at.word(i) in later]
        if at.found in [at.word(i) for i in range(index + 1, at.token)]:
            message = f"`{at.found}` stands twice after `{word}`"
            return at.problem("SC116", at.here(), message, f"the form is `{form}`")
        if not positions:
            return None
        if word == "record" and at.word(at.first + 1) in ("initial", "final"):
            return None
        return at.problem(
            "SC116",
            at.here(),
            f"`{at.found}` has to stand before `{at.word(positions[0])}`",
            f"the order is `{form}`",
            labels=((at.place(positions[0]), f"`{at.word(positions[0])}` stands here"),),
        )
    return None


def initial_or_final_clause(at: Situation) -> SyntaxProblem | None:
    """Explain a clause that `record initial` and `record final` do not take, as in ``record initial x every 3 seconds``."""
    if at.word(at.first) != "record" or at.found not in ("every", "after", "to"):
        return None
    moment = at.word(at.first + 1)
    if moment not in ("initial", "final"):
        return None
    return at.problem(
        "SC116",
        at.here(),
        f"`record {moment}` takes no `{at.found}`",
        f"only `as name` can follow; remove `{at.found} ...`",
    )


def _until_or_for(at: Situation) -> SyntaxProblem | None:
    """Explain clauses of `do`, as in ``do for 3 seconds``, ``do a for 3 seconds until x``, ``do a, b until x``."""
    if at.token == at.first + 1:
        clause = "until condition" if at.found == "until" else "for 3 seconds"
        message = f"what to do has to stand before `{at.found}`"
        return at.problem("SC116", at.here(), message, f"write `do behavior() {clause}`")
    earlier = [i for i in range(at.first, at.token) if at.word(i) in ("until", "for", "choose", "shuffle")]
    if earlier and at.opener(at.token) is None:
        word = at.word(earlier[0])
        if word in ("choose", "shuffle"):
            message = f"`do {word}` takes no `{at.found}`"
            advice = f"put the choice into a behavior, and run that with `{at.found}`"
        elif word == at.found:
            return None
        else:
            message = "`do` takes either `for` or `until`, not both"
            advice = "use `try` with `interrupt when` for the other condition"
        labels = ((at.place(earlier[0]), f"`{word}` stands here"),)
        return at.problem("SC116", at.here(), message, advice, labels=labels)
    if at.found == "for":
        return None
    changes = [insertion(at.first + 1, "("), insertion(at.token, ")")]
    return at.problem(
        "SC125",
        at.place(at.first + 1, at.token),
        "what stands before `until` needs parentheses here",
        "put parentheses around what stands between `do` and `until`",
        fix=("add parentheses", changes),
    )


def _while(at: Situation) -> SyntaxProblem:
    """Explain ``do a while x``."""
    changes = [Change(at.token, at.token + 1, ("until", "not"))]
    if not _BINDING_LESS.isdisjoint(map(at.word, range(at.token, at.end))):
        # `until not a and b` would end it for other reasons.
        changes += [insertion(at.token + 1, "("), insertion(at.end, ")")]
    return at.problem(
        "SC129",
        at.here(),
        "`do` has no `while`",
        "write `until`, which ends it when the condition holds",
        fix=("replace it by `until not`", changes),
    )


def target_first(at: Situation) -> SyntaxProblem | None:
    """Explain a clause that stands before the operand of its statement, as in ``do until x``, ``do for 3 seconds``, ``mutate by 2 x``, ``terminate x when``."""
    first = at.word(at.first)
    if first == "do" and at.found in ("until", "for"):
        return _until_or_for(at)
    if first == "do" and at.found == "while":
        return _while(at)
    if first == "mutate" and at.word(at.first + 1) == "by" and at.is_name(at.token):
        return at.problem(
            "SC116",
            at.here(),
            "the names of the objects have to stand before `by`",
            f"write `mutate {at.found} by ...`",
        )
    return None


def missing_unit(at: Situation) -> SyntaxProblem | None:
    """Explain a duration without its unit, as in ``terminate after 3``, ``wait for 3 minutes``."""
    if not at.expects("seconds") or not at.expects("steps"):
        return None
    if at.at_end() or at.found in (";", "as", "to", "after", "every", ","):
        if at.before in ("seconds", "steps"):
            return at.problem(
                "SC128",
                at.place(at.token - 1),
                f"the number before `{at.before}` is missing",
                f"write `3 {at.before}`",
            )
        return at.problem(
            "SC128",
            at.here(),
            "a duration needs a unit",
            f"write `{at.before} seconds` or `{at.before} steps`",
        )
    if at.is_name(at.token):
        unit = at.found
        is_unit = unit in ("minutes", "minute", "min", "hours", "hour", "h", "ms", "milliseconds")
        if is_unit or at.token == at.end - 1:
            return at.problem(
                "SC128",
                at.here(),
                f"`{unit}` is not a unit of durations",
                "durations are in `seconds` or `steps`",
            )
    return None


def message_of_requirement(at: Situation) -> SyntaxProblem | None:
    """Explain ``require x, "message"``, which `assert` allows."""
    if at.word(at.first) != "require" or at.found != "," or at.opener(at.token) is not None:
        return None
    if at.tokens.kinds[at.token + 1] == STRING:
        return at.problem(
            "SC110",
            at.here(),
            "`require` takes no message after a comma",
            f"name the requirement: `as {at.word(at.token + 1)}`",
            fix=("replace the comma by `as`", [Change(at.token, at.token + 1, ("as",))]),
        )
    return at.problem(
        "SC110",
        at.here(),
        "`require` takes one condition",
        "join the conditions with `and`, or write two statements",
    )


def probability(at: Situation) -> SyntaxProblem | None:
    """Explain a probability of ``require[p] x`` that is not a number."""
    first = at.first
    if at.word(first) != "require":
        return None
    close = at.token - 1
    if (at.word(first + 1), at.word(close), close) == ("(", ")", first + 3) and at.tokens.kinds[
        first + 2
    ] == NUMBER:
        number = at.word(first + 2)
        changes = [Change(first + 1, first + 2, ("[",)), Change(close, close + 1, ("]",))]
        return at.problem(
            "SC110",
            at.place(first + 1, at.token),
            "the probability of a requirement stands in brackets",
            f"write `require[{number}] ...`",
            fix=("write brackets", changes),
        )
    if at.word(first + 1) != "[":
        return None
    if at.before == "]" and at.opener(at.token - 1) == first + 1:
        return at.problem(
            "SC220",
            at.place(first + 2, at.token - 1),
            "the probability of a requirement has to be a number between 0 and 1",
            "write it out, as in `require[0.5] ...`",
        )
    return None


def quoted_module(at: Situation) -> SyntaxProblem | None:
    """Explain a module in quotation marks, as in ``model 'x'``, ``import 'x'``."""
    if at.word(at.first) not in ("model", "import", "from") or at.token != at.first + 1:
        return None
    if at.tokens.kinds[at.token] != STRING:
        return None
    name = at.found.strip("'\"")
    if not all(part.isidentifier() for part in name.split(".")):
        name = ""
    return SyntaxProblem(
        "SC110",
        at.here(),
        "the name of a module is written without quotes",
        f"write `{at.before} {name or 'folder.name'}`",
        fix=("Remove the quotes", ((at.here(), name),)) if name else None,
    )


def setting_of_parameter(at: Situation) -> SyntaxProblem | None:
    """Explain a parameter that is set without `=`, as in ``param x 3``, ``param x: 3``."""
    if at.word(at.first) != "param" or not at.expects("=") or at.token < at.first + 2:
        return None
    if at.found in (":", "==", ":="):
        change = Change(at.token, at.token + 1, ("=",))
        message = f"`{at.found}` cannot set a parameter"
        title = f"replace `{at.found}` by `=`"
    else:
        change = insertion(at.token, "=")
        message = f"`=` and a value are missing after the parameter `{at.before}`"
        title = "insert `=`"
    if at.tokens.kinds[at.token - 1] < 256 and at.tokens.kinds[at.token - 1] != STRING:
        return None
    return at.problem(
        "SC110", at.here(), message, f"write `param {at.before} = value`", fix=(title, [change])
    )


def not_a_plain_name(at: Situation) -> SyntaxProblem | None:
    """Explain an expression where a plain name has to stand, as in ``mutate a.b``, ``import a as b.c``."""
    if at.found not in (".", "[", "("):
        return None
    if at.word(at.first) == "mutate" and at.opener(at.token) is None:
        return at.problem(
            "SC110",
            at.here(),
            "`mutate` takes plain names of objects",
            "give the object a name first, and write that",
        )
    if at.word(at.token - 2) == "as" and at.word(at.first) in ("import", "from"):
        return at.problem(
            "SC110",
            at.here(),
            "what is imported can only be given a plain name",
            f"write `as {at.before}`",
        )
    return None


def monitor_without_parentheses(at: Situation) -> SyntaxProblem | None:
    """Explain ``monitor M:``, which older dialects had."""
    if at.word(at.first) != "monitor" or at.found != ":" or at.token != at.first + 2:
        return None
    return at.problem(
        "SC115",
        at.here(),
        "the definition of a monitor needs parentheses",
        f"write `monitor {at.before}():`, and start it with `require monitor {at.before}()`",
        fix=("insert `()`", [insertion(at.token, "(", ")")]),
    )


def constructor(at: Situation) -> SyntaxProblem | None:
    """Explain ``constructor C:``, which the first dialect had."""
    if at.word(at.first) != "constructor" or not at.is_name(at.first + 1) or at.token != at.first + 1:
        return None
    change = Change(at.first, at.first + 1, ("class",))
    if not at.repairs(change, context="block"):
        return None
    return at.problem(
        "SC115",
        at.place(at.first),
        "`constructor` is a word of an older dialect",
        "write `class`",
        fix=("replace it by `class`", [change]),
    )


def definition_without_parentheses(at: Situation) -> SyntaxProblem | None:
    """Explain a definition without parentheses, as in ``behavior B:``, ``def f:``."""
    word = at.word(at.first + 1) if at.word(at.first) == "async" else at.word(at.first)
    if word not in ("behavior", "def") or not at.is_name(at.token - 1) or at.word(at.token - 2) != word:
        return None
    if at.found not in (":", "->") and not at.at_end():
        return None
    what = "a behavior" if word == "behavior" else "a function"
    message, advice = f"the definition of {what} needs parentheses", f"write `{word} {at.before}():`"
    if at.at_end():
        place = at.gap(at.token)
        return SyntaxProblem("SC133", place, message, advice, fix=("Insert `():`", ((place, "():"),)))
    fix = ("insert `()`", [insertion(at.token, "(", ")")])
    return at.problem("SC133", at.here(), message, advice, fix=fix)


def attribute_of_property(at: Situation) -> SyntaxProblem | None:
    """Explain an unknown attribute of a property, as in ``speed[volatile]: 3``."""
    if not at.expects("`additive`, `dynamic` or `final`"):
        return None
    if at.found == "]":
        return at.problem(
            "SC130",
            at.here(),
            "an attribute of the property is missing between the brackets",
            "the attributes are `additive`, `dynamic` and `final`",
        )
    similar = nearest(at.found, ("additive", "dynamic", "final"), limit=2)
    fix = None
    if similar is not None:
        fix = (f"replace it by `{similar}`", [Change(at.token, at.token + 1, (similar,))])
    return at.problem(
        "SC130",
        at.here(),
        f"`{at.found}` is no attribute of a property",
        f"did you mean `{similar}`?" if similar else "the attributes are `additive`, `dynamic` and `final`",
        fix=fix,
    )


def annotated_property(at: Situation) -> SyntaxProblem | None:
    """Explain an annotated assignment in a class, as in ``width: float = 2``."""
    if at.found != "=" or at.word(at.first + 1) != ":" or at.expects("=") or at.before == ":":
        return None
    if at.context() != "class":
        return None
    name = at.word(at.first)
    return at.problem(
        "SC110",
        at.here(),
        "annotated assignments are not allowed in a class: `name: value` defines a property",
        f"write `{name}: value`, or `{name} = value` for an ordinary attribute",
    )


_PARTS: Final = ("setup", "compose")


def parts_of_scenario(at: Situation) -> SyntaxProblem | None:
    """Explain ``setup`` after ``compose``, beside other statements, or outside a scenario."""
    word = at.word(at.first)
    begins = word in _PARTS and at.word(at.first + 1) == ":" and at.token <= at.first + 2
    if not begins or (at.start < at.first and word != "setup"):
        return None
    header = at.header()
    if header is None or header.word(header.first) != "scenario":
        if header is not None:
            # If the header is a misspelt one, that is the only mistake.
            wrong = misspelt(header)
            if wrong is not None and wrong.fix is not None and wrong.fix[1][0][1] == "scenario":
                return wrong
        return at.problem(
            "SC134", at.place(at.first), f"`{word}` is a part of a scenario", "write it in `scenario Name():`"
        )
    lines = at.lines_of_block()
    words = [at.tokens.texts[line] for line in lines]
    if "setup" in words and "compose" in words and words.index("compose") < words.index("setup"):
        setup, compose = lines[words.index("setup")], lines[words.index("compose")]
        return at.problem(
            "SC116",
            at.place(setup),
            "`setup` has to stand before `compose`",
            "move it to the front",
            labels=((at.place(compose), "`compose` stands here"),),
        )
    for line, other in zip(lines, words, strict=True):
        if other in (*_PARTS, "precondition", "invariant") or at.tokens.kinds[line] == STRING:
            continue
        sibling = at.elsewhere(line, at.trials.line(line)[1])
        wrong = misspelt(sibling)
        if wrong is not None and wrong.fix is not None and wrong.fix[1][0][1] in _PARTS:
            return wrong
        return at.problem(
            "SC110",
            at.place(at.first),
            f"`{word}` cannot stand beside other statements of a scenario",
            "move them into `setup:`",
            labels=((at.place(line), "this statement is in neither part"),),
        )
    return None


def definition_without_name(at: Situation) -> SyntaxProblem | None:
    """Explain a definition without a name, as in ``behavior:``, ``scenario ():``."""
    word = at.word(at.first)
    if word not in ("behavior", "monitor", "scenario") or at.word(at.first + 1) not in (":", "("):
        return None
    if at.word(at.end - 1) != ":" or at.is_name(at.first + 1):
        return None
    return at.problem(
        "SC110", at.gap(at.first + 1), f"the name of the {word} is missing", f"write `{word} Name():`"
    )


def stray_specifier(at: Situation) -> SyntaxProblem | None:
    """Explain a line that starts with a specifier."""
    if at.token != at.first or at.start != at.first or at.tokens.kinds[at.token] not in SPECIFIER_KINDS:
        return None
    if at.found in ("not", "with") or at.word(at.token + 1) == "=":
        return None
    return at.problem(
        "SC110",
        at.here(),
        f"no statement starts with `{at.found}`",
        "to go on with the specifiers of the line before, end that line with a comma and indent this one",
    )


def statement_in_expression(at: Situation) -> SyntaxProblem | None:
    """Explain a statement inside an expression, as in ``x = require y``, ``f(return 3)``, ``x = take y``."""
    if at.before in SOFT_STATEMENT_WORDS and at.token > at.first + 1 and at.starts_operand(at.token):
        word, place = at.before, at.place(at.token - 1)
        if at.word(at.token - 2) not in ("=", "(", ",", "[", ":", "return"):
            return None
    elif at.found in STATEMENT_WORDS and at.expects("an expression", "an argument") and at.token != at.first:
        word, place = at.found, at.here()
    else:
        return None
    return at.problem(
        "SC110",
        place,
        f"`{word}` begins a statement, which cannot be part of an expression",
        f"write the `{word}` statement on a line of its own",
    )
