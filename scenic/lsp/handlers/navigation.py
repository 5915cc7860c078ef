"""Going from place to place: definitions, uses, hierarchies, symbols of the workspace."""

from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Any, Final

from scenic.ide import hierarchies, navigation
from scenic.ide.navigation import Target
from scenic.ide.symbols import Kind, flat, matches, symbols
from scenic.lsp import reading
from scenic.lsp.convert import Json
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.handlers.information import place_of
from scenic.lsp.progress import Partial, Progress
from scenic.lsp.session import Deferred, Session
from scenic.lsp.uris import to_path
from scenic.project.symbols import Symbol, SymbolKind

__all__ = ["KINDS", "REQUESTS"]

KINDS: Final = {
    Kind.CLASS: 5,
    Kind.PROPERTY: 7,
    Kind.FUNCTION: 12,
    Kind.METHOD: 6,
    Kind.BEHAVIOR: 24,
    Kind.MONITOR: 24,
    Kind.SCENARIO: 3,
    Kind.OBJECT: 19,
    Kind.VARIABLE: 13,
    Kind.CONSTANT: 14,
    Kind.PARAMETER: 20,
    Kind.REQUIREMENT: 17,
}
"""The protocol's numbers for kinds of symbols."""
_OF_PROJECT: Final = {
    SymbolKind.MODULE: 2,
    SymbolKind.CLASS: 5,
    SymbolKind.FUNCTION: 12,
    SymbolKind.METHOD: 6,
    SymbolKind.BEHAVIOR: 24,
    SymbolKind.MONITOR: 24,
    SymbolKind.SCENARIO: 3,
    SymbolKind.PROPERTY: 7,
    SymbolKind.ATTRIBUTE: 8,
}
_MOST: Final = 1000
"""So many symbols of the workspace are listed."""

_READ: Final = 2
_WRITE: Final = 3


def _goto(find: Callable[..., Sequence[Target]], name: str) -> Callable[[Session, Any], Json]:
    """The handler of a request that leads elsewhere."""

    def handler(session: Session, params: Any) -> Json:
        document, line, column = place_of(session, params)
        targets = find(session.project_with(document), document.snapshot, line, column)
        if not targets:
            return None
        if not session.client.can("textDocument", name, "linkSupport"):
            return [
                {
                    "uri": session.uri_of(each.filename),
                    "range": session.lines_of(each.filename).to_range(each.span),
                }
                for each in targets
            ]
        return [
            {
                "originSelectionRange": document.lines.to_range(each.origin),
                "targetUri": session.uri_of(each.filename),
                "targetRange": session.lines_of(each.filename).to_range(each.extent),
                "targetSelectionRange": session.lines_of(each.filename).to_range(each.span),
            }
            for each in targets
        ]

    return handler


def _references(session: Session, params: Any) -> Deferred:
    document, line, column = place_of(session, params)
    with_definitions = reading.flag(params, "context", "includeDeclaration")
    project = session.project_with(document)
    progress = Progress(session, reading.lookup(params, "workDoneToken"), "Finding references")
    partial = Partial(session, reading.lookup(params, "partialResultToken"))

    def work(go_on: Callable[[], None]) -> Json:
        with progress:
            found = navigation.usages(
                project, document.snapshot, line, column, with_definitions=with_definitions, go_on=go_on
            )
            for filename, places in groupby(found, lambda each: each.filename):
                uri, lines = session.uri_of(filename), session.lines_of(filename)
                partial.add([{"uri": uri, "range": lines.to_range(each.span)} for each in places])
        return partial.rest

    return Deferred(work)


