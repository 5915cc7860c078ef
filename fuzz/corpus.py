"""Programs that once broke a property, one file each; the tests try them again.

The name of a file is that of the property and a hash of the text. Files hold bytes: a text may contain lone surrogates,
which are written as UTF-8 would write them. Beside a text that a mutation made, a file of the same name that ends in
``.original`` holds the program that it was made from, if that is known.
"""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

__all__ = ["FOLDER", "Entry", "entries", "save"]

FOLDER: Final = Path(__file__).resolve().parent / "corpus"
_ORIGINAL: Final = ".original"


class Entry(NamedTuple):
    """A program of the corpus; ``of_grammar`` is true if the grammar made it, and false if a mutation did.

    ``of_formulas`` tells whether it is a formula, and broke a property of these. ``original`` is the program that a
    mutation started from.
    """

    path: Path
    text: str
    of_grammar: bool
    of_formulas: bool = False
    original: str | None = None


def entries(folder: Path | None = None) -> Iterator[Entry]:
    """All programs of a folder, by default `FOLDER`, in the order of their names."""
    for path in sorted((folder or FOLDER).glob("*.scenic")):
        is_formula = path.name.startswith("formula-")
        beside = path.with_suffix(_ORIGINAL)
        original = _read(beside) if beside.exists() else None
        yield Entry(path, _read(path), is_formula or path.name.startswith("program-"), is_formula, original)


def save(
    text: str,
    property_name: str,
    *,
    of_grammar: bool,
    of_formulas: bool = False,
    original: str | None = None,
    folder: Path | None = None,
) -> Path:
    """Write a program into a folder, by default `FOLDER`, and return where."""
    data = _encoded(text)
    kind = "formula" if of_formulas else "program" if of_grammar else "text"
    name = f"{kind}-{property_name}-{hashlib.sha256(data).hexdigest()[:10]}.scenic"
    path = (folder or FOLDER) / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    if original is not None:
        path.with_suffix(_ORIGINAL).write_bytes(_encoded(original))
    return path


def _read(path: Path) -> str:
    return path.read_bytes().decode("utf-8", "surrogatepass")


def _encoded(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")
