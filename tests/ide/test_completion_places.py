"""What is offered fits the place, and what the language provides leads to its declaration."""

from pathlib import Path

from scenic.ide.completion import completions
from scenic.ide.diagnostics import found_in
from scenic.ide.hover import hover
from scenic.ide.importing import missing_imports
from scenic.ide.navigation import Target, definitions
from scenic.ide.snapshot import Snapshot
from scenic.language.code_selection import Rules
from scenic.language.source import read_source
from scenic.project.index import Project

MODEL = "param weather = 'sun'\nsimulator None\n"


def opened(folder: Path, marked: str) -> tuple[Project, Snapshot, int, int]:
    """A program, and the place of ``|`` in it."""
    before, after = marked.split("|")
    snapshot, project = Snapshot(before + after, str(folder / "main.scenic")), Project((str(folder),))
    project.open(snapshot.filename, snapshot.text, tree=snapshot.tree, resolution=snapshot.resolution)
    return project, snapshot, before.count("\n") + 1, len(before) - before.rfind("\n") - 1


def offered(folder: Path, marked: str) -> list[str]:
    return [item.label for item in completions(*opened(folder, marked)).items]


def test_members_follow_from_what_a_value_is(tmp_path: Path) -> None:
    assert offered(tmp_path, "x = unknown.|\n") == offered(tmp_path, "x = 3\ny = x.|\n") == []
    assert offered(tmp_path, "def f(a):\n    return a.|\n") == []
    assert "norm" in offered(tmp_path, "ego = new Object\nx = ego.position.|\n")
    region = offered(tmp_path, "room = RectangularRegion(0, 0, 1, 1)\nx = room.|\n")
    assert ("intersect" in region, "norm" in region) == (True, False)
    assert "width" in offered(tmp_path, "for each in [new Object, new Object]:\n    each.|\n")
    assert "sqrt" in offered(tmp_path, "import math\nx = math.|\n")


def test_statements_want_something(tmp_path: Path) -> None:
    actions = "import math\nclass Go:\n    def applyTo(self, agent, simulation):\n        pass\nclass Chair:\n    legs: 3\n"
    assert offered(tmp_path, actions + "behavior B():\n    take |\n")[0] == "Go"
    assert "Chair" not in offered(tmp_path, actions + "behavior B():\n    take |\n")
    assert "math" not in offered(tmp_path, actions + "ego = new |\n")
    assert offered(tmp_path, "monitor M():\n    wait\nrequire monitor |\n")[0] == "M"
    simulators = "from scenic.simulators.kinematic import KinematicSimulator\nsimulator |\n"
    assert offered(tmp_path, simulators)[0] == "KinematicSimulator"
    assert offered(tmp_path, "model scenic.|\n") == ["domains", "simulators"]


def test_parameters_are_known_wherever_they_are_set(tmp_path: Path) -> None:
    (tmp_path / "town.scenic").write_text(MODEL)
    text = "model town\nparam speed = 3\nx = globalParameters."
    assert offered(tmp_path, f"{text}|\n") == ["speed", "weather"]
    assert offered(tmp_path, "model town\nparam |\n") == ["weather"]
    project, snapshot, line, column = opened(tmp_path, f"{text}weat|her\n")
    found = hover(snapshot, line, column, lambda: project)
    assert found is not None
    assert "param weather = 'sun'" in found.markdown
    (target,) = definitions(project, snapshot, line, column)
    assert (target.filename, target.span.line) == (str(tmp_path / "town.scenic"), 1)


def test_what_the_language_provides_leads_to_its_declaration(tmp_path: Path) -> None:
    def shown(target: Target) -> str:
        span = target.span
        return read_source(target.filename).line(span.line)[span.column : span.end_column]

    for marked, name in {
        "x = Ran|ge(1, 2)\n": "Range",
        "ego = new Ob|ject\n": "Object",
        "ego = new Object with wid|th 3\n": "width",
        "ego = new Object fa|cing 3\n": "facing",
        "x = ego can s|ee ego\n": "can see",
    }.items():
        (target,) = definitions(*opened(tmp_path, marked))
        assert shown(target) == name
        assert Path(target.filename).parent.name == "language"


def test_modules_of_python_are_imported(tmp_path: Path) -> None:
    project, snapshot, _, _ = opened(tmp_path, "x = math.pi\ny = np.array([1])\nz = sqrt(4)|\n")
    found = found_in(snapshot, Rules(), project)
    edits = {each.edit.text for each in missing_imports(project, snapshot, found, lambda _span: True)}
    assert {"import math\n", "import numpy as np\n"} <= edits
