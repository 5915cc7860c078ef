"""Documents as they are opened, changed and closed, and what is said of them on the way."""

import random
import time
from pathlib import Path
from typing import Any

import pytest

from scenic.compiler.check import check_text
from tests.lsp.client import FULL, Client, applied, at

ENCODINGS = {"utf-8": ("utf-8", 1), "utf-16": ("utf-16-le", 2), "utf-32": ("utf-32-le", 4)}


def in_characters(text: str, position: dict[str, int], encoding: str) -> tuple[int, int]:
    codec, size = ENCODINGS[encoding]
    line = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")[position["line"]]
    return position["line"] + 1, len(line.encode(codec)[: position["character"] * size].decode(codec))


@pytest.mark.parametrize(
    ("offered", "chosen"),
    [
        (None, "utf-16"),
        (["utf-8"], "utf-8"),
        (["utf-32", "utf-8"], "utf-32"),
        (["utf-7", "utf-16"], "utf-16"),
        ([], "utf-16"),
    ],
)
def test_columns_are_counted_as_agreed(client: Client, tmp_path: Path, offered: Any, chosen: str) -> None:
    general = {} if offered is None else {"general": {"positionEncodings": offered}}
    assert client.start({**FULL, "general": {}, **general})["positionEncoding"] == chosen
    file = tmp_path / "room.scenic"
    text = "ego = new Object at (0, 0)\nname = '😀é'; require (1 > $\nx = undefined_name\n"
    client.open(file.as_uri(), text)
    found = client.published(file.as_uri(), version=1)
    expected = check_text(text, filename=str(file))
    assert len(expected) > 1
    assert [(item["code"], *in_characters(text, item["range"]["start"], chosen)) for item in found] == [
        (item.code, item.span.line, item.span.column) for item in expected if item.span is not None
    ]


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_changes_of_ranges(client: Client, tmp_path: Path, line_end: str, mark: str, encoding: str) -> None:
    """After random changes the server has the same text as the editor."""
    client.start({**FULL, "general": {"positionEncodings": [encoding]}})
    uri = (tmp_path / "room.scenic").as_uri()
    codec, size = ENCODINGS[encoding]
    chance = random.Random(0)
    text = mark + line_end.join(["ego = new Object", "ünï = '😀😀'", "", "x = 1"])
    client.open(uri, text)
    for _ in range(40):
        lines = text.split(line_end)
        first, last = sorted(chance.choices(range(len(lines)), k=2))
        start = chance.randint(0, len(lines[first]))
        end = chance.randint(start if first == last else 0, len(lines[last]))
        new = chance.choice(["", "é", "😀", "y = 2", line_end, f"z{line_end}w"])
        units = [len(lines[n][:c].encode(codec)) // size for n, c in ((first, start), (last, end))]
        client.change(uri, ((first, units[0]), (last, units[1]), new))
        before = line_end.join([*lines[:first], lines[first][:start]])
        text = before + new + line_end.join([lines[last][end:], *lines[last + 1 :]])
        if line_end != "\r\n" and "\r\n" in text:
            break
    # What the server has is seen in what it formats, and in where it sees mistakes.
    version = client.change(
        uri, ((len(text.split(line_end)) + 5, 0), (99_999, 9), f"{line_end}undefined_name")
    )
    found = client.published(uri, version=version)
    text += f"{line_end}undefined_name"
    own = check_text(text, filename=str(tmp_path / "room.scenic"))
    assert [(each["code"], each["range"]["start"]["line"]) for each in found] == [
        (each.code, each.span.line - 1) for each in own if each.span is not None
    ]


def test_a_byte_order_mark_shifts_nothing_else(client: Client) -> None:
    client.start()
    client.open("untitled:a", "\ufeffx = undefined_name\ny = undefined_name\n")
    starts = [each["range"]["start"] for each in client.published("untitled:a")]
    assert starts == [{"line": 0, "character": 5}, {"line": 1, "character": 4}]
    hover = client.request(
        "textDocument/hover", {"textDocument": {"uri": "untitled:a"}, "position": {"line": 0, "character": 1}}
    )
    assert hover is None or hover["range"]["start"]["character"] == 1


def test_several_changes_in_one_notification_follow_each_other(client: Client) -> None:
    client.start()
    client.open("untitled:a", "abc\n")
    version = client.change(
        "untitled:a", ((0, 0), (0, 1), "x"), ((0, 1), (0, 3), " = undefined_name"), ((0, 0), (0, 0), "y")
    )
    (found,) = client.published("untitled:a", version=version)
    assert found["range"]["start"] == {"line": 0, "character": 5}


def test_only_the_last_of_quick_changes_is_checked(client: Client, tmp_path: Path) -> None:
    client.start()
    uri = (tmp_path / "a.scenic").as_uri()
    client.open(uri, "x = (\n")
    assert client.published(uri, version=1)
    client.change(uri, "x = (1\n")
    client.change(uri, "x = 1\n")
    message = client.wait(lambda each: each.get("method") == "textDocument/publishDiagnostics")
    assert (message["params"]["version"], message["params"]["diagnostics"]) == (3, [])


def test_who_types_without_pause_still_sees_problems(client: Client, tmp_path: Path) -> None:
    client.start()
    uri = (tmp_path / "a.scenic").as_uri()
    client.open(uri, "x = 1\n")
    client.published(uri, version=1)
    end = time.monotonic() + 4
    while time.monotonic() < end:
        client.change(uri, f"undefined{client.versions[uri]}\n")
        time.sleep(0.005)
    last = client.versions[uri]
    client.published(uri, version=last)
    seen = [
        each["params"]["version"]
        for each in client.kept
        if each.get("method") == "textDocument/publishDiagnostics"
    ]
    # Fewer than the changes, but some of them while they came.
    assert 3 <= len(seen) < last
    assert seen == sorted(seen)


def test_closing_takes_everything_back(client: Client, tmp_path: Path) -> None:
    client.start()
    settings = tmp_path / "pyproject.toml"
    settings.write_text("[tool.scenic]\nselct = []\n")
    one, two = ((tmp_path / name).as_uri() for name in ("a.scenic", "b.scenic"))
    for uri in (one, two):
        client.open(uri, "x = (\n")
        assert client.published(uri)
    assert client.published(settings.as_uri())[0]["code"] == "SC606"
    client.send("textDocument/didClose", {"textDocument": {"uri": one}})
    assert client.published(one) == []
    client.send("textDocument/didClose", {"textDocument": {"uri": two}})
    assert client.published(two) == []
    while client.published(settings.as_uri()):
        pass  # It is said again for each document.


def test_settings_and_ignore_comments_hold(client: Client, tmp_path: Path) -> None:
    settings = tmp_path / "pyproject.toml"
    settings.write_text('[tool.scenic]\nignore = ["SC390"]\nseverity = { SC300 = "error" }\nselct = []\n')
    uri = (tmp_path / "room.scenic").as_uri()
    client.start()
    client.open(uri, "ego = new Object with wdth 3\nx = 1  # scenic: ignore\n")
    (found,) = client.published(uri)
    assert (found["code"], found["severity"]) == ("SC300", 1)
    (problem,) = client.published(settings.as_uri())
    assert (problem["code"], problem["range"]["start"]) == ("SC606", {"line": 3, "character": 0})
    settings.write_text("[tool.scenic]\n")
    client.change(uri, "ego = new Object with wdth 3  # scenic: ignore[SC300]\n")
    assert client.published(uri) == []
    assert client.published(settings.as_uri()) == []


def test_problems_are_sent_or_asked_for_but_not_both(client: Client, tmp_path: Path) -> None:
    client.start({**FULL, "textDocument": {**FULL["textDocument"], "diagnostic": {}}})
    uri = (tmp_path / "a.scenic").as_uri()
    client.open(uri, "x = undefined_name\n")
    sent = client.published(uri, version=1)
    report = client.request("textDocument/diagnostic", {"textDocument": {"uri": uri}})
    assert report["kind"] == "full"
    assert report["items"] == sent
    assert client.published(uri) == []
    again = client.request(
        "textDocument/diagnostic", {"textDocument": {"uri": uri}, "previousResultId": report["resultId"]}
    )
    assert again == {"kind": "unchanged", "resultId": report["resultId"]}
    client.change(uri, "xy = undefined_name\n")
    changed = client.request(
        "textDocument/diagnostic", {"textDocument": {"uri": uri}, "previousResultId": report["resultId"]}
    )
    assert changed["items"][0]["range"]["start"] == {"line": 0, "character": 5}


def test_a_client_that_does_not_say_that_it_asks_is_told_all_the_same(client: Client, tmp_path: Path) -> None:
    client.start()
    uri = (tmp_path / "a.scenic").as_uri()
    client.open(uri, "x = undefined_name\n")
    sent = client.published(uri, version=1)
    report = client.request("textDocument/diagnostic", {"textDocument": {"uri": uri}})
    assert report["items"] == sent
    assert client.published(uri, version=client.change(uri, "x = 1\n")) == []
    assert len(client.published(uri, version=client.change(uri, "x = undefined_name\n"))) == 1


def test_the_whole_workspace(client: Client, tmp_path: Path) -> None:
    (tmp_path / "good.scenic").write_text("ego = new Object\n")
    (tmp_path / "bad.scenic").write_text("x = (\n")
    (tmp_path / "left_out.scenic").write_text("x = (\n")
    (tmp_path / "module.py").write_text("x = 1\n")
    (tmp_path / "pyproject.toml").write_text('[tool.scenic]\nexclude = ["left_out.scenic"]\n')
    client.start(FULL, tmp_path)
    token = "progress"
    report = client.request("workspace/diagnostic", {"previousResultIds": [], "workDoneToken": token})
    found = {Path(item["uri"]).name: [each["code"] for each in item["items"]] for item in report["items"]}
    assert found == {"bad.scenic": ["SC103"], "good.scenic": []}
    steps = [each["params"]["value"]["kind"] for each in client.kept if each.get("method") == "$/progress"]
    assert (steps[0], steps[-1]) == ("begin", "end")
    previous = [{"uri": item["uri"], "value": item["resultId"]} for item in report["items"]]
    again = client.request("workspace/diagnostic", {"previousResultIds": previous})
    assert {item["kind"] for item in again["items"]} == {"unchanged"}
    parts = {"previousResultIds": [], "partialResultToken": 7}
    assert client.request("workspace/diagnostic", parts) == {"items": []}
    sent = [each["params"] for each in client.kept if each.get("method") == "$/progress"]
    assert [item for each in sent if each["token"] == 7 for item in each["value"]["items"]] == report["items"]


def test_what_one_file_says_changes_what_is_said_of_another(client: Client, tmp_path: Path) -> None:
    library = tmp_path / "library.scenic"
    library.write_text("class Chair: pass\n")
    capabilities = {**FULL, "workspace": {"didChangeWatchedFiles": {"dynamicRegistration": True}}}
    client.start(capabilities, tmp_path)
    asked = client.wait(lambda each: each.get("method") == "client/registerCapability")
    assert [each["method"] for each in asked["params"]["registrations"]] == [
        "workspace/didChangeWatchedFiles"
    ]
    uri = (tmp_path / "main.scenic").as_uri()
    client.open(uri, "from library import Chair\nego = new Chair\n")
    assert client.published(uri) == []
    library.write_text("class Table: pass\n")
    client.send("workspace/didChangeWatchedFiles", {"changes": [{"uri": library.as_uri(), "type": 2}]})
    (found,) = client.published(uri)
    assert "Chair" in found["message"]
    # What an editor holds counts more than what is on the disk.
    client.open(library.as_uri(), "class Chair: pass\n")
    assert client.published(uri) == []
    client.change(library.as_uri(), "class Table: pass\n")
    assert len(client.published(uri)) == 1
    library.write_text("class Chair: pass\n")
    client.send("workspace/didChangeWatchedFiles", {"changes": [{"uri": library.as_uri(), "type": 2}]})
    client.send("textDocument/didClose", {"textDocument": {"uri": library.as_uri()}})
    client.wait(
        lambda each: (
            each.get("method") == "textDocument/publishDiagnostics"
            and each["params"]["uri"] == uri
            and each["params"]["diagnostics"] == []
        )
    )


def test_files_beside_an_opened_one_may_be_new(client: Client, tmp_path: Path) -> None:
    client.start(FULL, tmp_path)
    first, second = ((tmp_path / name).as_uri() for name in ("first.scenic", "second.scenic"))
    text = "from library import Chair\nego = new Chair\n"
    client.open(first, text)
    assert len(client.published(first)) == 1
    (tmp_path / "library.scenic").write_text("class Chair: pass\n")
    client.open(second, text)
    assert client.published(second) == []
    assert client.published(first) == []


def test_a_client_that_watches_no_files_tells_by_saving(client: Client, tmp_path: Path) -> None:
    client.start(FULL, tmp_path)
    uri = (tmp_path / "main.scenic").as_uri()
    client.open(uri, "from library import Chair\nego = new Chair\n")
    assert len(client.published(uri)) == 1
    library = tmp_path / "library.scenic"
    library.write_text("class Chair: pass\n")
    client.send("textDocument/didSave", {"textDocument": {"uri": library.as_uri()}})
    assert client.published(uri) == []


def test_who_asks_for_problems_is_told_to_ask_again(client: Client, tmp_path: Path) -> None:
    workspace = {"diagnostics": {"refreshSupport": True}}
    client.start({"textDocument": {"diagnostic": {}}, "workspace": workspace}, tmp_path)
    main, library = ((tmp_path / name).as_uri() for name in ("main.scenic", "library.scenic"))
    (tmp_path / "library.scenic").write_text("class Chair: pass\n")
    client.open(library, "class Chair: pass\n")
    client.open(main, "from library import Chair\nego = new Chair\n")
    assert client.request("textDocument/diagnostic", {"textDocument": {"uri": main}})["items"] == []
    client.change(library, "class Table: pass\n")
    client.wait(lambda each: each.get("method") == "workspace/diagnostic/refresh")
    assert len(client.request("textDocument/diagnostic", {"textDocument": {"uri": main}})["items"]) == 1


def test_python_modules_are_not_checked(client: Client, tmp_path: Path) -> None:
    client.start()
    uri = (tmp_path / "module.py").as_uri()
    client.open(uri, "print 3\n", "python")
    assert client.published(uri) == []


def test_repairs(client: Client, tmp_path: Path) -> None:
    uri = (tmp_path / "room.scenic").as_uri()
    text = "import os\r\nego = new Object with name '😀', with wdth 3\r\nif True\r\n    pass\r\n"
    provider = client.start({**FULL, "workspace": {}})["codeActionProvider"]
    assert provider["codeActionKinds"] == [
        "quickfix",
        "source.fixAll.scenic",
        "source.organizeImports",
        "refactor.extract",
        "refactor.inline",
    ]
    client.open(uri, text)
    client.published(uri)

    def actions(marked: str, **context: object) -> list[dict[str, Any]]:
        place = at(text, marked)
        params = {
            "textDocument": {"uri": uri},
            "range": {"start": place, "end": place},
            "context": {"diagnostics": [], **context},
        }
        found: list[dict[str, Any]] = client.request("textDocument/codeAction", params)
        return found

    # Columns count two units for the smiling face.
    action, silence = actions("w|dth", triggerKind=2)
    assert (action["title"], action["kind"], action["isPreferred"]) == ("Write `width`", "quickfix", True)
    assert action["diagnostics"][0]["code"] == "SC300"
    assert applied(text, action["edit"]["changes"][uri]) == text.replace("wdth", "width")
    silenced = applied(text, silence["edit"]["changes"][uri])
    assert silenced == text.replace("wdth 3", "wdth 3  # scenic: ignore[SC300]")
    (whole,) = actions("w|dth", only=["source"])
    assert whole["kind"] == "source.fixAll.scenic"
    repaired = applied(text, whole["edit"]["changes"][uri])
    assert repaired == text.replace("import os\r\n", "").replace("wdth", "width").replace("True", "True:")
    assert [each["kind"] for each in actions("w|dth")] == ["quickfix", "quickfix", "source.fixAll.scenic"]
    assert actions("w|dth", only=["refactor", "quick"]) == []
    assert actions("eg|o", only=["quickfix"]) == []


def test_a_selection_can_be_extracted(client: Client) -> None:
    client.start(FULL)
    client.open("untitled:a", "ego = new Object at f(1) @ 2\n")
    params = {
        "textDocument": {"uri": "untitled:a"},
        "range": {"start": {"line": 0, "character": 20}, "end": {"line": 0, "character": 24}},
        "context": {"diagnostics": [], "only": ["refactor"]},
    }
    (action,) = client.request("textDocument/codeAction", params)
    assert action["kind"] == "refactor.extract"
    (change,) = action["edit"]["documentChanges"]
    assert applied("ego = new Object at f(1) @ 2\n", change["edits"]) == (
        "value = f(1)\nego = new Object at value @ 2\n"
    )


def test_all_repairs_can_be_worked_out_later(client: Client) -> None:
    action = {
        "dataSupport": True,
        "resolveSupport": {"properties": ["edit"]},
        "codeActionLiteralSupport": {"codeActionKind": {"valueSet": []}},
    }
    client.start({**FULL, "textDocument": {"codeAction": action}})
    client.open("untitled:a", "import os\nx = 1\n")
    place = {"line": 0, "character": 0}
    params = {
        "textDocument": {"uri": "untitled:a"},
        "range": {"start": place, "end": place},
        "context": {"diagnostics": [], "only": ["source.fixAll"]},
    }
    (found,) = client.request("textDocument/codeAction", params)
    assert "edit" not in found
    resolved = client.request("codeAction/resolve", found)
    (change,) = resolved["edit"]["documentChanges"]
    assert change["textDocument"] == {"uri": "untitled:a", "version": 1}
    assert applied("import os\nx = 1\n", change["edits"]) == "x = 1\n"
    client.change("untitled:a", "import os\ny = 1\n")
    assert client.refused("codeAction/resolve", found) == -32801


def test_what_is_elsewhere_is_said_to_be_there(client: Client, tmp_path: Path) -> None:
    library, uri = tmp_path / "library.scenic", (tmp_path / "main.scenic").as_uri()
    library.write_text("# one\n# two\nbehavior Walk(speed):\n    take speed\n")
    client.start(FULL, tmp_path)
    client.open(uri, "from library import Walk\nego = new Object with behavior Walk(1, 2)\n")
    (found,) = client.published(uri)
    (related,) = found["relatedInformation"]
    assert related["location"]["uri"] == library.as_uri()
    assert related["location"]["range"]["start"] == {"line": 2, "character": 9}


def actions(client: Client, uri: str, line: int, only: str) -> list[dict[str, Any]]:
    place = {"line": line, "character": 0}
    params = {
        "textDocument": {"uri": uri},
        "range": {"start": place, "end": {"line": line + 1, "character": 0}},
        "context": {"diagnostics": [], "only": [only]},
    }
    found: list[dict[str, Any]] = client.request("textDocument/codeAction", params)
    return found


def edited(text: str, action: dict[str, Any]) -> str:
    (change,) = action["edit"]["documentChanges"]
    return applied(text, change["edits"])


@pytest.mark.parametrize(
    ("text", "line", "title", "expected"),
    [
        ("x = clamp(1)\n", 0, "Import `clamp` from `tools.bounds`", "from tools.bounds import clamp\n{}"),
        ('"""Doc."""\nego = new Chair\n', 1, "Import `Chair` from `seats`",
         '"""Doc."""\nfrom seats import Chair\nego = new Chair\n'),
        ("from seats import Stool\nego = new Chair\nnew Stool\n", 1, "Import `Chair` from `seats`",
         "from seats import Stool, Chair\nego = new Chair\nnew Stool\n"),
        ("import math\nx = clamp(math.pi)", 1, "Import `clamp` from `tools.bounds`",
         "import math\nfrom tools.bounds import clamp\nx = clamp(math.pi)"),
    ],
)  # fmt: skip
def test_names_that_are_missing_are_imported(
    client: Client, tmp_path: Path, text: str, line: int, title: str, expected: str
) -> None:
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "bounds.py").write_text("def clamp(x): return x\n")
    (tmp_path / "seats.scenic").write_text(
        "from tools.bounds import clamp\nclass Chair: pass\nclass Stool: pass\n"
    )
    uri = (tmp_path / "main.scenic").as_uri()
    client.start(FULL, tmp_path)
    client.open(uri, text)
    assert client.published(uri)
    found = [each for each in actions(client, uri, line, "quickfix") if each["title"].startswith("Import")]
    assert [each["title"] for each in found] == [title]
    assert "isPreferred" not in found[0]
    result = edited(text, found[0])
    assert result == expected.format(text)
    assert client.change(uri, result) == 2
    assert client.published(uri, version=2) == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("import sys\nimport os\nx = os, sys\n", "import os\nimport sys\nx = os, sys\n"),
        ("import math, os\nx = os\n", "import os\nx = os\n"),
        ("from math import sin, tan, cos\nimport os\nx = sin, cos, os\n",
         "import os\nfrom math import cos, sin\nx = sin, cos, os\n"),
        # What makes objects is run in the order in which it stands.
        ("from seats import b, a\nfrom chairs import c\nx = a, b, c\n",
         "from seats import a, b\nfrom chairs import c\nx = a, b, c\n"),
        ("import sys\n# first\nimport os\nx = os, sys\n", None),
        ("import sys; import os\nx = os, sys\n", None),
        ("import sys\nimport os\nx = (os, sys\n", None),
    ],
)  # fmt: skip
def test_imports_are_put_in_order(client: Client, tmp_path: Path, text: str, expected: str | None) -> None:
    (tmp_path / "seats.scenic").write_text("a = b = 1\n")
    (tmp_path / "chairs.scenic").write_text("c = 1\n")
    uri = (tmp_path / "main.scenic").as_uri()
    client.start(FULL, tmp_path)
    client.open(uri, text)
    found = actions(client, uri, 0, "source.organizeImports")
    assert [edited(text, each) for each in found] == ([] if expected is None else [expected])


