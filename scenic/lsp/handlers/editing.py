"""Changing documents: repairs, formatting, other names."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams

from scenic.ide import navigation
from scenic.ide.dedenting import dedented
from scenic.ide.diagnostics import found_in
from scenic.ide.formatting import formatting
from scenic.ide.importing import can_organize, missing_imports, organize_imports
from scenic.ide.migrating import is_old, migrated
from scenic.ide.refactoring import Refactoring, extract_variable, inline_variable
from scenic.ide.repairs import can_repair_all, ignoring, repair_all, repairs, touch
from scenic.language.diagnostics import Diagnostic, Edit
from scenic.language.spans import Span
from scenic.lsp.capabilities import FIX_ALL, ORGANIZE
from scenic.lsp.convert import to_diagnostic
from scenic.lsp.documents import Document
from scenic.lsp.handlers.information import place_of
from scenic.lsp.session import Session

__all__ = ["HANDLERS"]

_QUICK_FIX: Final = types.CodeActionKind.QuickFix
_EXTRACT: Final = types.CodeActionKind.RefactorExtract
_INLINE: Final = types.CodeActionKind.RefactorInline


# Code actions


def _actions(session: Session, params: types.CodeActionParams) -> list[types.CodeAction]:
    """Return the repairs at a place, and on request also the repairs of the whole document."""
    whole = session.document(params.text_document.uri)
    only = params.context.only or ()
    _, rules = session.rules(whole.snapshot.filename)
    project = session.project_beside(whole)
    # An editor asks with each move of the cursor what is offered there.
    automatic = params.context.trigger_kind is types.CodeActionTriggerKind.Automatic and not only
    actions: list[types.CodeAction] = []
    repairable = False
    for document in whole.programs:
        if not document.has_part_of(params.range):
            continue
        span = document.lines.from_range(params.range)
        diagnostics = found_in(document.snapshot, rules, project, stamp=session.generation)
        repairable |= can_repair_all(diagnostics)
        actions += _at_place(session, document, diagnostics, span, only)
        if not automatic and _wanted(ORGANIZE, only) and can_organize(document.snapshot, diagnostics):
            actions += _of_document(session, document, ORGANIZE, "Organize imports")
    if not automatic and _wanted(FIX_ALL, only) and repairable:
        actions += _of_document(session, whole, FIX_ALL, "Make all repairs of scenic")
    return actions


def _at_place(
    session: Session, document: Document, found: Sequence[Diagnostic], span: Span, only: Sequence[str]
) -> Iterator[types.CodeAction]:
    """Repairs and refactorings of a part of a program."""
    if _wanted(_QUICK_FIX, only):
        yield from _quick_fixes(session, document, found, span)
        for item, edit in ignoring(document.snapshot, found, span):
            title = f"Silence {item.code} on this line"
            yield _action(session, document, title, _QUICK_FIX, [edit], item)
        if is_old(found):
            yield from _of_document(session, document, _QUICK_FIX, "Convert this program to Scenic 3")
    if _wanted(_EXTRACT, only):
        yield from _refactoring(
            session,
            document,
            _EXTRACT,
            extract_variable(session.project_with(document), document.snapshot, span),
        )
    if _wanted(_INLINE, only):
        inlining = inline_variable(session.project_with(document), document.snapshot, span.line, span.column)
        yield from _refactoring(session, document, _INLINE, inlining)


def _refactoring(
    session: Session, document: Document, kind: str, found: Refactoring | None
) -> list[types.CodeAction]:
    return [] if found is None else [_action(session, document, found.title, kind, found.edits)]


def _quick_fixes(
    session: Session,
    document: Document,
    found: Sequence[Diagnostic],
    span: Span,
) -> Iterator[types.CodeAction]:
    for item in repairs(found, span):
        assert item.fix is not None
        action = _action(session, document, item.fix.title, _QUICK_FIX, item.fix.edits, item)
        # An editor may make what is preferred without asking.
        action.is_preferred = item.fix.certain or None
        yield action
    project = session.project_with(document)
    for missing in missing_imports(project, document.snapshot, found, lambda each: touch(each, span)):
        yield _action(session, document, missing.title, _QUICK_FIX, [missing.edit], missing.diagnostic)


def _of_document(session: Session, document: Document, kind: str, title: str) -> list[types.CodeAction]:
    """Return an action on the whole document; its changes are worked out when it is chosen, if the client can wait."""
    can_wait = "edit" in session.lists("text_document.code_action.resolve_support.properties")
    if can_wait and session.can("text_document.code_action.data_support"):
        data = {"uri": document.uri, "version": document.version, "kind": kind, "line": document.before}
        return [types.CodeAction(title, kind, data=data)]
    edits = _edits_of_document(session, document, kind)
    return (
        [types.CodeAction(title, kind, edit=session.workspace_edit({document.uri: edits}))] if edits else []
    )


def _edits_of_document(session: Session, document: Document, kind: str) -> list[types.TextEdit]:
    """Return the changes that an action makes to the whole document, one for each of its programs."""
    edits = [(each, _edit_of_program(session, each, kind)) for each in document.programs]
    return [
        change
        for each, edit in edits
        if edit is not None
        for change in each.lines.to_edits([edit], document.line_end)
    ]


def _edit_of_program(session: Session, document: Document, kind: str) -> Edit | None:
    """Return the change that an action makes to the whole document, computed once for each version."""
    snapshot = document.snapshot
    _, rules = session.rules(snapshot.filename)

    def make() -> Edit | None:
        project = session.project_beside(document)
        if kind == ORGANIZE:
            found = found_in(snapshot, rules, project, stamp=session.generation)
            return organize_imports(snapshot, found)
        if kind == _QUICK_FIX:
            return migrated(snapshot, project)
        return repair_all(snapshot.text, filename=snapshot.filename, rules=rules, project=project)

    return snapshot.derived(kind, make, stamp=(session.generation, rules))


def _resolve_action(session: Session, action: types.CodeAction) -> types.CodeAction:
    data: dict[str, Any] = action.data if isinstance(action.data, dict) else {}
    uri = data.get("uri")
    if not isinstance(uri, str) or action.edit is not None:
        return action
    line = data.get("line")
    document = session.document(uri).at(line if isinstance(line, int) else 0)
    if document.version != data.get("version"):
        raise JsonRpcException("the document has changed", types.LSPErrorCodes.ContentModified)
    edits = _edits_of_document(session, document, str(data.get("kind")))
    if edits:
        action.edit = session.workspace_edit({document.uri: edits})
    return action


def _action(
    session: Session,
    document: Document,
    title: str,
    kind: str,
    edits: Sequence[Edit],
    item: Diagnostic | None = None,
) -> types.CodeAction:
    """Return an action, and the diagnostic that it answers."""
    answers = None
    if item is not None:
        answers = [to_diagnostic(item, document.lines, document.uri, elsewhere=session.location)]
    return types.CodeAction(title, kind, answers, edit=_changes(session, document, edits))


def _changes(session: Session, document: Document, edits: Sequence[Edit]) -> types.WorkspaceEdit:
    return session.workspace_edit({document.uri: document.lines.to_edits(edits, document.line_end)})


def _wanted(kind: str, only: Sequence[str]) -> bool:
    """Return whether the editor requests actions of this kind: kinds are parts with dots between, the first ones wider."""
    return not only or any((kind + ".").startswith(asked + ".") for asked in only if asked) or "" in only


# Formatting


def _format(session: Session, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
    document = session.document(params.text_document.uri)
    return [
        edit
        for each in document.programs
        for edit in each.lines.to_edits(formatting(each.snapshot), document.line_end)
    ]


def _format_range(session: Session, params: types.DocumentRangeFormattingParams) -> list[types.TextEdit]:
    return _format_parts(session, params.text_document.uri, [params.range])


def _format_ranges(session: Session, params: types.DocumentRangesFormattingParams) -> list[types.TextEdit]:
    return _format_parts(session, params.text_document.uri, params.ranges)


def _format_parts(session: Session, uri: str, ranges: Sequence[types.Range]) -> list[types.TextEdit]:
    document = session.document(uri)
    edits: list[types.TextEdit] = []
    for each in document.programs:
        lines = [_lines(each, one) for one in ranges if each.has_part_of(one)]
        changes = formatting(each.snapshot, *lines) if lines else ()
        edits += each.lines.to_edits(changes, document.line_end)
    return edits


def _lines(document: Document, place: types.Range) -> tuple[int, int]:
    """The first and the last line of a range; one that ends where a line begins does not hold that line."""
    span = document.lines.from_range(place)
    last = span.end_line - 1 if span.end_column == 0 and span.end_line > span.line else span.end_line
    return span.line, last


def _format_typed(session: Session, params: types.DocumentOnTypeFormattingParams) -> list[types.TextEdit]:
    document, line, column = place_of(session, params)
    edits = dedented(document.snapshot, line, column) if params.ch == ":" else ()
    return document.lines.to_edits(edits, document.line_end)


# Names


def _prepare_rename(
    session: Session, params: types.PrepareRenameParams
) -> types.PrepareRenamePlaceholder | None:
    document, line, column = place_of(session, params)
    try:
        place_and_name = navigation.prepare_rename(
            session.project_with(document), document.snapshot, line, column
        )
    except navigation.RenameError as error:
        raise JsonRpcException(str(error), types.LSPErrorCodes.RequestFailed) from None
    if place_and_name is None:
        return None
    return types.PrepareRenamePlaceholder(document.lines.to_range(place_and_name[0]), place_and_name[1])


def _rename(session: Session, params: types.RenameParams) -> types.WorkspaceEdit:
    document, line, column = place_of(session, params)
    name = params.new_name
    try:
        replacements = navigation.rename(
            session.project_with(document), document.snapshot, line, column, name
        )
    except navigation.RenameError as error:
        if not name.isidentifier():
            raise JsonRpcInvalidParams(str(error)) from None
        raise JsonRpcException(str(error), types.LSPErrorCodes.RequestFailed) from None
    changes: dict[str, list[types.TextEdit]] = {}
    for place, text in replacements:
        edit = types.TextEdit(session.lines_of(place.filename).to_range(place.span), text)
        changes.setdefault(session.uri_of(place.filename), []).append(edit)
    return session.workspace_edit(changes)


def _linked(session: Session, params: types.LinkedEditingRangeParams) -> types.LinkedEditingRanges | None:
    document, line, column = place_of(session, params)
    spans = navigation.linked(session.project_with(document), document.snapshot, line, column)
    if not spans:
        return None
    return types.LinkedEditingRanges([document.lines.to_range(span) for span in spans], r"[A-Za-z_]\w*")


HANDLERS: Final = {
    types.TEXT_DOCUMENT_CODE_ACTION: _actions,
    types.CODE_ACTION_RESOLVE: _resolve_action,
    types.TEXT_DOCUMENT_FORMATTING: _format,
    types.TEXT_DOCUMENT_RANGE_FORMATTING: _format_range,
    types.TEXT_DOCUMENT_RANGES_FORMATTING: _format_ranges,
    types.TEXT_DOCUMENT_ON_TYPE_FORMATTING: _format_typed,
    types.TEXT_DOCUMENT_PREPARE_RENAME: _prepare_rename,
    types.TEXT_DOCUMENT_RENAME: _rename,
    types.TEXT_DOCUMENT_LINKED_EDITING_RANGE: _linked,
}
