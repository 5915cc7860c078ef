"""What the generated modules depend on, as one number; imports nothing, so that it can be asked for at every start."""

import hashlib
from pathlib import Path


def grammar_digest(grammar_path: Path) -> str:
    """The SHA-256 of the grammar, the generator, and the node classes that the grammar names."""
    folder = Path(__file__).parent
    sources = [
        grammar_path,
        *sorted((folder / "generator").glob("*.py")),
        folder.parent / "scenic" / "compiler" / "tree.py",
    ]
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()