def test_a_program_of_scenic_2_can_be_converted(client: Client) -> None:
    client.start(FULL)
    client.open("untitled:a", "ego = Object at 1 @ 2\nObject offset by 3 @ 4\n")
    place = {"line": 1, "character": 0}
    params = {
        "textDocument": {"uri": "untitled:a"},
        "range": {"start": place, "end": place},
        "context": {"diagnostics": [], "only": ["quickfix"]},
    }
    (action,) = client.request("textDocument/codeAction", params)
    assert action["title"] == "Convert this program to Scenic 3"
    (change,) = action["edit"]["documentChanges"]
    assert applied("ego = Object at 1 @ 2\nObject offset by 3 @ 4\n", change["edits"]) == (
        "ego = new Object at 1 @ 2\nnew Object at ego offset by 3 @ 4\n"
    )


MARKDOWN = """\
# Rooms 😀

ego = 3 is no program here

```scenic
import random
ego=new Object at (1, 2)
x = new Object lef of ego
```

- and

```scenic
chair = new Object
ego=new Objct left of chair
```
"""


def test_programs_in_markdown(client: Client, tmp_path: Path) -> None:
    """Each block is a program by itself, at its place in the page."""
    client.start({**FULL, "general": {"positionEncodings": ["utf-16"]}})
    uri = (tmp_path / "page.md").as_uri()
    text = MARKDOWN.replace("\n", "\r\n")
    client.open(uri, text)
    found = {each["code"]: each["range"]["start"] for each in client.published(uri, version=1)}
    assert found["SC118"] == {"line": 7, "character": 15}
    assert found["SC203"] == {"line": 14, "character": 8}
    document = {"textDocument": {"uri": uri}}

    def asked(method: str, line: int, character: int) -> Any:
        place = {"line": line, "character": character}
        return client.request(f"textDocument/{method}", {**document, "position": place})

    # What a name means is said within its block; prose has no completions.
    (chair,) = asked("definition", 14, 24)
    assert chair["targetUri"] == uri
    assert chair["targetSelectionRange"]["start"] == {"line": 13, "character": 0}
    assert asked("hover", 13, 15) is not None
    assert asked("hover", 2, 1) is None
    assert asked("completion", 2, 3)["items"] == []
    assert "chair" in {each["label"] for each in asked("completion", 14, 22)["items"]}
    assert client.request("textDocument/documentSymbol", document) == []
    edits = client.request(
        "textDocument/formatting", {**document, "options": {"tabSize": 4, "insertSpaces": True}}
    )
    normal = [{**each, "newText": each["newText"].replace("\r\n", "\n")} for each in edits]
    # A block with a mistake of syntax stays.
    assert applied(MARKDOWN, normal) == MARKDOWN.replace("ego=new Objct", "ego = new Objct")
    everywhere = {"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}}
    (action,) = client.request(
        "textDocument/codeAction",
        {**document, "range": everywhere, "context": {"diagnostics": [], "only": ["source.fixAll.scenic"]}},
    )
    (changed,) = action["edit"]["documentChanges"]
    edits = [{**each, "newText": each["newText"].replace("\r\n", "\n")} for each in changed["edits"]]
    expected = MARKDOWN.replace("import random\n", "").replace("lef of", "left of").replace("Objct", "Object")
    assert applied(MARKDOWN, edits) == expected
    client.change(uri, expected)
    assert client.published(uri, version=2) == []
    assert client.leave() == 0
