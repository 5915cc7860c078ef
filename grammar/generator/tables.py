"""Emits the tables that the lexer, the editor features and the messages read."""

from grammar.generator.analysis import Analysis
from grammar.generator.model import KINDS, Alternative, Reference, Token


def emit_tables(analysis: Analysis, header: str) -> str:
    """The text of the module ``tables``."""
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
        '"""What the lexer has to know: the kind of every keyword and operator."""',
        "",
        "KIND_NAMES = MappingProxyType(",
        f"    {{kind: name for name, kind in {KINDS!r}.items()}}",
        ")",
        "",
        f"STATEMENT_STARTERS = frozenset({starting_words!r})",
        '"""The words that start statements: hard keywords, and soft ones that may."""',
        "",
        f"INFIX_KINDS = frozenset({operators!r})",
        '"""The kinds of tokens with which an expression can go on."""',
        "",
        f"SPECIFIER_KINDS = frozenset({specifiers!r})",
        '"""The kinds of tokens with which a specifier starts."""',
        "",
    ]
    return "\n".join(lines)


def _ladder_of(analysis: Analysis) -> list[str]:
    """The steps of the ladder of ordinary expressions."""
    return analysis.ladder("expression") if "expression" in analysis.steps else []


def _starting_words(analysis: Analysis) -> set[str]:
    """The words with which a statement starts that is no expression."""
    words: set[str] = set()
    seen: set[str] = set()
    roots = ["statement"] if "statement" in analysis.rules else []
    while roots:
        name = roots.pop()
        if name in seen or name in analysis.steps:
            continue
        seen.add(name)
        for alternative in analysis.rules[name].alternatives:
            for named in alternative.items:
                for item in analysis.items_of(Alternative((named,), None)):
                    if isinstance(item, Token) and item.literal and item.text.isidentifier():
                        words.add(item.text)
                    elif isinstance(item, Reference):
                        roots.append(item.rule)
                if not analysis.may_be_empty(named.item):
                    break
    return words
