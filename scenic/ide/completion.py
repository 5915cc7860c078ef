"""Completions at a place: words that the grammar allows there, names that are in scope, members, modules."""

import ast
import builtins
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from keyword import iskeyword
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.generated import WORDS
from scenic.compiler.loader import SUFFIXES
from scenic.compiler.scopes import Binding, BindingKind, ScopeKind
from scenic.compiler.semantics.classes import Class, Classes, ClassMember
from scenic.compiler.semantics.model import Model
from scenic.compiler.semantics.modules import Exported, FoundModule, Module, ModuleKind
from scenic.compiler.semantics.symbols import Symbol, SymbolKind, symbol_of_binding, symbol_of_exported
from scenic.compiler.tokens import FSTRING_END, FSTRING_MIDDLE, FSTRING_START, STRING
from scenic.compiler.traversal import walk
from scenic.ide import descriptions, documentation
from scenic.ide.continuations import Continuation, Continuations, PhraseKind, continuations
from scenic.ide.expressions import expression, operand_before
from scenic.ide.members import members
from scenic.ide.parameters import settings
from scenic.ide.possibilities import Completion, CompletionKind, Completions, kind_of_symbol
from scenic.ide.snapshot import Snapshot
from scenic.language.names import NAMES, TRACKED, NameKind
from scenic.language.operators import OPERATORS
from scenic.language.properties import CLASSES
from scenic.language.spans import Span
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS, Place
from scenic.project.index import Project
from scenic.project.queries import call_signature

__all__ = ["Completion", "CompletionKind", "completions", "document", "must_follow"]


_NOTHING: Final = Completions(Span(1, 0, 1, 0), ())
_EXPRESSIONS: Final = frozenset(
    {"an expression", "a condition", "an argument", "a subscript", "a target", "a statement"}
)
_RUNNING: Final = frozenset({"do", "choose", "shuffle"})
_TARGETS: Final = (CompletionKind.BEHAVIOR, CompletionKind.SCENARIO)
_NEVER_RUN: Final = frozenset({CompletionKind.CLASS, CompletionKind.MONITOR})
_WANTED: Final[Mapping[tuple[str, ...], str]] = {
    ("take",): "applyTo",
    ("simulator",): "createSimulation",
    ("require", "monitor"): "",
}
"""After these words come instances of classes with such a method, or monitors."""
_VALUES: Final = frozenset(
    {CompletionKind.FUNCTION, CompletionKind.VARIABLE, CompletionKind.PARAMETER, CompletionKind.MODULE}
)
_DEEPEST: Final = 3
"""Depth in packages to which world models are searched."""
_OWN: Final = 4
"""The rank of the last names that a program or its modules define."""
_BEGUN: Final = re.compile(r"\w*$")
_NUMBER: Final = re.compile(r"(?<![\w.)\]])\d[\d_]*\.$")
"""A number, whose point has no members after it."""
_CLASS_HEADER: Final = re.compile(r"class\s+\w+\s*(?:\((?P<bases>[\w\s.,]*)\))?\s*:")
_NEW_NAME: Final = frozenset({"as", "behavior", "class", "def", "monitor", "scenario"})
"""After these words at the beginning of a line, and after the first one anywhere, comes a name that is still to be found."""

_BLOCKS: Final[Mapping[str, str]] = {
    "if": "if ${1:condition}:\n\t$0",
    "elif": "elif ${1:condition}:\n\t$0",
    "else": "else:\n\t$0",
    "for": "for ${1:item} in ${2:items}:\n\t$0",
    "while": "while ${1:condition}:\n\t$0",
    "def": "def ${1:name}(${2}):\n\t$0",
    "class": "class ${1:Name}:\n\t${2:width}: ${3:1}$0",
    "try": "try:\n\t${1:pass}\nexcept ${2:Exception}:\n\t$0",
    "with": "with ${1:context}:\n\t$0",
}
"""Python's statements with blocks, which the language does not declare."""


