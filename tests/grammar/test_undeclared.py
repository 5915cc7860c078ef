"""The generator refuses what the grammar has and no declaration explains."""

from pathlib import Path

import pytest

from grammar.generator import GrammarError, read_grammar_text
from grammar.generator.analysis import Analysis
from grammar.generator.declarations import check_declarations

GRAMMAR = (Path(__file__).resolve().parents[2] / "grammar" / "scenic.gram").read_text(encoding="utf-8")


def check_refused(old: str, new: str, *parts: str) -> None:
    assert GRAMMAR.count(old) == 1
    with pytest.raises(GrammarError) as caught:
        check_declarations(Analysis(read_grammar_text(GRAMMAR.replace(old, new))))
    for part in parts:
        assert part in str(caught.value)


def test_the_grammar_has_only_what_is_declared() -> None:
    check_declarations(Analysis(read_grammar_text(GRAMMAR)))


def test_an_operator() -> None:
    old = """    | "front" 'of' a=prefix"""
    new = """    | "rear" 'of' a=prefix { Operation(operator="rear of", operands=[a]) }\n"""
    check_refused(old, new + old, "'rear of'", "operators.py")


def test_an_operator_with_another_number_of_operands() -> None:
    old = """Operation(operator="front of", operands=[a])"""
    check_refused(old, """Operation(operator="front of", operands=[a, None])""", "'front of'", "2 operands")


def test_a_specifier() -> None:
    old = """    | "behind" a=expression"""
    new = """    | "inside" a=expression { SpecifierPhrase(specifier="inside", property=None, operands=[a]) }\n"""
    check_refused(old, new + old, "'inside'", "specifiers.py")


def test_a_temporal_operator() -> None:
    old = """    | "eventually" a=temporal_above"""
    new = """    | "never" a=temporal_above { Temporal(operator="never", operands=[a]) }\n"""
    check_refused(old, new + old, "'never'", "keywords.py")


def test_a_statement(monkeypatch: pytest.MonkeyPatch) -> None:
    from scenic.language.statements import STATEMENTS

    fewer = {node: each for node, each in STATEMENTS.items() if node != "Abort"}
    monkeypatch.setattr("grammar.generator.declarations.STATEMENTS", fewer)
    check_refused("""@start file\n""", "@start file\n", "Abort", "statements.py")
