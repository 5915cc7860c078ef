"""Mistakes in headers of blocks, in their contents, and in clauses that continue a statement after a block."""

from dataclasses import replace
from typing import Final

from scenic.compiler.actions import SyntaxProblem
from scenic.compiler.generated import HARD_KEYWORDS
from scenic.compiler.mistakes.elsewhere import first_word
from scenic.compiler.mistakes.situation import Situation, insertion
from scenic.compiler.mistakes.trial import Change
from scenic.compiler.mistakes.words import misspelt
from scenic.compiler.tokens import DEDENT, INDENT, NEWLINE
from scenic.language.spelling import nearest

__all__ = [
    "clause_without_beginning",
    "decorator_alone",
    "header_without_colon",
    "missing_block",
    "missing_colon",
    "try_alone",
    "unexpected_indent",
]

_HEADERS: Final = {
    "if": "`if`", "elif": "`elif`", "else": "`else`", "for": "`for`", "while": "`while`", "with": "`with`",
    "try": "`try`", "except": "`except`", "finally": "`finally`", "def": "a function", "class": "a class",
    "async": "`async`", "match": "`match`", "case": "`case`", "behavior": "a behavior", "monitor": "a monitor",
    "scenario": "a scenario", "setup": "`setup`", "compose": "`compose`", "interrupt": "`interrupt when`",
    "precondition": "`precondition`", "invariant": "`invariant`",
}  # fmt: skip
"""First words of lines that end in a colon, with their names in messages."""


def missing_colon(at: Situation) -> SyntaxProblem | None:
    """Explain a header without its colon, as in ``if x``, ``def f()``, ``while x {``."""
    first = at.word(at.first)
    if not at.expects(":") or first not in _HEADERS or at.opener(at.token) is not None or _has_colon(at):
        return None
    what = f"the colon after the header of {_HEADERS[first]} is missing"
    if first in ("else", "try", "finally", "setup", "compose", "precondition", "invariant"):
        what = f"the colon after `{first}` is missing"
    if at.at_end():
        if not _begins_block(at) and not at.repairs(insertion(at.token, ":"), context="block"):
            return None
        return _colon(at, what, [insertion(at.token, ":")])
    if at.found == "{" and at.token == at.end - 1:
        return at.problem(
            "SC129", at.here(), "a block begins with `:`, not with `{`", "write `:`, and indent the block"
        )
    if at.found in ("then", "do") and at.token == at.end - 1:
        change = Change(at.token, at.token + 1, (":",))
        return at.problem(
            "SC129",
            at.here(),
            f"a block begins with `:`, not with `{at.found}`",
            "write `:`",
            fix=("write `:`", [change]),
        )
    if at.found == ";" or (at.found == "=" and first not in ("else", "try")):
        return None
    changes = [insertion(at.token, ":")]
    return _colon(at, what, changes) if at.repairs(*changes) else None


def _has_colon(at: Situation) -> bool:
    """Return whether the header has its colon, and the mistake is after it, in ``if a: b c``; of lambdas come others."""
    depth = colons = 0
    for word in at.tokens.texts[at.first : at.token]:
        if word in ("(", "[", "{"):
            depth += 1
        elif word in (")", "]", "}"):
            depth -= 1
        elif depth == 0:
            colons += (word == ":") - (word == "lambda")
    return colons > 0


def _begins_block(at: Situation) -> bool:
    kinds = at.tokens.kinds
    return at.end + 1 < len(kinds) and kinds[at.end] == NEWLINE and kinds[at.end + 1] == INDENT


def _colon(at: Situation, message: str, changes: list[Change]) -> SyntaxProblem:
    header = at.words(at.first, at.token)
    advice = f"write `{header}:`" if len(header) < 40 else "end the line with `:`"
    problem = at.problem("SC121", at.gap(at.token), message, advice, fix=("insert `:`", changes))
    if problem.fix is None:
        # The block may be missing, too; the colon is right all the same.
        problem = replace(problem, fix=("Insert `:`", ((at.gap(at.token), ":"),)))
    return problem


def header_without_colon(at: Situation) -> SyntaxProblem | None:
    """Explain ``setup``, ``compose`` and the like before a block; without the colon they are names."""
    if at.word(at.first) not in ("setup", "compose") or at.end != at.first + 1:
        return None
    return _colon(at.elsewhere(at.start, at.end), f"the colon after `{at.word(at.first)}` is missing", [])


_NAMED: Final = ("behavior", "class", "def", "monitor", "scenario")
_LEAST: Final = 3
"""So many letters of a word are enough to know it by them."""


def unfinished_header(at: Situation) -> SyntaxProblem | None:
    """Explain ``behavior``, ``beha`` before the lines of a block: a header of which one word is typed so far."""
    word = at.word(at.first)
    if at.end != at.first + 1 or not at.is_name(at.first) or word in ("setup", "compose"):
        return None
    if word in _NAMED:
        return at.problem(
            "SC110", at.gap(at.end), f"the name of the {word} is missing", f"write `{word} Name():`"
        )
    header = next((each for each in _HEADERS if len(word) >= _LEAST and each.startswith(word)), None)
    if header is None:
        header = nearest(word, _HEADERS)
    if header is None:
        return None
    example = f"{header} Name():" if header in _NAMED else f"{header} ...:"
    return at.problem("SC118", at.place(at.first), f"`{word}` begins no block", f"did you mean `{example}`?")


