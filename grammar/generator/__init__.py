"""Generates the parser and its tables from ``grammar/scenic.gram``.

pegen reads the notation; the rest is ours. What is written is plain Python, in
``scenic/compiler/_generated``: ``tables`` (keywords, operators), ``parser`` (the fast parser),
``recording`` (the parser that finds out what is wrong with a text), ``syntax`` (the rules as data) and ``context_free`` (the
rules without ordered choice, narrowed by ``grammar/demands.gram``).
"""

import os
import tempfile
from pathlib import Path

from grammar.generator.analysis import Analysis
from grammar.generator.checks import check
from grammar.generator.context_free import emit_context_free
from grammar.generator.declarations import check_declarations
from grammar.generator.emitter import Emitter
from grammar.generator.model import Grammar, GrammarError
from grammar.generator.reader import read_grammar, read_grammar_text
from grammar.generator.syntax import emit_syntax
from grammar.generator.tables import emit_tables

__all__ = ["MODULES", "GrammarError", "generate", "modules", "read_grammar", "read_grammar_text"]

MODULES = ("context_free", "parser", "recording", "syntax", "tables")


def generate(grammar_path: Path, output_folder: Path) -> None:
    """Generate all modules from the grammar at ``grammar_path`` into ``output_folder``.

    Each file is replaced as a whole, so that processes which do this at once do not meet half a file.
    Raises `GrammarError` if the grammar is wrong, or has what `scenic.language` does not declare; then it leaves the
    folder as it was.
    """
    grammar = read_grammar(grammar_path)
    texts = modules(grammar)
    texts["context_free"] = emit_context_free(grammar_path, _header(grammar))
    check_declarations(Analysis(grammar))
    output_folder.mkdir(parents=True, exist_ok=True)
    _replace(output_folder / "__init__.py", "")
    for name in MODULES:
        _replace(output_folder / f"{name}.py", texts[name])


def modules(grammar: Grammar) -> dict[str, str]:
    """Return the texts of the modules that are made of the grammar alone, by name; raises `GrammarError` if the grammar is wrong."""
    analysis = Analysis(grammar)
    check(analysis)
    header = _header(grammar)
    return {
        "parser": Emitter(analysis, recording=False).emit(header),
        "recording": Emitter(analysis, recording=True).emit(header),
        "syntax": emit_syntax(analysis, header),
        "tables": emit_tables(analysis, header),
    }


def _header(grammar: Grammar) -> str:
    return (
        "# Generated from grammar/scenic.gram by grammar/generator (make generate); do not edit.\n"
        f'GRAMMAR_HASH = "{grammar.digest}"\n'
    )


def _replace(path: Path, text: str) -> None:
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}", suffix=".tmp")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(temporary).chmod(0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
