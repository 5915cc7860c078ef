"""What operators bind to: against the table of the specification, and against a parser of another kind."""

import ast
import random
from collections.abc import Iterable, Sequence
from itertools import chain, pairwise
from typing import Final

import pytest

from fuzz.climbing import climb
from scenic.compiler.parser import parse
from scenic.compiler.precedence import ATOM, FORMS, Associativity, Fixity, Ladder, form_of, forms_of
from tests.amounts import amount
from tests.compiler.batches import parse_lines, reading_of, same
from tests.compiler.operator_texts import (
    MIXED,
    ORDINARY,
    TEMPORAL,
    Pattern,
    filled,
    inside,
    one_of_each_shape,
    pairs,
    pattern,
    triples,
)
from tests.compiler.spec_table import Row, reading

BATCH: Final = 5000
INSTANCES: Final = ("new C", "new C at _", "new C offset along _ by _")


def line_of(text: str, temporal: bool) -> str:
    return f"require {text}" if temporal else f"x = ( {text} )"


def expression_of(statement: ast.stmt) -> ast.expr:
    """The expression of a line."""
    node = getattr(statement, "condition", None) or getattr(statement, "value", None)
    assert isinstance(node, ast.expr)
    return node


def batches(texts: Iterable[str]) -> Iterable[list[str]]:
    ordered = sorted(texts)
    for start in range(0, len(ordered), BATCH):
        yield ordered[start : start + BATCH]


def check_readings(texts: Sequence[str], *, temporal: bool, trees: bool) -> int:
    """Compare what texts mean with what the specification's table says; returns how many are refused.

    With ``trees`` the tree of the bare text is compared with that of the parenthesised one too.
    """
    expected = [reading(text, temporal=temporal) for text in texts]
    lines = [line_of(text, temporal) for text in texts]
    statements = parse_lines(lines)
    found = [
        None if statement is None else reading_of(line, expression_of(statement))
        for line, statement in zip(lines, statements, strict=True)
    ]
    wrong = [each for each in zip(texts, expected, found, strict=True) if each[1] != each[2]]
    assert not wrong, f"{len(wrong)} differ; text, expected, found: {wrong[:10]}"
    if trees:
        again = parse_lines([line_of(text or "a", temporal) for text in expected])
        for text, bare, full, meant in zip(texts, statements, again, expected, strict=True):
            assert meant is None or same(bare, full), text
    return expected.count(None)


def test_all_pairs_of_ordinary_operators() -> None:
    refused = sum(
        check_readings(texts, temporal=False, trees=True) for texts in batches(set(pairs(ORDINARY, ORDINARY)))
    )
    assert refused > 500


def test_all_pairs_with_temporal_operators() -> None:
    both = MIXED + TEMPORAL
    texts = sorted({*pairs(TEMPORAL, both), *pairs(both, TEMPORAL)})
    assert check_readings(texts, temporal=True, trees=True) > 100


def _some(texts: Iterable[str]) -> list[str]:
    """Every third text in their order; in long runs all."""
    return sorted(set(texts))[:: amount(3, 1)]


@pytest.mark.slow
def test_triples_of_ordinary_operators() -> None:
    # What specifiers may go on with is contested by operators around them; no table of levels says who wins.
    rows = [row for row in one_of_each_shape(ORDINARY) if not row.words & {":=", "C"}]
    rows += [row for row in ORDINARY if row.text in INSTANCES]
    assert {row.level for row in rows} == {row.level for row in ORDINARY} - {1}
    for texts in batches(_some(triples(rows, rows, rows))):
        check_readings(texts, temporal=False, trees=False)


@pytest.mark.slow
def test_triples_with_temporal_operators() -> None:
    both = MIXED + TEMPORAL
    texts = chain(triples(TEMPORAL, both, both), triples(both, TEMPORAL, both), triples(both, both, TEMPORAL))
    for batch in batches(_some(texts)):
        check_readings(batch, temporal=True, trees=True)


def random_pattern(chance: random.Random, rows: Sequence[Row], size: int) -> Pattern:
    """Operators in one another's operands, some of them in parentheses."""
    words = pattern(chance.choice(rows))
    for _ in range(size - 1):
        operands = words.count(None)
        if operands == 0:
            break
        inner = pattern(chance.choice(rows))
        if chance.random() < 0.3:
            inner = ("(", *inner, ")")
        words = inside(words, inner, chance.randrange(operands))
    return words


def damaged(chance: random.Random, words: list[str]) -> list[str]:
    """Words with one of them lost, doubled, or at another place."""
    at, to = chance.randrange(len(words)), chance.randrange(len(words))
    match chance.randrange(3):
        case 0:
            return words[:at] + words[at + 1 :]
        case 1:
            return [*words[:at], words[at], *words[at:]]
    words = list(words)
    words.insert(to, words.pop(at))
    return words


def balanced(words: list[str]) -> bool:
    """Whether every bracket has its partner."""
    text = "".join(word for word in words if word in set("()[]"))
    while (shorter := text.replace("()", "").replace("[]", "")) != text:
        text = shorter
    return not text


