"""The properties of recovery, checks, tools and repairs notice what they are there for."""

import ast
import random
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from fuzz.mutations import Mutant
from fuzz.properties import Case, Violation, recovery, repairs, surgery, tools
from fuzz.properties.case import describe
from fuzz.properties.signatures import SIGNATURES
from scenic.cli.checking import Checker
from scenic.compiler.check import check_text
from scenic.compiler.parser import ParseResult, parse
from scenic.language.diagnostics import Diagnostic, Edit, Fix
from scenic.language.spans import Span
from scenic.lsp.convert import Lines

PROGRAM = """\
first = 1
if first:
    second = (2,
        3)
    third = '''a
    b'''
else:
    fourth = 4

fifth = 5
sixth = 6
"""


# Recovery.


def mutant(old: str, new: str, original: str = PROGRAM) -> Mutant:
    assert original.count(old) == 1
    start = original.index(old)
    return Mutant(original.replace(old, new), original, start, start + len(new))


def near(old: str, new: str, original: str = PROGRAM) -> str:
    """The text near a change."""
    made = mutant(old, new, original)
    found = recovery.region(made.original, made.text)
    assert found is not None
    return made.text[found.start : found.end]


@pytest.mark.parametrize(
    ("old", "new", "begins", "ends"),
    [
        ("= 5", "= = 5", "fifth", "sixth = 6"),
        ("= 5", "= )5", "fifth", "sixth = 6"),
        # At the beginning of a statement what is before may be meant.
        ("fifth", "5 fifth", "fourth", "sixth = 6"),
        ("3)", "3", "second", "third = '''a\n    b'''"),
        # A header counts with its whole statement.
        ("if first", "if if first", "if", "fifth = 5"),
        ("else:", "else", "if", "fifth = 5"),
        # What is opened goes on to where it is closed.
        ("= 4", "= 4 + '''", "fourth", "6\n"),
        ("= 1", "= (1", "first", "if first:"),
        ("= 6", "= (6", "sixth", "= (6\n"),
        ("first = 1\n", "first = 1 + '''\n", "first", "else:"),
        ("fourth = 4", "fourth = (4", "fourth", "fifth = 5"),
        # The indentation belongs to both neighbours.
        ("    fourth", "  fourth", "else:", "fifth = 5"),
        ("    third", "third", "second", "else:"),
        ("sixth = 6", "sixth = = 6", "sixth", "6\n"),
    ],
)
def test_what_is_near_a_change(old: str, new: str, begins: str, ends: str):
    found = near(old, new)
    assert found.startswith(begins)
    assert found.endswith(ends)


def test_no_change_has_no_region():
    assert recovery.region("x\n", "x\r\n") is None


def misplaced(made: Mutant, line: int) -> Case:
    """A mutant whose only error is said to be on a line."""
    result = parse(made.text)
    case = Case(made.text, made)
    error = Diagnostic("SC110", "wrong", Span(line, 0, line, 3))
    case.__dict__["result"] = ParseResult(result.tree, (error,))
    return case


def test_errors_far_from_the_change_are_noticed():
    made = mutant("= 4", "= 4 4")
    recovery.errors_are_near_the_change(Case(made.text, made))
    recovery.errors_are_near_the_change(misplaced(made, 10))
    for line in (1, 3, 5, 7, 11):
        with pytest.raises(Violation, match="no error near the change"):
            recovery.errors_are_near_the_change(misplaced(made, line))


def test_what_was_no_program_has_no_region():
    made = mutant("fifth", "fifth fifth", "x x\nfifth\n")
    recovery.errors_are_near_the_change(misplaced(made, 1))


# Checks.


class Deaf(Exception):
    pass


@pytest.mark.parametrize("name", ["resolve", "lint"])
def test_a_check_that_needs_a_whole_tree_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch):
    right = getattr(surgery, name)

    def broken(first: Any, *others: Any) -> Any:
        for node in ast.walk(getattr(first, "tree", first)):
            if getattr(node, "body", None) == []:
                raise Deaf
        return right(first, *others)

    monkeypatch.setattr(surgery, name, broken)
    noticed = 0
    for number in range(20):
        try:
            surgery.checks_never_raise(Case(f"{PROGRAM}x = {number}\n", thorough=True))
        except Deaf:
            noticed += 1
    assert noticed >= 5


