"""Formulas of the temporal rules: that they are varied, that the properties hold, and that these notice faults."""

import ast
import copy
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import pytest
from hypothesis import find, given, settings

from fuzz import corpus, temporal
from fuzz.climbing import TABLE, Climber, Table, climb
from fuzz.draws import RandomDraws
from fuzz.grammar import derivations
from fuzz.properties.case import Case, Property, Violation
from fuzz.session import Report, run_round
from fuzz.temporal import FORMULAS, OF_FORMULAS, formulas, make_formula, predicted, texts, written_in_full
from scenic.compiler import tree
from scenic.compiler.lowering import lower
from scenic.compiler.parser import ParseResult, parse
from scenic.compiler.precedence import Form, Ladder, Slot
from scenic.compiler.resolver import resolve
from scenic.language.source import Source

PROPOSITIONS, CONDITIONS = range(2)
BY_NAME: Final = {each.name: each for each in OF_FORMULAS}


def cases(number: int, seed: int = 0, variety: int | None = None) -> Iterator[Case]:
    for index in range(number):
        yield Case(make_formula(RandomDraws(seed * 100_000 + index), variety).text, thorough=True)


def violated(names: str, number: int = 400, variety: int | None = PROPOSITIONS) -> str:
    """What the first case says for which one of some properties does not hold."""
    for case in cases(number, 1, variety):
        for name in names.split():
            try:
                BY_NAME[name].holds(case)
            except Violation as problem:
                return str(problem)
    return "nothing"


# What holds.


@pytest.mark.parametrize("variety", [PROPOSITIONS, CONDITIONS])
def test_the_properties_hold(variety: int) -> None:
    for case in cases(80, 2, variety):
        for each in OF_FORMULAS:
            each.holds(case)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(FORMULAS)
def test_the_properties_hold_of_what_hypothesis_makes(program: Any) -> None:
    for each in OF_FORMULAS:
        each.holds(Case(program.text))


@pytest.mark.parametrize("each", OF_FORMULAS, ids=lambda each: each.name)
@pytest.mark.parametrize(
    "text",
    [
        "a", "(a)", "always a", "always(a)", "a until b", "(a until b) until c", "a implies always b implies c",
        "not (always a) and b", "not (always a and b)", "(always a) or not (next b) and c", "a if b else not c",
        "always (a if b else c)", "not visible a until a < b", "a or always b implies c implies a", "not not a",
        "lambda: a", "(lambda: a) and b", "f(a)[b].c == (a and b)", "(a and b).m or c",
    ],
)  # fmt: skip
def test_the_properties_hold_of_known_cases(each: Property, text: str) -> None:
    each.holds(Case(f"require {text}\n"))


# What is made.


def test_all_temporal_alternatives_are_used() -> None:
    used = {
        alternative for index in range(400) for alternative in make_formula(RandomDraws(index)).alternatives
    }
    wanted = {each for each in derivations().countable if each.rule.startswith("temporal_")}
    assert len(wanted) > 20
    assert wanted <= used


def test_formulas_are_of_many_kinds() -> None:
    count: Counter[str] = Counter()
    found = list(cases(150, 3, PROPOSITIONS))
    for case in found:
        count.update(set(re.findall(r"\w+", case.text)))
        count["parentheses"] += "(" in case.text
        count["longer"] += len(texts(case)["in full"]) > len(texts(case)["on one line"]) + 4
    for kind in ("always", "eventually", "next", "until", "implies", "and", "or", "not", "if"):
        assert count[kind] > 10, kind
    for kind in ("parentheses", "longer"):
        assert count[kind] > 40, kind
    assert len({case.text for case in found}) > 100


def test_conditions_have_all_kinds_of_atoms() -> None:
    together = "\n".join(" ".join(temporal.words_of(case)) for case in cases(2000, 4, CONDITIONS))
    for text in (
        " < ",
        " not in ",
        " is not ",
        "not visible ",
        " visible from ",
        "( )",
        " . m",
        " deg",
        "lambda",
    ):
        assert text in together, text


def test_shrinking_gives_short_formulas() -> None:
    until = find(
        formulas(PROPOSITIONS),
        lambda made: "until" in made.text,
        settings=settings(derandomize=True, database=None),
    )
    assert until.text == "require a until a\n"


def test_the_texts_of_a_formula() -> None:
    text = "require ((always(a)))or(b)until c  # text"
    assert texts(Case(text)) == {
        "as the grammar derives it": text,
        "on one line": "require ( ( always ( a ) ) ) or ( b ) until c",
        "in full": "require ((( ( (always ( a )) ) ) or ( b )) until c)",
        "as the table predicts": "require ( ( ( always a ) or b ) until c )",
    }


def test_parentheses_by_places() -> None:
    line = "require always a and not b until c"
    assert written_in_full(line, temporal.condition_of(line)) == "require ((always (a and (not b))) until c)"
    assert (
        predicted(["always", "a", "and", "not", "b", "until", "c"])
        == "( ( always ( a and ( not b ) ) ) until c )"
    )
    assert predicted(["a", "until", "b", "until", "c"]) is None


# What is noticed.


