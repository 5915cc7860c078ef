"""What the unparser writes is parsed to the same tree again, and has no parentheses that could be left out."""

import ast
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import pytest
from hypothesis import given, settings

from fuzz.grammar import Program, programs
from scenic.compiler import tree
from scenic.compiler.generated import SOFT_KEYWORDS
from scenic.compiler.parser import parse
from scenic.compiler.unparser import UnparseError, unparse
from tests.amounts import amount
from tests.compiler import tree_strategies as trees
from tests.compiler.golden_cases import Case, python_cases, scenic_cases
from tests.compiler.round_trip import difference
from tests.compiler.round_trip import written_again as check
from tests.each import each

ROOT = Path(__file__).parent.parent.parent
DATA = ROOT / "tests" / "data" / "unparser"
NEWER = sys.version_info >= (3, 12)


def module(*statements: ast.stmt) -> ast.Module:
    return ast.Module(body=list(statements), type_ignores=[])


def readable(text: str) -> ast.Module | None:
    """The tree of a text, if it has no errors that leave something out."""
    found = parse(text).tree
    return None if any(isinstance(node, tree.ErrorStatement) for node in ast.walk(found)) else found


# What the parser makes.


@each(scenic_cases())
def test_scenic_cases(case: Case) -> None:
    found = readable(case.source)
    assert found is not None
    check(found)


@pytest.mark.parametrize("case", python_cases(), ids=str)
def test_python_cases(case: Case) -> None:
    found = readable(case.source)
    if found is None:
        assert not NEWER or parse(case.source).diagnostics
        return
    text = check(found)
    if not any(type(node).__module__ == tree.__name__ for node in ast.walk(found)):
        assert difference(ast.parse(text), found) is None or not NEWER


@pytest.mark.parametrize(
    "path",
    sorted([*ROOT.glob("examples/**/*.scenic"), *ROOT.glob("tests/data/**/*.scenic")]),
    ids=lambda path: path.stem,
)
def test_programs(path: Path) -> None:
    found = readable(path.read_text(encoding="utf-8"))
    if found is not None:
        check(found)


@settings(max_examples=amount(75, 150), derandomize=True, deadline=None)
@given(programs())
def test_generated_programs(program: Program) -> None:
    found = readable(program.text)
    if found is not None:
        check(found)


# Trees that were never texts.


def check_all(statements: Iterable[ast.stmt], size: int = 200) -> None:
    """Check many statements, several at once."""
    batch: list[ast.stmt] = []
    for statement in statements:
        batch.append(statement)
        if len(batch) == size:
            check_batch(batch)
            batch = []
    check_batch(batch)


def check_batch(batch: Sequence[ast.stmt]) -> None:
    whole = module(*batch)
    text = unparse(whole)
    if difference(parse(text).tree, whole) is not None:
        for statement in batch:
            check(module(statement))


SIMPLE = trees.simple()


def assigned(values: Iterable[ast.expr]) -> Iterator[ast.stmt]:
    return (ast.Assign(targets=[trees.name("v")], value=value, type_comment=None) for value in values)


def required(values: Iterable[ast.expr]) -> Iterator[ast.stmt]:
    return (tree.Require(condition=value, probability=None, name=None) for value in values)


def test_every_operator_in_every_operand() -> None:
    check_all(assigned(trees.pairs(trees.ORDINARY, SIMPLE)))


def test_every_operator_in_every_specifier() -> None:
    check_all(assigned(trees.in_specifiers(SIMPLE)))


def test_conditions() -> None:
    inner = [
        trees.build(form, [trees.name(x) for x in "xyz"[: len(form.slots)]])
        for form in trees.TEMPORAL
        if form.slots
    ]
    pairs = list(trees.pairs([form for form in trees.TEMPORAL if form.node != "Lambda"], inner))
    check_all(required([*inner, *pairs]))
    check_all(required(trees.pairs([form for form in trees.TEMPORAL if form.node != "Lambda"], SIMPLE)))
    check_all(required(trees.pairs([form for form in trees.TEMPORAL if form.node != "Lambda"], pairs)))


@settings(max_examples=amount(125, 250), deadline=None)
@given(trees.statements)
def test_random_trees(statement: ast.stmt) -> None:
    check(module(statement))


@pytest.mark.slow
@settings(max_examples=amount(150, 300), deadline=None)
@given(trees.statements)
def test_many_random_trees(statement: ast.stmt) -> None:
    check(module(statement))