def completions(project: Project, snapshot: Snapshot, line: int, column: int) -> Completions:
    """Completions at a place: ``line`` from 1, ``column`` in characters from 0. None in comments."""
    content = snapshot.source.line(line)[:column]
    word_match = _BEGUN.search(content)
    start = column if word_match is None else word_match.start()
    span = Span(line, start, line, column)
    if _is_in_comment(snapshot, line, start) or _is_in_open_string(snapshot, line, column):
        return _NOTHING
    text = _open_string(snapshot, line, column)
    if text is not None:
        return _files(snapshot, line, column, text)
    if content[start : start + 1].isdigit() or _NUMBER.search(content[:start]):
        return _NOTHING
    continuation_set = continuations(snapshot.text, line, column)
    items = list(_find(project, snapshot, line, start, continuation_set))
    unique: dict[tuple[str, CompletionKind], Completion] = {}
    for item in items:
        unique.setdefault((item.label, item.kind), item)
    return Completions(span, tuple(sorted(unique.values(), key=lambda item: (item.rank, item.label))))


def must_follow(snapshot: Snapshot, line: int, column: int) -> bool:
    """Return whether something must follow after the blank before a place: possibilities are not offered after each."""
    before = snapshot.source.line(line)[:column].split()
    return bool(before) and (before[-1].endswith(",") or (before[-1] in WORDS and before[-1].isidentifier()))


def document(project: Project, snapshot: Snapshot | None, key: tuple[str, ...]) -> str | None:
    """Return the documentation of a possibility, in Markdown."""
    match key:
        case ("specifier", name):
            return documentation.of_specifier(SPECIFIERS[name]) if name in SPECIFIERS else None
        case ("operator", name):
            return documentation.of_operator(OPERATORS[name]) if name in OPERATORS else None
        case ("temporal operator", name):
            return documentation.of_temporal(name)
        case ("statement", name):
            return documentation.of_statement(STATEMENTS[name]) if name in STATEMENTS else None
        case ("keyword", name):
            return documentation.of_keyword(name)
        case ("property", name):
            return documentation.of_property(name)
        case ("provided", name):
            return documentation.of_name(name) or descriptions.of_python(name)
        case ("member", filename, owner, name):
            return _document_member(project, filename, owner, name)
        case ("name", filename, name, *place):
            module = project.module(filename)
            if module is None:
                return None
            symbol = _symbol_named(project, module, snapshot, name, place)
            return None if symbol is None else descriptions.describe(project, symbol)
    return None


# What the place is


def _is_in_comment(snapshot: Snapshot, line: int, column: int) -> bool:
    return any(at == line and begin < column for at, begin, _ in snapshot.tokens.comments)


def _is_in_open_string(snapshot: Snapshot, line: int, column: int) -> bool:
    return any(
        each.code == "SC101" and each.span is not None and (each.span.line, each.span.column) < (line, column)
        for each in snapshot.tokens.diagnostics
        if each.span is not None and each.span.line == line
    )


def _open_string(snapshot: Snapshot, line: int, column: int) -> str | None:
    """Return the beginning of the string that a place is in, if it is in one."""
    tokens, byte = snapshot.tokens, snapshot.source.byte(line, column)
    for index in range(snapshot.tokens_of_line(line).stop - 1, -1, -1):
        if tokens.end_lines[index] < line:
            return None
        inside = (
            (tokens.lines[index], tokens.columns[index])
            < (line, byte)
            < (
                tokens.end_lines[index],
                tokens.end_columns[index],
            )
        )
        if inside and tokens.kinds[index] == STRING:
            first = snapshot.source.line(line)[:column]
            return (
                first[snapshot.source.character(line, tokens.columns[index]) :]
                if tokens.lines[index] == line
                else ""
            )
        if inside and tokens.kinds[index] == FSTRING_MIDDLE:
            return ""
        begin = (tokens.lines[index], tokens.columns[index])
        end = (tokens.end_lines[index], tokens.end_columns[index])
        # The text of an f-string ends where its quotes stand, and begins after them.
        if (tokens.kinds[index] in (FSTRING_MIDDLE, FSTRING_START) and end == (line, byte)) or (
            tokens.kinds[index] in (FSTRING_MIDDLE, FSTRING_END) and begin == (line, byte)
        ):
            return ""
    return None