def missing_block(at: Situation) -> SyntaxProblem | None:
    """The header of a block is followed by no indented line."""
    if INDENT not in at.expected and at.expected != {"an indented block"}:
        return None
    header = at.token - 1
    while header > 0 and at.tokens.kinds[header] in (NEWLINE, DEDENT, INDENT):
        header -= 1
    line, _ = at.trials.line(header)
    first = at.tokens.texts[line]
    what = _HEADERS.get(first, "this line")
    place = at.place(line, header + 1) if header > 0 else at.here()
    if at.tokens.texts[header] == ",":
        return at.problem(
            "SC127",
            place,
            "after a comma at the end of the line, specifiers have to follow, indented",
            "indent the lines of the specifiers",
        )
    return at.problem(
        "SC127",
        place,
        f"{what} needs an indented block" if first in _HEADERS else "an indented block has to follow",
        "indent the lines of the block; `pass` stands for an empty one",
    )


def unexpected_indent(at: Situation) -> SyntaxProblem | None:
    """Explain a line that is indented more than it can be."""
    if at.token >= len(at.tokens.kinds) or at.tokens.kinds[at.token] != INDENT:
        return None
    return at.problem("SC102", at.here(), "this line is indented more than it can be", "indent it less")


_BEGINNINGS: Final = {
    "elif": "`if`",
    "else": "`if`, `for`, `while` or `try`",
    "except": "`try`",
    "finally": "`try`",
    "interrupt": "`try`",
    "case": "`match`",
}
"""By the first word of a clause: what it belongs to."""


def clause_without_beginning(at: Situation) -> SyntaxProblem | None:
    """Explain `else` without `if`, `case` without `match`."""
    word = at.word(at.first)
    if word not in _BEGINNINGS or at.first != at.start:
        return None
    if word == "case" and (at.token != at.first + 1 or not at.starts_operand(at.token)):
        return None
    if word == "interrupt" and at.found != "when":
        return None
    if word in ("elif", "else", "except", "finally") and at.token != at.first:
        return None
    if word == "else" and at.word(at.first + 1) == "if":
        return None
    previous = _clause_before(at)
    if previous is not None:
        return at.problem(
            "SC116",
            at.place(at.first),
            f"`{word}` cannot follow `{at.tokens.texts[previous]}`",
            f"the order is {_CLAUSES.get(at.tokens.texts[previous], _CLAUSES['except'])}",
            labels=((at.place(previous), f"`{at.tokens.texts[previous]}` stands here"),),
        )
    header = at.header()
    if word == "case" and header is not None:
        wrong = misspelt(header) or first_word(header)
        if wrong is not None:
            return wrong
    return at.problem(
        "SC134",
        at.place(at.first),
        f"`{word}` has no {_BEGINNINGS[word]} that it could belong to",
        f"align it with its {_BEGINNINGS[word]}, between which and it no other statement stands",
    )


def _clause_before(at: Situation) -> int | None:
    """Return the beginning of the previous clause, if this clause cannot come after it."""
    kinds = at.tokens.kinds
    index = at.first - 1
    if index < 0 or kinds[index] != DEDENT:
        return None
    depth = 0
    while index > 0:
        depth += (kinds[index] == DEDENT) - (kinds[index] == INDENT)
        if depth == 0:
            break
        index -= 1
    if index < 2:
        return None
    first, _ = at.trials.line(index - 2)
    return first if at.tokens.texts[first] in _CLAUSES else None


_CLAUSES: Final = {
    "else": "`if`, `elif`, `else`",
    "except": "`try`, `interrupt when`, `except`, `else`, `finally`",
    "finally": "`try`, `interrupt when`, `except`, `else`, `finally`",
}
"""Clauses after which not every clause can come, and the order of clauses there."""


def try_alone(at: Situation) -> SyntaxProblem | None:
    """Explain `try` without any clause."""
    if not at.expects("`except`, `finally` or `interrupt when`"):
        return None
    place = at.trials.line(at.start)
    if at.word(at.token) == "when":
        return at.problem(
            "SC114",
            at.here(),
            "`interrupt` is missing before `when`",
            "write `interrupt when condition:`",
            fix=("insert `interrupt`", [insertion(at.token, "interrupt")]),
        )
    if at.is_plain_name(at.token):
        # A misspelt clause?
        clause = at.elsewhere(at.token, at.token + 1)
        wrong = misspelt(clause) or first_word(clause)
        if wrong is not None:
            return wrong
        if at.trials.line(at.token)[1] == at.token + 1 and any(
            each.startswith(at.word(at.token)) for each, of in _BEGINNINGS.items() if of == "`try`"
        ):
            return at.problem(
                "SC110",
                at.here(),
                f"`{at.word(at.token)}` is no complete clause",
                "write the whole clause, with a colon at its end",
            )
    # What follows may be right.
    return at.problem(
        "SC134",
        at.place(place[0]),
        "`try` needs a clause: `except`, `finally` or `interrupt when`",
        "add one after the block, indented like `try`",
    )


def decorator_alone(at: Situation) -> SyntaxProblem | None:
    """Explain a decorator before what it cannot decorate."""
    if at.token != at.first or at.tokens.texts[at.start] != "@" or HARD_KEYWORDS["def"] not in at.expected:
        return None
    if at.found and any(word.startswith(at.found) for word in ("async", "class", "def")):
        return None
    # The statement that follows may be right.
    first, end = at.trials.line(at.token - 2)
    return at.problem(
        "SC110",
        (*at.place(first)[:2], *at.place(end - 1)[2:]),
        "a decorator needs a function or class after it",
        "write `def` or `class` on the next line",
    )
