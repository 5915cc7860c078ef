"""The reference has every element of the language, with an example; the command line's page has every command."""

import keyword
import re
from pathlib import Path

from docs._extensions.blocks import blocks_of
from docs._extensions.commands import commands_text
from docs._extensions.declared import diagnostics_text
from scenic.cli.main import scenic
from scenic.compiler.generated import HARD_KEYWORDS, SOFT_KEYWORDS
from scenic.language.diagnostics import CODES
from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS, SIDES
from scenic.language.properties import CLASSES
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS

DOCS = Path(__file__).parents[2] / "docs"
REFERENCE = DOCS / "reference"
PYTHON_WORDS = {*keyword.kwlist, "_", "case", "match", "type"}
"""Python's own keywords."""


def code() -> str:
    """All programs of the tutorial and the reference, without comments and strings."""
    pages = [*DOCS.glob("tutorial/*.md"), *REFERENCE.glob("*.md")]
    blocks = [
        block.text
        for page in pages
        for block in blocks_of(page.read_text(encoding="utf-8"))
        if block.language == "scenic" and "fails" not in block.options
    ]
    return re.sub(r"#.*|'[^'\n]*'|\"[^\"\n]*\"", "", "\n".join(blocks))


def test_every_element_has_a_section_of_its_page() -> None:
    corners = {f"{side} of" for side in SIDES}
    for directive, page, names in (
        ("specifier", "specifiers", SPECIFIERS),
        ("statement", "statements", STATEMENTS),
        ("operator", "operators", OPERATORS.keys() - corners),
    ):
        shown = re.findall(rf"```{{{directive}}} (.+)", (REFERENCE / f"{page}.md").read_text())
        assert sorted(shown) == sorted(names)


def test_every_word_of_the_language_is_in_an_example() -> None:
    examples = code()
    words = {*HARD_KEYWORDS, *SOFT_KEYWORDS} - PYTHON_WORDS
    properties = {item.name for cls in CLASSES.values() for item in cls.properties}
    names = {name for name, item in NAMES.items() if item.syntax is None}
    sides = {f"{side} of" for side in SIDES}
    missing = [
        word
        for word in sorted({*words, *names, *sides, *properties})
        if not re.search(rf"(?<!\w){word}(?!\w)", examples)
    ]
    assert missing == []


def test_functions_of_syntax_are_listed() -> None:
    """The syntax that they stand for has its own examples."""
    page = (REFERENCE / "language.md").read_text(encoding="utf-8")
    listed = page.partition("## Operators and specifiers as functions\n")[2].partition("```")[0]
    functions = {name for name, item in NAMES.items() if item.syntax is not None}
    assert sorted(functions - set(re.findall(r"`(\w+)`", listed))) == []


def test_every_command_and_diagnostic_is_told_of() -> None:
    told = commands_text()
    assert all(f"## scenic {name}\n" in told for name in scenic.list_commands(None) if name != "preview")  # type: ignore[arg-type]
    pages = diagnostics_text("")
    assert all(f"({code.lower()})=" in pages for code in CODES)
