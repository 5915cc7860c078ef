"""Texts for language models: all pages, and the copy of the examples in the package."""

from docs._extensions.for_models import COPY, full_text, index_text, snippets, snippets_text
from scenic.compiler.check import check_text
from scenic.language.diagnostics import Severity


def test_the_package_has_the_examples_of_the_pages() -> None:
    assert COPY.read_text(encoding="utf-8") == snippets_text(), "python -m docs._extensions.for_models"


def test_examples_are_right() -> None:
    found = list(snippets())
    assert len(found) > 150
    assert all(each["topic"] and each["page"].endswith(".html") for each in found)
    parsed = [check_text(each["program"], filename="p.scenic") for each in found]
    syntax = [
        item
        for each in parsed
        for item in each
        if item.code.startswith("SC1") and item.severity is Severity.ERROR
    ]
    assert len(syntax) < len(found) / 10  # pages about mistakes have some


def test_pages_are_listed_and_joined() -> None:
    index = index_text()
    assert "(reference/specifiers.html)" in index
    assert "(howto/models.html)" in index
    text = full_text()
    assert "Turns the object to a global orientation" in text
    assert "```{specifier}" not in text
