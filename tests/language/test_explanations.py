"""The pages of the diagnostic codes: every code has one, and what they show is what happens."""

import warnings
from importlib import resources
from pathlib import Path

import pytest

from scenic.compiler.check import check_text
from scenic.compiler.fixes import apply_fixes
from scenic.deep.findings import deep_check
from scenic.failures import diagnose
from scenic.language.diagnostics import CODES, Diagnostic, Severity
from scenic.language.errors import ScenicWarning
from scenic.language.explanations import Explanation, explanation
from scenic.pipeline import scenarioFromString
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in
from scenic.simulators.kinematic import KinematicSimulator
from tests.each import each

PAGES = sorted(
    file.name.removesuffix(".md")
    for file in resources.files("scenic.language.explanations").iterdir()
    if file.name.endswith(".md")
)
RUN = [code for code in PAGES if explanation(code).language == "scenic" and not explanation(code).reason]


def test_every_code_has_a_page_and_every_page_a_code() -> None:
    assert sorted(CODES) == PAGES


@each(PAGES)
def test_the_title_is_that_of_the_code(code: str) -> None:
    assert explanation(code).title == CODES[code]


def test_hardly_any_page_is_not_run() -> None:
    """Syntax, names and meaning are always run, except what needs an old Python or an impossible text."""
    not_run = [code for code in PAGES if code < "SC400" and code not in RUN]
    assert not_run == ["SC107", "SC112", "SC120"]


def test_unknown_codes_have_none() -> None:
    with pytest.raises(KeyError):
        explanation("SC000")


def checked(text: str, *, verbose: bool = False) -> tuple[Diagnostic, ...]:
    """What the static check says of a program that stands alone in its folder."""
    known = surroundings_in(Project(["/nowhere"]), verbose=verbose)
    return check_text(text, filename="/nowhere/page.scenic", surroundings_of=known)


def observed(page: Explanation, text: str, folder: Path) -> list[Diagnostic]:
    """What the tool that finds this code says of a program."""
    if page.code < "SC400" or page.code in ("SC403", "SC613", "SC616"):
        return list(checked(text, verbose=page.severity is Severity.INFORMATION))
    assert check_text(text, filename="page.scenic") == () or text == page.repair, (
        "it is found without running it"
    )
    if page.code.startswith("SC7"):
        file = folder / "page.scenic"
        file.write_text(text)
        return list(deep_check(file))
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            scene, _ = scenarioFromString(text).generate(maxIterations=20)
        if page.code == "SC504":
            KinematicSimulator().simulate(scene, maxSteps=1)
    except Exception as error:  # noqa: BLE001 - whatever it is, it is what the user would see
        found = diagnose(error)
        assert found is not None
        return [found]
    return [item.message.diagnostic() for item in warned if isinstance(item.message, ScenicWarning)]


@pytest.mark.parametrize("code", RUN)
def test_the_example_has_this_one_diagnostic(code: str, tmp_path: Path) -> None:
    page = explanation(code)
    (found,) = observed(page, page.example, tmp_path)
    place = (None, None) if found.span is None else (found.span.line, found.span.column + 1)
    assert (found.code, *place, found.severity) == (code, page.line, page.column, page.severity)
    assert (found.message, found.help) == (page.message, page.help)


@pytest.mark.parametrize("code", RUN)
def test_the_repair_is_free_of_it(code: str, tmp_path: Path) -> None:
    page = explanation(code)
    assert code not in {found.code for found in observed(page, page.repair, tmp_path)}


@each(code for code in RUN if code < "SC400")
def test_a_fix_of_the_example_mends_it(code: str) -> None:
    page = explanation(code)
    for found in checked(page.example):
        if found.fix is not None:
            mended, _ = apply_fixes(page.example, [found.fix])
            assert found.code not in {each.code for each in checked(mended)}
