"""The forms in the declarations are programs, and parse to what they declare."""

import ast

import pytest

from scenic.compiler import tree
from scenic.compiler.compile import compile_text
from scenic.compiler.parser import parse
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS, Operand
from scenic.language.specifiers import SPECIFIERS


def parsed(text: str) -> ast.expr:
    result = parse(text)
    assert result.diagnostics == ()
    [statement] = result.tree.body
    assert isinstance(statement, ast.Expr)
    return statement.value


def check_operands(found: list[ast.expr | None], declared: tuple[Operand, ...], form: str) -> None:
    """Operands that are written stand in their places; those that are not may be left out."""
    words = form.split()
    for operand, declaration in zip(found, declared, strict=True):
        if operand is None:
            assert declaration.default is not None
            assert declaration.name not in words
        else:
            assert isinstance(operand, ast.Name)
            assert operand.id == declaration.name


OPERATOR_FORMS = [(operator.name, form) for operator in OPERATORS.values() for form in operator.forms]
SPECIFIER_FORMS = [(specifier.name, form) for specifier in SPECIFIERS.values() for form in specifier.forms]


@pytest.mark.parametrize(("name", "form"), OPERATOR_FORMS)
def test_operators(name: str, form: str) -> None:
    node = parsed(form)
    assert isinstance(node, tree.Operation)
    assert node.operator == name
    check_operands(node.operands, OPERATORS[name].operands, form)


@pytest.mark.parametrize(("name", "form"), SPECIFIER_FORMS)
def test_specifiers(name: str, form: str) -> None:
    node = parsed(f"new Object {form}")
    assert isinstance(node, tree.New)
    [specifier] = node.specifiers
    assert specifier.specifier == name
    assert specifier.property == ("property" if name == "with" else None)
    check_operands(specifier.operands, SPECIFIERS[name].operands, form)


def refusals(text: str) -> list[str]:
    return [item.code for item in compile_text(text, filename="f").diagnostics]


def within(statement: str, operands: tuple[Operand, ...]) -> str:
    """A statement whose operands are parameters of a function round it."""
    names = ", ".join(dict.fromkeys(["property", *(operand.name for operand in operands)]))
    return f"def f({names}):\n    return {statement}\n"


@pytest.mark.parametrize(("name", "form"), OPERATOR_FORMS)
def test_operators_are_refused_as_declared(name: str, form: str) -> None:
    assert refusals(within(form, OPERATORS[name].operands)) == (
        [] if OPERATORS[name].available else ["SC900"]
    )


@pytest.mark.parametrize(("name", "form"), SPECIFIER_FORMS)
def test_specifiers_are_refused_as_declared(name: str, form: str) -> None:
    assert refusals(within(f"new Object {form}", SPECIFIERS[name].operands)) == (
        [] if SPECIFIERS[name].available else ["SC900"]
    )


@pytest.mark.parametrize("name", NAMES)
def test_names_are_refused_as_declared(name: str) -> None:
    assert refusals(f"print({name})") == ([] if NAMES[name].available else ["SC900"])
    assert refusals(f"{name}_ = 3\nprint({name}_)") == []