def test_surgery_leaves_types_alone():
    texts = [PROGRAM, "class C(D, k=1):\n  x: 1\nnew C at x, with y (z, *w)\nmatch x:\n case {1: y}: pass\n"]
    kinds = set()
    for number in range(300):
        tree = parse(texts[number % 2]).tree
        before = ast.dump(tree)
        surgery.operate(tree, random.Random(number))
        kinds.add(ast.dump(tree) == before)
        for node in ast.walk(tree):
            for field in SIGNATURES[type(node)]:
                assert field.fault(getattr(node, field.name)) is None
    assert False in kinds


# Tools.

WRONG = "x = '😀' + y\nrequire z\n  \nx x\n"


def test_tools_that_say_something_else_are_noticed(monkeypatch: pytest.MonkeyPatch):
    def less(text: str, *, filename: str, project: object) -> tuple[Diagnostic, ...]:
        return check_text(text, filename=filename)[:-1]

    def without_names(text: str, *, filename: str, project: object) -> tuple[Diagnostic, ...]:
        return tuple(each for each in check_text(text, filename=filename) if each.code != "SC202")

    tools.check_and_server_agree(Case(WRONG, thorough=True))
    # An editor may spare names while a line is half typed, and nothing else.
    monkeypatch.setattr(tools, "diagnostics", without_names)
    tools.check_and_server_agree(Case(WRONG, thorough=True))
    monkeypatch.setattr(tools, "diagnostics", less)
    with pytest.raises(Violation, match="the editor says"):
        tools.check_and_server_agree(Case(WRONG, thorough=True))


def test_a_command_that_fails_is_noticed(monkeypatch: pytest.MonkeyPatch):
    def broken(task: Any) -> Any:
        return right(replace(task, text=task.text + "\n)"))

    right = Checker()
    monkeypatch.setattr(tools, "_command", lambda: broken)
    with pytest.raises(Violation, match="the command says: SC103"):
        tools.check_and_server_agree(Case(WRONG, thorough=True))


def test_wrong_columns_are_noticed(monkeypatch: pytest.MonkeyPatch):
    tools.places_survive_conversion(Case(WRONG, thorough=True))
    right = tools.to_diagnostic
    # As if each character took one unit.
    monkeypatch.setattr(
        tools, "to_diagnostic", lambda item, lines, uri: right(item, Lines(lines.source, "utf-32"), uri)
    )
    with pytest.raises(Violation, match="comes back from utf-"):
        tools.places_survive_conversion(Case(WRONG, thorough=True))


def test_wrong_json_is_noticed(monkeypatch: pytest.MonkeyPatch):
    right = tools.render
    monkeypatch.setattr(
        tools, "render", lambda name, report: right(name, report).replace('"end_column": ', '"end_column": 1')
    )
    with pytest.raises(Violation, match="the JSON says something else"):
        tools.places_survive_conversion(Case(WRONG, thorough=True))


# Repairs.


def repaired(text: str, monkeypatch: pytest.MonkeyPatch, *edits: Edit) -> None:
    """Try the property with another repair of the first diagnostic that has one."""

    def changed(found: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
        return tuple(replace(each, fix=Fix("t", edits)) if each.fix is not None else each for each in found)

    case = Case(text, thorough=True)
    assert any(each.fix is not None for each in case.checked)
    repairs.repairs_repair(case)
    case.__dict__["checked"] = changed(case.checked)
    repairs.repairs_repair(case)


@pytest.mark.parametrize(
    ("edits", "message"),
    [
        ((), "changes nothing"),
        ((Edit(Span(1, 16, 1, 16), ""),), "changes nothing"),
        ((Edit(Span(1, 30, 1, 30), " "),), "leaves: SC300"),
        ((Edit(Span(1, 16, 1, 30), "("),), r"makes SC103"),
    ],
)
def test_repairs_that_do_not_repair_are_noticed(
    edits: tuple[Edit, ...], message: str, monkeypatch: pytest.MonkeyPatch
):
    text = "ego = new Object with wdth 3, at (1, 2)\n"
    with pytest.raises(Violation, match=message):
        repaired(text, monkeypatch, *edits)


def test_what_a_repair_uncovers_is_no_fault():
    text = "ego = new Object at (1,, 2) at at\n"
    repairs.repairs_repair(Case(text, thorough=True))


@pytest.mark.parametrize(
    "text", ["require[1]simulator\n", "require[1](x)\n", "x = 1  # scenic: ignore\n", "ego = Object at 3\n"]
)
def test_repairs_that_repair(text: str):
    case = Case(text, thorough=True)
    assert any(each.fix is not None for each in case.checked), list(map(describe, case.checked))
    repairs.repairs_repair(case)
