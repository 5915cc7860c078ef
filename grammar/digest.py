"""A digest of the sources of the generated modules.

The module imports nothing, so that every start can compute it.
"""

import hashlib
from pathlib import Path

DECLARATIONS = ("keywords", "operators", "specifiers", "statements")
"""The modules of ``scenic.language`` that must declare what the grammar has."""


def grammar_digest(grammar_path: Path) -> str:
    """Return the SHA-256 digest of the grammar and the files beside it, the generator, the node classes that the grammar names, and the declarations."""
    folder = Path(__file__).parent
    package = folder.parent / "scenic"
    sources = [
        *sorted(grammar_path.parent.glob("*.gram")),
        *sorted((folder / "generator").glob("*.py")),
        package / "compiler" / "tree.py",
        *(package / "language" / f"{name}.py" for name in DECLARATIONS),
    ]
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()
