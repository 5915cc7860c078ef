"""Every feature of the server, asked for over the wire, in a project of two files."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from scenic.ide.snapshot import Snapshot
from scenic.ide.symbols import symbols
from scenic.lsp.handlers import METHODS, handler
from tests.lsp.client import FULL, Client, Refused, applied, at

LIBRARY = '''\
"""Things to sit on."""
import math


class Chair(Object):
    """Something to sit on."""
    width: 0.5
    legs: 4

    def weight(self, factor=2):
        """In kilograms."""
        return self.legs * factor


behavior Walk(speed=1, distance=10):
    """Walk on."""
    take speed


def helper(first, second=1):
    return math.sqrt(first)
'''
MAIN = """\
from library import *
import library as lib

# region seats
class Armchair(Chair):
    color: (1, 0.5, 0)
    legs: 3
# endregion

place = Range(1, 2)
chair = new Armchair at (place, 0, 0),
    facing 1.5,
    with legs 3
ego = new Object left of chair, with behavior Walk(2, distance=5)
require distance to chair < 5
total = helper(place, second=2) + chair.weight() + lib.helper(3)

scenario Main(count=1):
    setup:
        new Chair on chair, with color (0, 0, 1)

def outer(parameter):
    inner = parameter + 1  # 😀 after
    return helper(inner)
