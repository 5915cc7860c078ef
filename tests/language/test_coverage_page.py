"""``docs/reference/language.md`` tells of every word that the declarations know."""

from pathlib import Path

from scenic.language.names import NAMES
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from tests.each import each

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "language.md").read_text()
NOT_BUILT = PAGE.split("## What is not built")[1]


@each([*NAMES, *OPERATORS, *SPECIFIERS])
def test_every_word_is_listed(word: str) -> None:
    assert f"`{word}`" in PAGE


def test_the_last_section_lists_exactly_what_is_refused() -> None:
    refused = {name for name, entry in NAMES.items() if not entry.available}
    refused |= {name for name, entry in {**OPERATORS, **SPECIFIERS}.items() if not entry.available}
    told = {word for word in [*NAMES, *OPERATORS, *SPECIFIERS] if f"`{word}`" in NOT_BUILT}
    assert told == refused
