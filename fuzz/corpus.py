"""Programs that once broke a property, one file each; the tests try them again.

The name of a file is that of the property and a hash of the text. Files hold bytes: a text may contain lone surrogates,
which are written as UTF-8 would write them.
"""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

__all__ = ["FOLDER", "Entry", "entries", "save"]

FOLDER: Final = Path(__file__).resolve().parent / "corpus"


class Entry(NamedTuple):
    """A program of the corpus; ``of_grammar`` tells whether the grammar made it, or a mutation did.

    ``of_formulas`` tells whether it is a formula, and broke a property of these.
    """

    path: Path
    text: str
    of_grammar: bool
    of_formulas: bool = False


def entries(folder: Path | None = None) -> Iterator[Entry]:
    """All programs of a folder, by default `FOLDER`, in the order of their names."""
    for path in sorted((folder or FOLDER).glob("*.scenic")):
        text = path.read_bytes().decode("utf-8", "surrogatepass")
        is_formula = path.name.startswith("formula-")
        yield Entry(path, text, is_formula or path.name.startswith("program-"), is_formula)


def save(
    text: str,
    property_name: str,
    *,
    of_grammar: bool,
    of_formulas: bool = False,
    folder: Path | None = None,
) -> Path:
    """Write a program into a folder, by default `FOLDER`, and return where."""
    data = text.encode("utf-8", "surrogatepass")
    kind = "formula" if of_formulas else "program" if of_grammar else "text"
    name = f"{kind}-{property_name}-{hashlib.sha256(data).hexdigest()[:10]}.scenic"
    path = (folder or FOLDER) / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return path
