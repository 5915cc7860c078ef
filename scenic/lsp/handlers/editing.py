"""Changing documents: repairs, formatting, other names."""

from collections.abc import Sequence
from typing import Any, Final

from scenic.ide import navigation
from scenic.ide.dedenting import dedented
from scenic.ide.diagnostics import found_in
from scenic.ide.formatting import formatting
from scenic.ide.importing import missing_imports, organize_imports
from scenic.ide.repairs import can_repair_all, ignoring, repair_all, repairs, touch
from scenic.language.diagnostics import Diagnostic, Edit
from scenic.language.selection import Rules
from scenic.lsp import reading
from scenic.lsp.capabilities import FIX_ALL, ORGANIZE
from scenic.lsp.convert import Json, to_diagnostic
from scenic.lsp.documents import Document
from scenic.lsp.errors import ErrorCode, ProtocolError
from scenic.lsp.handlers.information import place_of
from scenic.lsp.session import Session

__all__ = ["REQUESTS"]

_AUTOMATIC: Final = 2
_QUICK_FIX: Final = "quickfix"


# Code actions


def _actions(session: Session, params: Any) -> Json:
    """What can be repaired at a place, and if that is asked for, all that can be repaired in the document."""
    document = session.document(reading.uri_of(params))
    span = document.lines.from_range(*reading.range_of(params, "range"))
    only = reading.texts(params, "context", "only")
    _, rules = session.rules(document.snapshot.filename)
    actions: list[Json] = []
    if _wanted(_QUICK_FIX, only):
        found = found_in(document.snapshot, rules, session.project_beside(document), stamp=session.generation)
        for item in repairs(found, span):
            assert item.fix is not None
            action = _action(session, document, item.fix.title, _QUICK_FIX, item.fix.edits)
            # An editor may make what is preferred without asking.
            preferred = {"isPreferred": True} if item.fix.certain else {}
            actions.append({**action, "diagnostics": [_diagnostic(session, item, document)], **preferred})
        project = session.project_with(document)
        for missing in missing_imports(project, document.snapshot, found, lambda each: touch(each, span)):
            action = _action(session, document, missing.title, _QUICK_FIX, [missing.edit])
            actions.append({**action, "diagnostics": [_diagnostic(session, missing.diagnostic, document)]})
        for item, edit in ignoring(document.snapshot, found, span):
            title = f"Silence {item.code} on this line"
            action = _action(session, document, title, _QUICK_FIX, [edit])
            actions.append({**action, "diagnostics": [_diagnostic(session, item, document)]})
    # An editor asks with each move of the cursor what is offered there.
    automatic = reading.lookup(params, "context", "triggerKind") == _AUTOMATIC and not only
    if not automatic and _wanted(FIX_ALL, only):
        actions += _all_repairs(session, document, rules)
    if not automatic and _wanted(ORGANIZE, only):
        found = found_in(document.snapshot, rules, session.project_beside(document), stamp=session.generation)
        organized = organize_imports(document.snapshot, found)
        if organized is not None:
            actions.append(_action(session, document, "Organize imports", ORGANIZE, [organized]))
    return actions


def _all_repairs(session: Session, document: Document, rules: Rules) -> list[Json]:
    """One action that makes all repairs; its changes are worked out when it is chosen, if the client can wait."""
    title = "Make all repairs of scenic"
    can_wait = "edit" in session.client.lists("textDocument", "codeAction", "resolveSupport", "properties")
    found = found_in(document.snapshot, rules, session.project_beside(document), stamp=session.generation)
    if not can_repair_all(found):
        return []
    if can_wait and session.client.can("textDocument", "codeAction", "dataSupport"):
        return [{"title": title, "kind": FIX_ALL, "data": {"uri": document.uri, "version": document.version}}]
    edit = _repair_all(session, document, rules)
    return [] if edit is None else [_action(session, document, title, FIX_ALL, [edit])]


def _repair_all(session: Session, document: Document, rules: Rules) -> Edit | None:
    """All repairs of a document as one edit, worked out once for each version."""
    snapshot = document.snapshot

    def make() -> Edit | None:
        project = session.project_beside(document)
        return repair_all(snapshot.text, filename=snapshot.filename, rules=rules, project=project)

    return snapshot.derived("all repairs", make, stamp=(session.generation, rules))


