"""Every alternative of every rule of the grammar is reached by a golden case: Scenic's by the cases of Scenic.

So is every form that a part of an alternative can have: absent and present, one and several, every one of several
tokens. What "reached" means is said in `grammar.tracing`.
"""

import ast
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from grammar import origins
from grammar.generator import read_grammar
from grammar.generator.model import Grammar
from grammar.tracing import AlternativeId, Choice, Trace, TracingParser, choices, explain
from scenic.compiler import tree
from scenic.compiler.actions import Actions
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.compiler.parser import deep_recursion, parse
from tests.compiler.golden_cases import Case, python_cases, scenic_cases

ROOT = Path(__file__).resolve().parents[2]


@cache
def grammar() -> Grammar:
    return read_grammar(ROOT / "grammar" / "scenic.gram")


@cache
def parser() -> TracingParser:
    return TracingParser(grammar())


def trace(text: str) -> Trace:
    tokens = lex(text, WORDS)
    with deep_recursion():
        return parser().parse(tokens.lists(), Actions(tokens))


@cache
def reached(cases: tuple[Case, ...]) -> frozenset[Choice]:
    """What the cases do together; each has the tree that the parser in use makes of it."""
    found: set[Choice] = set()
    for case in cases:
        traced = trace(case.source)
        assert traced.tree is not None, case
        assert ast.dump(traced.tree, include_attributes=True) == ast.dump(
            parse(case.source).tree, include_attributes=True
        ), case
        found |= traced.choices
    return frozenset(found)


def missing(wanted: Iterable[Choice], found: frozenset[Choice]) -> list[str]:
    return [explain(grammar(), choice) for choice in wanted if choice not in found]


@cache
def of_scenic() -> frozenset[AlternativeId]:
    return origins.of_scenic(grammar(), tree.__all__)


def test_scenic_rules_are_told_from_those_of_python() -> None:
    rules = {each.rule for each in of_scenic()}
    assert {"specifier", "prefix_operation", "temporal_group", "property_attributes", "duration"} <= rules
    assert {AlternativeId("term", 6), AlternativeId("bitor", 2), AlternativeId("try_rest", 1)} <= of_scenic()
    assert not {"number", "block", "if_statement", "except_block", "lambda_expression", "strings"} & rules
    assert AlternativeId("term", 1) not in of_scenic()


# The cases.


def test_golden_cases_of_scenic_reach_every_alternative_of_scenic() -> None:
    wanted = [choice for choice in choices(grammar()) if choice.alternative in of_scenic()]
    assert missing(wanted, reached(scenic_cases())) == []


def test_golden_cases_reach_every_alternative() -> None:
    assert missing(choices(grammar()), reached(scenic_cases()) | reached(python_cases())) == []


def test_what_only_one_file_reaches_is_missing_without_it() -> None:
    others = tuple(case for case in scenic_cases() if case.file != "specifiers")
    found = missing(choices(grammar()), reached(others) | reached(python_cases()))
    assert any("\"following\" expression ('from' expression)? 'for' expression" in each for each in found)
    assert any(each.startswith("specifier/9: present for ('from' expression)?") for each in found)