def _files(snapshot: Snapshot, line: int, column: int, text: str) -> Completions:
    """Return the files that a string may name, if it is one that names a file."""
    quote = re.match(r"[A-Za-z]{0,2}(['\"])", text)
    before = snapshot.source.line(line)[: column - len(text)].rstrip()
    call_match = re.search(r"\b(localPath|fromFile)\s*\($", before)
    if quote is None or call_match is None or not os.path.isabs(snapshot.filename):
        return _NOTHING
    head, slash, tail = text[quote.end() :].rpartition("/")
    folder = os.path.join(os.path.dirname(snapshot.filename), head + slash)
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except (OSError, ValueError):
        return _NOTHING
    items = tuple(
        Completion(
            entry.name + ("/" if entry.is_dir() else ""), CompletionKind.CONSTANT, entry.name, 0, "file"
        )
        for entry in entries
        if not entry.name.startswith(".")
    )
    return Completions(Span(line, column - len(tail), line, column), items)


# What fits there


def _find(
    project: Project, snapshot: Snapshot, line: int, column: int, found: Continuations
) -> Iterator[Completion]:
    before = found.before or tuple(_words_before(snapshot, line, column))
    last = before[-1] if before else ""
    first = before[0] if before else ""
    module = project.module(snapshot.filename)
    if module is None:
        return
    if last in _NEW_NAME and (len(before) == 1 or last == "as" or before == ("async", "def")):
        return
    if first in ("import", "from", "model") and "import" not in before[1:]:
        yield from _modules(project, snapshot, before)
        return
    if first == "from" and "import" in before:
        yield from _imported(project, module, before)
        return
    if last == ".":
        yield from members(project, snapshot, before[:-1], line, column)
        return
    if last == "new":
        yield from (each for each in _names(project, module, snapshot, line, column) if each.kind is CompletionKind.CLASS
                    and _is_scenic(project, module, snapshot, each, line, column))  # fmt: skip
        return
    if first == "param" and last in ("param", ","):
        yield from _parameters(project, module, before)
        return
    kind_wanted = _WANTED.get(before[-2:], _WANTED.get(before[-1:]))
    if kind_wanted is not None and "a name" not in found.labels:
        yield from _of_kind(project, module, snapshot, kind_wanted, line, column)
        return
    if last == "with" and "new" in before:
        yield from _properties(project, snapshot, before, line, column)
        return
    places = _places(snapshot, line)
    if not before and Place.CLASS in places:
        yield from _inherited(project, snapshot, line, column)
    yield from _continued(project, module, snapshot, (line, column), before, found)


def _continued(
    project: Project,
    module: Module,
    snapshot: Snapshot,
    at: tuple[int, int],
    before: tuple[str, ...],
    found: Continuations,
) -> Iterator[Completion]:
    """Yield the completions that the grammar lets follow, in the order of its rules."""
    line, column = at
    places = _places(snapshot, line)
    words_before: set[str] = set()
    run = bool(before) and (before[-1] in _RUNNING or (before[-1] == "," and before[0] == "do"))
    for item in found.items:
        if run and item.kind is PhraseKind.OPERATOR:
            continue
        if item.kind is PhraseKind.STATEMENT and not places & STATEMENTS[item.name].places:
            continue
        completion = _of_continuation(item)
        # Of several forms that begin alike, the first one has the words alone for its label.
        yield replace(completion, label=item.text) if item.words in words_before else completion
        words_before.add(item.words)
    if found.labels & _EXPRESSIONS or "a name" in found.labels:
        running = run or before[-2:] == ("with", "behavior")
        fitting = _TARGETS if running else ()
        for each in _names(project, module, snapshot, line, column):
            if each.kind in fitting:
                yield Completion(each.label, each.kind, each.text, 0, each.detail, each.snippet, each.key)
            elif not (run and (each.kind in _NEVER_RUN or each.rank > _OWN)):
                yield each
    if "an argument" in found.labels:
        yield from _arguments(project, snapshot, before, line, column)
    if not found.items and not found.labels and not found.kinds:
        # What stands before on the line cannot be read: names are the best guess.
        yield from _names(project, module, snapshot, line, column)


