"""Handlers of information about a place: hover, completion, signatures."""

from typing import Any, Final, Protocol

from lsprotocol import types

from scenic.ide.completion import CompletionKind, completions, document, must_follow
from scenic.ide.hover import hover
from scenic.ide.signatures import signature_help
from scenic.lsp.documents import Document
from scenic.lsp.session import Session

__all__ = ["HANDLERS", "Placed", "place_of"]

_KINDS: Final = {
    CompletionKind.KEYWORD: types.CompletionItemKind.Keyword,
    CompletionKind.SPECIFIER: types.CompletionItemKind.Keyword,
    CompletionKind.OPERATOR: types.CompletionItemKind.Operator,
    CompletionKind.SNIPPET: types.CompletionItemKind.Snippet,
    CompletionKind.CLASS: types.CompletionItemKind.Class,
    CompletionKind.FUNCTION: types.CompletionItemKind.Function,
    CompletionKind.METHOD: types.CompletionItemKind.Method,
    CompletionKind.BEHAVIOR: types.CompletionItemKind.Event,
    CompletionKind.MONITOR: types.CompletionItemKind.Event,
    CompletionKind.SCENARIO: types.CompletionItemKind.Module,
    CompletionKind.PROPERTY: types.CompletionItemKind.Property,
    CompletionKind.ATTRIBUTE: types.CompletionItemKind.Field,
    CompletionKind.VARIABLE: types.CompletionItemKind.Variable,
    CompletionKind.PARAMETER: types.CompletionItemKind.Variable,
    CompletionKind.MODULE: types.CompletionItemKind.Module,
    CompletionKind.CONSTANT: types.CompletionItemKind.Constant,
}


class Placed(Protocol):
    """Parameters of a request about a place in a document."""

    text_document: types.TextDocumentIdentifier
    position: types.Position


def place_of(session: Session, params: Placed) -> tuple[Document, int, int]:
    """Return the document that a request is about, or its block, and the line and column in it."""
    document = session.document(params.text_document.uri).at(params.position.line)
    return document, *document.lines.from_position(params.position)


def markup(session: Session, text: str, path: str) -> types.MarkupContent:
    """Return Markdown for a client that shows it, and otherwise plain text; ``path`` leads to the formats that the client lists."""
    formats = session.lists(path)
    if formats and types.MarkupKind.Markdown not in formats:
        plain = text.replace("```scenic\n", "").replace("```python\n", "").replace("\n```", "")
        return types.MarkupContent(types.MarkupKind.PlainText, plain.replace("`", "").replace("*", ""))
    return types.MarkupContent(types.MarkupKind.Markdown, text)


def _hover(session: Session, params: types.HoverParams) -> types.Hover | None:
    document, line, column = place_of(session, params)
    found = hover(document.snapshot, line, column, lambda: session.project_with(document))
    if found is None:
        return None
    shown = markup(session, found.markdown, "text_document.hover.content_format")
    return types.Hover(shown, document.lines.to_range(found.span))


def _completion(session: Session, params: types.CompletionParams) -> types.CompletionList:
    document, line, column = place_of(session, params)
    trigger = None if params.context is None else params.context.trigger_character
    if not document.programs or (trigger == " " and not must_follow(document.snapshot, line, column)):
        return types.CompletionList(is_incomplete=False, items=[])
    completion_list = completions(session.project_with(document), document.snapshot, line, column)
    snippets = session.can("text_document.completion.completion_item.snippet_support")
    # The place is the same for all, and need be said but once to clients that know of that.
    once = "editRange" in session.lists("text_document.completion.completion_list.item_defaults")
    place = document.lines.to_range(completion_list.span)
    items = []
    for item in completion_list.items:
        snippet = item.snippet if snippets else None
        text = item.text if snippet is None else snippet
        items.append(
            types.CompletionItem(
                item.label,
                kind=_KINDS[item.kind],
                sort_text=f"{item.rank}{item.label}",
                text_edit=None if once else types.TextEdit(place, text),
                text_edit_text=text if once and text != item.label else None,
                filter_text=item.label if item.text != item.label else None,
                detail=item.detail or None,
                insert_text_format=None if snippet is None else types.InsertTextFormat.Snippet,
                data={"uri": document.uri, "key": list(item.key)} if item.key else None,
            )
        )
    defaults = types.CompletionItemDefaults(edit_range=place) if once else None
    return types.CompletionList(is_incomplete=False, items=items, item_defaults=defaults)


def _resolve(session: Session, item: types.CompletionItem) -> types.CompletionItem:
    data: dict[str, Any] = item.data if isinstance(item.data, dict) else {}
    uri, key_parts = data.get("uri"), data.get("key")
    key = tuple(each for each in key_parts if isinstance(each, str)) if isinstance(key_parts, list) else ()
    if not key or not isinstance(uri, str) or item.documentation is not None:
        return item
    open_document = session.documents.get(uri)
    project = session.project if open_document is None else session.project_with(open_document)
    text = document(project, None if open_document is None else open_document.snapshot, key)
    if text is not None:
        path = "text_document.completion.completion_item.documentation_format"
        item.documentation = markup(session, text, path)
    return item


def _signature_help(session: Session, params: types.SignatureHelpParams) -> types.SignatureHelp | None:
    open_document, line, column = place_of(session, params)
    help_found = signature_help(session.project_with(open_document), open_document.snapshot, line, column)
    if help_found is None:
        return None
    path = "text_document.signature_help.signature_information"
    offsets = session.can(f"{path}.parameter_information.label_offset_support")
    parameters = [
        types.ParameterInformation((start, end) if offsets else help_found.label[start:end])
        for start, end in help_found.parameters
    ]
    documentation = None
    if help_found.documentation:
        documentation = markup(session, help_found.documentation, f"{path}.documentation_format")
    active = len(parameters) if help_found.active is None else help_found.active
    # The signature repeats the number: without it, `null` would be sent, which clients read as no parameter.
    signature = types.SignatureInformation(help_found.label, documentation, parameters, active)
    return types.SignatureHelp([signature], active_signature=0, active_parameter=active)


HANDLERS: Final = {
    types.TEXT_DOCUMENT_HOVER: _hover,
    types.TEXT_DOCUMENT_COMPLETION: _completion,
    types.COMPLETION_ITEM_RESOLVE: _resolve,
    types.TEXT_DOCUMENT_SIGNATURE_HELP: _signature_help,
}