def _highlights(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    found = navigation.highlights(session.project_with(document), document.snapshot, line, column)
    return [
        {"range": document.lines.to_range(each.span), "kind": _WRITE if each.writes else _READ}
        for each in found
    ]


# Hierarchies


def _item(session: Session, symbol: Symbol) -> Json:
    """A function or class as an item of a hierarchy."""
    assert symbol.filename is not None
    assert symbol.span is not None
    lines = session.lines_of(symbol.filename)
    extent = (
        symbol.extent if symbol.extent is not None and symbol.extent.contains(symbol.span) else symbol.span
    )
    found: dict[str, Json] = {
        "name": symbol.name,
        "kind": _OF_PROJECT.get(symbol.kind, 13),
        "uri": session.uri_of(symbol.filename),
        "range": lines.to_range(extent),
        "selectionRange": lines.to_range(symbol.span),
        "data": {"line": symbol.span.line, "column": symbol.span.column},
    }
    detail = symbol.container or (symbol.kind.value if symbol.kind is not SymbolKind.MODULE else "")
    if detail:
        found["detail"] = detail
    return found


def _prepare(find: Callable[..., Symbol | None]) -> Callable[[Session, Any], Json]:
    def handler(session: Session, params: Any) -> Json:
        document, line, column = place_of(session, params)
        symbol = find(session.project_with(document), document.snapshot.filename, line, column)
        return None if symbol is None else [_item(session, symbol)]

    return handler


def _symbol(session: Session, params: Any, find: Callable[..., Symbol | None]) -> tuple[Any, Symbol | None]:
    """What an item of a hierarchy stands for."""
    document = session.document(reading.text(params, "item", "uri"))
    line, column = document.lines.from_position(*reading.position(params, "item", "selectionRange", "start"))
    project = session.project_with(document)
    return project, find(project, document.snapshot.filename, line, column)


def _incoming(session: Session, params: Any) -> Json:
    project, symbol = _symbol(session, params, hierarchies.callable_at)
    if symbol is None:
        return None
    found = []
    for call in hierarchies.callers(project, symbol):
        lines = session.lines_of(call.filename)
        found.append(
            {"from": _item(session, call.symbol), "fromRanges": [lines.to_range(span) for span in call.spans]}
        )
    return found


def _outgoing(session: Session, params: Any) -> Json:
    project, symbol = _symbol(session, params, hierarchies.callable_at)
    if symbol is None:
        return None
    found = []
    for call in hierarchies.callees(project, symbol):
        lines = session.lines_of(call.filename)
        found.append(
            {"to": _item(session, call.symbol), "fromRanges": [lines.to_range(span) for span in call.spans]}
        )
    return found


def _types(find: Callable[..., Sequence[Symbol]]) -> Callable[[Session, Any], Json]:
    def handler(session: Session, params: Any) -> Json:
        project, symbol = _symbol(session, params, hierarchies.class_at)
        return None if symbol is None else [_item(session, each) for each in find(project, symbol)]

    return handler


# The workspace


def _workspace_symbols(session: Session, params: Any) -> Deferred:
    query = reading.text(params, "query")
    snapshots = session.workspace_snapshots()
    progress = Progress(session, reading.lookup(params, "workDoneToken"), "Searching symbols")
    partial = Partial(session, reading.lookup(params, "partialResultToken"))
    lazy = session.client.has("workspace", "symbol", "resolveSupport")

    def work(go_on: Callable[[], None]) -> Json:
        found: list[Json] = []
        with progress:
            for filename, snapshot in snapshots:
                go_on()
                lines = None
                for symbol, container in flat(symbols(snapshot())):
                    if not matches(symbol.name, query):
                        continue
                    lines = lines or session.lines_of_source(filename, snapshot().source)
                    place = {"uri": session.uri_of(filename), "range": lines.to_range(symbol.name_span)}
                    item: dict[str, Json] = {
                        "name": symbol.name,
                        "kind": KINDS[symbol.kind],
                        "location": place,
                    }
                    if container:
                        item["containerName"] = container
                    if lazy:
                        item["data"] = {"range": place["range"]}
                    found.append(item)
        query_name = query.lower()
        found.sort(key=lambda item: (not item["name"].lower().startswith(query_name), item["name"].lower()))
        partial.add(found[:_MOST])
        return partial.rest

    return Deferred(work)


def _resolve_symbol(session: Session, params: Any) -> Json:
    uri = reading.text(params, "location", "uri")
    place = reading.lookup(params, "data", "range") or reading.lookup(params, "location", "range")
    if to_path(uri) is None and uri not in session.documents:
        raise ProtocolError(ErrorCode.INVALID_PARAMS, f"{uri} is no document of the workspace")
    return {**params, "location": {"uri": uri, "range": place}} if place is not None else params


def _moniker(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    project = session.project_with(document)
    found = navigation.moniker(project, document.snapshot, line, column)
    if found is None:
        return None
    return [
        {
            "scheme": "scenic",
            "identifier": found.identifier,
            "unique": "document" if found.is_local else "project",
            "kind": "local" if found.is_local else "import" if found.is_import else "export",
        }
    ]


REQUESTS: Final = {
    "textDocument/moniker": _moniker,
    "textDocument/declaration": _goto(navigation.declarations, "declaration"),
    "textDocument/definition": _goto(navigation.definitions, "definition"),
    "textDocument/typeDefinition": _goto(navigation.type_definitions, "typeDefinition"),
    "textDocument/implementation": _goto(navigation.implementations, "implementation"),
    "textDocument/references": _references,
    "textDocument/documentHighlight": _highlights,
    "textDocument/prepareCallHierarchy": _prepare(hierarchies.callable_at),
    "callHierarchy/incomingCalls": _incoming,
    "callHierarchy/outgoingCalls": _outgoing,
    "textDocument/prepareTypeHierarchy": _prepare(hierarchies.class_at),
    "typeHierarchy/supertypes": _types(hierarchies.supertypes),
    "typeHierarchy/subtypes": _types(hierarchies.subtypes),
    "workspace/symbol": _workspace_symbols,
    "workspaceSymbol/resolve": _resolve_symbol,
}
