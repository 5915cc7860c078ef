"""Faults to plant: what a careless change of the compiler might do.

Each is a few replacements of text, made in a copy of the project (see `fuzz.faults`). A replacement whose text does not
occur exactly once is an error, so that the list cannot fall behind the code that it speaks of.

Replacements in ``grammar/`` make a parser that does not do what the grammar says: it is generated from the changed
grammar, and then the grammar is put back, so that the programs are still made from the right one.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

__all__ = ["FAULTS", "GENERATED", "Change", "Fault"]

GENERATED: Final = ("parser", "recording")
"""The generated modules that a change in ``grammar/`` affects by default."""

_GRAMMAR: Final = "grammar/scenic.gram"
_LEXER: Final = "scenic/compiler/lexer.py"
_SPACING: Final = "scenic/ide/spacing.py"
_LOWERING: Final = "scenic/compiler/lowering/program.py"
_RESOLVER: Final = "scenic/compiler/resolver.py"
_RECOVERY: Final = "scenic/compiler/recovery.py"
_EMITTED: Final = "scenic/compiler/_generated/parser.py"


@dataclass(frozen=True, slots=True)
class Change:
    """Replaces the only occurrence of ``old`` in the file ``path``."""

    path: str
    old: str
    new: str

    def apply(self, root: Path) -> None:
        """Make the change below ``root``; raises `LookupError` if the text occurs never, or more than once."""
        file = root / self.path
        text = file.read_text(encoding="utf-8")
        found = text.count(self.old)
        if found != 1:
            raise LookupError(f"{self.path}: this occurs {found} times, not once: {self.old!r}")
        file.write_text(text.replace(self.old, self.new), encoding="utf-8")


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault: its name, where it is, what is wrong then.

    Of the modules made from a changed grammar only those named in ``generated`` are used.
    """

    name: str
    place: str
    what: str
    changes: tuple[Change, ...]
    generated: tuple[str, ...] = GENERATED


def _without(path: str, text: str) -> Change:
    return Change(path, text, "")


_SWAPPED: Final = (
    Change(
        _GRAMMAR,
        "a=bitxor '^' b=bitand { BinOp(left=a, op=BITXOR",
        "a=bitxor '&' b=bitand { BinOp(left=a, op=BITAND",
    ),
    Change(
        _GRAMMAR,
        "a=bitand '&' b=shift { BinOp(left=a, op=BITAND",
        "a=bitand '^' b=shift { BinOp(left=a, op=BITXOR",
    ),
)

