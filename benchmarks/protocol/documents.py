"""Texts: positions in all encodings and line ends, edits held against a model, bursts, closed documents."""

import random
import re
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

from benchmarks.protocol.peer import ENCODINGS, Failure, started

__all__ = ["LINE_ENDS", "Model", "bursts", "edits", "positions", "random_change", "width"]

Row = tuple[str, Callable[[], Any], Any]

_LINE_END: Final = re.compile(r"\r\n|\n|\r")
LINE_ENDS: Final = {"LF": "\n", "CRLF": "\r\n", "CR": "\r"}


def width(text: str, encoding: str) -> int:
    """The length of a text in the code units of an encoding."""
    return {
        "utf-8": lambda: len(text.encode("utf-8", "surrogatepass")),
        "utf-16": lambda: sum(2 if ord(each) > 0xFFFF else 1 for each in text),
        "utf-32": lambda: len(text),
    }[encoding]()


class Model:
    """A text document by the text of the protocol: lines end at LF, CRLF and CR, and nowhere else."""

    def __init__(self, text: str, encoding: str) -> None:
        self.text = text
        self.encoding = encoding

    def lines(self) -> list[tuple[int, int]]:
        """The start and the end of each line, without its line end."""
        found, start = [], 0
        for each in _LINE_END.finditer(self.text):
            found.append((start, each.start()))
            start = each.end()
        return [*found, (start, len(self.text))]

    def position(self, offset: int) -> dict[str, int]:
        """The position of an offset; between CR and LF, that of the end of the line."""
        lines = self.lines()
        number = max(index for index, (start, _) in enumerate(lines) if start <= offset)
        start, end = lines[number]
        return {"line": number, "character": width(self.text[start : min(offset, end)], self.encoding)}

    def offset(self, position: dict[str, int]) -> int:
        """The offset of a position that lies between characters or past the end of a line or of the text."""
        lines = self.lines()
        if position["line"] >= len(lines):
            return len(self.text)
        start, end = lines[position["line"]]
        seen, offset = 0, start
        while offset < end and seen < position["character"]:
            seen += width(self.text[offset], self.encoding)
            offset += 1
        return offset

    def replace(self, first: dict[str, int], last: dict[str, int], new: str) -> None:
        """Replace what lies between two positions."""
        self.text = self.text[: self.offset(first)] + new + self.text[self.offset(last) :]


_PLACES: Final = (
    "x = missing_name",
    "é = missing_name",
    "s = '𝄞𝄞'; y = missing_name",
    "s = 'a\u2028b\u2029c\x85d\x0b'; y = missing_name",
    "\fx = missing_name",
    "s = 'e\u0301'; y = missing_name",
)
"""Lines with a mistake behind characters that are counted differently."""


def positions() -> Iterator[Row]:
    """The rows about places of diagnostics, symbols and edits."""
    for encoding in ENCODINGS:
        with started(encoding=encoding) as peer:
            chosen = peer.capabilities.get("positionEncoding", "utf-16")
            yield f"{encoding}: the encoding is agreed on", lambda chosen=chosen: chosen, encoding
            for name, line_end in LINE_ENDS.items():
                for mark in ("", "\ufeff"):
                    text = mark + line_end.join((*_PLACES, ""))
                    title = f"{encoding}, {name}{', byte order mark' if mark else ''}: places of diagnostics"
                    uri = f"untitled:{encoding}-{name}-{len(mark)}"
                    yield (
                        title,
                        lambda uri=uri, text=text, peer=peer, encoding=encoding: _placed(
                            peer, uri, text, encoding
                        ),
                        [],
                    )


def _placed(peer: Any, uri: str, text: str, encoding: str) -> list[str]:
    peer.open(uri, text)
    found = [
        (each["range"]["start"], each["range"]["end"])
        for each in peer.published(uri)
        if "missing_name" in each["message"]
    ]
    model = Model(text, encoding)
    wanted = [
        (model.position(each.start()), model.position(each.end()))
        for each in re.finditer("missing_name", text)
    ]
    return [
        f"{there} in place of {here}" for here, there in zip(wanted, found, strict=False) if here != there
    ] + ([f"{len(found)} of {len(wanted)}"] if len(found) != len(wanted) else [])


_SNIPPETS: Final = (
    "x", "\n", "\r\n", "\r", " ", "    ", "(", ")", "é", "𝄞", "\u2028", "\f", "'", '"', "#", ":", "ego = new Object\n", "def f(a):\n    return a\n",
    "require x > 3\n", ", facing 3 deg", "at (1, 2)", "\ufeff", "\t", "\\\n", '"""', "new ", "behavior B():\n    wait\n",
)  # fmt: skip

_START: Final = """ego = new Object at (1, 2), facing 30 deg
s = 'é𝄞\u2028'
class Car(Object):
    width: Range(1, 2)
    length: self.width * 2
for i in range(3):
    new Car at (i, 10)
behavior Drive(speed):
    while True:
        take speed
require distance to (3, 4) > 1
"""


