"""Going from place to place: definitions, uses, hierarchies, symbols of the workspace."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from itertools import groupby
from typing import Any, Final, TypeAlias, TypeVar

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from scenic.compiler.semantics.symbols import Symbol, SymbolKind
from scenic.ide import hierarchies, navigation
from scenic.ide.navigation import Target
from scenic.ide.symbols import OutlineKind, flat, matches, symbols
from scenic.lsp.handlers.information import Placed, place_of
from scenic.lsp.progress import Partial, Progress
from scenic.lsp.session import Session
from scenic.lsp.threads import GoOn
from scenic.lsp.uris import to_path
from scenic.project.index import Project

__all__ = ["HANDLERS", "KINDS"]

_Item = TypeVar("_Item", types.CallHierarchyItem, types.TypeHierarchyItem)

KINDS: Final = {
    OutlineKind.CLASS: types.SymbolKind.Class,
    OutlineKind.PROPERTY: types.SymbolKind.Property,
    OutlineKind.FUNCTION: types.SymbolKind.Function,
    OutlineKind.METHOD: types.SymbolKind.Method,
    OutlineKind.BEHAVIOR: types.SymbolKind.Event,
    OutlineKind.MONITOR: types.SymbolKind.Event,
    OutlineKind.SCENARIO: types.SymbolKind.Namespace,
    OutlineKind.OBJECT: types.SymbolKind.Object,
    OutlineKind.VARIABLE: types.SymbolKind.Variable,
    OutlineKind.CONSTANT: types.SymbolKind.Constant,
    OutlineKind.PARAMETER: types.SymbolKind.Key,
    OutlineKind.REQUIREMENT: types.SymbolKind.Boolean,
}
_OF_PROJECT: Final = {
    SymbolKind.MODULE: types.SymbolKind.Module,
    SymbolKind.CLASS: types.SymbolKind.Class,
    SymbolKind.FUNCTION: types.SymbolKind.Function,
    SymbolKind.METHOD: types.SymbolKind.Method,
    SymbolKind.BEHAVIOR: types.SymbolKind.Event,
    SymbolKind.MONITOR: types.SymbolKind.Event,
    SymbolKind.SCENARIO: types.SymbolKind.Namespace,
    SymbolKind.PROPERTY: types.SymbolKind.Property,
    SymbolKind.ATTRIBUTE: types.SymbolKind.Field,
}
_MOST: Final = 1000
"""So many symbols of the workspace are listed."""

Places: TypeAlias = list[types.Location] | list[types.LocationLink] | None
Find: TypeAlias = Callable[[Project, str, int, int], Symbol | None]


def _goto(find: Callable[..., Sequence[Target]], name: str) -> Callable[[Session, Placed], Places]:
    """The handler of a request that leads elsewhere."""

    def handler(session: Session, params: Placed) -> Places:
        document, line, column = place_of(session, params)
        targets = find(session.project_with(document), document.snapshot, line, column)
        if not targets:
            return None
        if not session.can(f"text_document.{name}.link_support"):
            return [session.location(each.filename, each.span) for each in targets]
        return [
            types.LocationLink(
                session.uri_of(each.filename),
                session.lines_of(each.filename).to_range(each.extent),
                session.lines_of(each.filename).to_range(each.span),
                origin_selection_range=document.lines.to_range(each.origin),
            )
            for each in targets
        ]

    return handler


def _references(session: Session, params: types.ReferenceParams) -> Future[list[types.Location]]:
    document, line, column = place_of(session, params)
    with_definitions = params.context.include_declaration
    project = session.project_with(document)
    progress = Progress(session, params.work_done_token, "Finding references")
    partial: Partial[types.Location] = Partial(session, params.partial_result_token)

    def work(go_on: GoOn) -> list[types.Location]:
        with progress:
            found = navigation.usages(
                project, document.snapshot, line, column, with_definitions=with_definitions, go_on=go_on
            )
            for filename, places in groupby(found, lambda each: each.filename):
                uri, lines = session.uri_of(filename), session.lines_of(filename)
                partial.add([types.Location(uri, lines.to_range(each.span)) for each in places])
        return partial.rest

    return session.work(work, token=params.work_done_token)


def _highlights(session: Session, params: types.DocumentHighlightParams) -> list[types.DocumentHighlight]:
    document, line, column = place_of(session, params)
    kind = types.DocumentHighlightKind
    return [
        types.DocumentHighlight(document.lines.to_range(each.span), kind.Write if each.writes else kind.Read)
        for each in navigation.highlights(session.project_with(document), document.snapshot, line, column)
    ]


# Hierarchies


def _item(session: Session, symbol: Symbol, make: type[_Item]) -> _Item:
    """Return a function or class as an item of a hierarchy."""
    assert symbol.filename is not None
    assert symbol.span is not None
    lines = session.lines_of(symbol.filename)
    extent = (
        symbol.extent if symbol.extent is not None and symbol.extent.contains(symbol.span) else symbol.span
    )
    detail = symbol.container or (symbol.kind.value if symbol.kind is not SymbolKind.MODULE else "")
    return make(
        name=symbol.name,
        kind=_OF_PROJECT.get(symbol.kind, types.SymbolKind.Variable),
        uri=session.uri_of(symbol.filename),
        range=lines.to_range(extent),
        selection_range=lines.to_range(symbol.span),
        detail=detail or None,
    )


def _prepare(find: Find, make: type[_Item]) -> Callable[[Session, Placed], list[_Item] | None]:
    def handler(session: Session, params: Placed) -> list[_Item] | None:
        document, line, column = place_of(session, params)
        symbol = find(session.project_with(document), document.snapshot.filename, line, column)
        return None if symbol is None else [_item(session, symbol, make)]

    return handler


def _symbol(
    session: Session, item: types.CallHierarchyItem | types.TypeHierarchyItem, find: Find
) -> tuple[Project, Symbol | None]:
    """Return the project and the symbol of an item in a hierarchy."""
    document = session.document(item.uri)
    line, column = document.lines.from_position(item.selection_range.start)
    project = session.project_with(document)
    return project, find(project, document.snapshot.filename, line, column)


def _incoming(
    session: Session, params: types.CallHierarchyIncomingCallsParams
) -> list[types.CallHierarchyIncomingCall] | None:
    project, symbol = _symbol(session, params.item, hierarchies.callable_at)
    if symbol is None or params.item.kind is types.SymbolKind.Module:
        return None  # Nothing calls a module.
    return [
        types.CallHierarchyIncomingCall(
            _item(session, call.symbol, types.CallHierarchyItem),
            [session.lines_of(call.filename).to_range(span) for span in call.spans],
        )
        for call in hierarchies.callers(project, symbol)
    ]


def _outgoing(
    session: Session, params: types.CallHierarchyOutgoingCallsParams
) -> list[types.CallHierarchyOutgoingCall] | None:
    project, symbol = _symbol(session, params.item, hierarchies.callable_at)
    if params.item.kind is types.SymbolKind.Module:
        module = project.module(session.document(params.item.uri).snapshot.filename)
        symbol = None if module is None else hierarchies.module_symbol(module)
    if symbol is None:
        return None
    return [
        types.CallHierarchyOutgoingCall(
            _item(session, call.symbol, types.CallHierarchyItem),
            [session.lines_of(call.filename).to_range(span) for span in call.spans],
        )
        for call in hierarchies.callees(project, symbol)
    ]


def _types(
    find: Callable[..., Sequence[Symbol]],
) -> Callable[[Session, Any], list[types.TypeHierarchyItem] | None]:
    def handler(
        session: Session, params: types.TypeHierarchySupertypesParams | types.TypeHierarchySubtypesParams
    ) -> list[types.TypeHierarchyItem] | None:
        project, symbol = _symbol(session, params.item, hierarchies.class_at)
        if symbol is None:
            return None
        return [_item(session, each, types.TypeHierarchyItem) for each in find(project, symbol)]

    return handler


# The workspace


def _workspace_symbols(
    session: Session, params: types.WorkspaceSymbolParams
) -> Future[list[types.WorkspaceSymbol]]:
    query = params.query
    snapshots = session.workspace_snapshots()
    progress = Progress(session, params.work_done_token, "Searching symbols")
    partial: Partial[types.WorkspaceSymbol] = Partial(session, params.partial_result_token)

    def work(go_on: GoOn) -> list[types.WorkspaceSymbol]:
        items = []
        with progress:
            for filename, snapshot in snapshots:
                go_on()
                lines = None
                for symbol, container in flat(symbols(snapshot())):
                    if not matches(symbol.name, query):
                        continue
                    lines = lines or session.lines_of_source(filename, snapshot().source)
                    place = types.Location(session.uri_of(filename), lines.to_range(symbol.name_span))
                    item = types.WorkspaceSymbol(
                        place, symbol.name, KINDS[symbol.kind], container_name=container or None
                    )
                    items.append(item)
        start = query.lower()
        items.sort(key=lambda item: (not item.name.lower().startswith(start), item.name.lower()))
        partial.add(items[:_MOST])
        return partial.rest

    return session.work(work, token=params.work_done_token)


def _resolve_symbol(session: Session, symbol: types.WorkspaceSymbol) -> types.WorkspaceSymbol:
    """Nothing is left to find out: a symbol is listed with its place."""
    uri = symbol.location.uri
    if to_path(uri) is None and uri not in session.documents:
        raise JsonRpcInvalidParams(f"{uri} is no document of the workspace")
    return symbol


def _moniker(session: Session, params: types.MonikerParams) -> list[types.Moniker] | None:
    document, line, column = place_of(session, params)
    project = session.project_with(document)
    identity = navigation.moniker(project, document.snapshot, line, column)
    if identity is None:
        return None
    unique, kind = types.UniquenessLevel.Project, types.MonikerKind.Export
    if identity.is_local:
        unique, kind = types.UniquenessLevel.Document, types.MonikerKind.Local
    elif identity.is_import:
        kind = types.MonikerKind.Import
    return [types.Moniker("scenic", identity.identifier, unique, kind)]


HANDLERS: Final = {
    types.TEXT_DOCUMENT_MONIKER: _moniker,
    types.TEXT_DOCUMENT_DECLARATION: _goto(navigation.declarations, "declaration"),
    types.TEXT_DOCUMENT_DEFINITION: _goto(navigation.definitions, "definition"),
    types.TEXT_DOCUMENT_TYPE_DEFINITION: _goto(navigation.type_definitions, "type_definition"),
    types.TEXT_DOCUMENT_IMPLEMENTATION: _goto(navigation.implementations, "implementation"),
    types.TEXT_DOCUMENT_REFERENCES: _references,
    types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: _highlights,
    types.TEXT_DOCUMENT_PREPARE_CALL_HIERARCHY: _prepare(hierarchies.callable_at, types.CallHierarchyItem),
    types.CALL_HIERARCHY_INCOMING_CALLS: _incoming,
    types.CALL_HIERARCHY_OUTGOING_CALLS: _outgoing,
    types.TEXT_DOCUMENT_PREPARE_TYPE_HIERARCHY: _prepare(hierarchies.class_at, types.TypeHierarchyItem),
    types.TYPE_HIERARCHY_SUPERTYPES: _types(hierarchies.supertypes),
    types.TYPE_HIERARCHY_SUBTYPES: _types(hierarchies.subtypes),
    types.WORKSPACE_SYMBOL: _workspace_symbols,
    types.WORKSPACE_SYMBOL_RESOLVE: _resolve_symbol,
}