def uses(word: str) -> Iterator[ast.expr]:
    """A name where it may be taken for a keyword: alone, and before what begins an operand."""
    name, x = trees.name, trees.name("x")
    called = ast.Call(func=name(word), args=[x], keywords=[])
    yield name(word)
    yield called
    yield ast.Subscript(value=name(word), slice=x, ctx=trees.LOAD)
    yield ast.UnaryOp(op=ast.Not(), operand=name(word))
    yield ast.UnaryOp(op=ast.Not(), operand=called)
    yield ast.BinOp(left=name(word), op=ast.Sub(), right=x)
    yield ast.BinOp(left=called, op=ast.BitOr(), right=called)
    yield ast.Compare(left=name(word), ops=[ast.NotIn()], comparators=[name(word)])
    yield ast.BoolOp(op=ast.And(), values=[called, called])
    yield ast.Lambda(args=trees.parameters(), body=called)
    for operator in ("visible", "not visible", "can see", "relative to"):
        yield tree.Operation(operator=operator, operands=[name(word), x])
    yield tree.Operation(operator="deg", operands=[name(word)])
    yield tree.Operation(operator="distance", operands=[name(word), name(word)])
    yield tree.Operation(operator="distance past", operands=[name(word), called])
    at = tree.SpecifierPhrase(specifier="at", property=None, operands=[name(word)])
    yield ast.List(elts=[tree.New(cls=x, specifiers=[at]), name(word), called], ctx=trees.LOAD)


def statements_with(value: ast.expr) -> Iterator[ast.stmt]:
    """Statements in which the value stands in all places where words of the statement are near."""
    name = trees.name
    seconds = tree.Duration(value=value, unit="seconds")
    yield ast.Expr(value=value)
    yield ast.Expr(value=ast.Tuple(elts=[value, value], ctx=trees.LOAD))
    yield ast.Assign(targets=[name("v")], value=value, type_comment=None)
    yield ast.Raise(exc=value, cause=value)
    yield ast.Expr(
        value=ast.ListComp(
            elt=value, generators=[ast.comprehension(target=name("v"), iter=value, ifs=[value], is_async=0)]
        )
    )
    yield ast.Expr(
        value=ast.JoinedStr(values=[ast.FormattedValue(value=value, conversion=-1, format_spec=None)])
    )
    for probability in (None, 0.5):
        for title in (None, "n"):
            yield tree.Require(condition=value, probability=probability, name=title)
    for operator in ("until", "implies"):
        condition = tree.Temporal(operator=operator, operands=[value, value])
        yield tree.Require(condition=condition, probability=None, name=None)
    either = ast.BoolOp(op=ast.Or(), values=[value, tree.Temporal(operator="next", operands=[value])])
    both = ast.BoolOp(op=ast.And(), values=[either, value])
    yield tree.Require(condition=both, probability=None, name=None)
    yield tree.RequireMonitor(monitor=value, name=None)
    for moment in (None, "initial", "final"):
        yield tree.Record(moment=moment, value=value, every=None, after=None, name=None, to=None)
    yield tree.Record(moment=None, value=value, every=seconds, after=None, name=None, to=None)
    yield tree.Record(moment=None, value=value, every=None, after=seconds, name="n", to=None)
    yield tree.Record(moment=None, value=value, every=None, after=None, name=None, to=value)
    yield tree.Take(actions=[value, value])
    yield tree.Simulator(value=value)
    yield tree.Do(targets=[value, value], duration=None, until=None)
    yield tree.Do(targets=[value], duration=seconds, until=None)
    yield tree.Do(targets=[value], duration=None, until=value)
    yield tree.DoChoose(targets=[value])
    yield tree.WaitFor(duration=seconds)
    yield tree.TerminateWhen(simulation=False, condition=value, name=None)
    yield tree.Override(
        target=value, specifiers=[tree.SpecifierPhrase(specifier="visible", property=None, operands=[None])]
    )
    if isinstance(value, ast.Name | ast.Subscript):
        for targets in (
            [value],
            [name("v"), value],
            [ast.Tuple(elts=[value, name("v")], ctx=ast.Store())],
            [ast.Tuple(elts=[name("v"), value], ctx=ast.Store())],
        ):
            yield ast.Assign(targets=targets, value=name("x"), type_comment=None)
        yield ast.AugAssign(target=value, op=ast.Add(), value=name("x"))
        yield ast.AnnAssign(target=value, annotation=name("x"), value=None, simple=0)
        yield ast.Delete(targets=[value])
        yield ast.For(target=value, iter=value, body=[ast.Pass()], orelse=[], type_comment=None)


