"""Writes what editors and the documentation take from the grammar: ``python -m editors.generate`` (``make generate``).

TextMate grammar, configuration and snippets for Visual Studio Code, the syntax file for Vim and Neovim, tables and diagrams for
``docs/``. What is written is in git, since editors install folders as they are; a test tells when it is stale.
"""

import json
from collections.abc import Mapping
from pathlib import Path

from editors import documentation, snippets, textmate, vim
from scenic.ide.language_configuration import language_configuration

__all__ = ["texts", "write"]

ROOT = Path(__file__).resolve().parents[1]


def texts() -> Mapping[str, str]:
    """The texts of all generated files by their paths in the project."""
    return {
        "editors/vscode/syntaxes/scenic.tmLanguage.json": textmate.grammar(),
        "editors/vscode/language-configuration.json": json.dumps(language_configuration(), indent=2) + "\n",
        "editors/vscode/snippets/scenic.json": snippets.snippets(),
        "editors/neovim/syntax/scenic.vim": vim.syntax(),
        "docs/reference/syntax.md": documentation.page(),
        **{f"docs/reference/syntax/{name}.svg": text for name, text in documentation.diagrams().items()},
    }


def write(root: Path = ROOT) -> None:
    """Write all files, and remove diagrams that are no longer made."""
    found = texts()
    for path in (root / "docs" / "reference" / "syntax").glob("*.svg"):
        if str(path.relative_to(root)) not in found:
            path.unlink()
    for name, text in found.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write()