def edits(count: int, seed: int = 1) -> Iterator[Row]:
    """The rows about random edits: after each twenty, the server answers as for a document that is opened with the model's text."""
    cases = [(encoding, name) for encoding in ENCODINGS for name in LINE_ENDS]
    each = max(1, count // len(cases))
    for number, (encoding, name) in enumerate(cases):
        yield (
            f"{each} random edits, {encoding}, {name}",
            lambda number=number, encoding=encoding, name=name: _edited(
                each, seed + number, encoding, LINE_ENDS[name]
            ),
            [],
        )


def _edited(count: int, seed: int, encoding: str, line_end: str) -> list[str]:
    generator = random.Random(seed)
    wrong: list[str] = []
    with started(encoding=encoding) as peer:
        uri = "untitled:edited"
        model = Model(_START.replace("\n", line_end), encoding)
        peer.open(uri, model.text)
        version, done = 1, 0
        while done < count:
            changes = []
            for _ in range(min(count - done, generator.choice((1, 1, 1, 2, 5)))):
                changes.append(random_change(model, generator))
                done += 1
            version += 1
            peer.change(uri, version, *changes)
            if version % 10 == 0 or done == count:
                wrong += _compared(peer, uri, f"untitled:fresh{version}", model, version)
                if len(model.text) > 4000:
                    model.text = _START.replace("\n", line_end)
                    version += 1
                    peer.change(uri, version, {"text": model.text})
    return wrong


def random_change(model: Model, generator: random.Random) -> dict[str, Any]:
    """Make a random change of the model; returns it as the protocol has it."""
    first = generator.randrange(len(model.text) + 1)
    last = min(len(model.text), first + generator.choice((0, 0, 0, 1, 2, 8)))
    start, end = model.position(first), model.position(last)
    if generator.random() < 0.05:
        end = {"line": end["line"], "character": end["character"] + 1000}
    if generator.random() < 0.02:
        end = {"line": 10_000, "character": 0}
    new = generator.choice(_SNIPPETS) if generator.random() < 0.8 else ""
    model.replace(start, end, new)
    return {"range": {"start": start, "end": end}, "text": new}


_ASKED: Final = (
    "textDocument/semanticTokens/full", "textDocument/documentSymbol", "textDocument/foldingRange", "textDocument/formatting",
)  # fmt: skip


def _compared(peer: Any, uri: str, fresh: str, model: Model, version: int) -> list[str]:
    peer.open(fresh, model.text)
    mine, theirs = _problems(peer.published(uri, version)), _problems(peer.published(fresh))
    wrong = [] if mine == theirs else [f"version {version}: diagnostics differ"]
    for method in _ASKED:
        answers = []
        for document in (uri, fresh):
            params = {"textDocument": {"uri": document}, "options": {"tabSize": 4, "insertSpaces": True}}
            found = peer.response(peer.ask(method, params))
            answer = found.get("result", found.get("error", {}).get("code"))
            answers.append(answer["data"] if isinstance(answer, dict) else answer)
        if answers[0] != answers[1]:
            wrong.append(f"version {version}: {method} differs")
    ends = peer.request(
        "textDocument/selectionRange",
        {"textDocument": {"uri": uri}, "positions": [{"line": 10**6, "character": 0}]},
    )
    last = ends[0]["range"]["end"]
    if last != model.position(len(model.text)):
        wrong.append(f"version {version}: the text ends at {last}")
    peer.notify("textDocument/didClose", {"textDocument": {"uri": fresh}})
    return wrong


def _problems(found: list[Any]) -> list[Any]:
    return [(each["range"], each["message"], each.get("code"), each.get("severity")) for each in found]


def bursts() -> Iterator[Row]:
    """The rows about many changes at once, and about closed documents."""
    with started() as peer:

        def burst() -> bool:
            uri = "untitled:burst"
            peer.open(uri, "x = 1\n" * 200)
            peer.published(uri, 1)
            for version in range(2, 202):
                peer.change(uri, version, {"range": _line(version % 200), "text": f"# {version} "})
            peer.published(uri, 201)
            peer.silent(0.5)
            earlier = [each for each in peer.kept if each.get("params", {}).get("uri") == uri]
            if len(earlier) > 20:
                raise Failure(f"{len(earlier) + 1} publications")
            return all(each["params"]["version"] < 201 for each in earlier)

        yield "200 changes at once: the last is published, and at most 20 others", burst, True

        def closed() -> bool:
            uri = "untitled:closed"
            peer.open(uri, "x = missing_name\n")
            if not peer.published(uri, 1):
                raise Failure("nothing was wrong")
            peer.change(uri, 2, {"text": "x = missing_name\ny = missing_name\n"})
            peer.notify("textDocument/didClose", {"textDocument": {"uri": uri}})
            time.sleep(1.0)
            peer.silent(0.3)
            later = [
                each["params"]["diagnostics"]
                for each in peer.kept
                if each.get("params", {}).get("uri") == uri
            ]
            return bool(later) and later[-1] == []

        yield "a closed document ends without diagnostics", closed, True
        yield "a closed document can be opened again", lambda: _opened_again(peer), 1
        yield "a document that is opened twice has the later text", lambda: _opened_twice(peer), 2


def _line(number: int) -> dict[str, Any]:
    return {"start": {"line": number, "character": 0}, "end": {"line": number, "character": 0}}


def _opened_again(peer: Any) -> int:
    uri = "untitled:closed"
    peer.kept.clear()
    peer.open(uri, "x = missing_name\n", 7)
    return len(peer.published(uri, 7))


def _opened_twice(peer: Any) -> int:
    uri = "untitled:twice"
    peer.open(uri, "x = missing_name\n", 1)
    peer.open(uri, "x = missing_name\ny = missing_name\n", 2)
    return len(peer.published(uri, 2))
