"""What editors show beside the text: inlay hints, lenses, links, colours."""

from typing import Any, Final

from scenic.ide.colors import colors, presentation
from scenic.ide.inlay_hints import HintKind, hints
from scenic.ide.lenses import lenses
from scenic.ide.links import links
from scenic.lsp import reading
from scenic.lsp.capabilities import SAMPLE, SIMULATE
from scenic.lsp.convert import Json
from scenic.lsp.session import Session
from scenic.lsp.uris import to_uri

__all__ = ["REQUESTS"]

_PARAMETER: Final = 2
_TYPE: Final = 1


def _inlay_hints(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    span = document.lines.from_range(*reading.range_of(params, "range"))
    later = "tooltip" in session.client.lists("textDocument", "inlayHint", "resolveSupport", "properties")
    found = []
    for hint in hints(document.snapshot, span):
        text = hint.text.strip()
        item: dict[str, Json] = {
            "position": document.lines.to_position(hint.line, hint.column),
            "label": text,
            "paddingLeft": hint.text.startswith(" "),
            "paddingRight": hint.text.endswith(" "),
        }
        if hint.kind is HintKind.PARAMETER:
            item["kind"] = _PARAMETER
        elif hint.kind is HintKind.UNIT:
            item["kind"] = _TYPE
        if later:
            item["data"] = {"tooltip": hint.tooltip}
        else:
            item["tooltip"] = hint.tooltip
        found.append(item)
    return found


def _resolve_hint(_session: Session, params: Any) -> Json:
    tooltip = reading.lookup(params, "data", "tooltip")
    return {**params, "tooltip": tooltip} if isinstance(tooltip, str) else params


def _lenses(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    found = []
    for lens in lenses(document.snapshot):
        for simulates in (False, True) if lens.simulates else (False,):
            data = {"uri": document.uri, "scenario": lens.scenario, "simulates": simulates}
            command = _command(document.uri, lens.scenario, simulates=simulates)
            found.append({"range": document.lines.to_range(lens.span), "command": command, "data": data})
    return found


def _resolve_lens(_session: Session, params: Any) -> Json:
    uri = reading.lookup(params, "data", "uri")
    if not isinstance(uri, str):
        return params
    scenario = reading.lookup(params, "data", "scenario")
    simulates = reading.flag(params, "data", "simulates")
    command = _command(uri, scenario if isinstance(scenario, str) else None, simulates=simulates)
    return {**params, "command": command}


def _command(uri: str, scenario: str | None, *, simulates: bool) -> Json:
    title = "Simulate" if simulates else "Sample a scene"
    if scenario is not None:
        title += f" {scenario}" if simulates else f" of {scenario}"
    options = {} if scenario is None else {"scenario": scenario}
    return {"title": title, "command": SIMULATE if simulates else SAMPLE, "arguments": [uri, options]}


def _links(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    tooltips = session.client.can("textDocument", "documentLink", "tooltipSupport")
    found = []
    for link in links(session.project_with(document), document.snapshot):
        item = {"range": document.lines.to_range(link.span), "target": to_uri(link.path)}
        if tooltips:
            item["tooltip"] = link.path
        found.append(item)
    return found


def _resolve_link(_session: Session, params: Any) -> Json:
    return params


def _colors(session: Session, params: Any) -> Json:
    document = session.document(reading.uri_of(params))
    return [
        {
            "range": document.lines.to_range(each.span),
            "color": {"red": each.red, "green": each.green, "blue": each.blue, "alpha": each.opacity},
        }
        for each in colors(document.snapshot)
    ]


def _presentations(_session: Session, params: Any) -> Json:
    parts = [reading.number(params, "color", part) for part in ("red", "green", "blue", "alpha")]
    return [{"label": presentation(*parts)}]


REQUESTS: Final = {
    "textDocument/documentColor": _colors,
    "textDocument/colorPresentation": _presentations,
    "textDocument/inlayHint": _inlay_hints,
    "inlayHint/resolve": _resolve_hint,
    "textDocument/codeLens": _lenses,
    "codeLens/resolve": _resolve_lens,
    "textDocument/documentLink": _links,
    "documentLink/resolve": _resolve_link,
}
