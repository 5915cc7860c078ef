"""Latency of the language server over the wire: one edit at a time, until the answer.

    python -m benchmarks.language_server [--edits N] [--memory]

Times are in milliseconds: the 95th percentile of what passes on the clock, and the processor time of the server for each. The
client reads JSON and does no more, as editors do. The server starts as an installed one does: its modules are compiled already.
"""

import argparse
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.lsp.client import FULL, Client

BLOCK = '''
class Chair{i}(Object):
    """Chair number {i}."""
    width: Range(0.4, 0.6)
    length: 0.5
    shape: BoxShape()

behavior Walk{i}(speed=1, distance=10):
    """Walk on."""
    travelled = 0
    while travelled < distance:
        take SetSpeed(speed)
        travelled = travelled + speed

x{i} = Range(1, {i} + 2)
table{i} = new Chair{i} at (x{i}, {i} * 10, 0), facing 30 deg, with behavior Walk{i}(2)
for k in range(3):
    new Chair{i} left of table{i} by 1 + k, with height 1.5
require distance from table{i} to (0, 0, 0) > 1

def f{i}(a, b=1):
    return a + b * {i} if a > b else [c for c in range(a) if c % 2]
'''
HEAD = "class SetSpeed:\n    def __init__(self, s):\n        self.s = s\n\nego = new Object\n"


EXAMPLES = sorted((Path(__file__).parents[1] / "examples").rglob("*.scenic"))


def real_program(lines: int) -> str:
    """The repository's examples one after the other, again and again."""
    texts: list[str] = []
    while sum(text.count("\n") for text in texts) < lines:
        texts.append(EXAMPLES[len(texts) % len(EXAMPLES)].read_text(encoding="utf-8"))
    return "".join(texts)


def program(lines: int) -> str:
    """Blocks of one kind."""
    count = lines // BLOCK.count("\n")
    return HEAD + "".join(BLOCK.replace("{i}", str(index)) for index in range(count))


def started(folder: Path) -> Client:
    """A server of its own, and a client that has greeted it."""
    client = Client(
        cwd=folder,
        program=("-P", "-m", "scenic.cli.main", "lsp"),
        strict=False,
        environment={"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(folder / "compiled")},
    )
    client.start(FULL)
    return client


def processor(client: Client) -> float:
    """Seconds of processor time that the server has used."""
    fields = Path(f"/proc/{client.process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory(client: Client) -> int:
    """Kilobytes that the server holds."""
    status = Path(f"/proc/{client.process.pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0])


def measured(client: Client, edits: int, what: Callable[[int], float]) -> str:
    before = processor(client)
    waits = sorted(what(index) for index in range(edits))
    used = (processor(client) - before) / edits
    return f"p95 {1000 * waits[int(0.95 * edits)]:7.1f}   processor {1000 * used:7.1f}"


def session(name: str, text: str, edits: int, folder: Path) -> None:
    uri = (folder / "program.scenic").as_uri()
    began = time.perf_counter()
    client = started(folder)
    client.open(uri, text)
    client.published(uri, version=1)
    print(name)
    print(
        f"  start to first diagnostics       {1000 * (time.perf_counter() - began):7.1f}   processor {1000 * processor(client):7.1f}"
    )
    rows = text.split("\n")
    line = next(
        number for number, row in enumerate(rows) if re.match(r"\w+ = new", row) and number > len(rows) // 2
    )
    inner = next(
        number for number, row in enumerate(rows) if re.match(r" +width:", row) and number > len(rows) // 2
    )
    position = {"line": line, "character": 12}
    place = {
        "textDocument": {"uri": uri},
        "position": position,
        "range": {"start": position, "end": position},
        "context": {"diagnostics": [], "triggerKind": 1},
        "options": {"tabSize": 4, "insertSpaces": True},
    }

    def edit(new: str, at: int = line, column: int = 0) -> int:
        return client.change(uri, ((at, column), (at, column), new))

    def diagnostics(_index: int) -> float:
        start = time.perf_counter()
        client.published(uri, version=edit("q"))
        return time.perf_counter() - start

    def within(_index: int) -> float:
        column = rows[inner].index("width")
        start = time.perf_counter()
        client.published(uri, version=edit("q", inner, column))
        return time.perf_counter() - start

    def answer(method: str, *, settled: bool) -> Callable[[int], float]:
        def wait(_index: int) -> float:
            version = edit("q")
            if settled:
                client.published(uri, version=version)
            else:
                time.sleep(0.03)  # The check has begun.
            start = time.perf_counter()
            client.request(method, place)
            waited = time.perf_counter() - start
            if not settled:
                client.published(uri, version=version)
            return waited

        return wait

    def line_end(_index: int) -> float:
        start = time.perf_counter()
        client.published(uri, version=edit("\n"))
        return time.perf_counter() - start

    def bracket(index: int) -> float:
        start = time.perf_counter()
        change = ((line, 0), (line, 1), "") if index % 2 else ((line, 0), (line, 0), "(")
        client.published(uri, version=client.change(uri, change))
        return time.perf_counter() - start

    print(f"  diagnostics after a keystroke    {measured(client, edits, diagnostics)}")
    client.published(uri, version=client.change(uri, text))
    print(f"  the same within a class          {measured(client, edits, within)}")
    client.published(uri, version=client.change(uri, text))
    print(f"  diagnostics after a new line     {measured(client, edits, line_end)}")
    client.published(uri, version=client.change(uri, text))
    print(f"  after a bracket is typed, deleted {measured(client, edits, bracket)}")
    # Elsewhere a bracket is open.
    client.published(uri, version=client.change(uri, text + "def f(a, b=1:\n    return a\n"))
    print(f"  the same in a broken text        {measured(client, edits, diagnostics)}")
    client.published(uri, version=client.change(uri, text))
    for name, method, settled in (
        ("completion", "textDocument/completion", True),
        ("hover", "textDocument/hover", True),
        ("hover while a check runs", "textDocument/hover", False),
        ("symbols", "textDocument/documentSymbol", True),
        ("semantic tokens", "textDocument/semanticTokens/full", True),
        ("code actions", "textDocument/codeAction", True),
        ("formatting", "textDocument/formatting", True),
    ):
        print(f"  {name:32} {measured(client, edits, answer(method, settled=settled))}   (with the check)")
    client.end()


def growth(edits: int, folder: Path) -> None:
    """Memory after many edits of one document."""
    client = started(folder)
    uri = (folder / "grown.scenic").as_uri()
    client.open(uri, program(500))
    early = 0
    for count in range(1, edits + 1):
        line = count % 400
        new = client.change(uri, ((line, 0), (line, 1 - count % 2), "" if count % 2 == 0 else "z"))
        if count % 50 == 0:
            client.published(uri, version=new)
            client.request(
                "textDocument/hover",
                {"textDocument": {"uri": uri}, "position": {"line": line, "character": 3}},
            )
        if count == 100:
            early = memory(client)
    late = memory(client)
    print(f"memory after 100 edits {early} kB, after {edits} {late} kB: {late / early:.2f} times")
    client.end()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=40)
    parser.add_argument(
        "--memory", action="store_true", help="measure how memory grows over 10,000 edits instead"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if options.memory:
            growth(10_000, Path(folder))
        else:
            started(Path(folder)).end()  # Its modules are compiled.
            for lines in (500, 5000):
                session(f"{lines} lines of one kind", program(lines), options.edits, Path(folder))
                session(f"{lines} lines of examples", real_program(lines), options.edits, Path(folder))


if __name__ == "__main__":
    main()
