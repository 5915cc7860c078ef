"""The properties of trees, and of writing them, notice what they are there for."""

import ast
from collections.abc import Callable
from typing import Any

import pytest

from fuzz.properties import Case, Violation, formatting, trees
from fuzz.properties.differences import difference
from fuzz.properties.signatures import SIGNATURES
from scenic.compiler import tree as scenic
from scenic.compiler.parser import parse
from scenic.ide.formatting import format_text


def changed(text: str, cls: type[ast.AST], change: Callable[[Any], object]) -> Case:
    """A text in whose tree the first node of a class has been changed."""
    made = Case(text)
    change(next(node for node in ast.walk(made.result.tree) if isinstance(node, cls)))
    return made


def to(**fields: object) -> Callable[[Any], object]:
    return lambda node: [setattr(node, name, value) for name, value in fields.items()]


def test_signatures_cover_all_classes():
    assert {cls for cls in vars(scenic).values() if isinstance(cls, type) and "_fields" in vars(cls)} <= set(
        SIGNATURES
    )
    for cls, signature in SIGNATURES.items():
        if cls.__module__ == "scenic.compiler.tree" or cls.__name__ not in (
            "Num",
            "Str",
            "Bytes",
            "Ellipsis",
        ):
            assert tuple(field.name for field in signature) == cls._fields, cls


@pytest.mark.parametrize(
    ("text", "cls", "change", "message"),
    [
        ("x = 1\n", ast.Assign, to(targets=()), r"targets is \(\), not a list"),
        ("x = 1\n", ast.Assign, to(value=None), "value is None"),
        ("x = 1\n", ast.Assign, to(value="x"), "value is 'x'"),
        ("x = 1\n", ast.Module, to(body=[ast.Name("x", ast.Load())]), r"body\[0\] is Name"),
        ("x = 1\n", ast.Name, to(id=b"x"), "id is b'x'"),
        ("x = 1\n", ast.Constant, to(value=()), r"value is \(\)"),
        ("x = 1\n", ast.Name, to(ctx=ast.Load()), "context Load, not Store"),
        ("del x, (y,)\n", ast.Tuple, to(ctx=ast.Store()), "context Store, not Del"),
        ("(x, *y), z = 1\n", ast.Starred, to(value=ast.Name("y", ast.Load())), "context Load, not Store"),
        ("x.y = 1\n", ast.Name, to(ctx=ast.Store()), "context Store, not Load"),
        ("for x[i] in y: pass\n", ast.Subscript, to(ctx=ast.Load()), "context Load, not Store"),
        ("x\n", ast.Name, lambda node: delattr(node, "id"), "has no id"),
        ("{**a}\n", ast.Dict, to(keys=[]), "differ in length"),
        ("f(a)\n", ast.Call, to(args=[None]), r"args\[0\] is None"),
        ("def f(*, a): pass\n", ast.arguments, to(kw_defaults=[]), "more defaults"),
        ("x: int\n", ast.AnnAssign, to(simple=True), "simple is True"),
        ("new C\n", scenic.New, to(cls=ast.Constant(1)), "cls is Constant"),
        ("x offset by y\n", scenic.Operation, to(operands="xy"), "operands is 'xy'"),
        ("require x\n", scenic.Require, to(probability="1"), "probability is '1'"),
        ("scenario S():\n  x\n", scenic.ScenarioDef, to(setup=1), "setup is 1"),
        ("x\n", ast.Module, lambda node: node.body.append(Odd(value=node.body[0].value)), "Odd is no class"),
    ],
)
def test_fields_of_other_types_are_noticed(
    text: str, cls: type[ast.AST], change: Callable[[Any], object], message: str
):
    trees.fields_have_their_types(Case(text))
    with pytest.raises(Violation, match=message):
        trees.fields_have_their_types(changed(text, cls, change))


class Odd(ast.Expr):
    pass


def test_empty_lists_are_noticed():
    with pytest.raises(Violation, match="If at 1:0: body is empty"):
        trees.right_trees_are_whole(changed("if x: y\n", ast.If, to(body=[])))
    trees.right_trees_are_whole(changed("if x: y\nx x\n", ast.If, to(body=[])))


