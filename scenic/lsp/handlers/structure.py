"""The structure of a document: its symbols, what can be folded, what a selection grows to, what each word is."""

from collections.abc import Sequence
from typing import Final

from lsprotocol import types

from scenic.ide.folding import FoldKind, folds
from scenic.ide.selection import selections
from scenic.ide.semantic_tokens import MODIFIERS, TYPES, SemanticToken, semantic_tokens
from scenic.ide.symbols import OutlineSymbol, flat, symbols
from scenic.lsp.convert import Encoding
from scenic.lsp.documents import Document
from scenic.lsp.handlers.navigation import KINDS
from scenic.lsp.session import Session

__all__ = ["HANDLERS"]

_TYPE: Final = {name: index for index, name in enumerate(TYPES)}
_MODIFIER: Final = {name: 1 << index for index, name in enumerate(MODIFIERS)}
_FOLDS: Final = {
    FoldKind.COMMENT: types.FoldingRangeKind.Comment,
    FoldKind.IMPORTS: types.FoldingRangeKind.Imports,
    FoldKind.REGION: types.FoldingRangeKind.Region,
}


def _symbols(
    session: Session, params: types.DocumentSymbolParams
) -> list[types.DocumentSymbol] | list[types.SymbolInformation]:
    document = session.document(params.text_document.uri)
    document_symbols = symbols(document.snapshot)
    if session.can("text_document.document_symbol.hierarchical_document_symbol_support"):
        return [_symbol(document, each) for each in document_symbols]
    return [
        types.SymbolInformation(
            types.Location(document.uri, document.lines.to_range(symbol.span)),
            symbol.name,
            KINDS[symbol.kind],
            container_name=container or None,
        )
        for symbol, container in flat(document_symbols)
    ]


def _symbol(document: Document, symbol: OutlineSymbol) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        symbol.name,
        KINDS[symbol.kind],
        document.lines.to_range(symbol.span),
        document.lines.to_range(symbol.name_span),
        detail=symbol.detail or None,
        children=[_symbol(document, each) for each in symbol.children],
    )


def _folding(session: Session, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
    document = session.document(params.text_document.uri)
    support = session.client.text_document and session.client.text_document.folding_range
    most = support.range_limit if support else None
    found = [
        types.FoldingRange(fold.line - 1, fold.end_line - 1, kind=_FOLDS.get(fold.kind))
        for fold in folds(document.snapshot)
    ]
    return found[:most]


def _selection(session: Session, params: types.SelectionRangeParams) -> list[types.SelectionRange]:
    document = session.document(params.text_document.uri)
    found = []
    for position in params.positions:
        place = document.lines.from_position(position)
        result = None
        for span in reversed(selections(document.snapshot, *place)):
            result = types.SelectionRange(document.lines.to_range(span), result)
        found.append(result or types.SelectionRange(types.Range(position, position)))
    return found


# Semantic tokens


def _full(session: Session, params: types.SemanticTokensParams) -> types.SemanticTokens:
    document = session.document(params.text_document.uri)
    data = _encoded(document, _tokens(session, document))
    return types.SemanticTokens(data, session.tokens.keep(document.uri, data))


def _delta(
    session: Session, params: types.SemanticTokensDeltaParams
) -> types.SemanticTokens | types.SemanticTokensDelta:
    document = session.document(params.text_document.uri)
    before = session.tokens.known(document.uri, params.previous_result_id)
    data = _encoded(document, _tokens(session, document))
    name = session.tokens.keep(document.uri, data)
    if before is None:
        return types.SemanticTokens(data, name)
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
        return types.SemanticTokensDelta([], name)
    edit = types.SemanticTokensEdit(start, len(before) - same - start, data[start : len(data) - same])
    return types.SemanticTokensDelta([edit], name)


def _range(session: Session, params: types.SemanticTokensRangeParams) -> types.SemanticTokens:
    document = session.document(params.text_document.uri)
    span = document.lines.from_range(params.range)
    tokens = [
        token
        for token in _tokens(session, document)
        if (token.line, token.end_column) > (span.line, span.column)
        and (token.line, token.column) < (span.end_line, span.end_column)
    ]
    return types.SemanticTokens(_encoded(document, tokens))


def _tokens(session: Session, document: Document) -> Sequence[SemanticToken]:
    return semantic_tokens(document.snapshot, session.project_with(document), stamp=session.generation)


def _encoded(document: Document, tokens: Sequence[SemanticToken]) -> list[int]:
    """Encode tokens as the protocol does: five numbers each, places relative to the token before."""
    data: list[int] = []
    last_line = last_start = 0
    lines, rows = document.lines, document.snapshot.source.lines
    plain = [lines.encoding is Encoding.UTF32 or row.isascii() for row in rows]
    modifiers: dict[frozenset[str], int] = {}
    for token in tokens:
        line, start, end = token.line, token.column, token.end_column
        if line == 1 or not plain[line - 1]:
            start = lines.to_position(line, start).character
            end = lines.to_position(line, end).character
        if token.modifiers not in modifiers:
            modifiers[token.modifiers] = sum(_MODIFIER[name] for name in token.modifiers)
        data += (
            line - 1 - last_line,
            start - last_start if line - 1 == last_line else start,
            end - start,
            _TYPE[token.type],
            modifiers[token.modifiers],
        )
        last_line, last_start = line - 1, start
    return data


HANDLERS: Final = {
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: _symbols,
    types.TEXT_DOCUMENT_FOLDING_RANGE: _folding,
    types.TEXT_DOCUMENT_SELECTION_RANGE: _selection,
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: _full,
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL_DELTA: _delta,
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE: _range,
}