"""


class Project:
    """A server with the two files open."""

    def __init__(self, folder: Path) -> None:
        self.client = Client()
        (folder / "library.scenic").write_text(LIBRARY)
        (folder / "main.scenic").write_text(MAIN)
        (folder / "mesh.obj").write_text("")
        self.library, self.main = ((folder / f"{name}.scenic").as_uri() for name in ("library", "main"))
        self.offered = self.client.start(FULL, folder)
        self.client.open(self.main, MAIN)
        self.client.published(self.main)

    def place(self, marked: str) -> dict[str, Any]:
        return {"textDocument": {"uri": self.main}, "position": at(MAIN, marked)}

    def ask(self, method: str, marked: str = "", **others: object) -> Any:
        params = self.place(marked) if marked else {"textDocument": {"uri": self.main}}
        return self.client.request(f"textDocument/{method}", {**params, **others})

    def text(self, uri: str, found: dict[str, Any]) -> str:
        """What stands at a range."""
        lines = (LIBRARY if uri == self.library else MAIN).split("\n")
        start, end = found["start"], found["end"]
        assert start["line"] == end["line"]
        line = lines[start["line"]].encode("utf-16-le")
        return line[2 * start["character"] : 2 * end["character"]].decode("utf-16-le")

    def texts(self, found: list[dict[str, Any]]) -> list[tuple[str, str, int]]:
        """By location: the file, what stands there, and the line from 1."""
        return [
            (
                Path(each["uri"]).stem,
                self.text(each["uri"], each["range"]),
                each["range"]["start"]["line"] + 1,
            )
            for each in found
        ]


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Project]:
    project = Project(tmp_path_factory.mktemp("project"))
    yield project
    project.client.end()


def test_every_method_has_a_handler() -> None:
    assert all(callable(handler(method)) for method in METHODS)


def test_what_is_offered(project: Project) -> None:
    providers = {name for name, value in project.offered.items() if name.endswith("Provider") and value}
    assert len(providers) == 30
    assert project.offered["textDocumentSync"] == {
        "openClose": True,
        "change": 2,
        "save": {"includeText": False},
    }
    assert project.offered["executeCommandProvider"]["commands"] == [
        "scenic.show",
        "scenic.sample",
        "scenic.simulate",
    ]


# Information


@pytest.mark.parametrize(
    ("marked", "said"),
    [
        ("class Arm|chair(Chair)", "class Armchair(Chair)"),
        ("class Armchair(Cha|ir)", "Something to sit on."),
        ("chair = n|ew Armchair", "Creates an instance"),
        ("    fac|ing 1.5", "Turns the object"),
        ("left o|f chair", "Places the object"),
        ("with l|egs 3", "legs: 3"),
        ("behavior Wa|lk(2", "behavior Walk(speed=1, distance=10)"),
        ("Ran|ge(1, 2)", "uniform on an interval"),
        ("req|uire distance", "Keeps only scenes"),
        ("dist|ance to chair", "distance"),
        ("chair.wei|ght()", "In kilograms."),
        ("import library as li|b", "module library"),
        ("def outer(para|meter)", "parameter"),
        ("e|go = new Object", "point of view"),
        ("e|go = new Object", "new Object left of chair"),
    ],
)
def test_hover(project: Project, marked: str, said: str) -> None:
    found = project.ask("hover", marked)
    assert found["contents"]["kind"] == "markdown"
    assert said in found["contents"]["value"]
    word = project.text(project.main, found["range"])
    assert word in marked.replace("|", "")


def test_what_is_being_defined_is_not_called(project: Project) -> None:
    assert project.ask("signatureHelp", "def outer(para|meter)") is None


@pytest.mark.parametrize("marked", ["# reg|ion seats", "Range(|1, 2)", "😀 aft|er"])
def test_nothing_to_explain(project: Project, marked: str) -> None:
    assert project.ask("hover", marked) is None


def test_signatures(project: Project) -> None:
    found = project.ask("signatureHelp", "helper(place, sec|ond=2)")
    (signature,) = found["signatures"]
    assert signature["label"] == "helper(first, second=1)"
    shown = [signature["label"][slice(*each["label"])] for each in signature["parameters"]]
    assert shown == ["first", "second=1"]
    assert found["activeParameter"] == signature["activeParameter"] == 1
    assert project.ask("signatureHelp", "helper(pl|ace, second=2)")["activeParameter"] == 0
    walk = project.ask("signatureHelp", "Walk(2, distance=|5)")
    assert (walk["signatures"][0]["label"], walk["activeParameter"]) == ("Walk(speed=1, distance=10)", 1)
    assert project.ask("signatureHelp", "Range(1, |2)")["signatures"][0]["label"] == "Range(low, high)"
    assert project.ask("signatureHelp", "(|place, 0, 0)") is None


@pytest.mark.parametrize(
    ("text", "first", "absent"),
    [
        ("x = new ", {"Armchair", "Chair", "Object", "OrientedPoint", "Point"}, {"Range", "helper"}),
        ("x = new Armchair with ", {"color", "legs", "width", "behavior", "shape"}, {"Range", "heading"}),
        ("x = new Armchair at 1, ", {"facing", "facing toward", "with", "on", "left of"}, {"require"}),
        ("chair.", {"legs", "weight", "color", "position", "distanceTo"}, {"Range"}),
        ("x = chair.position.", {"x", "y", "z", "rotatedBy"}, {"legs"}),
        ("lib.", {"Chair", "Walk", "helper"}, {"Armchair"}),
        ("from library import ", {"Chair", "Walk", "helper"}, {"Armchair"}),
        ("import ", {"library", "math"}, {"Range"}),
        ("model ", {"library"}, {"Range"}),
        ("behavior B():\n    do ", {"B", "Walk", "choose", "shuffle"}, {"require"}),
        ("require ", {"always", "eventually", "distance to", "chair"}, {"at position"}),
        ("x = new Object facing ", {"toward", "away from", "chair"}, {"with"}),
        ("x = helper(", {"first=", "second=", "chair"}, set()),
        ("behavior B(far):\n    near = 1\n    take ", {"self", "far", "near", "chair"}, {"with"}),
        ("class Stool(Chair):\n    high: 1\n    width: self.", {"high", "legs", "height"}, {"require"}),
        ("param pace = 3\nx = globalParameters.", {"pace"}, {"legs"}),
        ("behavior B():\n    x = self.", {"position", "speed"}, {"legs"}),
        ("class Stool(Chair):\n    width: ", {"self", "chair"}, {"width"}),
        ("", {"require", "behavior", "param", "chair", "if", "class"}, {"take", "do"}),
        ("behavior B():\n    ", {"take", "do", "wait", "try"}, {"param", "model"}),
        ("behavior B():\n    do ", {"Walk", "choose"}, {"Chair", "Range", "distance to", "len"}),
        ("class Stool(Chair):\n    ", {"width", "legs", "def"}, {"require"}),
        ("class Stool(Chair):\n    legs: 3\n    wi", {"width"}, {"legs"}),
        ("class Stool(Chair):\n    def f(self):\n        ", {"chair"}, {"legs"}),
        ("x = 'abc ", set(), {"chair"}),
        ("# ", set(), {"chair"}),
        ('x = f"cha', set(), {"chair"}),
        ('x = f"{cha', {"chair"}, set()),
        ("x = 3.", set(), {"deg", "chair"}),
        ("behavior ", set(), {"deg", "chair"}),
        ("import math as m", set(), {"chair", "math"}),
    ],
)
def test_completion(project: Project, text: str, first: set[str], absent: set[str]) -> None:
    client, uri = project.client, "untitled:completion"
    whole = f"{MAIN}\n{text}"
    document = (Path(project.main.removeprefix("file://")).parent / "draft.scenic").as_uri()
    client.open(document, whole)
    lines = whole.split("\n")
    position = {"line": len(lines) - 1, "character": len(lines[-1])}
    found = client.request(
        "textDocument/completion", {"textDocument": {"uri": document}, "position": position}
    )
    labels = {item["label"] for item in found["items"]}
    assert first <= labels, first - labels
    assert not absent & labels
    for item in found["items"]:
        edit = item["textEdit"]["range"]
        assert edit["end"] == position
        assert edit["start"]["line"] == position["line"]
    documented = [item for item in found["items"] if item["label"] in first and "data" in item]
    for item in documented:
        resolved = client.request("completionItem/resolve", item)
        assert resolved["documentation"]["value"], item
    client.send("textDocument/didClose", {"textDocument": {"uri": document}})
    assert uri not in client.versions


def test_completion_says_the_place_once_to_clients_that_know_of_that() -> None:
    client = Client()
    completion = {
        "completionItem": {"snippetSupport": True},
        "completionList": {"itemDefaults": ["editRange"]},
    }
    try:
        client.start({"textDocument": {"completion": completion}})
        client.open("untitled:defaults", "ego = new Object\nreq")
        place = {"textDocument": {"uri": "untitled:defaults"}, "position": {"line": 1, "character": 3}}
        found = client.request("textDocument/completion", place)
        start = {"line": 1, "character": 0}
        assert found["itemDefaults"] == {"editRange": {"start": start, "end": place["position"]}}
        texts = {item["label"]: item.get("textEditText", item["label"]) for item in found["items"]}
        assert texts["require"].startswith("require ${")
        assert texts["repr"] == "repr"
        assert not any("textEdit" in item for item in found["items"])
    finally:
        client.end()


# Navigation


@pytest.mark.parametrize(
    ("method", "marked", "expected"),
    [
        ("definition", "class Armchair(Cha|ir)", [("library", "Chair", 5)]),
        ("definition", "behavior Wa|lk(2", [("library", "Walk", 15)]),
        ("definition", "with l|egs 3", [("main", "legs", 7)]),
        ("definition", "chair.wei|ght()", [("library", "weight", 10)]),
        ("definition", "to ch|air < 5", [("main", "chair", 11)]),
        ("definition", "from lib|rary import", [("library", "", 1)]),
        ("definition", "lib.hel|per(3)", [("library", "helper", 20)]),
        ("definition", "distance|=5)", [("library", "distance", 15)]),
        ("declaration", "li|b.helper(3)", [("main", "lib", 2)]),
        ("typeDefinition", "to ch|air < 5", [("main", "Armchair", 5)]),
        ("implementation", "class Armchair(Cha|ir)", [("main", "Armchair", 5)]),
    ],
)
def test_where_names_lead(
    project: Project, method: str, marked: str, expected: list[tuple[str, str, int]] | None
) -> None:
    found = project.ask(method, marked)
    if found is None:
        assert expected is None
        return
    places = [
        {"uri": each["targetUri"], "range": each["targetSelectionRange"]} if "targetUri" in each else each
        for each in found
    ]
    assert project.texts(places) == expected


def test_references(project: Project) -> None:
    found = project.ask("references", "class Armchair(Cha|ir)", context={"includeDeclaration": True})
    assert sorted(project.texts(found)) == [
        ("library", "Chair", 5),
        ("main", "Chair", 5),
        ("main", "Chair", 20),
    ]
    without = project.ask("references", "class Armchair(Cha|ir)", context={"includeDeclaration": False})
    assert sorted(project.texts(without)) == [("main", "Chair", 5), ("main", "Chair", 20)]


def test_highlights(project: Project) -> None:
    found = project.ask("documentHighlight", "to ch|air < 5")
    assert [(each["range"]["start"]["line"] + 1, each["kind"]) for each in found] == [
        (11, 3),
        (14, 2),
        (15, 2),
        (16, 2),
        (20, 2),
    ]


def test_rename_across_files(project: Project) -> None:
    prepared = project.ask("prepareRename", "total = hel|per(")
    assert prepared["placeholder"] == "helper"
    edit = project.ask("rename", "total = hel|per(", newName="assist")
    changes = {each["textDocument"]["uri"]: each for each in edit["documentChanges"]}
    assert changes[project.main]["textDocument"]["version"] == 1
    assert changes[project.library]["textDocument"]["version"] is None
    assert applied(LIBRARY, changes[project.library]["edits"]) == LIBRARY.replace("helper", "assist")
    assert applied(MAIN, changes[project.main]["edits"]) == MAIN.replace("helper", "assist")


@pytest.mark.parametrize(
    ("marked", "name", "reason"),
    [
        ("e|go = new", "me", "belongs to the language"),
        ("Ran|ge(1, 2)", "Area", "belongs to the language"),
        ("to ch|air < 5", "1chair", "not a name"),
        ("to ch|air < 5", "new", "keyword"),
        ("to ch|air < 5", "total", "already"),
        ("    in|ner = parameter", "helper", "already"),
        ("def out|er(", "chair", "already"),
    ],
)
def test_impossible_names(project: Project, marked: str, name: str, reason: str) -> None:
    with pytest.raises(Refused, match=reason):
        project.ask("rename", marked, newName=name)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("import library as l|ib\nx = lib.helper(lib.lib)\n", "import library as own\nx = own.helper(own.lib)\n"),
        ("import library as lib\nx = li|b.helper(1)\n", "import library as own\nx = own.helper(1)\n"),
        ("from math import sin as si|ne\nx = sine(2)\n", "from math import sin as own\nx = own(2)\n"),
        ("from library import Chair as Se|at\ndef f(Seat): return Seat\nego = new Seat\n",
         "from library import Chair as own\ndef f(Seat): return Seat\nego = new own\n"),
    ],
)  # fmt: skip
def test_names_that_imports_give(project: Project, before: str, after: str) -> None:
    uri = (Path(project.main.removeprefix("file://")).parent / "aliases.scenic").as_uri()
    head, tail = before.split("|")
    project.client.open(uri, head + tail)
    position = {"line": head.count("\n"), "character": len(head) - head.rfind("\n") - 1}
    params = {"textDocument": {"uri": uri}, "position": position, "newName": "own"}
    found = project.client.request("textDocument/rename", params)
    (change,) = found["documentChanges"]
    assert applied(head + tail, change["edits"]) == after
    with pytest.raises(Refused):
        project.client.request(
            "textDocument/rename", {**params, "newName": "x" if "x =" in tail else "Seat()"}
        )
    project.client.send("textDocument/didClose", {"textDocument": {"uri": uri}})


def test_linked_names(project: Project) -> None:
    found = project.ask("linkedEditingRange", "    in|ner = parameter")
    assert [project.text(project.main, each) for each in found["ranges"]] == ["inner", "inner"]
    assert project.ask("linkedEditingRange", "ch|air = new") is None


def test_calls(project: Project) -> None:
    (item,) = project.ask("prepareCallHierarchy", "total = hel|per(")
    assert (item["name"], item["uri"]) == ("helper", project.library)
    incoming = project.client.request("callHierarchy/incomingCalls", {"item": item})
    assert {each["from"]["name"]: len(each["fromRanges"]) for each in incoming} == {
        "main.scenic": 2,
        "outer": 1,
    }
    # And back: what a module calls outside of definitions, and not what is called within them.
    whole = next(each["from"] for each in incoming if each["from"]["name"] == "main.scenic")
    outgoing = project.client.request("callHierarchy/outgoingCalls", {"item": whole})
    assert {each["to"]["name"]: len(each["fromRanges"]) for each in outgoing} == {
        "Armchair": 1,
        "Walk": 1,
        "helper": 2,
        "weight": 1,
    }
    assert project.client.request("callHierarchy/incomingCalls", {"item": whole}) is None
    (outer,) = project.ask("prepareCallHierarchy", "def ou|ter(")
    (outgoing,) = project.client.request("callHierarchy/outgoingCalls", {"item": outer})
    assert outgoing["to"]["name"] == "helper"
    assert project.text(project.main, outgoing["fromRanges"][0]) == "helper"
    assert project.ask("prepareCallHierarchy", "to ch|air < 5") is None
    # Making an instance is a call of the class.
    (item,) = project.ask("prepareCallHierarchy", "class Armchair(Cha|ir)")
    (incoming,) = project.client.request("callHierarchy/incomingCalls", {"item": item})
    assert incoming["from"]["name"] == "Main"


def test_types(project: Project) -> None:
    (item,) = project.ask("prepareTypeHierarchy", "class Armchair(Cha|ir)")
    (below,) = project.client.request("typeHierarchy/subtypes", {"item": item})
    assert below["name"] == "Armchair"
    (above,) = project.client.request("typeHierarchy/supertypes", {"item": below})
    assert (above["name"], above["uri"]) == ("Chair", project.library)


def test_values_while_debugging(project: Project) -> None:
    text = "k = 3\nbehavior B(p):\n    n = p + k\n    take n\ndef f(q):\n    return q\nego = new Object\n"
    project.client.open("untitled:debugged", text)
    stopped = {"start": {"line": 3, "character": 4}, "end": {"line": 3, "character": 10}}
    everything = {"start": {"line": 0, "character": 0}, "end": {"line": 9, "character": 0}}
    params = {
        "textDocument": {"uri": "untitled:debugged"},
        "range": everything,
        "context": {"frameId": 1, "stoppedLocation": stopped},
    }
    found = project.client.request("textDocument/inlineValue", params)
    assert [
        (each["range"]["start"]["line"], each.get("variableName") or each["expression"]) for each in found
    ] == [
        (0, "k"),
        (2, "__instance__.n"),
        (2, "__instance__.p"),
        (2, "k"),
        (3, "__instance__.n"),
    ]


def test_names_in_other_characters(project: Project) -> None:
    # Python takes them for the same: `x𝐱` is `xx`.
    project.client.open("untitled:characters", "x𝐱 = 1\ny = x𝐱 + xx\n")
    document = {"textDocument": {"uri": "untitled:characters"}, "position": {"line": 0, "character": 0}}
    edit = project.client.request("textDocument/rename", {**document, "newName": "z"})
    (changed,) = edit["documentChanges"]
    assert len(changed["edits"]) == 3


def test_highlights_are_the_references_in_the_document(project: Project) -> None:
    # A property means the same where a class gives another default, and where an object sets it.
    found = project.ask("documentHighlight", "    le|gs: 3")
    references = project.ask("references", "    le|gs: 3", context={"includeDeclaration": True})
    own = [each["range"] for each in references if each["uri"] == project.main]
    assert [each["range"] for each in found] == own
    assert len(own) == 2


def test_symbols_of_the_workspace(project: Project) -> None:
    found = project.client.request("workspace/symbol", {"query": "chr"})
    names = {(each["name"], Path(each["location"]["uri"]).stem) for each in found}
    assert names == {("Chair", "library"), ("Armchair", "main"), ("chair", "main")}
    assert project.client.request("workspaceSymbol/resolve", found[0])["location"]["range"]
    assert len(project.client.request("workspace/symbol", {"query": ""})) > 10


def test_symbols_of_python_modules(tmp_path: Path) -> None:
    (tmp_path / "tools.py").write_text("# new\nnew = 3\n\n@cache\nclass Hammer:\n    def hit(self): pass\n")
    (tmp_path / "broken.py").write_text("def (:")
    client = Client()
    try:
        client.start(FULL, tmp_path)
        found = client.request("workspace/symbol", {"query": ""})
        places = {each["name"]: (each["location"]["range"], each.get("containerName")) for each in found}
        assert {
            name: (place["start"]["line"], place["start"]["character"]) for name, (place, _) in places.items()
        } == {
            "new": (1, 0),
            "Hammer": (4, 6),
            "hit": (5, 8),
        }
        assert places["hit"][1] == "Hammer"
    finally:
        client.end()


# Structure


def test_symbols_of_the_document(project: Project) -> None:
    def names(found: list[dict[str, Any]]) -> list[Any]:
        return [
            (each["name"], names(each["children"])) if each["children"] else each["name"] for each in found
        ]

    found = project.ask("documentSymbol")
    assert names(found) == [
        ("Armchair", ["color", "legs"]),
        "place",
        "chair",
        "ego",
        "total",
        "Main",
        "outer",
    ]
    for each in found:
        assert project.text(project.main, each["selectionRange"]) == each["name"]


def test_symbols_after_a_string_that_is_left_open() -> None:
    text = '"""What is this?\nbehavior Go(goal, x=[3]):\n    wait\nscenario S(y):\n    setup:\n        pass\n'
    found = [(each.name, each.detail) for each in symbols(Snapshot(text, "x"))]
    assert found == [("Go", "(goal, x=[3])"), ("S", "(y)")]


