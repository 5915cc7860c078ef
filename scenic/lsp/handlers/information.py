"""What a reader or writer wants to know about a place: hover, completion, signatures."""

from typing import Any, Final

from scenic.ide.completion import CompletionKind, completions, document, must_follow
from scenic.ide.hover import hover
from scenic.ide.signatures import signature_help
from scenic.lsp import reading
from scenic.lsp.convert import Json
from scenic.lsp.documents import Document
from scenic.lsp.session import Session

__all__ = ["REQUESTS"]

_KINDS: Final = {
    CompletionKind.KEYWORD: 14,
    CompletionKind.SPECIFIER: 14,
    CompletionKind.OPERATOR: 24,
    CompletionKind.SNIPPET: 15,
    CompletionKind.CLASS: 7,
    CompletionKind.FUNCTION: 3,
    CompletionKind.METHOD: 2,
    CompletionKind.BEHAVIOR: 23,
    CompletionKind.MONITOR: 23,
    CompletionKind.SCENARIO: 9,
    CompletionKind.PROPERTY: 10,
    CompletionKind.ATTRIBUTE: 5,
    CompletionKind.VARIABLE: 6,
    CompletionKind.PARAMETER: 6,
    CompletionKind.MODULE: 9,
    CompletionKind.CONSTANT: 17,
}
_SNIPPET: Final = 2


def place_of(session: Session, params: Any) -> tuple[Document, int, int]:
    """The document that a request is about, and the line and column in it."""
    document = session.document(reading.uri_of(params))
    return document, *document.lines.from_position(*reading.position(params, "position"))


def markup(session: Session, text: str, *path: str) -> Json:
    """Markdown for a client that shows it, and otherwise without its marks; ``path`` leads to the formats it lists."""
    formats = session.client.lists(*path)
    if formats and "markdown" not in formats:
        plain = text.replace("```scenic\n", "").replace("```python\n", "").replace("\n```", "")
        return {"kind": "plaintext", "value": plain.replace("`", "").replace("*", "")}
    return {"kind": "markdown", "value": text}


def _hover(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    found = hover(document.snapshot, line, column, lambda: session.project_with(document))
    if found is None:
        return None
    return {
        "contents": markup(session, found.markdown, "textDocument", "hover", "contentFormat"),
        "range": document.lines.to_range(found.span),
    }


def _completion(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    if reading.lookup(params, "context", "triggerCharacter") == " " and not must_follow(
        document.snapshot, line, column
    ):
        return {"isIncomplete": False, "items": []}
    found = completions(session.project_with(document), document.snapshot, line, column)
    snippets = session.client.can("textDocument", "completion", "completionItem", "snippetSupport")
    # The place is the same for all, and need be said but once to clients that know of that.
    once = "editRange" in session.client.lists("textDocument", "completion", "completionList", "itemDefaults")
    place = document.lines.to_range(found.span)
    items = []
    for item in found.items:
        snippet = item.snippet if snippets else None
        text = item.text if snippet is None else snippet
        shown: dict[str, Json] = {
            "label": item.label,
            "kind": _KINDS[item.kind],
            "sortText": f"{item.rank}{item.label}",
        }
        if not once:
            shown["textEdit"] = {"range": place, "newText": text}
        elif text != item.label:
            shown["textEditText"] = text
        if item.text != item.label:
            shown["filterText"] = item.label
        if item.detail:
            shown["detail"] = item.detail
        if snippet is not None:
            shown["insertTextFormat"] = _SNIPPET
        if item.key:
            shown["data"] = {"uri": document.uri, "key": list(item.key)}
        items.append(shown)
    answer: dict[str, Json] = {"isIncomplete": False, "items": items}
    if once:
        answer["itemDefaults"] = {"editRange": place}
    return answer


def _resolve(session: Session, params: Any) -> Json:
    key = tuple(reading.texts(params, "data", "key"))
    uri = reading.lookup(params, "data", "uri")
    if not key or not isinstance(uri, str) or "documentation" in params:
        return params
    document = session.documents.get(uri)
    project = session.project if document is None else session.project_with(document)
    text = None if project is None else document_of(project, document, key)
    if text is None:
        return params
    path = ("textDocument", "completion", "completionItem", "documentationFormat")
    return {**params, "documentation": markup(session, text, *path)}


def document_of(project: Any, opened: Document | None, key: tuple[str, ...]) -> str | None:
    """What there is to say about a possibility."""
    return document(project, None if opened is None else opened.snapshot, key)


def _signature_help(session: Session, params: Any) -> Json:
    opened, line, column = place_of(session, params)
    found = signature_help(session.project_with(opened), opened.snapshot, line, column)
    if found is None:
        return None
    path = ("textDocument", "signatureHelp", "signatureInformation")
    offsets = session.client.can(*path, "parameterInformation", "labelOffsetSupport")
    parameters = [
        {"label": [start, end] if offsets else found.label[start:end]} for start, end in found.parameters
    ]
    signature: dict[str, Json] = {"label": found.label, "parameters": parameters}
    if found.documentation:
        signature["documentation"] = markup(session, found.documentation, *path, "documentationFormat")
    active = len(parameters) if found.active is None else found.active
    return {"signatures": [signature], "activeSignature": 0, "activeParameter": active}


REQUESTS: Final = {
    "textDocument/hover": _hover,
    "textDocument/completion": _completion,
    "completionItem/resolve": _resolve,
    "textDocument/signatureHelp": _signature_help,
}
