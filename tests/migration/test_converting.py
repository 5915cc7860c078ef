"""Programs of Scenic 2 beside their conversions, which are reviewed; ``--update-golden`` writes them again."""

from pathlib import Path

import pytest

from scenic.compiler.check import check_text
from scenic.compiler.generated import WORDS
from scenic.compiler.lexer import lex
from scenic.language.diagnostics import Severity
from scenic.migration.converting import Converter
from scenic.migration.migration_rules import RULES
from scenic.pipeline import scenarioFromFile
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in
from tests.compiler.golden_cases import Case, cases_text, read_cases
from tests.maps import straight

FOLDER = Path(__file__).parent.parent / "data" / "migration"
FILES = tuple(sorted(FOLDER.glob("*.cases")))
CASES = tuple(case for file in FILES for case in read_cases(file)[1])

NEVER_LOADS = {
    "override of the heading",
    "with heading beside a pitch",
    "arithmetic on a field",
    "a map that is nowhere",
    "positionStdDev of a random number",
    "a class of a module that is not found",
    "an unknown class beside an object, without a world model",
    "a class that is called",
}
"""Programs that a person must change before they run."""

MARK = "# decide: "


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the modules and the map that the programs name."""
    folder = tmp_path_factory.mktemp("project")
    (folder / "shapes.scenic").write_text("class Ball:\n    width: 1\nclass Cone(Ball):\n    width: 2\n")
    (folder / "constants.py").write_text("SIZE = 3\n")
    (folder / "town.xodr").write_text(straight(300))
    return folder


def converted(case: Case, folder: Path) -> tuple[str, str]:
    """The converted text, and the text with the decisions that are left."""
    result = Converter((str(folder),)).convert(case.source, str(folder / "program.scenic"))
    assert result.problem is None, result.problem
    decisions = [f"{MARK}{note.rule}:{note.line}\n" for note in result.notes if not note.rewritten]
    return result.text, "".join([result.text, *decisions])


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_programs_become_what_was_reviewed(file: Path, project: Path, request: pytest.FixtureRequest) -> None:
    introduction, cases = read_cases(file)
    found = tuple(Case(case.file, case.title, case.source, converted(case, project)[1]) for case in cases)
    if request.config.getoption("--update-golden"):
        file.write_text(cases_text(introduction, found).rstrip("\n") + "\n")
    assert {case.title: case.tree for case in cases} == {case.title: case.tree for case in found}


def test_a_second_run_changes_nothing(project: Path) -> None:
    for case in CASES:
        text, _ = converted(case, project)
        again = Converter((str(project),)).convert(text, str(project / "program.scenic"))
        assert again.text == text, case
        assert not any(note.rewritten for note in again.notes), case


def test_comments_and_line_ends_stay(project: Path) -> None:
    name = str(project / "program.scenic")
    for case in CASES:
        text, _ = converted(case, project)
        assert comments(text) == comments(case.source), case
        for end in ("\r\n", "\r"):
            other = Converter((str(project),)).convert("\ufeff" + case.source.replace("\n", end), name)
            assert other.text == "\ufeff" + text.replace("\n", end), case


def test_mixed_line_ends_stay(project: Path) -> None:
    before = "ego = Object at 0 @ 0\r\nmonitor M:\n    wait\r\nx = Object at 5 @ 5\n"
    after = "ego = new Object at 0 @ 0\r\nmonitor M():\n    wait\r\nx = new Object at 5 @ 5\nrequire monitor M()\n"
    assert Converter().convert(before, str(project / "program.scenic")).text == after


def comments(text: str) -> list[str]:
    return [comment for _, _, comment in lex(text, WORDS).comments]


def test_converted_programs_have_no_errors(project: Path) -> None:
    known = surroundings_in(Project([str(project)]))
    for case in CASES:
        text, _ = converted(case, project)
        found = check_text(text, filename=str(project / "program.scenic"), surroundings_of=known)
        errors = [item for item in found if item.severity is Severity.ERROR]
        assert not errors or case.title in NEVER_LOADS, case


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", CASES, ids=str)
def test_converted_programs_load(case: Case, project: Path) -> None:
    if case.title in NEVER_LOADS:
        pytest.skip("a person must decide first")
    path = project / "program.scenic"
    path.write_text(converted(case, project)[0])
    scenarioFromFile(path)


def test_every_rule_has_a_case(project: Path) -> None:
    rules = {
        note.rule
        for case in CASES
        for note in Converter((str(project),)).convert(case.source, str(project / "program.scenic")).notes
    }
    of_files = {"python-api", "formatted-string"}
    assert rules == set(RULES) - of_files


def test_programs_of_scenic_3_stay() -> None:
    """Of the examples and libraries of this package nothing changes."""
    folders = [Path(__file__).parent.parent.parent / name for name in ("examples", "scenic")]
    for path in sorted(path for folder in folders for path in folder.rglob("*.scenic")):
        text = path.read_text()
        converted = Converter((str(path.parent),)).convert(text, str(path))
        assert (converted.text, converted.notes, converted.problem) == (text, (), None), path
