"""The declarations fit together and say what the specification says."""

import keyword
from pathlib import Path

import pytest

from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.language import keywords
from scenic.language.keywords import PYTHON_KEYWORDS, TEMPORAL_OPERATORS
from scenic.language.names import CONVERSIONS, LIFTED_FUNCTIONS, NAMES, RESERVED
from scenic.language.operators import OPERATORS, SIDES
from scenic.language.properties import CLASSES, PROPERTY_ATTRIBUTES, attributes_of, properties_of
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS
from scenic.language.support import refused_features

REFUSED = Path(__file__).parent.parent / "data" / "refused_features.txt"

OWN_SOFT_KEYWORDS = {"resting"}
"""Words that this implementation adds to the language."""

SPECIFICATION_SOFT_KEYWORDS = """
    _ abort above additive after ahead along altitude always angle apparent apparently away back behavior behind below
    beyond bottom can case choose compose contained deg directly distance dynamic ego eventually every facing final
    follow following front heading implies initial interrupt intersects invariant left match minimum model monitor
    mutate next offset override param past position precondition record relative right scenario seconds see setup
    shuffle simulation simulator steps take terminate top toward type visible wait when workspace
"""


def test_what_this_version_refuses(request: pytest.FixtureRequest) -> None:
    found = "".join(f"{feature}\n" for feature in refused_features())
    if request.config.getoption("--update-golden", default=False):
        REFUSED.write_text(found, encoding="utf-8")
    assert found == REFUSED.read_text(encoding="utf-8")


def test_keywords_are_those_of_the_specification() -> None:
    assert {*SOFT_KEYWORDS, *keywords.MEANINGS} == set(
        SPECIFICATION_SOFT_KEYWORDS.split()
    ) | OWN_SOFT_KEYWORDS
    assert set(PYTHON_KEYWORDS) == set(keyword.kwlist)
    hard = {"at", "by", "do", "new", "of", "on", "require", "to", "until"}
    assert set(HARD_KEYWORDS) == hard | set(PYTHON_KEYWORDS)
    assert set(keywords.HARD_KEYWORDS) == hard
    assert set(TEMPORAL_OPERATORS) <= set(SOFT_KEYWORDS) | set(HARD_KEYWORDS)


@pytest.mark.parametrize("table", [OPERATORS, SPECIFIERS, STATEMENTS, NAMES, CLASSES])
def test_every_declaration_is_documented(table: dict[str, object]) -> None:
    for name, declaration in table.items():
        documentation = declaration.documentation
        assert documentation.endswith("."), name
        assert documentation[0].isupper() or documentation[0] == "`", name


@pytest.mark.parametrize("table", [OPERATORS, SPECIFIERS])
def test_forms_name_the_operands(table: dict[str, object]) -> None:
    for declaration in table.values():
        required = {operand.name for operand in declaration.operands if operand.default is None}
        for form in declaration.forms:
            assert required <= set(form.replace(",", " ").split()), form


def test_there_is_an_operator_for_every_side() -> None:
    assert len(SIDES) == 18
    for side in SIDES:
        first, *rest = side.split()
        attribute = first + "".join(word.capitalize() for word in rest)
        assert attribute in attributes_of("Object")
        assert f"{side} of" in OPERATORS


def test_specifiers_specify_declared_properties() -> None:
    known = set(properties_of("Object"))
    for specifier in SPECIFIERS.values():
        for specified in specifier.specifies:
            assert specified.property in known, specifier.name
            assert specified.priority in (1, 2, 3)
        assert set(specifier.modifies) <= {specified.property for specified in specifier.specifies}
        assert set(specifier.needs) <= known, specifier.name
    assert [specifier.name for specifier in SPECIFIERS.values() if specifier.modifies] == ["on", "resting on"]


def test_properties_inherit_and_need_declared_ones() -> None:
    assert list(CLASSES) == ["Point", "OrientedPoint", "Object"]
    for cls in CLASSES:
        properties = properties_of(cls)
        for entry in properties.values():
            assert set(entry.needs) <= set(properties), entry.name
            assert not (entry.additive and entry.dynamic), entry.name
        # A property that is an attribute as well could not be specified.
        assert not set(properties) & set(attributes_of(cls))
    assert properties_of("Object")["width"].default == "shape.width"
    assert properties_of("OrientedPoint")["width"].default == "0"
    assert {entry.name for entry in properties_of("Object").values() if entry.final} == {
        "orientation",
        "heading",
        "observations",
    }
    assert set(PROPERTY_ATTRIBUTES) == {"additive", "dynamic", "final"}


def test_lifted_functions_and_reserved_names() -> None:
    assert CONVERSIONS <= LIFTED_FUNCTIONS <= set(NAMES)
    assert {"sin", "cos", "hypot", "max", "min", "round", "len", "abs"} <= LIFTED_FUNCTIONS
    assert sorted(RESERVED) == ["ego", "float", "globalParameters", "int", "str", "workspace"]
