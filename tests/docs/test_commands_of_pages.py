"""Every command and program of README and pages runs as it is written; what cannot is marked on its page.

Pages whose outputs are golden are run by `test_pages`; here are the others.
"""

import shutil
import tempfile
from pathlib import Path

import pytest

from docs._extensions.blocks import blocks_of
from docs._extensions.running import PageRun, checked, workplace
from docs._extensions.shell import WrongCommandError, commands_of, run_commands
from tests.docs.test_pages import DOCS, PAGES

ROOT = DOCS.parent
RUN = {"sh", "console", "python", "scenic"}
OTHERS = [
    path
    for path in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md"))]
    if path not in PAGES and any(block.language in RUN for block in blocks_of(path.read_text()))
]


@pytest.mark.slow
@pytest.mark.parametrize("path", OTHERS, ids=lambda path: path.stem)
def test_the_page_runs_as_it_is_written(path: Path) -> None:
    page = path.read_text(encoding="utf-8")
    folder = Path(tempfile.mkdtemp(prefix="scenic-pages-"))
    try:
        with workplace(folder, examples=True):
            # Pages that show how to name files name this one.
            shutil.copy("examples/indoor/desk.scenic", "room.scenic")
            assert checked(page, PageRun.begin(shell=True)) == page
    finally:
        shutil.rmtree(folder)


def test_words_of_commands() -> None:
    text = "scenic check - < 'a b.scenic' # input\n\nscenic sample x \\\n  -n 5 | scenic view -\n# nothing\n"
    assert commands_of(text) == [
        ["scenic", "check", "-", "<", "a b.scenic"],
        ["scenic", "sample", "x", "-n", "5", "|", "scenic", "view", "-"],
    ]


def test_a_command_that_fails_is_found(tmp_path: Path) -> None:
    for text in ("scenic check nowhere.scenic\n", "ls\n"):
        with pytest.raises(WrongCommandError):
            run_commands(text)
