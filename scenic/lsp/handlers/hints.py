"""Handlers of what editors show beside the text: inlay hints, values while debugging, lenses, links, colours."""

from typing import Any, Final

from lsprotocol import types

from scenic.ide.colors import colors, presentation
from scenic.ide.inlay_hints import HintKind, hints
from scenic.ide.inline_values import inline_values
from scenic.ide.lenses import lenses
from scenic.ide.links import links
from scenic.ide.remarks import shares
from scenic.lsp.capabilities import SAMPLE, SHOW, SIMULATE
from scenic.lsp.session import Session
from scenic.lsp.uris import to_uri

__all__ = ["HANDLERS"]

_KINDS: Final = {
    HintKind.PARAMETER: types.InlayHintKind.Parameter,
    HintKind.UNIT: types.InlayHintKind.Type,
}


def _inlay_hints(session: Session, params: types.InlayHintParams) -> list[types.InlayHint]:
    session.shows_remarks = True
    later = "tooltip" in session.lists("text_document.inlay_hint.resolve_support.properties")
    return [
        types.InlayHint(
            document.lines.to_position(hint.line, hint.column),
            hint.text.strip(),
            kind=_KINDS.get(hint.kind),
            padding_left=hint.text.startswith(" "),
            padding_right=hint.text.endswith(" "),
            tooltip=None if later else hint.tooltip,
            data={"tooltip": hint.tooltip} if later else None,
        )
        for document in session.document(params.text_document.uri).programs
        for hint in hints(
            session.project_with(document),
            document.snapshot,
            document.lines.from_range(params.range),
            session.remarks.get(document.uri),
        )
    ]


def _resolve_hint(_session: Session, hint: types.InlayHint) -> types.InlayHint:
    tooltip = hint.data.get("tooltip") if isinstance(hint.data, dict) else None
    if isinstance(tooltip, str):
        hint.tooltip = tooltip
    return hint


def _inline_values(session: Session, params: types.InlineValueParams) -> list[types.InlineValue]:
    document = session.document(params.text_document.uri)
    lines = document.lines
    # The line that is about to run shows what it will read.
    stop = lines.from_position(params.context.stopped_location.end)
    return [
        types.InlineValueVariableLookup(
            lines.to_range(each.span), case_sensitive_lookup=True, variable_name=each.name
        )
        if each.expression is None
        else types.InlineValueEvaluatableExpression(lines.to_range(each.span), each.expression)
        for each in inline_values(
            session.project_with(document), document.snapshot, lines.from_range(params.range), stop
        )
    ]


def _lenses(session: Session, params: types.CodeLensParams) -> list[types.CodeLens]:
    session.shows_remarks = True
    document = session.document(params.text_document.uri)
    code_lenses = []
    for lens in lenses(document.snapshot):
        for command in (SHOW, SAMPLE, SIMULATE) if lens.simulates else (SHOW, SAMPLE):
            data = {"uri": document.uri, "scenario": lens.scenario, "command": command}
            shown_command = _command(document.uri, lens.scenario, command)
            code_lenses.append(types.CodeLens(document.lines.to_range(lens.span), shown_command, data))
    remarks = session.remarks.get(document.uri)
    # An editor shows a command without a name as words that cannot be clicked.
    code_lenses += [
        types.CodeLens(document.lines.to_range(share.span), types.Command(share.words, ""))
        for share in (() if remarks is None else shares(document.snapshot, remarks))
    ]
    return code_lenses


def _resolve_lens(_session: Session, lens: types.CodeLens) -> types.CodeLens:
    data: dict[str, Any] = lens.data if isinstance(lens.data, dict) else {}
    uri, scenario, command = data.get("uri"), data.get("scenario"), data.get("command")
    if isinstance(uri, str) and command in _TITLES:
        lens.command = _command(uri, scenario if isinstance(scenario, str) else None, command)
    return lens


_TITLES: Final = {
    SHOW: ("Show a scene", "Show a scene of {}"),
    SAMPLE: ("Sample", "Sample {}"),
    SIMULATE: ("Simulate", "Simulate {}"),
}
"""The words of the commands: for the program, and for one of its scenarios."""


def _command(uri: str, scenario: str | None, command: str) -> types.Command:
    plain, named = _TITLES[command]
    if scenario is None:
        return types.Command(plain, command, arguments=[uri, {}])
    return types.Command(named.format(scenario), command, arguments=[uri, {"scenario": scenario}])


def _links(session: Session, params: types.DocumentLinkParams) -> list[types.DocumentLink]:
    document = session.document(params.text_document.uri)
    tooltips = session.can("text_document.document_link.tooltip_support")
    return [
        types.DocumentLink(
            document.lines.to_range(link.span), to_uri(link.path), link.path if tooltips else None
        )
        for link in links(session.project_with(document), document.snapshot)
    ]


def _colors(session: Session, params: types.DocumentColorParams) -> list[types.ColorInformation]:
    return [
        types.ColorInformation(
            document.lines.to_range(each.span),
            types.Color(each.red, each.green, each.blue, each.opacity),
        )
        for document in session.document(params.text_document.uri).programs
        for each in colors(document.snapshot)
    ]


def _presentations(_session: Session, params: types.ColorPresentationParams) -> list[types.ColorPresentation]:
    color = params.color
    return [types.ColorPresentation(presentation(color.red, color.green, color.blue, color.alpha))]


HANDLERS: Final = {
    types.TEXT_DOCUMENT_DOCUMENT_COLOR: _colors,
    types.TEXT_DOCUMENT_COLOR_PRESENTATION: _presentations,
    types.TEXT_DOCUMENT_INLAY_HINT: _inlay_hints,
    types.INLAY_HINT_RESOLVE: _resolve_hint,
    types.TEXT_DOCUMENT_INLINE_VALUE: _inline_values,
    types.TEXT_DOCUMENT_CODE_LENS: _lenses,
    types.CODE_LENS_RESOLVE: _resolve_lens,
    types.TEXT_DOCUMENT_DOCUMENT_LINK: _links,
    types.DOCUMENT_LINK_RESOLVE: lambda _session, link: link,
}