def _of_kind(
    project: Project, module: Module, snapshot: Snapshot, method: str, line: int, column: int
) -> Iterator[Completion]:
    """Yield completions for a statement that takes an instance: first the fitting names, then other names of
    the program, none of the language's.

    ``method`` is what the instances of the wanted classes have; without one, monitors are wanted.
    """
    for each in _names(project, module, snapshot, line, column):
        if not method:
            fits = each.kind is CompletionKind.MONITOR
        elif each.kind is CompletionKind.CLASS:
            symbol = _symbol_named(project, module, snapshot, each.label, [str(line), str(column)])
            cls = Classes(project).of_symbol(symbol)
            fits = cls is not None and cls.member(method) is not None
        else:
            fits = False
        if fits:
            yield replace(each, rank=0)
        elif each.rank <= _OWN and each.kind in _VALUES:
            yield each


def _parameters(project: Project, module: Module, before: tuple[str, ...]) -> Iterator[Completion]:
    """Yield the parameters that a program may set: those that its modules set or that it reads."""
    read = (
        node.attr
        for node in walk(module.tree)
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "globalParameters"
    )
    values_by_name = {setting.name: setting.value for setting in settings(project, module)}
    for name in sorted({*values_by_name, *read} - {*before}):
        yield Completion(
            name, CompletionKind.PARAMETER, f"{name} = ", 1, values_by_name.get(name, "parameter")
        )


def _places(snapshot: Snapshot, line: int) -> frozenset[Place]:
    """Return the kinds of places in a program that a line belongs to, which decide the statements that are allowed there.

    Read off the headers of the blocks around it, since what is being written may not be in the tree.
    """
    for header in _headers(snapshot, line):
        word = header.split(maxsplit=1)[0].rstrip(":")
        if word in _PLACES:
            return _PLACES[word]
    return frozenset({Place.TOP})


def _headers(snapshot: Snapshot, line: int) -> Iterator[str]:
    """Yield the lines above a line that are indented less, the innermost first."""
    content = snapshot.source.line(line)
    level = len(content) - len(content.lstrip())
    for number in range(line - 1, 0, -1):
        if not level:
            return
        content = snapshot.source.line(number)
        indentation = len(content) - len(content.lstrip())
        if content.strip() and indentation < level:
            level = indentation
            yield content.strip()


_PLACES: Final[Mapping[str, frozenset[Place]]] = {
    "behavior": frozenset({Place.BEHAVIOR}),
    "monitor": frozenset({Place.MONITOR}),
    "setup": frozenset({Place.SETUP}),
    "compose": frozenset({Place.COMPOSE}),
    "scenario": frozenset({Place.SETUP}),
    "class": frozenset({Place.CLASS}),
}
"""By the first word of a header."""


def _words_before(snapshot: Snapshot, line: int, column: int) -> list[str]:
    """The tokens of a line before a place."""
    tokens, byte = snapshot.tokens, snapshot.source.byte(line, column)
    return [
        tokens.texts[index]
        for index in snapshot.tokens_of_line(line)
        if tokens.end_columns[index] <= byte and tokens.texts[index].strip()
    ]


def _of_continuation(item: Continuation) -> Completion:
    kind = {
        PhraseKind.SPECIFIER: CompletionKind.SPECIFIER,
        PhraseKind.OPERATOR: CompletionKind.OPERATOR,
        PhraseKind.TEMPORAL: CompletionKind.OPERATOR,
        PhraseKind.STATEMENT: CompletionKind.SNIPPET,
    }.get(item.kind, CompletionKind.KEYWORD)
    rank = {PhraseKind.SPECIFIER: 1, PhraseKind.TEMPORAL: 1, PhraseKind.STATEMENT: 2}.get(item.kind, 5)
    snippet = _BLOCKS.get(item.name) if item.kind is PhraseKind.KEYWORD else _snippet(item)
    detail = item.kind.value if item.text == item.words else item.text
    return Completion(item.words, kind, item.words, rank, detail, snippet, (item.kind.value, item.name))