def _resolve_action(session: Session, params: Any) -> Json:
    uri = reading.lookup(params, "data", "uri")
    if not isinstance(uri, str) or "edit" in params:
        return params
    document = session.document(uri)
    if document.version != reading.lookup(params, "data", "version"):
        raise ProtocolError(ErrorCode.CONTENT_MODIFIED, "the document has changed")
    _, rules = session.rules(document.snapshot.filename)
    edit = _repair_all(session, document, rules)
    if edit is None:
        return params
    return {**params, "edit": _action(session, document, "", FIX_ALL, [edit])["edit"]}


def _action(
    session: Session, document: Document, title: str, kind: str, edits: Sequence[Edit]
) -> dict[str, Json]:
    changes = {document.uri: document.lines.to_edits(edits, document.line_end)}
    return {"title": title, "kind": kind, "edit": session.workspace_edit(changes)}


def _diagnostic(session: Session, item: Diagnostic, document: Document) -> Json:
    return to_diagnostic(item, document.lines, document.uri, elsewhere=session.location)


def _wanted(kind: str, only: Sequence[str]) -> bool:
    """Whether the editor asks for actions of this kind: kinds are parts with dots between, the first ones wider."""
    return not only or any((kind + ".").startswith(asked + ".") for asked in only if asked) or "" in only


# Formatting


def _format(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    return document.lines.to_edits(formatting(document.snapshot), document.line_end)


def _format_range(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    lines = _lines(document, reading.range_of(params, "range"))
    return document.lines.to_edits(formatting(document.snapshot, lines), document.line_end)


def _format_ranges(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    every = reading.items(params, "ranges")
    ranges = [_lines(document, reading.range_of(params, "ranges", index)) for index, _ in enumerate(every)]
    edits = formatting(document.snapshot, *ranges) if ranges else ()
    return document.lines.to_edits(edits, document.line_end)


def _lines(document: Document, places: tuple[tuple[int, int], tuple[int, int]]) -> tuple[int, int]:
    """The first and the last line of a range; one that ends where a line begins does not hold that line."""
    span = document.lines.from_range(*places)
    last = span.end_line - 1 if span.end_column == 0 and span.end_line > span.line else span.end_line
    return span.line, last


def _format_typed(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    typed = reading.text(params, "ch")
    edits = dedented(document.snapshot, line, column) if typed == ":" else ()
    return document.lines.to_edits(edits, document.line_end)


# Names


def _prepare_rename(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    try:
        found = navigation.prepare_rename(session.project_with(document), document.snapshot, line, column)
    except navigation.RenameError as error:
        raise ProtocolError(ErrorCode.REQUEST_FAILED, str(error)) from None
    if found is None:
        return None
    return {"range": document.lines.to_range(found[0]), "placeholder": found[1]}


def _rename(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    name = reading.text(params, "newName")
    try:
        changed = navigation.rename(session.project_with(document), document.snapshot, line, column, name)
    except navigation.RenameError as error:
        code = ErrorCode.REQUEST_FAILED if name.isidentifier() else ErrorCode.INVALID_PARAMS
        raise ProtocolError(code, str(error)) from None
    changes: dict[str, list[Json]] = {}
    for place, text in changed:
        edit = {"range": session.lines_of(place.filename).to_range(place.span), "newText": text}
        changes.setdefault(session.uri_of(place.filename), []).append(edit)
    return session.workspace_edit(changes)


def _linked(session: Session, params: Any) -> Json:
    document, line, column = place_of(session, params)
    spans = navigation.linked(session.project_with(document), document.snapshot, line, column)
    if not spans:
        return None
    return {"ranges": [document.lines.to_range(span) for span in spans], "wordPattern": r"[A-Za-z_]\w*"}


REQUESTS: Final = {
    "textDocument/codeAction": _actions,
    "codeAction/resolve": _resolve_action,
    "textDocument/formatting": _format,
    "textDocument/rangeFormatting": _format_range,
    "textDocument/rangesFormatting": _format_ranges,
    "textDocument/onTypeFormatting": _format_typed,
    "textDocument/prepareRename": _prepare_rename,
    "textDocument/rename": _rename,
    "textDocument/linkedEditingRange": _linked,
}
