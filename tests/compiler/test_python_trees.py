"""What Scenic reads otherwise than Python, and how trees are compared; `test_library` compares those of modules."""

import ast
import sys
from typing import Any

import pytest

from scenic.compiler.parser import parse
from tests.compiler.python_trees import RULES, difference, reasons, words_of

ALL_FIELDS: dict[str, Any] = {"show_empty": True} if sys.version_info >= (3, 13) else {}

# What Scenic reads otherwise: the text, the rule that excuses it, and the tree it has in Scenic, if any.

OTHERWISE = [
    ("new = 1\n", "keyword_as_name", None),
    ("x.at(3)\n", "keyword_as_name", None),
    ("f(by=3)\n", "keyword_as_name", None),
    ("def until(): pass\n", "keyword_as_name", None),
    ("import on\n", "keyword_as_name", None),
    (
        "x = a @ b\n",
        "at_between_operands",
        "Assign([Name('x', Store())], Operation('@', [Name('a', Load()), Name('b', Load())]))",
    ),
    (
        "x = a @ b @ -c\n",
        "at_between_operands",
        (
            "Assign([Name('x', Store())], "
            "Operation('@', [Operation('@', [Name('a', Load()), Name('b', Load())]), UnaryOp(USub(), Name('c', Load()))]))"
        ),
    ),
    (
        "class C:\n  x: int\n",
        "annotation_in_class",
        None,
    ),
    (
        "class C:\n  x: (1, 2)\n",
        "annotation_in_class",
        "ClassDef('C', [], [], [PropertyDef('x', [], Tuple([Constant(1), Constant(2)], Load()))], [])",
    ),
    ("class C:\n  x: int = 3\n", "annotation_in_class", None),
    ("class C: x: int = 3\n", "annotation_in_class", None),
    ("take(3)\n", "statement_of_soft_keyword", "Take([Constant(3)])"),
    ("take[3]\n", "statement_of_soft_keyword", "Take([List([Constant(3)], Load())])"),
    ("take - 3\n", "statement_of_soft_keyword", "Take([UnaryOp(USub(), Constant(3))])"),
    (
        "record(x)\n",
        "statement_of_soft_keyword",
        "Record(None, Name('x', Load()), None, None, None, None)",
    ),
    ("simulator(x)\n", "statement_of_soft_keyword", "Simulator(Name('x', Load()))"),
    (
        "visible(x)\n",
        "statement_of_soft_keyword",
        "Expr(Operation('visible', [Name('x', Load()), None]))",
    ),
    (
        "y = visible[x]\n",
        "statement_of_soft_keyword",
        "Assign([Name('y', Store())], Operation('visible', [List([Name('x', Load())], Load()), None]))",
    ),
]


@pytest.mark.parametrize(("text", "rule", "tree"), OTHERWISE)
def test_what_scenic_reads_otherwise(text: str, rule: str, tree: str | None) -> None:
    expected = ast.parse(text)
    assert list(reasons(text, expected)) == [rule]
    result = parse(text)
    assert result.diagnostics or difference(result.tree, expected) is not None
    if tree is not None:
        assert not result.diagnostics
        statement = result.tree.body[0]
        vars(statement).pop("type_params", None)  # a field since 3.12
        assert ast.dump(statement, annotate_fields=False, **ALL_FIELDS) == tree


def test_every_rule_has_a_test() -> None:
    assert {rule.__name__ for rule in RULES} == {rule for _, rule, _ in OTHERWISE}


@pytest.mark.parametrize(
    "text",
    [
        "@new_decorator\ndef f(): pass\n",  # `@` not between operands
        "x: int = 3\n",
        "def f():\n  x: int\n",
        "class C:\n  def f(self):\n    x: int\n",
        "take = 3\n",
        "take.record(3)\n",
        "x = record\n",
        "visible.x = 3\n",
        "x @= y\n",
    ],
)
def test_what_scenic_reads_alike(text: str) -> None:
    expected = ast.parse(text)
    words = words_of(text)
    assert not any(rule(words, expected) for rule in RULES)
    result = parse(text)
    assert not result.diagnostics
    assert difference(result.tree, expected) is None


def test_the_comparison_sees_what_a_dump_shows() -> None:
    base = "x = f(1, 'a', *b)\nif a < b:\n  c: int = lambda d, e=3: None\n"
    for text in (
        base,
        base.replace("1", "2"),
        base.replace("1", "True"),
        base.replace("1", "1.0"),
        base.replace("'a'", "b'a'"),
        base.replace("*b", "b"),
        base.replace("<", ">"),
        base.replace(" = f", "  = f"),
        base.replace("c:", "(c):"),
        base.replace(", e=3", ""),
        base.replace("d,", "e,"),
        base + "pass\n",
    ):
        left, right = ast.parse(base), ast.parse(text)
        same = ast.dump(left, include_attributes=True) == ast.dump(right, include_attributes=True)
        assert (difference(left, right) is None) == same == (text == base)