def _snippet(item: Continuation) -> str | None:
    """The form with places to fill in; ``None`` if there are none."""
    count = 0

    def place(found: re.Match[str]) -> str:
        nonlocal count
        word = found[0]
        if word in WORDS and word not in item.operands:
            return word
        count += 1
        return f"${{{count}:{word}}}"

    rest = item.text[len(item.words) :].replace(", ...", "")
    template = re.sub(r"[A-Za-z_]\w*", place, rest)
    while ": ... " in template:
        count += 1
        template = template.replace(": ... ", f":\n\t${{{count}:pass}}\n", 1)
    template = re.sub(r": \.\.\.$", ":\n\t$0", template)
    return item.words + template if template.strip() else None


def _names(
    project: Project, module: Module, snapshot: Snapshot, line: int, column: int
) -> Iterator[Completion]:
    """The names that can be read at a place."""
    scope = snapshot.scope_at(line, column)
    place = (str(line), str(column))
    names_done: set[str] = set()
    for outer in scope.ancestors():
        if outer is not scope and outer.kind is ScopeKind.CLASS:
            continue
        for name, binding in outer.bindings.items():
            if name not in names_done:
                names_done.add(name)
                local = outer.kind is not ScopeKind.MODULE
                kind, detail = _kind_of_binding(project, module, binding)
                yield Completion(
                    name, kind, name, 2 if local else 3, detail, key=("name", snapshot.filename, name, *place)
                )
    for name, export in Model(module, project).brought.items():
        if name not in names_done and not name.startswith("_"):
            names_done.add(name)
            binding_of_export = None if export.binding is None else export.binding
            kind, detail = (
                (CompletionKind.VARIABLE, "")
                if binding_of_export is None
                else _kind_of_binding(project, module, binding_of_export)
            )
            yield Completion(name, kind, name, 4, detail, key=("name", snapshot.filename, name, *place))
    for name in TRACKED:
        yield Completion(name, CompletionKind.VARIABLE, name, 3, "tracked", key=("provided", name))
    for name, declaration in NAMES.items():
        if name not in names_done:
            kind = {
                NameKind.FUNCTION: CompletionKind.FUNCTION,
                NameKind.VALUE: CompletionKind.VARIABLE,
            }.get(declaration.kind, CompletionKind.CLASS)
            yield Completion(
                name, kind, name, 6, declaration.kind.value, _call(declaration.signature), ("provided", name)
            )
    for name, value in vars(builtins).items():
        if name not in names_done and name not in NAMES and not name.startswith("_") and not iskeyword(name):
            kind = CompletionKind.CLASS if isinstance(value, type) else CompletionKind.FUNCTION
            yield Completion(name, kind, name, 9, "Python", key=("provided", name))


def _call(signature: str) -> str | None:
    """A snippet for a call of something with parameters."""
    name, bracket, inside = signature.partition("(")
    if not bracket:
        return None
    required = [part.strip() for part in inside.removesuffix(")").split(",") if "=" not in part]
    if not all(part.isidentifier() for part in required):
        return f"{name}($0)"
    return name + "(" + ", ".join(f"${{{index}:{part}}}" for index, part in enumerate(required, 1)) + ")"


def _kind_of_binding(project: Project, module: Module, binding: Binding) -> tuple[CompletionKind, str]:
    kinds = binding.kinds
    table = (
        (BindingKind.CLASS, CompletionKind.CLASS),
        (BindingKind.FUNCTION, CompletionKind.FUNCTION),
        (BindingKind.BEHAVIOR, CompletionKind.BEHAVIOR),
        (BindingKind.MONITOR, CompletionKind.MONITOR),
        (BindingKind.SCENARIO, CompletionKind.SCENARIO),
        (BindingKind.MODULE, CompletionKind.MODULE),
        (BindingKind.PARAMETER, CompletionKind.PARAMETER),
        (BindingKind.SELF, CompletionKind.PARAMETER),
    )
    for kind, completion_kind in table:
        if kind in kinds:
            return completion_kind, kind.value
    if BindingKind.IMPORTED in kinds and binding.scope.kind is ScopeKind.MODULE:
        symbol = symbol_of_exported(project, Exported(binding.name, module, binding))
        return kind_of_symbol(symbol), symbol.kind.value
    return CompletionKind.VARIABLE, "variable"


