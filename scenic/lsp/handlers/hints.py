"""Handlers of what editors show beside the text: inlay hints, values while debugging, lenses, links, colours."""

from typing import Any, Final

from lsprotocol import types

from scenic.ide.colors import colors, presentation
from scenic.ide.inlay_hints import HintKind, hints
from scenic.ide.inline_values import inline_values
from scenic.ide.lenses import lenses
from scenic.ide.links import links
from scenic.lsp.capabilities import SAMPLE, SIMULATE
from scenic.lsp.session import Session
from scenic.lsp.uris import to_uri

__all__ = ["HANDLERS"]

_KINDS: Final = {
    HintKind.PARAMETER: types.InlayHintKind.Parameter,
    HintKind.UNIT: types.InlayHintKind.Type,
}


def _inlay_hints(session: Session, params: types.InlayHintParams) -> list[types.InlayHint]:
    document = session.document(params.text_document.uri)
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
        for hint in hints(document.snapshot, document.lines.from_range(params.range))
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
    stopped = lines.from_position(params.context.stopped_location.end)
    return [
        types.InlineValueVariableLookup(
            lines.to_range(each.span), case_sensitive_lookup=True, variable_name=each.name
        )
        if each.expression is None
        else types.InlineValueEvaluatableExpression(lines.to_range(each.span), each.expression)
        for each in inline_values(document.snapshot, lines.from_range(params.range), stopped)
    ]


def _lenses(session: Session, params: types.CodeLensParams) -> list[types.CodeLens]:
    document = session.document(params.text_document.uri)
    found = []
    for lens in lenses(document.snapshot):
        for simulates in (False, True) if lens.simulates else (False,):
            data = {"uri": document.uri, "scenario": lens.scenario, "simulates": simulates}
            command = _command(document.uri, lens.scenario, simulates=simulates)
            found.append(types.CodeLens(document.lines.to_range(lens.span), command, data))
    return found


def _resolve_lens(_session: Session, lens: types.CodeLens) -> types.CodeLens:
    data: dict[str, Any] = lens.data if isinstance(lens.data, dict) else {}
    uri, scenario = data.get("uri"), data.get("scenario")
    if isinstance(uri, str):
        chosen = scenario if isinstance(scenario, str) else None
        lens.command = _command(uri, chosen, simulates=data.get("simulates") is True)
    return lens


def _command(uri: str, scenario: str | None, *, simulates: bool) -> types.Command:
    title = "Simulate" if simulates else "Sample a scene"
    if scenario is not None:
        title += f" {scenario}" if simulates else f" of {scenario}"
    options = {} if scenario is None else {"scenario": scenario}
    return types.Command(title, SIMULATE if simulates else SAMPLE, arguments=[uri, options])


def _links(session: Session, params: types.DocumentLinkParams) -> list[types.DocumentLink]:
    document = session.document(params.text_document.uri)
    tooltips = session.can("text_document.document_link.tooltip_support")
    return [
        types.DocumentLink(
            document.lines.to_range(link.span), to_uri(link.path), link.path if tooltips else None
        )
        for link in links(session.project_with(document), document.snapshot)
    ]


def _resolve_link(_session: Session, link: types.DocumentLink) -> types.DocumentLink:
    return link


def _colors(session: Session, params: types.DocumentColorParams) -> list[types.ColorInformation]:
    document = session.document(params.text_document.uri)
    return [
        types.ColorInformation(
            document.lines.to_range(each.span),
            types.Color(each.red, each.green, each.blue, each.opacity),
        )
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
    types.DOCUMENT_LINK_RESOLVE: _resolve_link,
}