FAULTS: Final = (
    # The generated parser.
    Fault(
        "dropped-form",
        "parser",
        "`apparent heading of x` without `from` is not read",
        (
            _without(
                _GRAMMAR,
                '    | "apparent" "heading" \'of\' a=prefix { Operation(operator="apparent heading", operands=[a, None]) }\n',
            ),
        ),
    ),
    Fault(
        "dropped-statement",
        "parser",
        "`terminate after` is not read",
        (_without(_GRAMMAR, '    | "terminate" "after" a=duration { TerminateAfter(duration=a) }\n'),),
    ),
    Fault("swapped-precedence", "parser", "`^` binds tighter than `&`", _SWAPPED),
    Fault(
        "right-associative-minus",
        "parser",
        "`a - b - c` is read as `a - (b - c)`",
        (
            Change(
                _GRAMMAR,
                "a=sum '-' b=term { BinOp(left=a, op=SUB, right=b) }",
                "a=term '-' b=sum { BinOp(left=a, op=SUB, right=b) }",
            ),
        ),
    ),
    Fault(
        "right-associative-until",
        "parser",
        "`a until b until c` is accepted, and read as `a until (b until c)`",
        (
            Change(
                _GRAMMAR,
                "a=temporal_above 'until' b=temporal_above {",
                "a=temporal_above 'until' b=temporal_until {",
            ),
        ),
    ),
    Fault(
        "not-visible-as-not",
        "parser",
        "`not visible x` is read as `not (visible x)`",
        (
            Change(
                _GRAMMAR,
                'inversion["an expression"]:\n    | &(\'not\' "visible") a=comparison\n',
                'inversion["an expression"]:\n',
            ),
        ),
    ),
    Fault(
        "exchanged-operands",
        "parser",
        "`distance to x from y` is the distance from x to y",
        (
            Change(
                _GRAMMAR,
                "    | \"distance\" 'to' b=expression 'from' a=prefix { Operation(operator=\"distance\", operands=[a, b]) }",
                "    | \"distance\" 'to' b=expression 'from' a=prefix { Operation(operator=\"distance\", operands=[b, a]) }",
            ),
        ),
    ),
    Fault(
        "exchanged-clauses",
        "parser",
        "`beyond a by b from c` is read as `beyond a by c from b`",
        (
            Change(
                _GRAMMAR,
                'SpecifierPhrase(specifier="beyond", property=None, operands=[a, b, c]) }',
                'SpecifierPhrase(specifier="beyond", property=None, operands=[a, c or b, c and b]) }',
            ),
        ),
    ),
    Fault(
        "hasty-soft-keyword",
        "parser",
        "a line that begins with `wait` is a `wait` statement, whatever follows",
        (
            Change(
                _GRAMMAR, "    | a=soft_statement &(NEWLINE | ';') { a }\n", "    | a=soft_statement { a }\n"
            ),
        ),
    ),
    Fault(
        "lost-else",
        "parser",
        "the `else` of a `while` is read and forgotten",
        (
            Change(
                _GRAMMAR,
                "While(test=a, body=b, orelse=c or []) }",
                "While(test=a, body=b, orelse=[]) }",
            ),
        ),
    ),
    Fault(
        "standing-memo",
        "parser",
        "what `new` made is remembered, but not where it ended",
        (
            Change(
                _EMITTED,
                "            hit = memo_new_expression.get(s)\n            if hit is not None:\n                p = hit[1]\n",
                "            hit = memo_new_expression.get(s)\n            if hit is not None:\n",
            ),
        ),
    ),
    Fault(
        "lost-default",
        "parser",
        "the default of a keyword-only parameter is lost",
        (
            Change(
                "scenic/compiler/actions/definitions.py",
                "result.kw_defaults.append(value)",
                "result.kw_defaults.append(None)",
            ),
        ),
    ),
    # The table of precedence.
    Fault("wrong-table", "table", "`^` stands below `&` in the table of precedence", _SWAPPED, ("tables",)),
    # The lexer.
    Fault(
        "long-words",
        "lexer",
        "a word ends one column too late",
        (
            Change(
                _LEXER,
                "            add_end_column(end - line_start)\n",
                "            add_end_column(end - line_start + (group == 1))\n",
            ),
        ),
    ),
    Fault(
        "columns-in-characters",
        "lexer",
        "columns count characters, not bytes of UTF-8",
        (Change(_LEXER, "        tokens.count_bytes()\n", "        pass\n"),),
    ),
    Fault(
        "uncounted-line",
        "lexer",
        "a line that is continued by a backslash does not count",
        (
            Change(
                _LEXER,
                "            self.next_line(end)\n            if end == len(text):",
                "            self.line_start = end\n            if end == len(text):",
            ),
        ),
    ),
    # What becomes of mistakes.
    Fault(
        "swallowed-statement",
        "recovery",
        "with a statement that is wrong, the next one is skipped",
        (
            Change(
                _RECOVERY,
                "        position = self._line_end(start)\n        if kinds[position] == NEWLINE:\n            position += 1\n"
                "        if kinds[position] != INDENT:\n            return position, []\n",
                "        position = self._line_end(start)\n        if kinds[position] == NEWLINE:\n            position += 1\n"
                "        if kinds[position] not in (INDENT, DEDENT, ENDMARKER):\n            position = self._line_end(position) + 1\n"
                "        if kinds[position] != INDENT:\n            return position, []\n",
            ),
        ),
    ),
    Fault(
        "lost-diagnostic",
        "recovery",
        "a mistake that an action finds is not reported",
        (
            Change(
                _RECOVERY,
                "            self._add(self.expectations.failed(start, failure), farthest)\n",
                "            self._note(farthest)\n",
            ),
        ),
    ),
    Fault(
        "places-in-bytes",
        "recovery",
        "columns of diagnostics count bytes, not characters",
        (
            Change(
                "scenic/compiler/parser.py",
                "start = (line, source.character(line, column))",
                "start = (line, column)",
            ),
        ),
    ),
    # The formatter.
    Fault(
        "lost-conversion",
        "formatter",
        "`!r` in an f-string is not written",
        (Change(_SPACING, 'return "\\n".join(lines)', 'return "\\n".join(lines).replace("!r", "")'),),
    ),
    Fault(
        "lost-comment",
        "formatter",
        "comments after statements are not written",
        (
            Change(
                "scenic/ide/formatting.py",
                "        if parts and line.trailing:\n",
                "        if not parts and line.trailing:\n",
            ),
        ),
    ),
    # Lowering.
    Fault(
        "lost-decorator",
        "lowering",
        "functions lose their decorators",
        (
            Change(
                _LOWERING,
                "        with self.blocks.inside(False):\n            lowered = self.copy(node)\n        return self._kept(node, lowered)",
                "        with self.blocks.inside(False):\n            lowered = self.copy(node, decorator_list=[])\n        return self._kept(node, lowered)",
            ),
        ),
    ),
    Fault(
        "lost-keyword",
        "lowering",
        "keyword arguments beside a starred one lose their names",
        (
            Change(
                _LOWERING,
                "None if item.arg is None else constant(item.arg, item) for item in node.keywords",
                "None for item in node.keywords",
            ),
        ),
    ),
    Fault(
        "lost-place",
        "lowering",
        "calls of the runtime have the place where their operator begins",
        (
            Change(
                "scenic/compiler/lowering/build.py",
                "    return at(ast.Call(callee, list(args), constants), origin)\n",
                "    return start_of(ast.Call(callee, list(args), constants), origin)\n",
            ),
        ),
    ),
    Fault(
        "unlowered-else",
        "lowering",
        "what stands after `else` is left as it is",
        (
            Change(
                _LOWERING,
                "            if field in changes:\n",
                '            if field in changes or field == "orelse":\n',
            ),
        ),
    ),
    # Resolution of names, and checks.
    Fault(
        "missed-comprehension",
        "resolver",
        "comprehensions have no scope of their own",
        (
            Change(
                _RESOLVER,
                '        inner = self._open(ScopeKind.COMPREHENSION, "<comprehension>", node, scope)\n',
                "        inner = scope\n",
            ),
        ),
    ),
    Fault(
        "escaped-parameter",
        "resolver",
        "the parameters of a lambda belong to the scope around it",
        (
            Change(
                _RESOLVER,
                "        yield from self._parameters(node.args, scope, inner)\n        yield node.body, inner",
                "        yield from self._parameters(node.args, scope, scope)\n        yield node.body, inner",
            ),
        ),
    ),
    Fault(
        "open-class",
        "resolver",
        "functions see the names of the class around them",
        (
            Change(
                "scenic/compiler/scopes.py",
                "reachable = not is_global and (transparent or scope.kind is not ScopeKind.CLASS)",
                "reachable = not is_global",
            ),
        ),
    ),
    Fault(
        "raising-check",
        "checks",
        "the check of names expects statements in what could not be parsed",
        (
            Change(
                "scenic/compiler/checks/names.py",
                "        span = context.source.span(node)\n        for line in range(span.line",
                "        span = context.source.span(node.body[0])\n        for line in range(span.line",
            ),
        ),
    ),
    # The tools.
    Fault(
        "other-columns",
        "server",
        "columns in UTF-16 count a character beyond the basic plane once",
        (
            Change(
                "scenic/lsp/convert.py",
                'return len(text.encode("utf-16-le", "surrogatepass")) // 2',
                "return len(text)",
            ),
        ),
    ),
)
"""All faults."""