def _is_scenic(
    project: Project, module: Module, snapshot: Snapshot, item: Completion, line: int, column: int
) -> bool:
    """Return whether ``new`` can make instances of a class."""
    if item.key[:1] == ("provided",):
        return item.label in CLASSES
    symbol = _symbol_named(project, module, snapshot, item.label, [str(line), str(column)])
    cls = Classes(project).of_symbol(symbol)
    return cls is not None and (cls.is_scenic or not cls.complete)


def _symbol_named(
    project: Project, module: Module, snapshot: Snapshot | None, name: str, place: Iterable[str]
) -> Symbol | None:
    """Return the symbol that a name denotes at a place, or ``None``."""
    numbers = [int(part) for part in place if part.isdigit()]
    if snapshot is not None and snapshot.filename == module.filename and len(numbers) == 2:
        scope = snapshot.scope_at(numbers[0], numbers[1])
        inner = scope.lookup(name)
        if inner is not None and inner.scope.kind is not ScopeKind.MODULE:
            return symbol_of_binding(module, inner)
    export = Model(module, project).at_top(name)
    return None if export is None else symbol_of_exported(project, export)


def _class_made(
    project: Project, snapshot: Snapshot, before: tuple[str, ...], line: int, column: int
) -> Class | None:
    """The class after the last ``new``."""
    index = len(before) - 1 - before[::-1].index("new")
    if index + 1 >= len(before):
        return None
    found = expression(project, snapshot, before[index + 1], line, column)
    return None if found is None else found[0].class_of_symbol(found[0].meaning(found[1]))


def _properties(
    project: Project, snapshot: Snapshot, before: tuple[str, ...], line: int, column: int
) -> Iterator[Completion]:
    cls = _class_made(project, snapshot, before, line, column)
    names_before = {word for place, word in enumerate(before) if place and before[place - 1] == "with"}
    if cls is None:
        cls = Classes(project).of_symbol(Symbol("Object", SymbolKind.CLASS))
    for member in () if cls is None else cls.properties.values():
        if member.name in names_before or "final" in member.attributes:
            continue
        yield _property(snapshot, member, member.name)


def _inherited(project: Project, snapshot: Snapshot, line: int, column: int) -> Iterator[Completion]:
    """Yield the properties that a class may give other defaults, where it may define a property.

    Of a class without a body there is nothing in the tree: its bases are read off its header.
    """
    header = _CLASS_HEADER.match(next(_headers(snapshot, line), ""))
    if header is None:
        return
    scope = snapshot.scope_at(line, column)
    body = getattr(scope.node, "body", ()) if scope.kind is ScopeKind.CLASS else ()
    own_names = {each.name for each in body if isinstance(each, scenic.PropertyDef)}
    members_by_name: dict[str, ClassMember] = {}
    for base in (header["bases"] or "Object").split(","):
        base_expression = expression(project, snapshot, base.strip(), line, column)
        cls = (
            None
            if base_expression is None
            else base_expression[0].class_of_symbol(base_expression[0].meaning(base_expression[1]))
        )
        for member in () if cls is None or not cls.is_scenic else cls.properties.values():
            members_by_name.setdefault(member.name, member)
    for member in members_by_name.values():
        if member.name in own_names or "final" in member.attributes:
            continue
        yield _property(snapshot, member, f"{member.name}:", after=" ")


def _property(snapshot: Snapshot, member: ClassMember, text: str, *, after: str = "") -> Completion:
    """Return a property that is given a value: ``text``, then the value; ``after`` is what a client without snippets adds."""
    own = member.symbol is not None
    key = ("member", snapshot.filename, member.owner, member.name) if own else ("property", member.name)
    detail = member.type or (f"default: {member.default}" if member.default else member.owner)
    snippet = f"{text} ${{1:{_escaped(member.default or 'value')}}}"
    return Completion(
        member.name, CompletionKind.PROPERTY, text + after, 0 if own else 1, detail, snippet, key
    )


def _escaped(text: str) -> str:
    return re.sub(r"([\\$}])", r"\\\1", text)


