"""Programs in Markdown documents: where they are, and their usual style."""

from scenic.compiler.markdown import SUFFIXES, ProgramBlock, program_blocks, with_blocks
from scenic.ide.formatting import format_text

__all__ = ["ProgramBlock", "format_blocks", "is_markdown", "program_blocks"]


def is_markdown(name: str, language: str = "") -> bool:
    """Return whether a document of a name, or of a language as editors say it, is a Markdown text."""
    return language == "markdown" or name.lower().endswith(SUFFIXES)


def format_blocks(text: str) -> str:
    """Return a Markdown text with its programs in the usual style; those with mistakes of syntax stay as they are."""
    return with_blocks(text, format_text)
