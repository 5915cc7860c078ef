"""Emits the tables that the lexer, the editor features and the messages read."""

from grammar.generator.analysis import Analysis
from grammar.generator.model import KINDS, Alternative, Reference, Token
from grammar.generator.precedence import Content, Form, Part, Precedence, Slot


def emit_tables(analysis: Analysis, header: str) -> str:
    """Write the text of the module ``tables``."""
    vocabulary = analysis.grammar.vocabulary
    starting_words = sorted(_starting_words(analysis))
    operators = sorted(
        frozenset().union(
            *(analysis.continuations(name) for name in analysis.steps if name in _ladder_of(analysis)),
            frozenset(),
        )
    )
    specifiers = sorted(analysis.first["specifier"]) if "specifier" in analysis.rules else []
    lines = [header.rstrip(), "", "from types import MappingProxyType", ""]
    for name, table in (
        ("HARD_KEYWORDS", vocabulary.hard_keywords),
        ("OPERATORS", vocabulary.operators),
        ("SOFT_KEYWORDS", vocabulary.soft_keywords),
    ):
        lines.append(f"{name} = MappingProxyType(")
        lines.append("    {")
        lines += [f"        {word!r}: {kind}," for word, kind in table.items()]
        lines += ["    }", ")", ""]
    lines += [
        "WORDS = MappingProxyType({**HARD_KEYWORDS, **OPERATORS, **SOFT_KEYWORDS})",
        '"""The kind of every keyword and operator, for the lexer."""',
        "",
        "KIND_NAMES = MappingProxyType(",
        f"    {{kind: name for name, kind in {KINDS!r}.items()}}",
        ")",
        "",
        f"STATEMENT_STARTERS = frozenset({starting_words!r})",
        '"""The words that start statements: hard keywords, and soft ones that may."""',
        "",
        f"INFIX_KINDS = frozenset({operators!r})",
        '"""The kinds of tokens that can continue an expression."""',
        "",
        f"SPECIFIER_KINDS = frozenset({specifiers!r})",
        '"""The kinds of tokens with which a specifier starts."""',
        "",
        *_precedence(Precedence(analysis)),
        "",
    ]
    return "\n".join(lines)


def _precedence(precedence: Precedence) -> list[str]:
    """The lines with the ladders and the forms; `scenic.compiler.precedence` defines their fields."""
    lines = ["LADDERS = {"]
    lines += [f"    {ladder!r}: {tuple(steps)!r}," for ladder, steps in precedence.ladders.items()]
    lines += ["}", '"""The rules of each ladder of operators with their levels, loosest first."""', ""]
    for name, forms, comment in (
        ("FORMS", precedence.forms, "All ways to write an operator"),
        ("SPECIFIER_FORMS", precedence.specifiers, "All ways to write a specifier"),
    ):
        lines += [f"{name} = (", *(f"    {_form(form)!r}," for form in forms), ")"]
        lines += [f'"""{comment}, for `scenic.compiler.precedence`."""', ""]
    return lines


def _form(form: Form) -> tuple[object, ...]:
    return (
        form.rule,
        form.level.ladder,
        form.level.number,
        tuple(_part(part) for part in form.parts),
        form.fixity,
        form.associativity,
        form.yields_to,
        form.followed_by,
        form.node,
        form.operator,
        form.targets,
        form.absent,
    )


def _part(part: Part) -> tuple[object, ...]:
    match part:
        case Slot():
            return ("slot", part.level.ladder, part.level.number, part.also)
        case Content():
            return ("content", part.rule, part.optional)
        case _:
            return ("word", part)


def _ladder_of(analysis: Analysis) -> list[str]:
    """The steps of the ladder of ordinary expressions."""
    return analysis.ladder("expression") if "expression" in analysis.steps else []


def _starting_words(analysis: Analysis) -> set[str]:
    """The first words of statements that are not expressions."""
    words: set[str] = set()
    names: set[str] = set()
    roots = ["statement"] if "statement" in analysis.rules else []
    while roots:
        name = roots.pop()
        if name in names or name in analysis.steps:
            continue
        names.add(name)
        for alternative in analysis.rules[name].alternatives:
            for entry in alternative.items:
                for item in analysis.items_of(Alternative((entry,), None)):
                    if isinstance(item, Token) and item.literal and item.text.isidentifier():
                        words.add(item.text)
                    elif isinstance(item, Reference):
                        roots.append(item.rule)
                if not analysis.may_be_empty(entry.item):
                    break
    return words