def places_of(name: str, **places: int) -> Case:
    """A text in whose tree the name has another place."""

    def change(tree: ast.Module) -> None:
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and node.id == name:
                vars(node).update(places)

    return changed("x + éé + yy + z\nw\n", ast.Module, change)


@pytest.mark.parametrize(
    ("name", "places", "message"),
    [
        ("éé", {"lineno": 9, "end_lineno": 9}, "outside"),
        ("éé", {"end_lineno": 9}, "outside"),
        ("éé", {"end_col_offset": 99}, "outside"),
        ("x", {"lineno": 0}, "outside"),
        ("x", {"col_offset": -1}, "outside"),
        ("éé", {"col_offset": 5, "end_col_offset": 4}, "ends before it starts"),
        # Each of the letters takes two bytes.
        ("éé", {"col_offset": 5}, "not start at a token"),
        ("éé", {"col_offset": 6}, "not start at a token"),
        ("éé", {"end_col_offset": 5}, "not end at the end of a token"),
        ("éé", {"end_col_offset": 6}, "not end at the end of a token"),
        ("éé", {"end_col_offset": 9}, "not end at the end of a token"),
        ("éé", {"end_col_offset": 10}, "not inside what it is part of"),
        ("éé", {"col_offset": 0}, "begins before the part before it ends"),
        ("w", {"lineno": 1, "end_lineno": 1}, "not inside what it is part of"),
    ],
)
def test_wrong_places_are_noticed(name: str, places: dict[str, int], message: str):
    trees.nodes_lie_in_the_text(places_of(name))
    with pytest.raises(Violation, match=message):
        trees.nodes_lie_in_the_text(places_of(name, **places))


def test_a_node_without_a_place_is_noticed():
    with pytest.raises(Violation, match="Name has no place"):
        trees.nodes_lie_in_the_text(changed("x\n", ast.Name, lambda node: delattr(node, "lineno")))


def test_another_order_is_noticed():
    with pytest.raises(Violation, match="begins before the part before it"):
        trees.nodes_lie_in_the_text(changed("f(a, b)\n", ast.Call, lambda node: node.args.reverse()))
    with pytest.raises(Violation, match="begins before the part before it"):
        trees.nodes_lie_in_the_text(changed("x\ny\n", ast.Module, lambda node: node.body.reverse()))


# Writing.


def test_differences_between_trees():
    def between(left: str, right: str, **options: bool) -> str | None:
        return difference(parse(left).tree, parse(right).tree, **options)

    assert between("x = (1)\n", "x = 1\n") is None
    assert between("x\n", "x \n", places=True) is None
    assert between("(x)\n", "x\n", places=True) == "tree.body[0].value.col_offset: 1 and 0"
    assert between("x = 1\n", "x = True\n") == "tree.body[0].value.value: 1 and True"
    assert between("x = 0.0\n", "x = -0.0\n") == "tree.body[0].value: Constant and UnaryOp"
    assert between("f(a, b)\n", "f(a)\n") == "tree.body[0].value.args: 2 and 1 elements"
    assert between("f(a, b)\n", "f(a, c)\n") == "tree.body[0].value.args[1].id: 'b' and 'c'"
    assert between("x = 1e999 - 1e999\n", "x = 1e999 - 1e999\n") is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("(a + b) * c", "a + b * c", "another tree"),
        ("@d\n", "", "another tree"),
        ("always ", "", "another tree"),
        ("a + b", "a b", "refused: SC1"),
        ("x = ", "x =  ", "differently the second time"),
    ],
)
def test_text_that_reads_differently_is_noticed(
    old: str, new: str, message: str, monkeypatch: pytest.MonkeyPatch
):
    text = "@d\ndef f(): pass\nx = (a + b) * c\nrequire always x\n"
    formatting.formatted_texts_read_the_same(Case(text, thorough=True))
    monkeypatch.setattr(formatting, "format_text", lambda text: (format_text(text) or "").replace(old, new))
    if "second" in message:
        monkeypatch.setattr(formatting, "format_text", lambda text: text.replace(old, new))
    with pytest.raises(Violation, match=message):
        formatting.formatted_texts_read_the_same(Case(text, thorough=True))
