"""Commands to run parts of a document: the program itself, and each scenario that it defines."""

from collections.abc import Iterator

from scenic.compiler import tree as scenic
from scenic.compiler.traversal import walk
from scenic.dataclass import dataclass
from scenic.ide.name_places import name_span
from scenic.ide.snapshot import Snapshot
from scenic.language.spans import Span

__all__ = ["CodeLens", "lenses"]


@dataclass(frozen=True, slots=True)
class CodeLens:
    """Something that can be run; ``scenario`` is the name of one of several, ``simulates`` if it changes over time."""

    span: Span
    scenario: str | None
    simulates: bool


def lenses(snapshot: Snapshot) -> tuple[CodeLens, ...]:
    """Return the commands of a document; none in a text that makes no objects."""
    return snapshot.derived("lenses", lambda: tuple(_find(snapshot)))


def _find(snapshot: Snapshot) -> Iterator[CodeLens]:
    tree = snapshot.tree
    scenarios = [node for node in tree.body if isinstance(node, scenic.ScenarioDef)]
    if not scenarios and not any(isinstance(node, scenic.New | scenic.Model) for node in walk(tree)):
        return
    dynamic = any(
        isinstance(node, scenic.BehaviorDef | scenic.MonitorDef | scenic.Simulator | scenic.RequireMonitor)
        or (isinstance(node, scenic.SpecifierPhrase) and node.property == "behavior")
        or (isinstance(node, scenic.ScenarioDef) and node.compose is not None)
        for node in walk(tree)
    )
    if not scenarios:
        first = next((each for each in tree.body if not scenic.is_documentation(each)), None)
        line = 1 if first is None else first.lineno
        yield CodeLens(Span(line, 0, line, len(snapshot.source.line(line))), None, dynamic)
    for node in scenarios:
        yield CodeLens(name_span(snapshot, node), node.name, dynamic)