@pytest.mark.parametrize("word", [*SOFT_KEYWORDS, "plain"])
def test_soft_keywords_as_names(word: str) -> None:
    check_all(statement for use in uses(word) for statement in statements_with(use))


# Parentheses.

PAIR = re.compile(r"[()]")


def in_parentheses(text: str) -> Iterator[tuple[int, int]]:
    """The places of all pairs of parentheses."""
    opened: list[int] = []
    for found in PAIR.finditer(text):
        if found[0] == "(":
            opened.append(found.start())
        else:
            yield opened.pop(), found.start()


def needless(statement: ast.stmt) -> Iterator[str]:
    """Texts with a pair of parentheses less that mean the same."""
    whole = module(statement)
    text = unparse(whole)
    for start, end in in_parentheses(text):
        shorter = f"{text[:start]} {text[start + 1 : end]} {text[end + 1 :]}"
        result = parse(shorter)
        if not result.diagnostics and difference(result.tree, whole) is None:
            yield shorter


def of_later_readings(text: str) -> bool:
    """Whether parentheses help a reader from left to right: `follow` leaves its `from` to no operand otherwise."""
    return text.startswith("v = follow ")


def test_no_needless_parentheses() -> None:
    of_pairs = [*assigned(trees.pairs(trees.ORDINARY, SIMPLE))][::3]
    found = [text for statement in of_pairs for text in needless(statement)]
    assert [text for text in found if not of_later_readings(text)] == []
    assert len(found) <= 8


def test_no_needless_parentheses_in_specifiers() -> None:
    of_specifiers = assigned(trees.in_specifiers(SIMPLE))
    assert [text for statement in of_specifiers for text in needless(statement)] == []


def test_no_needless_parentheses_in_conditions() -> None:
    ladder = [form for form in trees.TEMPORAL if form.node != "Lambda"]
    inner = [trees.build(form, [trees.name(x) for x in "xyz"[: len(form.slots)]]) for form in ladder]
    conditions = required(trees.pairs(ladder, [*inner, *SIMPLE]))
    assert [text for statement in conditions for text in needless(statement)] == []


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("x = distance from (distance to a) to b", "x = distance from distance to a to b"),
        ("x = distance from (distance from a) to b", None),
        ("x = (distance to a) + b", None),
        ("x = distance to (a + b)", "x = distance to a + b"),
        ("x = (a relative to b) relative to c", "x = a relative to b relative to c"),
        ("x = a relative to (b relative to c)", None),
        ("x = (2 * x) deg", "x = 2 * x deg"),
        ("x = 2 * (x deg)", None),
        ("x = not (visible x)", None),
        ("x = not visible x", None),
        ("x = not (visible)", "x = not visible"),
        ("x = [(new C at p), visible]", None),
        ("x = [(new C at p), y]", "x = [new C at p, y]"),
        ("x = (new C at p) + y", None),
        ("x = (new C) + y", "x = new C + y"),
        ("x = new C at (new D at p), facing h", "x = new C at (new D at p), facing h"),
        ("x = new C at (new D), facing h", "x = new C at new D, facing h"),
        ("x = new C left of (new D left of a) by 3", None),
        ("(take)(3)", None),
        ("(wait)", None),
        ("wait == 3", None),
        ("visible[i] = 3", None),
        ("x = (visible)(y)", None),
        ("x = a + visible(y)", None),
        ("record (initial scenario)", None),
        ("require (monitor)(x)", None),
        ("require ([0.5])[0]", None),
        ("require (always) - x", None),
        ("require (always a) implies (eventually (b until c))", "require (always a) implies eventually (b until c)"),
        ("require (always a) and b", None),
        ("require a and (always b)", "require a and always b"),
        ("do (a if c else b) until d", None),
        ("x = (3).real", None),
        ("x = (lambda: y)()", None),
        ("x = (yield)", "x = yield"),
        ("return (a, b)", "return a, b"),
        ("for (a, b) in (c, d):\n    pass", "for a, b in c, d:\n    pass"),
        ("with ((a, b)):\n    pass", None),
        ("raise (distance) from x", None),
    ],
)  # fmt: skip
def test_parentheses(text: str, written: str | None) -> None:
    found = readable(text)
    assert found is not None
    assert check(found) == f"{written or text}\n"


