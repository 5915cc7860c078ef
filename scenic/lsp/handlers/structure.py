"""The structure of a document: its symbols, what can be folded, what a selection grows to, what each word is."""

from collections.abc import Sequence
from typing import Any, Final

from scenic.ide.folding import FoldKind, folds
from scenic.ide.selection import selections
from scenic.ide.semantic_tokens import MODIFIERS, TYPES, SemanticToken, semantic_tokens
from scenic.ide.symbols import Symbol, flat, symbols
from scenic.lsp import reading
from scenic.lsp.convert import Json, units
from scenic.lsp.documents import Document
from scenic.lsp.handlers.navigation import KINDS
from scenic.lsp.session import Session

__all__ = ["REQUESTS"]

_TYPE: Final = {name: index for index, name in enumerate(TYPES)}
_MODIFIER: Final = {name: 1 << index for index, name in enumerate(MODIFIERS)}
_FOLDS: Final = {FoldKind.COMMENT: "comment", FoldKind.IMPORTS: "imports", FoldKind.REGION: "region"}


def _symbols(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    found = symbols(document.snapshot)
    if session.client.can("textDocument", "documentSymbol", "hierarchicalDocumentSymbolSupport"):
        return [_symbol(document, each) for each in found]
    return [
        {
            "name": symbol.name,
            "kind": KINDS[symbol.kind],
            "location": {"uri": document.uri, "range": document.lines.to_range(symbol.span)},
            **({"containerName": container} if container else {}),
        }
        for symbol, container in flat(found)
    ]


def _symbol(document: Document, symbol: Symbol) -> Json:
    found = {
        "name": symbol.name,
        "kind": KINDS[symbol.kind],
        "range": document.lines.to_range(symbol.span),
        "selectionRange": document.lines.to_range(symbol.name_span),
        "children": [_symbol(document, each) for each in symbol.children],
    }
    if symbol.detail:
        found["detail"] = symbol.detail
    return found


def _folding(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    limit = reading.lookup(params, "rangeLimit")
    asked = session.client.limit("textDocument", "foldingRange", "rangeLimit")
    found = []
    for fold in folds(document.snapshot):
        item: dict[str, Json] = {"startLine": fold.line - 1, "endLine": fold.end_line - 1}
        if fold.kind in _FOLDS:
            item["kind"] = _FOLDS[fold.kind]
        found.append(item)
    most = limit if isinstance(limit, int) else asked
    return found if most is None else found[:most]


def _selection(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    found = []
    for index in range(len(reading.items(params, "positions"))):
        place = document.lines.from_position(*reading.position(params, "positions", index))
        result: Json = None
        for span in reversed(selections(document.snapshot, *place)):
            item = {"range": document.lines.to_range(span)}
            result = item if result is None else {**item, "parent": result}
        found.append(result)
    return found


# Semantic tokens


def _full(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    data = _encoded(document, _tokens(session, document))
    return {"resultId": session.tokens.keep(document.uri, data), "data": data}


def _delta(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    before = session.tokens.known(document.uri, reading.text(params, "previousResultId"))
    data = _encoded(document, _tokens(session, document))
    name = session.tokens.keep(document.uri, data)
    if before is None:
        return {"resultId": name, "data": data}
    start = next((at for at, (one, two) in enumerate(zip(before, data, strict=False)) if one != two), None)
    if start is None:
        start = min(len(before), len(data))
    most = min(len(before), len(data)) - start
    pairs = zip(
        before[: start - 1 if start else None : -1], data[: start - 1 if start else None : -1], strict=False
    )
    same = next((at for at, (one, two) in enumerate(pairs) if one != two), most)
    same = min(same, most)
    if start == len(before) == len(data):
        return {"resultId": name, "edits": []}
    edit = {"start": start, "deleteCount": len(before) - same - start, "data": data[start : len(data) - same]}
    return {"resultId": name, "edits": [edit]}


def _range(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    span = document.lines.from_range(*reading.range_of(params, "range"))
    tokens = [
        token
        for token in _tokens(session, document)
        if (token.line, token.end_column) > (span.line, span.column)
        and (token.line, token.column) < (span.end_line, span.end_column)
    ]
    return {"data": _encoded(document, tokens)}


def _tokens(session: Session, document: Document) -> Sequence[SemanticToken]:
    return semantic_tokens(document.snapshot, session.project_with(document), stamp=session.generation)


def _encoded(document: Document, tokens: Sequence[SemanticToken]) -> list[int]:
    """Tokens as the protocol has them: five numbers each, places relative to the token before."""
    data: list[int] = []
    last_line = last_start = 0
    encoding = document.lines.encoding
    for token in tokens:
        content = document.snapshot.source.line(token.line)
        position = document.lines.to_position(token.line, token.column)
        line, start = position["line"], position["character"]
        length = units(content[token.column : token.end_column], encoding)
        data += (
            line - last_line,
            start - last_start if line == last_line else start,
            length,
            _TYPE[token.type],
            sum(_MODIFIER[name] for name in token.modifiers),
        )
        last_line, last_start = line, start
    return data


REQUESTS: Final = {
    "textDocument/documentSymbol": _symbols,
    "textDocument/foldingRange": _folding,
    "textDocument/selectionRange": _selection,
    "textDocument/semanticTokens/full": _full,
    "textDocument/semanticTokens/full/delta": _delta,
    "textDocument/semanticTokens/range": _range,
}
