"""The reference of the syntax: tables of all forms, and a diagram of each statement, from grammar and declarations."""

import io
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import railroad

from scenic.compiler.precedence import FORMS, Form
from scenic.compiler.precedence import SPECIFIERS as SPECIFIER_FORMS
from scenic.compiler.precedence import Word as Written
from scenic.compiler.syntax import (
    RULES,
    STATEMENT_FORMS,
    Choice,
    Item,
    ListOf,
    Many,
    Optional,
    Row,
    RuleReference,
    StatementForm,
    TokenKind,
    Word,
)
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.operators import OPERATORS, Operand
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

_INTRODUCTION = """\
# The syntax of Scenic

<!-- Generated from grammar/scenic.gram and scenic/language by editors/generate.py (make generate); do not edit. -->

All of Python 3.12 is syntax of Scenic too. What Scenic adds is listed here as the grammar has it: statements with a
diagram each, the specifiers of `new`, the operators, and those of conditions over time.
Words in *italics* stand for operands.
"""

_LAYOUT = frozenset({"NEWLINE", "INDENT", "DEDENT"})
_INLINE = frozenset(
    {
        "by_clause",
        "duration",
        "parameter_setting",
        "record_target",
        "requirement_name",
        "scenario_guard",
        "compose_part",
    }
)
"""Rules that are drawn where they are used."""


def page() -> str:
    """The page as Markdown."""
    parts = [_INTRODUCTION, "## Statements\n"]
    for node, statement in STATEMENTS.items():
        parts.append(f"### `{statement.title}`\n")
        if _forms_of(node):
            parts.append(f"![{statement.title}](syntax/{_slug(statement.title)}.svg)\n")
        parts.append("".join(f"- `{form}`\n" for form in statement.forms))
        places = ", ".join(sorted(str(place) for place in statement.places))
        parts.append(f"{statement.documentation} It can stand {places}.\n")
    parts.append("## Specifiers\n\n![specifiers](syntax/specifiers.svg)\n")
    parts.append(
        _table(
            ("specifier", "gives", "meaning"),
            (
                (
                    _written(declaration.forms, declaration.operands),
                    ", ".join(f"`{each.property}` ({each.priority})" for each in declaration.specifies)
                    or "the property",
                    declaration.documentation,
                )
                for declaration in SPECIFIERS.values()
            ),
        )
    )
    parts.append("The number after a property is the priority with which it is given: 1 is the strongest.\n")
    parts.append("## Operators\n")
    parts.append(
        _table(
            ("operator", "result", "meaning"),
            (
                (
                    _written(declaration.forms, declaration.operands),
                    declaration.result,
                    declaration.documentation,
                )
                for declaration in OPERATORS.values()
            ),
        )
    )
    parts.append("## Temporal operators of `require`\n")
    parts.append(
        _table(
            ("operator", "meaning"),
            (
                (
                    _written(declaration.forms, (Operand(name, "") for name in declaration.operands)),
                    declaration.documentation,
                )
                for declaration in TEMPORAL_OPERATORS.values()
            ),
        )
    )
    return "\n".join(parts)


def _table(titles: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def _written(forms: Iterable[str], operands: Iterable[Operand]) -> str:
    """Forms with the operands in italics."""
    names = {operand.name for operand in operands} | {"property"}
    return "<br>".join(" ".join(_marked(form.split(), names)) for form in forms)


def _marked(words: list[str], names: set[str]) -> Iterator[str]:
    """The words of a form; one that has the name of an operand is one where the grammar has no word."""
    written = next((form.parts for form in (*FORMS, *SPECIFIER_FORMS) if _agrees(words, form)), None)
    for index, word in enumerate(words):
        is_operand = word in names and (written is None or not isinstance(written[index], Written))
        yield f"*{word}*" if is_operand else f"`{word}`"


def _agrees(words: list[str], form: Form) -> bool:
    return len(words) == len(form.parts) and all(
        not isinstance(part, Written) or part.text == word
        for word, part in zip(words, form.parts, strict=True)
    )


# Diagrams.


def diagrams() -> Mapping[str, str]:
    """The diagrams as SVG, by name."""
    drawings = {
        _slug(STATEMENTS[node].title): _drawn(_statement(_forms_of(node)))
        for node in STATEMENTS
        if _forms_of(node)
    }
    rows = [each.row for each in RULES["specifier"].alternatives]
    return {
        **drawings,
        "specifiers": _drawn(railroad.Choice(0, *(railroad.Sequence(*_row(row)) for row in rows))),
    }


def _forms_of(node: str) -> list[StatementForm]:
    first = re.split(r"\W", STATEMENTS[node].forms[0], maxsplit=1)[0]
    return [form for form in STATEMENT_FORMS if form.node == node] or [
        form for form in STATEMENT_FORMS if form.node is None and form.start == first
    ]


def _statement(forms: list[StatementForm]) -> Any:
    rows = [railroad.Sequence(*_row(form.row)) for form in forms]
    return rows[0] if len(rows) == 1 else railroad.Choice(0, *rows)


def _row(row: Row) -> Iterator[Any]:
    return (each for item in row for each in _item(item))


def _item(item: Item) -> Iterator[Any]:
    match item:
        case Word(text):
            yield railroad.Terminal(text)
        case TokenKind(name) if name not in _LAYOUT:
            yield railroad.NonTerminal(name.lower())
        case RuleReference(rule) if rule in _INLINE:
            rows = [railroad.Sequence(*_row(each.row)) for each in RULES[rule].alternatives]
            yield rows[0] if len(rows) == 1 else railroad.Choice(0, *rows)
        case RuleReference(rule):
            yield railroad.NonTerminal(
                (RULES[rule].label or rule.replace("_", " ")).removeprefix("a ").removeprefix("an ")
            )
        case Optional(inner):
            yield railroad.Optional(railroad.Sequence(*_row(inner)))
        case Many(inner):
            yield railroad.OneOrMore(railroad.Sequence(*_row(inner)))
        case ListOf(inner, separator):
            yield railroad.OneOrMore(railroad.Sequence(*_row(inner)), railroad.Sequence(*_row(separator)))
        case Choice(rows):
            yield railroad.Choice(0, *(railroad.Sequence(*_row(row)) for row in rows))
        case _:
            pass


def _drawn(content: Any) -> str:
    text = io.StringIO()
    railroad.Diagram(content).writeStandalone(text.write)
    return re.sub(r"[ \t]+$", "", text.getvalue(), flags=re.MULTILINE).rstrip() + "\n"


def _slug(title: str) -> str:
    return "-".join(re.findall(r"\w+", title))