def _modules(project: Project, snapshot: Snapshot, before: tuple[str, ...]) -> Iterator[Completion]:
    """Yield the modules whose names can continue the text here."""
    words = [word for word in before[1:] if word != ","]
    parts: list[str] = []
    while len(words) >= 2 and words[-1] == ".":
        parts.insert(0, words[-2])
        words = words[:-2]
    if (
        before[0] == "from"
        and len(before) > 1
        and before[-1] not in (".", "...")
        and before[-1].isidentifier()
    ):
        yield Completion("import", CompletionKind.KEYWORD, "import", 0, key=("keyword", "import"))
        return
    folder = os.path.dirname(snapshot.filename)
    for name in project.finder.importable(folder, ".".join(parts)):
        module_found = project.find(".".join([*parts, name]), importer=snapshot.filename)
        beside = module_found.filename is not None and module_found.filename.startswith(folder)
        if before[0] == "model" and not _leads_to_models(module_found, beside=beside or bool(parts)):
            continue
        if not name.startswith("_"):
            yield Completion(name, CompletionKind.MODULE, name, 1 if beside else 5, module_found.kind.value)


def _leads_to_models(found: FoundModule, *, beside: bool) -> bool:
    """Return whether a module is one of Scenic, or a folder with such modules: for installed packages, right in it."""
    if found.kind is ModuleKind.SCENIC or found.filename is None:
        return found.kind is ModuleKind.SCENIC
    is_package = os.path.basename(found.filename).startswith("__init__.")
    if not is_package and not os.path.isdir(found.filename):
        return False
    folder = os.path.dirname(found.filename) if is_package else found.filename
    is_own = found.name.partition(".")[0] == "scenic"
    deepest = folder.count(os.sep) + (_DEEPEST if beside or is_own else 0)
    for path, folders, files in os.walk(folder):
        if any(file == "model.scenic" if is_own else file.endswith(SUFFIXES) for file in files):
            return True
        folders[:] = (
            [] if path.count(os.sep) >= deepest else [each for each in folders if each[0] not in "._"]
        )
    return False


def _imported(project: Project, module: Module, before: tuple[str, ...]) -> Iterator[Completion]:
    """The names that can be imported from a module."""
    name = "".join(before[1 : before.index("import")])
    level = len(name) - len(name.lstrip("."))
    module_found = project.find(name.lstrip("."), importer=module.filename, level=level)
    exports = project.exports_of(module_found)
    names_before = set(before[before.index("import") + 1 :])
    for each in sorted(exports.names):
        if each not in names_before and not each.startswith("__"):
            symbol = symbol_of_exported(project, exports.names[each])
            yield Completion(each, kind_of_symbol(symbol), each, 8 if each.startswith("_") else 1, symbol.kind.value,
                             key=("name", module_found.filename or "", each))  # fmt: skip


def _arguments(
    project: Project, snapshot: Snapshot, before: tuple[str, ...], line: int, column: int
) -> Iterator[Completion]:
    """Yield the parameters that can be given by name in the call around a place."""
    depth = 0
    for index in range(len(before) - 1, -1, -1):
        if before[index] in ")]}":
            depth += 1
        elif before[index] in ("(", "[", "{"):
            depth -= 1
            if depth < 0:
                text = operand_before(before[:index])
                call = expression(project, snapshot, f"{text}()", line, column) if text else None
                if call is None or not isinstance(call[1], ast.Call):
                    return
                signature = call_signature(call[0], call[1])
                names_before = {
                    before[at - 1] for at, word in enumerate(before) if word == "=" and at > index
                }
                for parameter in () if signature is None else signature.parameters:
                    if (
                        not parameter.prefix
                        and not parameter.positional_only
                        and parameter.name not in names_before
                    ):
                        label = f"{parameter.name}="
                        yield Completion(label, CompletionKind.PARAMETER, label, 1, str(parameter))
                return


def _document_member(project: Project, filename: str, owner: str, name: str) -> str | None:
    module = project.module(filename)
    symbol: Any = None if module is None else _symbol_named(project, module, None, owner, ())
    cls = Classes(project).of_symbol(symbol)
    member = None if cls is None else cls.member(name)
    if member is None or member.symbol is None:
        return documentation.of_property(name)
    return descriptions.describe(project, member.symbol)
