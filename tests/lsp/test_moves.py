"""Files that get other names, headers that fall into place while they are typed, and names told apart."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenic.ide.dedenting import dedented
from scenic.ide.moving import imports_after_moves
from scenic.ide.snapshot import Snapshot
from scenic.project.index import Project
from tests.lsp.client import FULL, Client

FILES = {
    "cars.scenic": "class Car:\n    width: 2\n",
    "util.py": "LIMIT = 3\n",
    "parts/__init__.py": "",
    "parts/wheel.scenic": "class Wheel:\n    pass\n",
    "main.scenic": (
        "model cars\nimport util\nfrom parts.wheel import Wheel\nfrom parts import wheel as w\n"
        "import parts.wheel\nego = new Car with width util.LIMIT\nutil = util\nx = parts.wheel.Wheel\n"
    ),
    "other.scenic": "from cars import Car as C\nimport cars\nego = cars.Car\ncars_are = 'cars'\n",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def after(folder: Path, old: str, new: str) -> dict[str, str]:
    """The files that change when one gets another name, as they are then."""
    project = Project([str(folder)])
    texts: dict[str, list[str]] = {}
    moved = imports_after_moves(project, [(str(folder / old), str(folder / new))])
    for place, text in sorted(moved, key=lambda each: each[0].span, reverse=True):
        name = Path(place.filename).relative_to(folder).as_posix()
        lines = texts.setdefault(name, FILES[name].split("\n"))
        line, span = lines[place.span.line - 1], place.span
        lines[span.line - 1] = line[: span.column] + text + line[span.end_column :]
    return {name: "\n".join(lines) for name, lines in texts.items()}


def test_another_name_in_the_same_folder(folder: Path) -> None:
    changed = after(folder, "cars.scenic", "autos.scenic")
    assert changed == {
        "main.scenic": FILES["main.scenic"].replace("model cars", "model autos"),
        "other.scenic": "from autos import Car as C\nimport autos\nego = autos.Car\ncars_are = 'cars'\n",
    }


def test_a_module_within_a_package(folder: Path) -> None:
    changed = after(folder, "parts/wheel.scenic", "parts/rim.scenic")
    assert changed["main.scenic"].split("\n")[2:5] == [
        "from parts.rim import Wheel",
        "from parts import rim as w",
        "import parts.rim",
    ]
    assert "x = parts.rim.Wheel" in changed["main.scenic"]


def test_a_package(folder: Path) -> None:
    changed = after(folder, "parts", "pieces")["main.scenic"]
    assert "from pieces.wheel import Wheel" in changed
    assert "from pieces import wheel as w" in changed
    assert "x = pieces.wheel.Wheel" in changed


def test_to_another_folder(folder: Path) -> None:
    changed = after(folder, "cars.scenic", "parts/cars.scenic")
    assert changed["main.scenic"].startswith("model parts.cars\n")
    assert changed["other.scenic"].startswith("from parts.cars import Car as C\n")
    assert after(folder, "parts/wheel.scenic", "wheel.scenic")["main.scenic"].split("\n")[2] == (
        "from wheel import Wheel"
    )


@pytest.mark.parametrize("new", ["not a name.scenic", "cars.scenic", "cars.sc"])
def test_names_that_change_nothing(folder: Path, new: str) -> None:
    assert after(folder, "cars.scenic", new) == {}


@pytest.mark.parametrize(
    ("before", "expected"),
    [
        ("if a:\n    b\n    else:|", "else:"),
        ("if a:\n    b\nelse:|", None),
        ("for a in b:\n    if a:\n        c\n        else:|", "    else:"),
        ("for a in b:\n    if a:\n        c\n    d\n    else:|", "else:"),
        ("behavior B():\n    try:\n        wait\n        interrupt when x:|", "    interrupt when x:"),
        ("try:\n\ta\n\texcept E:|", "except E:"),
        ("a = 1\n    else:|", None),
        ("if a:\n    b = '''\n    else:|\n'''", None),
        ("if a:\n    b = {c\n    else:|\n}", None),
        ("if a:\n    f(x[1:|])", None),
        ("class A:\n    width:|", None),
    ],
)
def test_headers_fall_into_place(before: str, expected: str | None) -> None:
    start, _, end = before.partition("|")
    line = start.count("\n") + 1
    edits = dedented(Snapshot(start + end, "f"), line, len(start.split("\n")[-1]))
    if expected is None:
        assert edits == ()
        return
    [edit] = edits
    text = start.split("\n")[-1]
    assert edit.text + text[edit.span.end_column :] == expected


@pytest.fixture
def client(folder: Path) -> Iterator[Client]:
    client = Client(cwd=folder)
    detailed = {**FULL["textDocument"]["publishDiagnostics"], "codeDescriptionSupport": True}
    told = {
        **FULL["textDocument"],
        "publishDiagnostics": detailed,
        "rangeFormatting": {"rangesSupport": True},
    }
    offered = client.start({**FULL, "textDocument": told}, folder)
    assert offered["documentRangeFormattingProvider"] == {"rangesSupport": True}
    yield client
    client.end()


def test_over_the_wire(client: Client, folder: Path) -> None:
    uri = (folder / "main.scenic").as_uri()
    client.open(uri, FILES["main.scenic"])
    files = [
        {"oldUri": (folder / "cars.scenic").as_uri(), "newUri": (folder / "autos.scenic").as_uri()},
        {"oldUri": "untitled:a", "newUri": "untitled:b"},
    ]
    edit = client.request("workspace/willRenameFiles", {"files": files})
    assert sorted(Path(each["textDocument"]["uri"]).name for each in edit["documentChanges"]) == [
        "main.scenic",
        "other.scenic",
    ]
    (folder / "cars.scenic").rename(folder / "autos.scenic")
    client.published(uri, version=1)
    client.send("workspace/didRenameFiles", {"files": files})
    [missing] = [each for each in client.published(uri) if each["code"] == "SC406"]
    page = missing["codeDescription"]["href"]
    assert page.startswith("file:///")
    assert page.endswith("/SC406.md")


def test_monikers(client: Client, folder: Path) -> None:
    uri = (folder / "main.scenic").as_uri()
    client.open(uri, FILES["main.scenic"] + "def f(a): return a\n")

    def at(line: int, character: int) -> Any:
        place = {"textDocument": {"uri": uri}, "position": {"line": line, "character": character}}
        return client.request("textDocument/moniker", place)

    [car] = at(5, 11)
    assert car == {"scheme": "scenic", "identifier": "cars.scenic:Car", "unique": "project", "kind": "import"}
    assert at(8, 4)[0]["kind"] == "export"
    assert at(8, 6)[0]["kind"] == "local"
    assert at(0, 6)[0]["identifier"] == "cars.scenic"
    assert at(5, 7) is None


def test_several_ranges(client: Client) -> None:
    uri = "untitled:ranges"
    client.open(uri, "a=1\nb=2\nc=3\n")
    ranges = [
        {"start": {"line": line, "character": 0}, "end": {"line": line, "character": 3}} for line in (0, 2)
    ]
    params = {
        "textDocument": {"uri": uri},
        "ranges": ranges,
        "options": {"tabSize": 4, "insertSpaces": True},
    }
    edits = client.request("textDocument/rangesFormatting", params)
    assert [each["newText"] for each in edits] == ["a = 1\n", "c = 3\n"]


def test_while_typing(client: Client) -> None:
    uri = "untitled:typed"
    client.open(uri, "if a:\n    b\n    else:\n")
    params = {
        "textDocument": {"uri": uri},
        "position": {"line": 2, "character": 9},
        "ch": ":",
        "options": {"tabSize": 4, "insertSpaces": True},
    }
    [edit] = client.request("textDocument/onTypeFormatting", params)
    assert (edit["newText"], edit["range"]["end"]["character"]) == ("", 4)
    assert client.request("textDocument/onTypeFormatting", {**params, "ch": "x"}) == []