@pytest.mark.parametrize("temporal", [False, True])
def test_a_parser_driven_by_the_table_alone_agrees(temporal: bool) -> None:
    chance = random.Random(29 + temporal)
    # Specifiers are no part of the table: instances stand without them.
    rows = [row for row in (MIXED + TEMPORAL) * 2 + ORDINARY if "new" not in row.words]
    rows = [row for row in rows if ":=" not in row.words and (temporal or not row.temporal)]
    texts: list[str] = []
    while len(texts) < amount(1200, 4000):
        words = random_pattern(chance, rows, chance.randint(1, 7))
        if words.count(None) > 8:
            continue
        tokens = filled(words).split()
        # Displays are atoms of which the table does not tell, and pieces of calls can become some.
        if chance.random() < 0.4 and not {"[", "()"} & {*tokens, *map("".join, pairwise(tokens))}:
            tokens = damaged(chance, tokens)
        # Nor does it of `*a`, and unbalanced brackets are the lexer's business.
        if (
            tokens
            and "()" not in map("".join, pairwise(tokens))
            and not {"(*", "(**"} & {"(" + tokens[0], *map("".join, pairwise(tokens))}
            and balanced(tokens)
        ):
            texts.append(" ".join(tokens))
    prefix = "require" if temporal else "x ="
    lines = [f"{prefix} {text}" for text in texts]
    statements = parse_lines(lines, shared_words=False)
    climbed = [climb(text, temporal=temporal) for text in texts]
    refused = 0
    for text, statement, full in zip(texts, statements, climbed, strict=True):
        assert (statement is None) == (full is None), (text, full)
        if full is None:
            refused += 1
        else:
            meant = parse(f"{prefix} {full}")
            assert meant.diagnostics == (), (text, full)
            assert same(statement, meant.tree.body[0]), (text, full)
    assert len(texts) / 8 < refused < 3 * len(texts) / 4


def test_levels_are_those_of_the_specification() -> None:
    assert ATOM == 19
    levels = {form.text: form.level for form in FORMS if form.ladder is Ladder.ORDINARY}
    assert levels["_ offset along _ by _"] == 8
    assert levels["distance from _ to _"] == 11
    assert levels["_ := _"] == 1
    temporal = {form.text: form.level for form in FORMS if form.ladder is Ladder.TEMPORAL}
    # Where both ladders have an operator, its level is one number.
    assert temporal["not _"] == levels["not _"]
    assert (
        temporal["_ until _"]
        < temporal["always _"]
        < temporal["_ implies _"]
        < temporal["_ or _"]
        == levels["_ or _"]
    )


def test_fixity_and_associativity() -> None:
    found = {form.text: (form.fixity, form.associativity) for form in FORMS if form.ladder is Ladder.ORDINARY}
    assert found["_ if _ else _"] == (Fixity.TERNARY, Associativity.RIGHT)
    assert found["_ < _"] == (Fixity.INFIX, Associativity.CHAINED)
    assert found["_ - _"] == (Fixity.INFIX, Associativity.LEFT)
    assert found["_ ** _"] == (Fixity.INFIX, Associativity.RIGHT)
    assert found["_ deg"] == (Fixity.POSTFIX, Associativity.LEFT)
    assert found["not visible _"] == (Fixity.PREFIX, Associativity.RIGHT)
    assert found["new _ _"] == (Fixity.CLOSED, Associativity.NONE)
    (until,) = forms_of("Temporal", "until", Ladder.TEMPORAL)
    assert until.associativity is Associativity.NONE


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("a + b", "_ + _"),
        ("a if b else c", "_ if _ else _"),
        ("a or b or c", "_ or _"),
        ("a < b in c", "_ < _"),
        ("-a", "- _"),
        ("a visible from b", "_ visible from _"),
        ("visible a", "visible _"),
        ("not visible a", "not visible _"),
        ("distance to b from a", "distance from _ to _"),
        ("distance to b", "distance to _"),
        ("f()", "_ ( )"),
        ("f(*a)", "_ ( _ )"),
        ("f(a=b)", "_ ( _ )"),
        ("a.b", "_ . _"),
        ("a[b]", "_ [ _ ]"),
        ("new C at a", "new _ _"),
        ("initial scenario", "initial scenario"),
        ("lambda a: b", "lambda _ : _"),
        ("a", None),
        ("[a]", None),
        ("'a'", None),
    ],
)
def test_the_form_of_a_node(text: str, form: str | None) -> None:
    (statement,) = parse(f"x = {text}").tree.body
    found = form_of(expression_of(statement))
    assert (found and found.text) == form


def test_forms_in_conditions_and_specifiers() -> None:
    (statement,) = parse("require not (always a)").tree.body
    condition = expression_of(statement)
    outer = form_of(condition, Ladder.TEMPORAL)
    assert outer is not None
    assert (outer.ladder, outer.level) == (Ladder.TEMPORAL, 5)
    assert isinstance(condition, ast.UnaryOp)
    assert form_of(condition.operand) is None
    inner = form_of(condition.operand, Ladder.TEMPORAL)
    assert inner is not None
    (slot,) = outer.slots
    assert slot.accepts(inner)
    (addition,) = forms_of("BinOp", "Add", Ladder.TEMPORAL)
    assert addition.ladder is Ladder.ORDINARY
    assert slot.accepts(addition)
    # `:=` has the number of a temporal level, but stands in no condition without parentheses.
    (named,) = forms_of("NamedExpr", None)
    assert not any(
        each.accepts(named) for form in FORMS if form.ladder is Ladder.TEMPORAL for each in form.slots
    )
    (created,) = parse("x = new C beyond a by b").tree.body
    instance = expression_of(created)
    beyond = form_of(instance.specifiers[0])  # type: ignore[attr-defined] # of `New`
    assert beyond is not None
    assert (beyond.ladder, beyond.text, beyond.absent) == (Ladder.SPECIFIER, "beyond _ by _", (2,))
