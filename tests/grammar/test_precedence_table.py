"""The table of precedence that the generator reads from the grammar."""

from collections.abc import Iterable

import pytest

from grammar.generator import read_grammar_text
from grammar.generator.analysis import Analysis
from grammar.generator.precedence import Content, Form, Precedence, Slot
from scenic.compiler import precedence
from scenic.compiler.precedence import FORMS, LADDERS, SPECIFIERS, Ladder, Word
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS as DECLARED_SPECIFIERS
from tests.compiler import spec_table

SMALL = """\
@start file
file: a=named_expression ENDMARKER { a }
named_expression:
    | a=each { a }
each:
    | "each" a=sum 'in' b=each { Operation(operator="each", operands=[b, a]) }
    | sum
sum:
    | a=sum ('+' | '-') b=sign { Operation(operator="sum", operands=[a, b]) }
    | sign
sign:
    | '-' a=sign { UnaryOp(op=USUB, operand=a) }
    | range
range:
    | a=call "to" b=call c=("step" d=call)? { Operation(operator="range", operands=[a, b, c]) }
    | call
call:
    | a=call '(' b=arguments? ')' { Call(func=a, args=b, keywords=[]) }
    | atom
atom:
    | '(' a=named_expression ')' { a }
    | a=NAME { texts[a] }
    | '[' ']' { texts[0] }
arguments:
    | a=','.named_expression+ { a }
"""


def small() -> Precedence:
    return Precedence(Analysis(read_grammar_text(SMALL)))


def shown(form: Form) -> str:
    return " ".join(
        f"<{part.level.number}>"
        if isinstance(part, Slot)
        else f"[{part.rule}]"
        if isinstance(part, Content)
        else part
        for part in form.parts
    )


def test_levels_and_forms_of_a_small_grammar() -> None:
    table = small()
    assert table.ladders == {
        "ordinary": [
            ("named_expression", 1),
            ("each", 2),
            ("sum", 3),
            ("sign", 4),
            ("range", 5),
            ("call", 6),
            ("atom", 7),
        ]
    }
    assert [(form.level.number, shown(form), form.fixity, form.associativity) for form in table.forms] == [
        (2, "each <3> in <2>", "prefix", "right"),
        (3, "<3> + <4>", "infix", "left"),
        (3, "<3> - <4>", "infix", "left"),
        (4, "- <4>", "prefix", "right"),
        (5, "<6> to <6> step <6>", "ternary", "none"),
        (5, "<6> to <6>", "infix", "none"),
        (6, "<6> ( [arguments] )", "postfix", "left"),
        (7, "( <1> )", "closed", "none"),
    ]


def test_what_the_actions_of_a_small_grammar_make() -> None:
    found = [(form.node, form.operator, form.targets, form.absent) for form in small().forms]
    assert found == [
        ("Operation", "each", (("operands", 1), ("operands", 0)), ()),
        ("Operation", "sum", (("operands", 0), ("operands", 1)), ()),
        ("Operation", "sum", (("operands", 0), ("operands", 1)), ()),
        ("UnaryOp", "USub", (("operand", None),), ()),
        ("Operation", "range", (("operands", 0), ("operands", 1), ("operands", 2)), ()),
        ("Operation", "range", (("operands", 0), ("operands", 1)), (2,)),
        ("Call", None, (("func", None),), ()),
        ("", None, (None,), ()),
    ]


def row_text(parts: Iterable[object]) -> str:
    """A form with the levels of its operands, the same for the specification's rows and the grammar's."""
    words = []
    for part in parts:
        match part:
            case str():
                words.append(part)
            case Word():
                words.append(part.text)
            case spec_table.Slot():
                words.append(f"<{part.level}{' or prefix' if part.prefixes else ''}>")
            case precedence.Slot():
                assert part.also in ((), ("temporal_prefix",))
                words.append(f"<{part.level}{' or prefix' if part.also else ''}>")
            case _:
                words.append("_")
    # What stands after `new` is one thing in the specification, a name and specifiers in the grammar.
    return " ".join(words).replace("new _ _", "new _")


def test_the_table_is_that_of_the_specification() -> None:
    written = {(row.temporal, row.level, row_text(row.parts), row.chain) for row in spec_table.TABLE}
    extracted = {
        (
            form.ladder is Ladder.TEMPORAL,
            form.level,
            row_text(form.parts),
            form.associativity is precedence.Associativity.CHAINED,
        )
        for form in FORMS
    }
    assert extracted == written


@pytest.mark.parametrize("ladder", list(LADDERS))
def test_every_level_has_an_operator_or_only_groups_others(ladder: Ladder) -> None:
    used = {form.level for form in FORMS if form.ladder is ladder}
    assert used == set(LADDERS[ladder].values())


def test_every_declared_operator_and_specifier_has_forms() -> None:
    """The forms that make it leave out, between them, only operands that have a default."""
    for name, operator in OPERATORS.items():
        forms = [form for form in FORMS if form.node == "Operation" and form.operator == name]
        check_operands(name, forms, [each.default is not None for each in operator.operands])
    for name, specifier in DECLARED_SPECIFIERS.items():
        forms = [form for form in SPECIFIERS if form.operator == name]
        check_operands(name, forms, [each.default is not None for each in specifier.operands])


def check_operands(name: str, forms: list[precedence.Form], optional: list[bool]) -> None:
    assert forms, name
    for form in forms:
        given = sorted(
            slot.target.index for slot in form.slots if slot.target and slot.target.index is not None
        )
        assert sorted([*given, *form.absent]) == list(range(len(optional))), form.text
        assert all(optional[index] for index in form.absent), form.text
