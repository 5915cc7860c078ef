"""The syntax file for Vim and Neovim: Python's, with Scenic's words where they are keywords."""

from collections.abc import Collection, Iterable

from scenic.ide.highlighting import VOCABULARY

_HEADER = """\
" Vim syntax file of Scenic. Generated from grammar/scenic.gram by editors/generate.py (make generate); do not edit.
if exists("b:current_syntax")
  finish
endif
runtime! syntax/python.vim
unlet! b:current_syntax
"""

_GROUPS = {
    "Statement": "Statement",
    "Definition": "Structure",
    "Defined": "Type",
    "Operator": "Operator",
    "Constant": "Constant",
    "Variable": "Identifier",
    "Class": "Type",
    "Function": "Function",
    "Property": "Identifier",
}


def syntax() -> str:
    """The text of the file."""
    vocabulary = VOCABULARY
    operand = rf"\>\ze\s\+\%({_any(vocabulary.infix)}\>\)\@![[:alnum:]_\"'([{{]"
    start = r"^\s*\zs"
    statements = [row for row in vocabulary.phrases if row[0] in vocabulary.statement_starts]
    operators = [row for row in vocabulary.phrases if row[0] not in vocabulary.statement_starts]
    lines = [
        f"syn keyword scenicStatement {_listed(vocabulary.statement_words)}",
        f"syn keyword scenicOperator {_listed(vocabulary.operator_words - {'with'})}",
        f"syn keyword scenicConstant {_listed(vocabulary.constants)}",
        f"syn keyword scenicVariable {_listed(vocabulary.variables)}",
        f"syn keyword scenicClass {_listed(vocabulary.classes)}",
        f"syn match scenicFunction /\\<{_any(vocabulary.functions)}\\ze(/",
        r"syn match scenicProperty /\<with\s\+\zs\h\w*\ze\s/",
        r"syn match scenicProperty /^\s\+\zs\h\w*\ze\s*\%(\[[a-z, ]\+\]\)\?\s*:\s*[^[:space:]#:=]/",
        f"syn match scenicOperator /\\<{_any(vocabulary.before_operands)}{operand}/",
        rf"syn match scenicOperator /\%([[:alnum:]_)\]]\s\)\@2<={_any(vocabulary.after_operands)}\>\%(\s*[=(.]\)\@!/",
        rf"syn match scenicOperator /\<{_rows(operators)}\>/",
        rf"syn match scenicStatement /{start}{_any(vocabulary.statements)}{operand}/",
        rf"syn match scenicStatement /{start}{_rows(statements)}\>\%(\s*[=(.]\)\@!/",
        rf"syn match scenicStatement /{start}{_any(vocabulary.whole_statements)}\ze\s*\%($\|[#;]\)/",
        rf"syn match scenicStatement /{start}{_any(vocabulary.headers)}\>\ze\s.*:\s*\%(#.*\)\?$/",
        rf"syn match scenicStatement /{start}{_any(vocabulary.blocks)}\ze\s*:/",
        rf"syn match scenicDefinition /\<{_any(vocabulary.definitions)}\>\ze\s\+\h\w*/ nextgroup=scenicDefined skipwhite",
        r"syn match scenicDefined /\h\w*/ contained",
    ]
    links = [f"hi def link scenic{name} {group}" for name, group in _GROUPS.items()]
    return "\n".join([_HEADER, *lines, "", *links, "", 'let b:current_syntax = "scenic"', ""])


def _listed(words: Collection[str]) -> str:
    return " ".join(sorted(words))


def _any(words: Collection[str]) -> str:
    return r"\%(" + r"\|".join(sorted(words, key=lambda word: (-len(word), word))) + r"\)"


def _rows(rows: Iterable[tuple[str, ...]]) -> str:
    return r"\%(" + r"\|".join(r"\s\+".join(words) for words in rows) + r"\)"
