"""The pages of the documentation show what is so: their programs are run, and write what is shown."""

import shutil
import tempfile
from pathlib import Path

import pytest

from docs._extensions.blocks import blocks_of
from docs._extensions.running import PageRun, checked, workplace

ELEMENTS = (
    "distributions",
    "operators",
    "properties",
    "regions",
    "shapes",
    "specifiers",
    "statements",
    "values",
)
DOCS = Path(__file__).parents[2] / "docs"
TUTORIAL = sorted(DOCS.glob("tutorial/*.md"))
REFERENCE = [DOCS / "reference" / f"{name}.md" for name in ELEMENTS]
GUIDES = [DOCS / "howto" / f"{name}.md" for name in ("ci", "custom", "library", "simulator", "slow")]
EXPLANATION = [DOCS / "explanation" / f"{name}.md" for name in ("pruning", "reproducibility")]
PAGES = [DOCS / "index.md", *TUTORIAL, *REFERENCE, *GUIDES, *EXPLANATION]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_the_page_shows_what_its_programs_do(path: Path, request: pytest.FixtureRequest) -> None:
    page = path.read_text(encoding="utf-8")
    folder = Path(tempfile.mkdtemp(prefix="scenic-docs-"))
    try:
        with workplace(folder, examples=True):
            found = checked(page, PageRun.begin(shell=True))
    finally:
        shutil.rmtree(folder)
    if request.config.getoption("--update-golden"):
        path.write_text(found, encoding="utf-8")
    else:
        assert found == page


def test_every_block_of_the_tutorial_is_run_or_shows_what_is_written() -> None:
    languages = {
        block.language
        for path in TUTORIAL
        for block in blocks_of(path.read_text())
        if block.language[:1] != "{"
    }
    assert languages <= {"scenic", "python", "console", "text", "sh"}
