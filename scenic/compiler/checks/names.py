"""Names that must not be bound, and names that nothing binds."""

import ast
import builtins
import re
from collections.abc import Collection, Iterable, Iterator
from typing import Any, Final

from scenic.compiler import tree as scenic
from scenic.compiler.checks.arguments import kind_of
from scenic.compiler.checks.context import CheckContext
from scenic.compiler.checks.foreign_names import keyword_meant, known_elsewhere
from scenic.compiler.checks.unfinished import (
    alone_names,
    begun_names,
    begun_word,
    compared_names,
    may_bind_more,
    text_before,
    unfinished,
)
from scenic.compiler.places import word_span
from scenic.compiler.scopes import PROVIDED, Binding, BindingKind, Reference, ScopeKind
from scenic.compiler.traversal import position
from scenic.language.diagnostics import Diagnostic, Fix, Label
from scenic.language.libraries import DRIVING_CLASSES, LIBRARIES
from scenic.language.names import CONVERSIONS, IMPORTABLE, NAMES, TRACKED, NameKind
from scenic.language.properties import CLASSES
from scenic.language.spelling import distance, nearest, related

__all__ = ["check_classes", "check_names", "check_reserved"]


MOST_SUGGESTIONS: Final = 100
"""Names for which a similar one is looked for: a file full of undefined names must not take long."""

_IMPORTS: Final = ("import", "from", "model")
"""First words of statements that import names of other modules."""

_BUILTINS: Final = frozenset(dir(builtins))

_NOT_SCENIC: Final = frozenset({NameKind.DISTRIBUTION, NameKind.FUNCTION, NameKind.REGION, NameKind.SHAPE})
"""Kinds of provided names that are not classes of objects, even if they are classes in Python."""


