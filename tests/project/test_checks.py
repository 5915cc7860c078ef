"""What the static check says of programs that import others: folders with marked programs.

Marks are those of `tests.compiler.checks.test_lint`. A folder is a project of its own.
"""

import re
from pathlib import Path

import pytest

from scenic.compiler.check import check_text
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in
from tests.compiler.checks.test_lint import applied, marks, place
from tests.project.layouts import project, write

FOLDER = Path(__file__).parents[1] / "data" / "projects"
CASES = sorted(FOLDER.glob("*/*.scenic"))


def findings(path: Path, text: str, *, verbose: bool = False) -> list[Diagnostic]:
    """What the check says, without features that are not built yet."""
    known = surroundings_in(Project([str(path.parent)]), verbose=verbose)
    found = check_text(text, filename=str(path), surroundings_of=known)
    return [item for item in found if item.code != "SC900"]


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.parent.name}/{case.stem}")
def test_marked_programs(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    found = findings(case, text)
    expected = marks(text)
    assert [place(item) for item in found] == [mark[:4] for mark in expected]
    for item, mark in zip(found, expected, strict=True):
        assert item.message.startswith(mark[4]), item.message
        assert item.help


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.parent.name}/{case.stem}")
def test_repairs_repair(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    before = findings(case, text)
    for item in before:
        if item.fix is not None:
            assert len(findings(case, applied(text, item.fix))) < len(before), item


def test_what_cannot_be_known_is_told_on_demand() -> None:
    case = FOLDER / "dynamic" / "main.scenic"
    found = [item for item in findings(case, case.read_text(), verbose=True) if item.code == "SC213"]
    assert [(item.span.line, item.severity) for item in found if item.span] == [
        (2, Severity.INFORMATION),
        (3, Severity.INFORMATION),
        (4, Severity.INFORMATION),
    ]
    assert "`reflective.py`" in found[0].message


def test_a_missing_module_is_an_error_only_if_the_project_should_have_it() -> None:
    case = FOLDER / "missing" / "main.scenic"
    severities = {
        item.message: item.severity for item in findings(case, case.read_text()) if item.code == "SC406"
    }
    warnings = [message for message, severity in severities.items() if severity is Severity.WARNING]
    assert warnings == ["there is no module `some_library_that_nobody_has`"]


ELSEWHERE = """model {}
ego = new Car
behavior Drive():
    do FollowLaneBehavior(target_speed=fast)
new Truck at 3, with behavior Drive
"""


@pytest.mark.parametrize(
    ("model", "advice"),
    [
        (
            "scenic.simulators.webots.mars.model",
            r"; .*copy its files to `scenic/simulators/webots/mars` beside the program",
        ),
        ("scenic.simulators.airsim.model", r"there is no \.scenic file of that name"),
        (
            "world.mine",
            r"beside the program or on Python's path; install the package that `world` belongs to",
        ),
    ],
)
def test_a_world_model_that_is_not_here_is_one_piece_of_information(
    model: str, advice: str, tmp_path: Path
) -> None:
    found = findings(tmp_path / "main.scenic", ELSEWHERE.format(model), verbose=True)
    assert [(item.code, item.severity) for item in found] == [
        ("SC406", Severity.INFORMATION),
        ("SC404", Severity.ERROR),
    ]
    assert re.search(advice, found[0].help or "")


def test_a_world_model_may_lie_beside_the_program_under_its_established_name(tmp_path: Path) -> None:
    write(tmp_path, {"scenic/simulators/webots/mars/model.scenic": "class Car:\n    wheels: 4\n"})
    text = "model scenic.simulators.webots.mars.model\nego = new Carr\n"
    [found] = findings(tmp_path / "main.scenic", text)
    assert found.help == "did you mean `Car`?"


def test_the_same_class_in_two_branches_is_known(tmp_path: Path) -> None:
    branches = (
        "if flat:\n    class Low:\n        rise: 0\nelse:\n    class Low:\n        rise: {}\n        {}: 1\n"
    )
    text = "from low import Car\nego = new Car with risee 3\n"
    for extra, count in (("rise", 1), ("fall", 0)):
        module = branches.format(2, extra).replace("        rise: 1\n", "")
        write(tmp_path, {"low.scenic": f"flat = True\n{module}class Car(Low):\n    speed: 3\n"})
        found = [item.help for item in findings(tmp_path / "main.scenic", text) if item.code == "SC300"]
        assert found == ["did you mean `rise`?"] * count


def test_misspelt_properties_of_webots_objects_are_found(tmp_path: Path) -> None:
    text = "model scenic.simulators.webots.model\nego = new WebotsObject with webotsTyp 'ROVER'\n"
    [found] = findings(tmp_path / "main.scenic", text)
    assert (found.code, found.help) == ("SC300", "did you mean `webotsType`?")


def test_labels_lead_to_other_files() -> None:
    case = FOLDER / "cars" / "main.scenic"
    [found] = [item for item in findings(case, case.read_text()) if "needs `target`" in item.message]
    [label] = found.labels
    assert label.filename == str(FOLDER / "cars" / "lib" / "model.scenic")
    assert label.span.line == 15


def test_an_ego_that_a_module_brings_is_there(tmp_path: Path) -> None:
    text = "from first import *\nnew Object left of ego\n"
    write(tmp_path, {"second.scenic": "ego = new Object\n", "first.scenic": "import second\n"})
    assert findings(tmp_path / "main.scenic", text) == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("from math import pi\nego = new Object at pie\n", ["SC202 `pie`"]),
        ("import m\nego = new Object at foo\n", ["SC406 `m`", "SC202 `foo`"]),
        ("from math import pi\nego = new Object at tau\n", ["SC206 `pi`", "SC202 `tau`"]),
        ("from tools import Action\nego = new Object\nnew Action\n", ["SC203 `Action`"]),
        # What has a handler may be meant to fail; interrupts handle no errors.
        ("import tools\nego = new Object\ntry:\n    tools.pull\nexcept AttributeError:\n    pass\n", []),
        ("import tools\nego = new Object\ntry:\n    tools.pull\nfinally:\n    pass\n", ["SC212 `tools`"]),
        (
            (
                "import tools\nego = new Object\nbehavior B():\n    try:\n        take tools.Axion()\n"
                "    interrupt when tools.pull:\n        wait\nego.behavior = B\n"
            ),
            ["SC212 `tools`", "SC212 `tools`"],
        ),
    ],
)
def test_what_is_said_of_python_modules(tmp_path: Path, text: str, expected: list[str]) -> None:
    write(tmp_path, {"tools.py": "class Action:\n    pass\ndef push(): pass\n"})
    found = findings(tmp_path / "main.scenic", text)
    assert [f"{item.code} `{item.message.split('`')[1]}`" for item in found] == expected


def test_changes_of_a_module_are_seen(tmp_path: Path) -> None:
    found = project(tmp_path, {"m.scenic": "def f(a): return a\n"})
    known = surroundings_in(found)
    text = "from m import *\nego = new Object facing f(1, 2)\n"

    def codes() -> list[str]:
        return [
            item.code for item in check_text(text, filename=str(tmp_path / "a.scenic"), surroundings_of=known)
        ]

    assert codes() == ["SC211"]
    found.open(str(tmp_path / "m.scenic"), "def f(a, b): return a\n")
    assert codes() == []
    found.open(str(tmp_path / "m.scenic"), "def g(a, b): return a\n")
    assert codes() == ["SC202"]


def test_slips_in_attributes_of_what_a_world_model_brings(tmp_path: Path) -> None:
    text = (
        "model scenic.domains.driving.model\nego = new Car\nx = network.lane, network.lanes, road.polygons\n"
    )
    (found,) = (each for each in findings(tmp_path / "program.scenic", text) if each.code == "SC214")
    assert found.message == "a `Network` has no attribute `lane`"
    assert found.fix is not None
