"""Capabilities, deep nesting and large documents: whatever is offered is answered, whatever the text is."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

from benchmarks.protocol.peer import Failure, Peer, started

__all__ = ["capabilities", "depth", "size"]

Row = tuple[str, Callable[[], Any], Any]

_URI: Final = "untitled:features"
_TEXT: Final = """class Car(Object):
    width: 2

def gap(a, b=1):
    return a + b

ego = new Car at (gap(1), 0), with color (1, 0, 0)
require ego.width > 1
"""
_DOCUMENT: Final = {"uri": _URI}
_RANGE: Final = {"start": {"line": 3, "character": 4}, "end": {"line": 3, "character": 4}}
_PLACE: Final = {"textDocument": _DOCUMENT, "position": _RANGE["start"]}
_OPTIONS: Final = {"tabSize": 4, "insertSpaces": True}

_METHODS: Final[dict[str, list[tuple[str, dict[str, Any]]]]] = {
    "hoverProvider": [("textDocument/hover", _PLACE)],
    "completionProvider": [("textDocument/completion", _PLACE)],
    "signatureHelpProvider": [
        ("textDocument/signatureHelp", {**_PLACE, "position": {"line": 6, "character": 22}})
    ],
    "declarationProvider": [("textDocument/declaration", _PLACE)],
    "definitionProvider": [("textDocument/definition", _PLACE)],
    "typeDefinitionProvider": [("textDocument/typeDefinition", _PLACE)],
    "implementationProvider": [("textDocument/implementation", _PLACE)],
    "referencesProvider": [("textDocument/references", {**_PLACE, "context": {"includeDeclaration": True}})],
    "documentHighlightProvider": [("textDocument/documentHighlight", _PLACE)],
    "documentSymbolProvider": [("textDocument/documentSymbol", {"textDocument": _DOCUMENT})],
    "codeActionProvider": [
        (
            "textDocument/codeAction",
            {"textDocument": _DOCUMENT, "range": _RANGE, "context": {"diagnostics": []}},
        )
    ],
    "codeLensProvider": [("textDocument/codeLens", {"textDocument": _DOCUMENT})],
    "documentLinkProvider": [("textDocument/documentLink", {"textDocument": _DOCUMENT})],
    "colorProvider": [
        ("textDocument/documentColor", {"textDocument": _DOCUMENT}),
        (
            "textDocument/colorPresentation",
            {
                "textDocument": _DOCUMENT,
                "range": _RANGE,
                "color": {"red": 1, "green": 0, "blue": 0, "alpha": 1},
            },
        ),
    ],
    "workspaceSymbolProvider": [("workspace/symbol", {"query": "Car"})],
    "documentFormattingProvider": [
        ("textDocument/formatting", {"textDocument": _DOCUMENT, "options": _OPTIONS})
    ],
    "documentRangeFormattingProvider": [
        ("textDocument/rangeFormatting", {"textDocument": _DOCUMENT, "range": _RANGE, "options": _OPTIONS})
    ],
    "documentOnTypeFormattingProvider": [
        ("textDocument/onTypeFormatting", {**_PLACE, "ch": ":", "options": _OPTIONS})
    ],
    "renameProvider": [
        ("textDocument/prepareRename", _PLACE),
        ("textDocument/rename", {**_PLACE, "newName": "distance_between"}),
    ],
    "foldingRangeProvider": [("textDocument/foldingRange", {"textDocument": _DOCUMENT})],
    "selectionRangeProvider": [
        ("textDocument/selectionRange", {"textDocument": _DOCUMENT, "positions": [_RANGE["start"]]})
    ],
    "linkedEditingRangeProvider": [("textDocument/linkedEditingRange", _PLACE)],
    "callHierarchyProvider": [("textDocument/prepareCallHierarchy", _PLACE)],
    "typeHierarchyProvider": [
        ("textDocument/prepareTypeHierarchy", {**_PLACE, "position": {"line": 0, "character": 7}})
    ],
    "semanticTokensProvider": [
        ("textDocument/semanticTokens/full", {"textDocument": _DOCUMENT}),
        (
            "textDocument/semanticTokens/range",
            {"textDocument": _DOCUMENT, "range": {**_RANGE, "end": {"line": 9, "character": 0}}},
        ),
    ],
    "monikerProvider": [("textDocument/moniker", _PLACE)],
    "inlayHintProvider": [
        (
            "textDocument/inlayHint",
            {"textDocument": _DOCUMENT, "range": {**_RANGE, "end": {"line": 9, "character": 0}}},
        )
    ],
    "inlineValueProvider": [
        (
            "textDocument/inlineValue",
            {
                "textDocument": _DOCUMENT,
                "range": _RANGE,
                "context": {"frameId": 1, "stoppedLocation": _RANGE},
            },
        )
    ],
    "diagnosticProvider": [
        ("textDocument/diagnostic", {"textDocument": _DOCUMENT}),
        ("workspace/diagnostic", {"previousResultIds": []}),
    ],
}
"""Requests by the capability that promises them."""

_WITHOUT_REQUESTS: Final = frozenset(
    {
        "positionEncoding",
        "textDocumentSync",
        "workspace",
        "executeCommandProvider",
        "notebookDocumentSync",
        "experimental",
    }
)


def capabilities() -> Iterator[Row]:
    """The rows about what is offered."""
    with started() as peer:
        peer.open(_URI, _TEXT)
        peer.published(_URI)
        offered = {
            name for name, value in peer.capabilities.items() if value is not None and value is not False
        }
        yield (
            "every capability is one that this client knows",
            lambda: sorted(offered - _METHODS.keys() - _WITHOUT_REQUESTS),
            [],
        )
        yield "documents are synchronized by ranges, with open and close", lambda: _synchronized(peer), True
        for name in sorted(offered & _METHODS.keys()):
            for method, params in _METHODS[name]:
                yield (
                    f"{name}: {method}",
                    lambda method=method, params=params: peer.code(method, params),
                    None,
                )
        yield (
            "an unknown command is refused",
            lambda: peer.code("workspace/executeCommand", {"command": "unknown"}) in (-32602, -32600, -32803),
            True,
        )
        for method in ("textDocument/hover", "textDocument/documentSymbol", "textDocument/completion"):
            params = {
                "textDocument": {"uri": "file:///nowhere/none.scenic"},
                "position": {"line": 5, "character": 5},
            }
            yield (
                f"{method} of a file that is not there",
                lambda method=method, params=params: peer.code(method, params) in (None, -32602, -32803),
                True,
            )
    with started(capabilities={}) as peer:
        peer.open(_URI, _TEXT)
        yield "a client without capabilities gets diagnostics", lambda: len(peer.published(_URI)), 0
        yield "and UTF-16", lambda: peer.capabilities.get("positionEncoding", "utf-16"), "utf-16"
        yield (
            "and symbols as a flat list",
            lambda: "location" in peer.request("textDocument/documentSymbol", {"textDocument": _DOCUMENT})[0],
            True,
        )


def _synchronized(peer: Peer) -> bool:
    sync = peer.capabilities["textDocumentSync"]
    return sync == 2 or (bool(sync["openClose"]) and sync["change"] == 2)


_DEEP: Final = {
    "1,953 ` + 1`": "x = 1" + " + 1" * 1953 + "\n",
    "976 brackets": "x = " + "(" * 976 + "1" + ")" * 976 + "\n",
    "976 open brackets": "x = " + "[" * 976 + "\n",
    "90 nested ifs": "".join("    " * depth + "if x:\n" for depth in range(90)) + "    " * 90 + "pass\n",
    "1,386 nested ifs": "x = 1\n"
    + "".join(" " * depth + "if x:\n" for depth in range(1386))
    + " " * 1386
    + "pass\n",
    "488 elifs": "x = 1\nif x:\n    pass\n" + "elif x:\n    pass\n" * 488,
    "600 attributes": "x = 1\ny = x" + ".a" * 600 + "\n",
    "600 calls": "x = 1\ny = x" + "()" * 600 + "\n",
    "500 nots": "x = 1\ny = " + "not " * 500 + "x\n",
    "400 nested lists of new": "x = " + "[new Object, " * 400 + "1" + "]" * 400 + "\n",
}
_OF_DEEP: Final = (
    "textDocument/selectionRange", "textDocument/documentSymbol", "textDocument/foldingRange", "textDocument/semanticTokens/full",
    "textDocument/codeAction", "textDocument/formatting", "textDocument/hover", "textDocument/inlayHint",
)  # fmt: skip
_SLOWEST: Final = 10.0
"""Seconds that an answer about a deep text may take."""


def depth() -> Iterator[Row]:
    """The rows about deep nesting."""
    with started() as peer:
        for number, (name, text) in enumerate(_DEEP.items()):
            uri = f"untitled:deep{number}"

            def opened(uri: str = uri, text: str = text) -> bool:
                began = time.monotonic()
                peer.open(uri, text)
                peer.published(uri)
                return _in_time(began)

            yield f"{name}: diagnostics", opened, True
            for method in _OF_DEEP:
                yield (
                    f"{name}: {method}",
                    lambda uri=uri, text=text, method=method: _answered(peer, uri, text, method),
                    True,
                )
        yield (
            "a plain request after all of that",
            lambda: peer.code(
                "textDocument/hover",
                {"textDocument": {"uri": "untitled:deep0"}, "position": {"line": 0, "character": 0}},
            ),
            None,
        )


def _answered(peer: Peer, uri: str, text: str, method: str) -> bool:
    began = time.monotonic()
    peer.request(method, _asked(uri, text))
    return _in_time(began)


def _asked(uri: str, text: str) -> dict[str, Any]:
    """Parameters of all requests about a document."""
    middle = {"line": min(text.count("\n") // 2, 40), "character": 6}
    return {
        "textDocument": {"uri": uri},
        "position": middle,
        "positions": [middle],
        "range": {"start": {"line": 0, "character": 0}, "end": {"line": text.count("\n"), "character": 0}},
        "context": {"diagnostics": []},
        "options": _OPTIONS,
    }


def _in_time(began: float) -> bool:
    if time.monotonic() - began > _SLOWEST:
        raise Failure(f"{time.monotonic() - began:.1f} s")
    return True


def size(megabytes: float = 1.0) -> Iterator[Row]:
    """The rows about a large document."""
    examples = sorted((Path(__file__).parents[2] / "examples").rglob("*.scenic"))
    text = ""
    while len(text) < megabytes * 1_000_000:
        text += "".join(each.read_text(encoding="utf-8") for each in examples)
    text = text[: int(megabytes * 1_000_000)].rpartition("\n")[0] + "\n"
    with started() as peer:
        uri = "untitled:large"

        def timed(action: Callable[[], Any]) -> str:
            began, used = time.monotonic(), peer.processor()
            action()
            return f"{time.monotonic() - began:.2f} s, of the processor {peer.processor() - used:.2f} s"

        def opened() -> None:
            peer.open(uri, text)
            peer.published(uri, 1)

        def key_stroke() -> None:
            line = {"line": text.count("\n") // 2, "character": 0}
            peer.change(uri, 2, {"range": {"start": line, "end": line}, "text": "q"})
            peer.published(uri, 2)

        title = f"{megabytes:g} MB ({text.count(chr(10)):,} lines): first diagnostics"
        yield title, lambda: timed(opened), ...
        for method in _OF_DEEP:
            yield (
                f"{megabytes:g} MB: {method}",
                lambda method=method: timed(lambda: peer.request(method, _asked(uri, text))),
                ...,
            )
        yield f"{megabytes:g} MB: a key stroke", lambda: timed(key_stroke), ...