def check_reserved(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC200 for bindings of names with a fixed meaning (section 1.3)."""
    for name, site in context.resolution.reserved:
        if name in TRACKED:
            message = f"`{name}` can only be set by `{name} = value`"
            help_ = f"write `{name} = value` as a statement of its own, or use another name here"
        elif name in CONVERSIONS:
            message = f"`{name}` is the conversion function and cannot be bound"
            help_ = "use another name"
        else:
            message = f"`{name}` cannot be bound"
            help_ = "set global parameters with `param name = value`"
        yield context.error("SC200", message, word_span(context.source, site, name), help_)


def check_names(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC202 for names that are read and that nothing binds; SC203 if they stand after ``new``."""
    resolution = context.resolution
    if context.wildcard:
        return
    missing = [reference for name in context.unresolved for reference in resolution.uses[name]]
    if missing and (model := _imported_model(context)) is not None:
        # Its names are those that are missing.
        yield model
        return
    judge: _MissingNames | None = None
    for reference in sorted(missing, key=lambda each: position(each.node)):
        if reference.node in resolution.tolerated or isinstance(reference.node.ctx, ast.Store):
            continue
        judge = judge or _MissingNames(context)
        diagnostic = judge.diagnostic(reference)
        if diagnostic is not None:
            yield diagnostic


class _MissingNames:
    """Judges names that nothing binds, by the rest of a program in which there are such."""

    def __init__(self, context: CheckContext) -> None:
        self._context = context
        self._skipped = _skipped_words(context)
        self._alone = alone_names(context)
        self._compared = compared_names(context)
        self._meant = {each.id for each in self._compared}
        self._suggestions: dict[str, str | None] = {}
        words = {each.id for each in begun_names(context)}
        # Only who is still typing may be about to write what would bind the name.
        missing_imports = _missing_imports(context) if context.typing else []
        self._importing = any(_is_import(word) for word in words) or _is_import_broken(context)
        self._half_typed = may_bind_more(context) or any(
            context.surroundings is not None and context.surroundings.is_begun(site)
            for binding in missing_imports
            for site in binding.sites
            if isinstance(site, ast.alias)
        )
        self._slips = {each.name for each in _missing_imports(context)} if context.surroundings else set()
        self._being_typed = words | _last_words(context) | {each.name for each in missing_imports}

    def diagnostic(self, reference: Reference) -> Diagnostic | None:
        """Return the diagnostic of a name; ``None`` if another one, or half a line, explains it."""
        context, node = self._context, reference.node
        name = node.id
        if name in self._skipped or (self._slips and nearest(name, self._slips) is not None):
            # The import of a misspelt name is reported.
            return None
        if node not in self._alone and (
            self._importing or any(_may_become(word, name) for word in self._being_typed)
        ):
            return None
        if name in self._meant:
            advice = f"`==` and `<` compare; `{name} = ...` would define it"
            return self._undefined(node, advice) if node in self._compared else None
        if context.broken:
            # Its binding may be among what is broken: once is enough.
            self._skipped.add(name)
        if any(node is new.cls for new in context.nodes_around(node, scenic.New)):
            return self._of_class(reference)
        keyword = unfinished(context, node)
        if keyword is not None:
            return keyword
        if _names_property(context, reference):
            return _without_self(context, reference)
        elsewhere = _bound_somewhere(name, context)
        return self._of_name(reference) if elsewhere is None else _out_of_reach(context, reference, elsewhere)

    def _of_class(self, reference: Reference) -> Diagnostic | None:
        name = reference.node.id
        if name not in self._suggestions and len(self._suggestions) < MOST_SUGGESTIONS:
            self._suggestions[name] = nearest(name, _classes_in_reach(reference, self._context))
        suggestion = self._suggestions.get(name)
        if self._half_typed and suggestion is None:
            return None
        return _unknown_class(self._context, reference, suggestion)

    def _of_name(self, reference: Reference) -> Diagnostic | None:
        context, node = self._context, reference.node
        name = node.id
        suggestion = self._suggestion(reference)
        if suggestion is None or suggestion in PROVIDED:
            diagnostic = _known_elsewhere(context, node)
            if diagnostic is not None:
                return diagnostic
        if self._half_typed and suggestion is None and node not in self._alone:
            # No slip of another name: what is being typed may bind it.
            return None
        if text_before(context, node).endswith("//"):
            advice = "a comment begins with `#`, not with `//`"
        elif suggestion:
            advice = f"did you mean `{suggestion}`?"
        elif name in IMPORTABLE:
            advice = f"import it: `from {IMPORTABLE[name]} import {name}`"
        else:
            advice = "define it before it is used, or import it"
        if suggestion is not None and any(
            node in each.decorator_list for each in context.nodes_around(node, ast.FunctionDef)
        ):
            diagnostic = _known_elsewhere(context, node)
            if diagnostic is not None:
                return diagnostic
        # What the program does not define may be any of the many names that are always there.
        certain = suggestion not in PROVIDED
        fix = context.renaming(node, name, suggestion, certain=certain) if suggestion else None
        return self._undefined(node, advice, fix)

    def _suggestion(self, reference: Reference) -> str | None:
        name, suggestions = reference.node.id, self._suggestions
        if name not in IMPORTABLE and name not in suggestions and len(suggestions) < MOST_SUGGESTIONS:
            own = self._context.resolution.names_in_reach(reference.scope).union(self._context.brought)
            suggestions[name] = (
                begun_word(self._context, reference.node)
                or _similar(name, own, {word for word in PROVIDED if word[0] != "_"})
                or _only_one(each for each in own.union(TRACKED) if len(name) > 1 and each.startswith(name))
            )
        return suggestions.get(name)

    def _undefined(self, node: ast.Name, advice: str, fix: Fix | None = None) -> Diagnostic:
        return self._context.error("SC202", f"the name `{node.id}` is not defined", node, advice, fix=fix)


def _imported_model(context: CheckContext) -> Diagnostic | None:
    """Return SC202 for ``import scenic.domains.driving.model``, which brings no names but `scenic`."""
    for statement, _ in context.nodes(ast.Import):
        for alias in statement.names:
            if alias.name in LIBRARIES and alias.name.endswith("model") and alias.asname is None:
                alone = len(statement.names) == 1
                return context.error(
                    "SC202",
                    f"`import` brings only the name `{alias.name.split('.')[0]}`, not the names of the world model",
                    statement,
                    f"write `model {alias.name}`",
                    fix=context.replacement("Write `model`", statement, f"model {alias.name}")
                    if alone
                    else None,
                )
    return None


def _similar(name: str, own: Collection[str], provided: Collection[str]) -> str | None:
    """The name that is probably meant: the nearest, or the one with the same words if none is very near."""
    pool = {*own, *provided}
    candidate = nearest(name, pool)
    if (
        candidate is not None
        and candidate in _BUILTINS
        and name[:1].isupper()
        and name.lower() != candidate.lower()
    ):
        candidate = nearest(name, {each for each in pool if each[:1].isupper()})
    if candidate is not None and distance(name.lower(), candidate.lower(), limit=1) <= 1:
        return candidate
    same_words = related(name, pool) if len(name) >= _SHORTEST_OF_WORDS else None
    if candidate is not None and same_words is not None and len(same_words) < len(name) < len(candidate) + 3:
        # `RectangleRegion` is a `RectangularRegion` rather than a `Region`.
        return candidate
    return same_words or candidate


_SHORTEST_OF_WORDS: Final = 6
"""Shorter names are not compared word by word."""


def _known_elsewhere(context: CheckContext, node: ast.Name) -> Diagnostic | None:
    """Return SC118, SC202 for a name that is a misspelt keyword, or has a meaning in another language or library."""
    keyword = keyword_meant(node, context)
    if keyword is not None:
        return context.error(
            "SC118",
            f"unknown keyword `{node.id}`",
            node,
            f"did you mean `{keyword}`?",
            fix=context.renaming(node, node.id, keyword),
        )
    suggestion = known_elsewhere(node, context)
    if suggestion is None:
        return None
    return context.error(
        "SC202", f"the name `{node.id}` is not defined", node, suggestion.help, fix=suggestion.fix
    )


def _only_one(candidates: Iterable[str]) -> str | None:
    found = set(candidates)
    return found.pop() if len(found) == 1 else None


def _skipped_words(context: CheckContext) -> set[str]:
    """Return the words in statements that could not be parsed, any of which these may bind."""
    words: set[str] = set()
    for node, _ in context.nodes(scenic.ErrorStatement):
        span = context.source.span(node)
        for line in range(span.line, span.end_line + 1):
            words.update(re.findall(r"\w+", context.source.line(line)))
    return words


def _last_words(context: CheckContext) -> set[str]:
    """The last word of each line that could not be parsed: it may be the beginning of a name that the line will bind."""
    words: set[str] = set()
    for node, _ in context.nodes(scenic.ErrorStatement):
        found = re.search(r"[^\W\d]\w*$", context.source.line(node.lineno).rstrip())
        if found is not None:
            words.add(found[0])
    return words


def _may_become(word: str, name: str) -> bool:
    """Return whether a word that binds nothing, where something should be bound, was meant to bind a name."""
    return name.startswith(word) or (len(word) > 2 and distance(word, name, limit=2) <= 2)


def _is_import(word: str) -> bool:
    """Return whether a word is the beginning of an import."""
    return any(keyword.startswith(word) for keyword in _IMPORTS)


def _is_import_broken(context: CheckContext) -> bool:
    """Return whether an import could not be parsed, which may bind anything."""
    lines = (context.source.line(node.lineno).split() for node, _ in context.nodes(scenic.ErrorStatement))
    return any(words and words[0] in _IMPORTS for words in lines)


def _missing_imports(context: CheckContext) -> list[Binding]:
    """Names that are imported from where they are not, and not used: they may be the beginnings of others."""
    return [
        binding
        for binding in context.resolution.names.values()
        if binding.kinds <= {BindingKind.MODULE, BindingKind.IMPORTED}
        and binding not in context.resolution.read
        and all(
            isinstance(site, ast.alias)
            and (context.surroundings is None or context.surroundings.is_missing(site))
            for site in binding.sites
        )
    ]


def _bound_somewhere(name: str, context: CheckContext) -> Binding | None:
    """The first binding of a name in any scope but the module's."""
    scopes = [
        scope
        for scope in context.resolution.scopes.values()
        if name in scope.bindings and scope.kind not in (ScopeKind.MODULE, ScopeKind.PROPERTY)
    ]
    return min(scopes, key=lambda each: position(each.node)).bindings[name] if scopes else None


def _out_of_reach(context: CheckContext, reference: Reference, binding: Binding) -> Diagnostic:
    """A name that only other scopes bind."""
    name = reference.node.id
    scope = binding.scope
    if scope.kind is ScopeKind.CLASS:
        within = f"the body of the class `{scope.name}`"
        help_ = f"write `{scope.name}.{name}`, or `self.{name}` in a method"
    elif scope.kind in (ScopeKind.COMPREHENSION, ScopeKind.LAMBDA):
        within = f"a {scope.kind}"
        help_ = f"a name bound in a {scope.kind} exists only there"
    else:
        within = f"the {scope.kind} `{scope.name}`"
        help_ = "what is bound in there exists only there: bind the name here, or return the value"
    first = binding.first_site
    return context.error(
        "SC202",
        f"the name `{name}` is not defined here, only in {within}",
        reference.node,
        help_,
        labels=(Label(word_span(context.source, first, name), "bound here"),),
    )


def _names_property(context: CheckContext, reference: Reference) -> bool:
    """Return whether a name in the default of a property can only mean another property of the same object."""
    for scope in reference.scope.ancestors():
        if scope.kind is ScopeKind.PROPERTY and scope.parent is not None:
            cls = context.class_at(scope.parent.node)
            return cls is not None and reference.node.id in cls.properties
    return False


def _without_self(context: CheckContext, reference: Reference) -> Diagnostic:
    name = reference.node.id
    return context.error(
        "SC202",
        f"the name `{name}` is not defined; the property of the object is `self.{name}`",
        reference.node,
        f"write `self.{name}`",
        fix=context.replacement(f"Write `self.{name}`", reference.node, f"self.{name}"),
    )


def check_classes(context: CheckContext) -> Iterator[Diagnostic]:
    """Report SC203 for names after ``new`` that are not classes."""
    for node, _ in context.nodes(scenic.New):
        yield from _no_class(context, node.cls)


def _no_class(context: CheckContext, name: ast.Name) -> Iterator[Diagnostic]:
    """A name after ``new`` that certainly means something else than a class."""
    builtin_name = context.provided(name)
    if builtin_name is not None and builtin_name in NAMES and NAMES[builtin_name].kind in _NOT_SCENIC:
        what = f"`{builtin_name}` is a {NAMES[builtin_name].kind} of the language, not a class of objects"
        yield context.error("SC203", what, name, f"leave out `new`: write `{NAMES[builtin_name].signature}`")
        return
    if builtin_name is not None and builtin_name in _BUILTINS and builtin_name not in NAMES:
        reference = context.resolution.references.get(name)
        similar_class = (
            None if reference is None else nearest(builtin_name, _classes_in_reach(reference, context))
        )
        # A warning: running the program raises the `TypeError` that scripts may expect.
        yield context.warning(
            "SC203",
            f"`{builtin_name}` is a name of Python, not a class of objects",
            name,
            f"did you mean `{similar_class}`?" if similar_class else "name a class, for example `Object`",
            fix=context.renaming(name, builtin_name, similar_class) if similar_class else None,
        )
        return
    symbol = context.definition(name)
    definition: Any = None if symbol is None else symbol.node
    labels: tuple[Label, ...] = ()
    cls = context.class_of_symbol(symbol)
    if symbol is not None and cls is not None and cls.complete and not cls.is_scenic:
        labels = context.defined(symbol)
        what = f"`{name.id}` is a class of Python, not one of objects"
        help_ = f"leave out `new`: write `{name.id}(...)`"
        yield context.warning("SC203", what, name, help_, labels=labels)
        return
    if symbol is not None and cls is None:
        what = kind_of(definition)
        labels = context.defined(symbol)
        help_ = f"leave out `new`: write `{name.id}(...)`"
        yield context.error("SC203", f"`{name.id}` is a {what}, not a class", name, help_, labels=labels)
        return
    value = context.constant(name)
    if value is not None:
        labels = (context.label(value, "its value"),)
        help_ = "name a class, for example `Object`"
        yield context.error("SC203", f"`{name.id}` is a plain value, not a class", name, help_, labels=labels)


def _classes_in_reach(reference: Reference, context: CheckContext) -> set[str]:
    imported_classes = {name for name in context.brought if name[:1].isupper()}
    return imported_classes.union(
        CLASSES,
        context.class_names,
        (
            name
            for scope in reference.scope.ancestors()
            for name, binding in scope.bindings.items()
            if any(isinstance(site, ast.ClassDef) for site in binding.sites)
        ),
    )


def _unknown_class(context: CheckContext, reference: Reference, suggestion: str | None) -> Diagnostic:
    name = reference.node.id
    return context.error(
        "SC203",
        f"there is no class `{name}`",
        reference.node,
        f"did you mean `{suggestion}`?"
        if suggestion
        else "it comes with a world model: begin the program with `param map = localPath('town.xodr')` and "
        "`model scenic.domains.driving.model`, or define it"
        if name in DRIVING_CLASSES
        else f"define `class {name}:`, or import it",
        fix=context.renaming(reference.node, name, suggestion) if suggestion else None,
    )