# Literals and layout.


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("'a'", '"a"'),
        ("'say \"a\"'", "'say \"a\"'"),
        ("u'a'", 'u"a"'),
        ("b'a\\x00'", 'b"a\\x00"'),
        ("'\\ud800\\x07é'", '"\\ud800\\x07é"'),
        ("1e999", "1e309"),
        ("1e999j", "1e309j"),
        ("0x10", "16"),
        ("f'{x[\"a\"]}'", "f\"{x['a']}\""),
        ("f'{x=}'", 'f"x={x!r}"'),
        ("f'{x!s:>{w}.2f}{{}}'", 'f"{x!s:>{w}.2f}{{}}"'),
        ("f'{(lambda: x)}'", 'f"{(lambda: x)}"'),
        ("f'{ {1: 2}[1] }'", 'f"{ {1: 2}[1]}"'),
        ("f'{a, b}'", 'f"{a, b}"'),
        ("f'{x:\\x7b\\'}'", 'f"{x:\\x7b\'}"'),
        ("u'a' f'{x}' u'b'", 'u"a" f"{x}" u"b"'),
        ("f'{f\"{x}\"}'", "f\"{f'{x}'}\""),
        ("f'{a != b}'", 'f"{a != b}"'),
    ],
)
def test_literals(text: str, written: str) -> None:
    found = readable(f"x = {text}")
    assert found is not None
    assert check(found) == f"x = {written}\n"


def test_huge_numbers() -> None:
    check(module(ast.Expr(value=ast.Constant(value=10**5000, kind=None))))


def test_layout(request: pytest.FixtureRequest) -> None:
    found = readable((DATA / "layout.scenic").read_text(encoding="utf-8"))
    assert found is not None
    written = check(found)
    golden = DATA / "layout.expected.scenic"
    if request.config.getoption("--update-golden"):
        golden.write_text(written, encoding="utf-8")
    assert written == golden.read_text(encoding="utf-8")


def test_parts_of_trees() -> None:
    [statement] = parse("x = 1, 2").tree.body
    assert unparse(statement) == "x = 1, 2\n"
    assert isinstance(statement, ast.Assign)
    assert unparse(statement.value) == "(1, 2)"


# Depth, and trees without a text.


@pytest.mark.parametrize(
    "text",
    [
        "x = " + " + ".join(["a"] * 5000),
        "x = " + "-" * 5000 + "a",
        "x = " + "not " * 5000 + "a",
        "x = " + "a ** " * 5000 + "a",
        "x = " + "a if b else " * 5000 + "c",
        "x = " + "f(" * 5000 + ")" * 5000,
        "x = a" + ".b" * 5000,
        "x = " + " relative to ".join(["a"] * 5000),
        "x = " + "distance from " * 5000 + "a",
        "require " + "always " * 5000 + "a",
        "if a:\n    pass\n" + "elif b:\n    pass\n" * 2000,
        "\n".join(" " * depth + "if x:" for depth in range(500)) + "\n" + " " * 500 + "pass",
    ],
    ids=lambda text: text[4:16],
)
def test_deep_trees(text: str) -> None:
    check(parse(text).tree)


@pytest.mark.parametrize(
    ("node", "message"),
    [
        (tree.ErrorStatement(body=[], lineno=3), "could not be parsed has no text (line 3 "),
        (ast.If(test=trees.name("a"), body=[], orelse=[]), "a block without statements"),
        (ast.Expr(value=ast.Set(elts=[])), "the empty set"),
        (ast.Expr(value=ast.Constant(value=(1, 2))), "type `tuple`"),
        (
            ast.Expr(value=ast.BinOp(left=trees.name("a"), op=ast.MatMult(), right=trees.name("b"))),
            "Scenic reads its sign otherwise",
        ),
        (ast.Expr(value=tree.Temporal(operator="always", operands=[trees.name("a")])), "outside the condition"),
        (ast.Expr(value=tree.Operation(operator="at", operands=[None, None])), "`at` with these operands"),
        (ast.Expr(value=ast.MatchAs()), "`MatchAs` has no text as an expression"),
        (tree.PropertyDef(name="a", attributes=[], value=trees.name("b")), "outside a class"),
        (
            ast.ClassDef(
                name="C",
                bases=[],
                keywords=[],
                decorator_list=[],
                body=[ast.AnnAssign(target=trees.name("a"), annotation=trees.name("b"), value=None, simple=1)],
            ),
            "where it is a property",
        ),
    ],
)  # fmt: skip
def test_trees_without_a_text(node: ast.stmt, message: str) -> None:
    with pytest.raises(UnparseError, match=re.escape(message)):
        unparse(module(node))
