"""One module of a project: its text, its tree and what its names are bound to. Immutable once it is made."""

import ast
import warnings
from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import Any, Final, TypeVar

from scenic.compiler import tree as scenic
from scenic.compiler.checks.places import word_span
from scenic.compiler.parser import deep_recursion, parse
from scenic.compiler.resolver import bind
from scenic.compiler.scopes import Resolution, Scope, ScopeKind
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.language.source import Source
from scenic.language.spans import Span

__all__ = ["Module", "read_module"]

_T = TypeVar("_T")

_EMPTY: Final = ast.Module(body=[], type_ignores=[])


@dataclass(frozen=True, eq=False)
class Module:
    """A parsed module; ``is_scenic`` gives its language, and ``broken`` is true if parts of it could not be parsed."""

    source: Source
    tree: ast.Module = field(repr=False)
    resolution: Resolution = field(repr=False)
    is_scenic: bool
    broken: bool
    _derived: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def filename(self) -> str:
        """The absolute path of the file."""
        return self.source.filename

    @cached_property
    def import_of(self) -> dict[ast.alias, ast.Import | ast.ImportFrom]:
        """The statement that each alias stands in."""
        return {
            alias: node
            for cls in (ast.Import, ast.ImportFrom)
            for node, _ in self.resolution.nodes(cls)
            for alias in node.names
        }

    @cached_property
    def assignment_of(self) -> dict[ast.AST, ast.Assign | ast.AnnAssign]:
        """The assignment of which each name is a whole target."""
        found: dict[ast.AST, ast.Assign | ast.AnnAssign] = {}
        for node, _ in self.resolution.nodes(ast.Assign):
            found.update((target, node) for target in node.targets if isinstance(target, ast.Name))
        for node, _ in self.resolution.nodes(ast.AnnAssign):
            if isinstance(node.target, ast.Name):
                found[node.target] = node
        return found

    @cached_property
    def annotation_of(self) -> dict[ast.AST, ast.expr]:
        """The annotation of each name or attribute that is assigned or declared with one."""
        return {node.target: node.annotation for node, _ in self.resolution.nodes(ast.AnnAssign)}

    @cached_property
    def loop_of(self) -> dict[ast.AST, ast.expr]:
        """The values that each name runs through, of loops, comprehensions and functions without a name that are called for each."""
        found: dict[ast.AST, ast.expr] = {}
        loops: list[ast.For | ast.comprehension] = [node for node, _ in self.resolution.nodes(ast.For)]
        for kind in (ast.ListComp, ast.SetComp, ast.GeneratorExp, ast.DictComp):
            for node, _ in self.resolution.nodes(kind):
                loops += node.generators
        for loop in loops:
            if isinstance(loop.target, ast.Name):
                found[loop.target] = loop.iter
        for node, _ in self.resolution.nodes(ast.Call):
            match node:
                case ast.Call(func=ast.Name(id="filter" | "map"), args=[ast.Lambda() as function, values]):
                    pass
                case ast.Call(
                    func=ast.Name(id="max" | "min" | "sorted"),
                    args=[values],
                    keywords=[ast.keyword(arg="key", value=ast.Lambda() as function)],
                ):
                    pass
                case _:
                    continue
            if len(function.args.args) == 1:
                found[function.args.args[0]] = values
        return found

    @cached_property
    def egos(self) -> tuple[ast.expr, ...]:
        """The values that are assigned to the ego."""
        return tuple(
            node.value
            for node, _ in self.resolution.nodes(ast.Assign)
            if any(isinstance(target, ast.Name) and target.id == "ego" for target in node.targets)
        )

    def word_span(self, node: ast.AST, word: str) -> Span:
        """The place of a word in a node."""
        return word_span(self.source, node, word)

    def attribute_span(self, node: ast.Attribute) -> Span:
        """The place of the name after the dot, which ends the node."""
        whole = self.source.span(node)
        start = max(0, whole.end_column - len(node.attr))
        return Span(whole.end_line, start, whole.end_line, whole.end_column)

    def text(self, node: ast.AST) -> str:
        """The text of a node, on one line."""
        span = self.source.span(node)
        if span.line == span.end_line:
            return self.source.line(span.line)[span.column : span.end_column]
        lines = [self.source.line(span.line)[span.column :]]
        lines += [self.source.line(number).strip() for number in range(span.line + 1, span.end_line)]
        lines.append(self.source.line(span.end_line)[: span.end_column].strip())
        return " ".join(lines)

    @cached_property
    def owner_of_specifier(self) -> dict[ast.AST, scenic.New | scenic.Override]:
        """The class or module that each specifier belongs to."""
        return {
            specifier: node
            for node in walk(self.tree)
            if isinstance(node, scenic.New | scenic.Override)
            for specifier in node.specifiers
        }

    @cached_property
    def call_of(self) -> dict[ast.keyword, ast.Call]:
        """The call that each argument by name belongs to."""
        return {
            keyword: node
            for node in walk(self.tree)
            if isinstance(node, ast.Call)
            for keyword in node.keywords
        }

    def knows(self, name: str) -> bool:
        """Return whether what is computed under a name is there already."""
        return name in self._derived

    def derived(self, name: str, compute: Callable[[], _T]) -> _T:
        """The result of a computation from the module, computed on first use and kept under a name."""
        known = self._derived.get(name)
        if known is None:
            known = self._derived[name] = compute()
        found: _T = known
        return found

    @cached_property
    def stars(self) -> tuple[ast.ImportFrom | scenic.Model, ...]:
        """The statements that bring names that the text does not show, in order."""
        nodes = self.resolution.nodes
        found: list[Any] = [node for node, _ in nodes(scenic.Model)]
        found += [node for node, _ in nodes(ast.ImportFrom) if any(alias.name == "*" for alias in node.names)]
        return tuple(sorted(found, key=lambda node: (node.lineno, node.col_offset)))

    @cached_property
    def public(self) -> frozenset[str] | None:
        """The names in ``__all__``; ``None`` without it, or if it is not a plain list of strings."""
        binding = self.resolution.names.get("__all__")
        if binding is None:
            return None
        for reference in self.resolution.uses.get("__all__", ()):
            if isinstance(reference.node.ctx, ast.Load) and reference.scope.kind is ScopeKind.MODULE:
                return None  # It may be changed in place: `__all__.append("name")`.
        names: set[str] = set()
        understood: set[ast.AST] = set()
        for node in self.tree.body:
            match node:
                case ast.Assign(targets=[ast.Name(id="__all__") as target], value=value):
                    pass
                case ast.AugAssign(target=ast.Name(id="__all__") as target, op=ast.Add(), value=value):
                    pass
                case _:
                    continue
            texts = [getattr(each, "value", None) for each in getattr(value, "elts", (value,))]
            if not all(isinstance(text, str) for text in texts):
                return None
            names.update(text for text in texts if isinstance(text, str))
            understood.add(target)
        return frozenset(names) if understood.issuperset(binding.sites) else None

    @cached_property
    def is_dynamic(self) -> bool:
        """Return whether it may have names that its text does not show, apart from those that star imports bring."""
        if self.broken or "__getattr__" in self.resolution.names:
            return True
        return self.resolution.rebinding

    @cached_property
    def sets_ego(self) -> bool:
        """Return whether running the module may set the ego (that of a scenario in it does not count)."""
        return any(
            not isinstance(reference.node.ctx, ast.Load) and not _in_scenario(reference.scope)
            for reference in self.resolution.uses.get("ego", ())
        )


def read_module(
    source: Source, *, tree: ast.Module | None = None, resolution: Resolution | None = None
) -> Module:
    """Parse and bind a module; the ending of the filename selects the language. Never raises.

    ``tree`` is the tree of the text, and ``resolution`` what its names are bound to, where that is already known.
    """
    is_scenic = not source.filename.endswith((".py", ".pyi"))
    broken = False
    try:
        with deep_recursion():
            if tree is None and is_scenic:
                parsed = parse(source.text, filename=source.filename)
                tree = parsed.tree
            elif tree is None:
                tree = _python(source)
            resolution = bind(tree) if resolution is None else resolution
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        tree, broken = _EMPTY, True
        resolution = bind(tree)
    broken = broken or bool(resolution.nodes(scenic.ErrorStatement))
    return Module(source, tree, resolution, is_scenic, broken)


def _python(source: Source) -> ast.Module:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Python's opinion of other people's modules is not asked for.
        return ast.parse(source.text, filename=source.filename)


def _in_scenario(scope: Scope) -> bool:
    own = (ScopeKind.SCENARIO, ScopeKind.BEHAVIOR, ScopeKind.MONITOR)
    return any(outer.kind in own for outer in scope.ancestors())