def test_folding(project: Project) -> None:
    found = [
        (each["startLine"] + 1, each["endLine"] + 1, each.get("kind")) for each in project.ask("foldingRange")
    ]
    assert found == [
        (1, 2, "imports"),
        (4, 8, "region"),
        (5, 7, None),
        (11, 13, None),
        (18, 20, None),
        (19, 20, None),
        (22, 24, None),
    ]


def test_selections_grow(project: Project) -> None:
    (found,) = project.ask("selectionRange", positions=[at(MAIN, "(pl|ace, 0, 0)")])
    sizes = []
    while found:
        sizes.append((found["range"]["start"], found["range"]["end"]))
        found = found.get("parent")
    assert len(sizes) >= 5
    for (start, end), (outer_start, outer_end) in pairwise(sizes):
        assert tuple(outer_start.values()) <= tuple(start.values())
        assert tuple(end.values()) <= tuple(outer_end.values())


def decoded(project: Project, data: list[int]) -> list[tuple[str, str]]:
    """The words of the document with their kinds."""
    legend = project.offered["semanticTokensProvider"]["legend"]["tokenTypes"]
    lines = MAIN.split("\n")
    line = start = 0
    found = []
    for index in range(0, len(data), 5):
        down, along, length, kind, _ = data[index : index + 5]
        line, start = line + down, along if down else start + along
        word = lines[line].encode("utf-16-le")[2 * start : 2 * (start + length)].decode("utf-16-le")
        found.append((word, legend[kind]))
    return found


