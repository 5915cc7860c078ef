"""The declarations of the language as Markdown."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, cast

from scenic.language.keywords import (
    HARD_KEYWORDS,
    MEANINGS,
    PYTHON_KEYWORDS,
    TEMPORAL_OPERATORS,
    TemporalOperator,
)
from scenic.language.names import NAMES, SENSORS
from scenic.language.operators import OPERATORS, Operand, Operator
from scenic.language.properties import CLASSES, BuiltinProperty, attributes_of, properties_of
from scenic.language.specifiers import SPECIFIERS, SpecifierDeclaration
from scenic.language.statements import STATEMENTS, Statement

__all__ = [
    "of_keyword",
    "of_name",
    "of_operator",
    "of_property",
    "of_specifier",
    "of_statement",
    "of_temporal",
]

_MOST_FORMS: Final = 6

_REFUSED = "*This version does not build it yet.*"


def of_operator(operator: Operator) -> str:
    """Return an operator: its forms, what it does, its operands."""
    return _page(
        operator.forms,
        operator.documentation,
        [*_operands(operator.operands), f"result: {operator.result}"],
        available=operator.available,
    )


def of_specifier(specifier: SpecifierDeclaration) -> str:
    """Return a specifier: its forms, what it does, its operands, and what it specifies."""
    points = _operands(specifier.operands)
    for given in specifier.specifies:
        condition = f", if {given.when}" if given.when else ""
        points.append(f"specifies `{given.property}` (priority {given.priority}{condition})")
    points += [f"may adjust `{name}`" for name in specifier.modifies]
    return _page(specifier.forms, specifier.documentation, points, available=specifier.available)


def of_statement(statement: Statement) -> str:
    """Return a statement: its forms and what it does."""
    return _page(statement.forms, statement.documentation, (), available=statement.available)


def of_temporal(name: str) -> str | None:
    """Return a temporal operator."""
    operator = TEMPORAL_OPERATORS.get(name)
    if operator is None:
        return None
    return _page(operator.forms, operator.documentation, (), available=operator.available)


def of_name(name: str) -> str | None:
    """A name of the language: a class, a function, a distribution, a sensor."""
    declaration = NAMES.get(name) or SENSORS.get(name)
    if declaration is not None:
        points = [
            f"{declaration.kind.value}, also of random values"
            if declaration.lifted
            else declaration.kind.value
        ]
        if name in CLASSES:
            points.append("properties: " + ", ".join(f"`{each}`" for each in properties_of(name)))
        return _page(
            (declaration.signature,), declaration.documentation, points, available=declaration.available
        )
    if name in ("ego", "workspace"):
        return of_keyword(name)
    return None


def of_property(name: str) -> str | None:
    """Return a property or derived attribute of the built-in classes, as the most derived class has it."""
    for cls in reversed(list(CLASSES)):
        declaration = properties_of(cls).get(name)
        if declaration is not None:
            return _property(declaration)
        attribute = attributes_of(cls).get(name)
        if attribute is not None:
            call = "(...)" if attribute.is_method else ""
            return _page(
                (f"{name}{call}: {attribute.type}",), attribute.documentation, ("cannot be specified",)
            )
    return None


def of_keyword(word: str) -> str | None:
    """Return a keyword, in general: its own meaning, or the elements of the language that begin with it or hold it."""
    for table in (HARD_KEYWORDS, MEANINGS, PYTHON_KEYWORDS):
        if word in table:
            return _page((word,), table[word], ())
    elements = [
        (form, declaration.documentation) for declaration in _elements() for form in declaration.forms
    ]
    beginning = {form: text for form, text in elements if re.match(rf"{word}\b", form)}
    if beginning:
        return _page(list(beginning)[:_MOST_FORMS], next(iter(beginning.values())), ())
    forms = [form for form, _ in elements if word in form.split()]
    return _page(forms[:_MOST_FORMS], f"`{word}` is a part of what is written so.", ()) if forms else None


def _elements() -> Iterator[SpecifierDeclaration | Operator | TemporalOperator | Statement]:
    for table in (SPECIFIERS, OPERATORS, TEMPORAL_OPERATORS, STATEMENTS):
        yield from cast(
            "Mapping[str, SpecifierDeclaration | Operator | TemporalOperator | Statement]", table
        ).values()


def _property(declared: BuiltinProperty) -> str:
    attributes = [name for name in ("additive", "dynamic", "final") if getattr(declared, name)]
    points = [f"default: {declared.default}"]
    if attributes:
        points.append(", ".join(attributes))
    if declared.needs:
        points.append("the default depends on " + ", ".join(f"`{name}`" for name in declared.needs))
    return _page((f"{declared.name}: {declared.type}",), declared.documentation, points)


def _operands(operands: Sequence[Operand]) -> list[str]:
    return [
        f"`{operand.name}`: {operand.type}" + (f" (default: {operand.default})" if operand.default else "")
        for operand in operands
    ]


def _page(forms: Sequence[str], text: str, points: Sequence[str], *, available: bool = True) -> str:
    parts = ["```scenic\n" + "\n".join(forms) + "\n```", text]
    if points:
        parts.append("\n".join(f"- {point}" for point in points))
    if not available:
        parts.append(_REFUSED)
    return "\n\n".join(parts)
