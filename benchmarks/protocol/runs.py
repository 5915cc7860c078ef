"""Programs that are run from an editor, and where facts come from several parts of a text: lenses, hierarchies, repairs, Markdown."""

import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from benchmarks.protocol.peer import Peer, started

__all__ = ["runs"]

Row = tuple[str, Callable[[], Any], Any]

_CAPABILITIES: Final[Mapping[str, Any]] = {
    "textDocument": {
        "publishDiagnostics": {"versionSupport": True},
        "codeAction": {"codeActionLiteralSupport": {"codeActionKind": {"valueSet": ["quickfix", "source"]}}},
    },
    "workspace": {
        "codeLens": {"refreshSupport": True},
        "inlayHint": {"refreshSupport": True},
        "workspaceEdit": {"documentChanges": True},
    },
}
_TEXT: Final = """\
class Chair(Object):
    width: 0.5

behavior Walk():
    wait

behavior Tour():
    do Walk()

x = Range(-10, 10)
ego = new Object at (x, 0), with behavior Tour
chair = new Chair at (Range(-10, 10), 3)
require x > 5
require (ego.x * ego.x) % 2 > 1

class Armchair(Chair):
    legs: 4
"""
_PAGE: Final = "# Page\n\n```scenic\nego=new Objct\n```\n"
_EVERYWHERE: Final = {"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}}
_PATIENCE: Final = 60.0


def runs() -> Iterator[Row]:
    """The rows about programs that are run, and about several parts of a text."""
    with (
        tempfile.TemporaryDirectory() as folder,
        started(capabilities=dict(_CAPABILITIES), trusted=True) as peer,
    ):
        uri, page = ((Path(folder) / name).as_uri() for name in ("room.scenic", "page.md"))
        peer.open(uri, _TEXT)
        document = {"textDocument": {"uri": uri}}
        titles = ["Show a scene", "Sample", "Simulate"]
        yield "lenses show, sample and simulate", lambda: _titles(peer, document, clickable=True), titles
        yield "no shares before a run", lambda: _titles(peer, document, clickable=False), []
        command = {"command": "scenic.show", "arguments": [uri, {"seed": 1}]}
        yield (
            "a scene is shown",
            lambda: peer.request("workspace/executeCommand", command).count('"seed":"1"'),
            1,
        )
        yield (
            "shares of both requirements after it",
            lambda: [each.split()[0] for each in _later(lambda: _titles(peer, document, clickable=False))],
            ["rejects", "rejects"],
        )
        yield "the range that is left", lambda: _ranges(peer, document), ["→ 5 to 10"]
        yield from _hierarchies(peer, document)
        peer.open(page, _PAGE)
        yield (
            "a block of Markdown is checked",
            lambda: [each["code"] for each in peer.published(page)],
            ["SC203"],
        )
        paged = {"textDocument": {"uri": page}}
        options = {"options": {"tabSize": 4, "insertSpaces": True}}
        yield (
            "and formatted",
            lambda: [
                each["newText"].strip()
                for each in peer.request("textDocument/formatting", {**paged, **options})
            ],
            ["ego = new Objct"],
        )
        asked = {
            **paged,
            "range": _EVERYWHERE,
            "context": {"diagnostics": [], "only": ["source.fixAll.scenic"]},
        }
        yield (
            "and repaired as a whole",
            lambda: [each["kind"] for each in peer.request("textDocument/codeAction", asked)],
            ["source.fixAll.scenic"],
        )


def _hierarchies(peer: Peer, document: Mapping[str, Any]) -> Iterator[Row]:
    def item(kind: str, line: int, character: int) -> Any:
        place = {"line": line, "character": character}
        return peer.request(f"textDocument/prepare{kind}Hierarchy", {**document, "position": place})[0]

    def names(method: str, found: Any, key: str | None = None) -> list[str]:
        answers = peer.request(method, {"item": found})
        return sorted((each[key] if key else each)["name"] for each in answers or [])

    yield (
        "callers of a behavior",
        lambda: names("callHierarchy/incomingCalls", item("Call", 3, 10), "from"),
        ["Tour"],
    )
    yield (
        "what a behavior runs",
        lambda: names("callHierarchy/outgoingCalls", item("Call", 6, 10), "to"),
        ["Walk"],
    )
    yield "classes above", lambda: names("typeHierarchy/supertypes", item("Type", 15, 7)), ["Chair"]
    yield "classes below", lambda: names("typeHierarchy/subtypes", item("Type", 0, 7)), ["Armchair"]


def _titles(peer: Peer, document: Mapping[str, Any], *, clickable: bool) -> list[str]:
    lenses = peer.request("textDocument/codeLens", document)
    return [each["command"]["title"] for each in lenses if bool(each["command"]["command"]) == clickable]


def _ranges(peer: Peer, document: Mapping[str, Any]) -> list[str]:
    hints = peer.request("textDocument/inlayHint", {**document, "range": _EVERYWHERE})
    return [each["label"] for each in hints if "→" in each["label"]]


def _later(ask: Callable[[], list[str]]) -> list[str]:
    """The answer as soon as there is one."""
    end = time.monotonic() + _PATIENCE
    while not (found := ask()) and time.monotonic() < end:
        time.sleep(0.2)
    return found