def test_semantic_tokens(project: Project) -> None:
    full = project.ask("semanticTokens/full")
    words = decoded(project, full["data"])
    for expected in [
        ("library", "namespace"),
        ("Armchair", "class"),
        ("color", "property"),
        ("Range", "class"),
        ("new", "keyword"),
        ("facing", "keyword"),
        ("Walk", "event"),
        ("helper", "function"),
        ("weight", "method"),
        ("parameter", "parameter"),
        ("Main", "macro"),
        ("0.5", "number"),
        ("# 😀 after", "comment"),
        ("<", "operator"),
    ]:
        assert expected in words, expected
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}}
    assert project.ask("semanticTokens/range", range=whole)["data"] == full["data"]
    part = {"start": {"line": 9, "character": 0}, "end": {"line": 10, "character": 0}}
    assert decoded(project, project.ask("semanticTokens/range", range=part)["data"])[0][0] == "place"


def test_changes_of_semantic_tokens(project: Project) -> None:
    client, uri = project.client, "untitled:tokens"
    client.open(uri, MAIN)
    known = client.request("textDocument/semanticTokens/full", {"textDocument": {"uri": uri}})
    for text in (
        MAIN,
        MAIN.replace("chair", "seat"),
        "x = 1\n" + MAIN,
        MAIN.replace("import", "from"),
        "",
        MAIN,
    ):
        client.change(uri, text)
        params = {"textDocument": {"uri": uri}, "previousResultId": known["resultId"]}
        found = client.request("textDocument/semanticTokens/full/delta", params)
        data = list(known["data"])
        for edit in found["edits"]:
            data[edit["start"] : edit["start"] + edit["deleteCount"]] = edit.get("data", [])
        fresh = client.request("textDocument/semanticTokens/full", {"textDocument": {"uri": uri}})
        assert data == fresh["data"]
        known = fresh
    params = {"textDocument": {"uri": uri}, "previousResultId": "unknown"}
    assert client.request("textDocument/semanticTokens/full/delta", params)["data"] == known["data"]