def swapped(one: int, other: int) -> Table:
    """The table with two levels in the place of each other."""
    levels = {one: other, other: one}

    def form(each: Form) -> Form:
        if each.ladder is not Ladder.TEMPORAL or each.level not in levels:
            return each
        # Operands stay as much tighter than the operator as they were.
        by = levels[each.level] - each.level
        parts = [
            replace(part, level=part.level + by) if isinstance(part, Slot) else part for part in each.parts
        ]
        return replace(each, level=each.level + by, parts=tuple(parts))

    return Table(tuple(map(form, TABLE.forms)))


@pytest.mark.parametrize(("one", "other"), [(0, 1), (0, 2), (1, 2), (2, 3), (3, 4), (4, 5)])
def test_swapped_levels_of_the_table_are_noticed(
    one: int, other: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = swapped(one, other)
    monkeypatch.setattr(temporal, "predicted", partial(predicted, table=table))
    assert violated("all_texts_are_one_tree") != "nothing"


@pytest.mark.parametrize(("one", "other"), [(2, 3), (3, 4)])
def test_verdicts_notice_swapped_levels(one: int, other: int, monkeypatch: pytest.MonkeyPatch) -> None:
    table = swapped(one, other)
    monkeypatch.setattr(temporal, "predicted", partial(predicted, table=table))
    assert "as the table predicts" in violated("all_texts_have_one_verdict", 2000)
    monkeypatch.setattr(temporal, "Climber", partial(Climber, table=table))
    assert violated("the_table_alone_gives_the_verdict", 2000) != "nothing"


def test_a_table_without_an_associativity_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a prefix that does not take what is looser than itself after `and`."""
    forms = tuple(
        replace(
            each,
            parts=tuple(replace(part, also=()) if isinstance(part, Slot) else part for part in each.parts),
        )
        for each in TABLE.forms
    )
    monkeypatch.setattr(temporal, "predicted", partial(predicted, table=Table(forms)))
    assert "refuses" in violated("all_texts_are_one_tree")


class Narrow(ast.NodeTransformer):
    """Gives `always` no more than the first operand of an `and` that has no parentheses."""

    def __init__(self, text: str) -> None:
        self.lines = Source(text, "").lines

    def visit_Temporal(self, node: Any) -> ast.AST:
        self.generic_visit(node)
        match node:
            case tree.Temporal(operator="always", operands=[ast.BoolOp(op=ast.And()) as taken]):
                first = taken.values[0]
                between = self.lines[node.lineno - 1][node.col_offset : first.col_offset]
                if "(" not in between and node.lineno == first.lineno:
                    node.operands = [first]
                    taken.values[0] = node
                    return taken
        return node


def with_tree(change: Callable[[str], ast.NodeTransformer]) -> Callable[[str], ParseResult]:
    """A parser with something changed in its trees."""

    def changed(text: str) -> ParseResult:
        result = parse(text)
        return replace(result, tree=change(text).visit(result.tree))

    return changed


def test_a_wrong_scope_in_the_parser_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(temporal, "parse", with_tree(Narrow))
    assert violated("all_texts_are_one_tree", 1500) != "nothing"
    texts_of_it = [
        f"require {prefix} always {a} and {b}" for prefix in ("", "not", "next") for a in "abc" for b in "abc"
    ]
    for name in ("all_texts_have_one_verdict", "the_table_alone_gives_the_verdict"):
        noticed = 0
        for text in texts_of_it:
            try:
                BY_NAME[name].holds(Case(text))
            except Violation:
                noticed += 1
        # Not every trace tells the difference.
        assert noticed > 5


def test_a_refusal_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def refusing(text: str) -> ParseResult:
        return parse(text.replace(" until", " until until"))

    monkeypatch.setattr(temporal, "parse", refusing)
    assert "refused" in violated("formulas_are_accepted")


class Reversed(ast.NodeTransformer):
    """Takes the premise for the conclusion."""

    def visit_Temporal(self, node: Any) -> ast.AST:
        self.generic_visit(node)
        if node.operator == "implies":
            node.operands.reverse()
        return node


def test_wrong_code_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def reversing(module: ast.Module, resolution: Any) -> ast.Module:
        del resolution
        wrong = Reversed().visit(copy.deepcopy(module))
        return lower(wrong, resolve(wrong, Case("").source))

    monkeypatch.setattr(temporal, "lower", reversing)
    assert "simulations find" in violated("formulas_are_followed_as_meant", 1500)


def test_the_climbing_parser_is_driven_by_its_table() -> None:
    assert climb("a or b and c", temporal=True) == "( a or ( b and c ) )"
    assert climb("a or b and c", temporal=True, table=swapped(3, 4)) == "( ( a or b ) and c )"


def no_until(case: Case) -> None:
    if "until" in case.text:
        raise Violation("there is an `until`")


def test_a_run_tries_formulas_and_keeps_shrunk_ones(tmp_path: Path) -> None:
    report = Report()
    run_round(
        report,
        seed_of_round=3,
        until=math.inf,
        programs=0,
        mutants=0,
        formulas=60,
        of_formulas=(Property.of(no_until),),
    )
    (failure,) = report.failures
    assert report.formulas == 60
    assert failure.text == "require a until a\n"
    path = corpus.save(failure.text, "no_until", of_grammar=True, of_formulas=True, folder=tmp_path)
    assert path.name.startswith("formula-no_until-")
    assert list(corpus.entries(tmp_path)) == [corpus.Entry(path, failure.text, True, True)]