# Hints


def test_inlay_hints(project: Project) -> None:
    whole = {"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}}
    found = {(each["position"]["line"] + 1, each["label"]) for each in project.ask("inlayHint", range=whole)}
    assert found >= {
        (10, "low:"),
        (10, "high:"),
        (12, "rad"),
        (14, "(distance: no gap)"),
        (15, "(start: the ego)"),
    }
    part = {"start": {"line": 9, "character": 0}, "end": {"line": 9, "character": 99}}
    hints = project.ask("inlayHint", range=part)
    assert [each["label"] for each in hints] == ["low:", "high:"]
    assert project.client.request("inlayHint/resolve", hints[0])["tooltip"] == "Range(low, high)"


def test_links(project: Project) -> None:
    found = project.ask("documentLink")
    assert [(project.text(project.main, each["range"]), each["target"]) for each in found] == [
        ("library", project.library),
        ("library", project.library),
    ]
    uri = project.main.replace("main", "other")
    project.client.open(
        uri, "ego = new Object with shape MeshShape.fromFile('mesh.obj')\nx = localPath('none.obj')\n"
    )
    (link,) = project.client.request("textDocument/documentLink", {"textDocument": {"uri": uri}})
    assert link["target"].endswith("/mesh.obj")
    project.client.send("textDocument/didClose", {"textDocument": {"uri": uri}})


def test_colors(project: Project) -> None:
    found = project.ask("documentColor")
    assert [project.text(project.main, each["range"]) for each in found] == ["(1, 0.5, 0)", "(0, 0, 1)"]
    assert found[0]["color"] == {"red": 1, "green": 0.5, "blue": 0, "alpha": 1}
    (shown,) = project.ask("colorPresentation", color=found[0]["color"], range=found[0]["range"])
    assert shown["label"] == "(1, 0.5, 0)"


def test_lenses(project: Project) -> None:
    lenses = project.ask("codeLens")
    for lens, title, command in zip(
        lenses,
        ("Show a scene of Main", "Sample Main", "Simulate Main"),
        ("scenic.show", "scenic.sample", "scenic.simulate"),
        strict=True,
    ):
        arguments = [project.main, {"scenario": "Main"}]
        assert lens["command"] == {"title": title, "command": command, "arguments": arguments}
        assert project.client.request("codeLens/resolve", lens)["command"] == lens["command"]


# Formatting


def test_formatting(project: Project) -> None:
    client, uri = project.client, "untitled:formatting"
    text = "import  os\r\nx=( 1 )   # note\r\nclass A :\r\n  width :  2\r\n"
    client.open(uri, text)
    options = {"options": {"tabSize": 4, "insertSpaces": True}, "textDocument": {"uri": uri}}
    edits = client.request("textDocument/formatting", options)
    lines = text.replace("\r\n", "\n")
    plain = [{**each, "newText": each["newText"].replace("\r\n", "\n")} for each in edits]
    assert applied(lines, plain) == "import os\nx = 1  # note\n\n\nclass A:\n    width: 2\n"
    part = {"range": {"start": {"line": 0, "character": 0}, "end": {"line": 0, "character": 3}}}
    (edit,) = client.request("textDocument/rangeFormatting", {**options, **part})
    assert edit["newText"] == "import os\r\n"
    client.change(uri, "x = (\n")
    assert client.request("textDocument/formatting", options) == []


# Running


def test_a_run_leaves_shares_and_ranges(tmp_path: Path) -> None:
    uri = (tmp_path / "room.scenic").as_uri()
    text = "x = Range(-10, 10)\nego = new Object at (x, 0)\nrequire x > 5\nrequire (ego.x * ego.x) % 2 > 1\n"
    refreshing = {"codeLens": {"refreshSupport": True}, "inlayHint": {"refreshSupport": True}}
    client = Client()
    try:
        client.start({**FULL, "workspace": refreshing}, initializationOptions={"trusted": True})
        client.open(uri, text)
        document: dict[str, Any] = {"textDocument": {"uri": uri}}
        everywhere = {
            **document,
            "range": {"start": {"line": 0, "character": 0}, "end": {"line": 9, "character": 0}},
        }

        def words() -> tuple[dict[int, str], list[str]]:
            lenses = client.request("textDocument/codeLens", document)
            hints = client.request("textDocument/inlayHint", everywhere)
            shown = {
                each["range"]["start"]["line"] + 1: each["command"]["title"]
                for each in lenses
                if not each["command"]["command"]
            }
            return shown, [each["label"] for each in hints if "→" in each["label"]]

        assert words() == ({}, [])
        page = client.request(
            "workspace/executeCommand", {"command": "scenic.sample", "arguments": [uri, {"seed": 1}]}
        )
        assert page.count('"seed":"1"') == 9
        for what in ("codeLens", "inlayHint"):
            client.wait(lambda each, what=what: each.get("method") == f"workspace/{what}/refresh")  # type: ignore[misc]
        shares, ranges = words()
        assert shares[3] == "rejects none of 2,000 candidates, after narrowing"
        share = int(shares[4].removeprefix("rejects ").removesuffix("% of candidates"))
        assert 40 < share < 60  # about one half of the squares between 25 and 100
        assert ranges == ["→ 5 to 10"]
        client.change(uri, f"{text}# more\n")
        assert words() == ({}, [])
        client.change(uri, text)
        assert words() == (shares, ranges)
    finally:
        client.end()


@pytest.mark.slow
def test_sampling(tmp_path: Path) -> None:
    uri = (tmp_path / "room.scenic").as_uri()
    text = "import library\nego = new Object at (Range(0, 1), 0, 0)\nprint('said')\n"
    (tmp_path / "library.scenic").write_text("x = 1\n")
    command = {"command": "scenic.sample", "arguments": [uri]}

    def session(**others: object) -> Client:
        client = Client()
        client.start(**others)  # type: ignore[arg-type]
        client.open(uri, text)
        return client

    trusting = session(initializationOptions={"trusted": True})
    page = trusting.request("workspace/executeCommand", {**command, "workDoneToken": 3})
    assert page.startswith("<!doctype html>")
    assert page.rstrip().endswith("</html>")
    assert [
        each["params"]["value"]["kind"] for each in trusting.kept if each.get("method") == "$/progress"
    ] == [
        "begin",
        "end",
    ]
    trusting.change(uri, "ego = new Object at unknown\n")
    with pytest.raises(Refused, match="SC202"):
        trusting.request("workspace/executeCommand", command)
    trusting.change(uri, "while True: pass\n")
    number = trusting.ask("workspace/executeCommand", command)
    trusting.send("$/cancelRequest", {"id": number})
    with pytest.raises(Refused, match="cancelled"):
        trusting.answer(number)
    moving = "behavior B():\n    wait\nego = new Object with behavior B\n"
    trusting.change(uri, moving)
    simulate = {**command, "command": "scenic.simulate"}
    with pytest.raises(Refused, match="save"):
        trusting.request("workspace/executeCommand", simulate)
    (tmp_path / "room.scenic").write_text(moving)
    assert trusting.request("workspace/executeCommand", simulate).lower().startswith("<!doctype html>")
    assert trusting.leave() == 0
    trusting.end()

    for options in ({"trusted": False}, None):
        client = session(initializationOptions=options)
        with pytest.raises(Refused, match="not trusted"):
            client.request("workspace/executeCommand", command)
        client.end()

    asking = session(capabilities={**FULL, "window": {"showMessage": {"messageActionItem": {}}}})
    for answer in (None, {"title": "Cancel"}, {"title": "Run it"}):
        number = asking.ask("workspace/executeCommand", command)
        question = asking.wait(lambda each: each.get("method") == "window/showMessageRequest")
        body = b'{"jsonrpc": "2.0", "id": "%s", "result": %s}' % (
            question["id"].encode(),
            b"null" if answer is None else b'{"title": "%s"}' % answer["title"].encode(),
        )
        asking.raw(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        if answer == {"title": "Run it"}:
            assert asking.answer(number).startswith("<!doctype html>")
        else:
            with pytest.raises(Refused, match="not trusted"):
                asking.answer(number)
    asking.end()
