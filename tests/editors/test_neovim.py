"""The plugin and the language server as a user of Neovim meets them: keys are typed, and the editor's state is read."""

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

NVIM = shutil.which("nvim")
PLUGIN = Path(__file__).resolve().parents[2] / "editors" / "neovim"

pytestmark = pytest.mark.skipif(NVIM is None, reason="needs Neovim: apt-get install neovim")

LIBRARY = """\
class Chair(Object):
    width: 0.5
    height: 0.9


def beside(thing, gap=1):
    return thing.position + (gap, 0, 0)
"""

PROGRAM = """\
from library import Chair, beside

größe = 2
ego = new Chair at (0, 0, 0),
    with widht 3
box = new Object lef of ego by größe
require ego.height > 0.5
"""


class Editor:
    """Neovim with the plugin, and nothing else of its user's."""

    def __init__(self, folder: Path) -> None:
        settings = folder / "init.lua"
        command = [sys.executable, "-P", "-m", "scenic.cli.main", "lsp"]
        settings.write_text(
            f"vim.opt.runtimepath:prepend({str(PLUGIN)!r})\n"
            "vim.opt.swapfile = false\n"
            "vim.cmd('filetype plugin indent on')\n"
            "vim.cmd('syntax on')\n"
            f"require('scenic').setup {{ cmd = {{ {', '.join(map(repr, command))} }}, trusted = true }}\n"
        )
        self._address = str(folder / "socket")
        self.process = subprocess.Popen(
            [str(NVIM), "--headless", "--listen", self._address, "-n", "-i", "NONE", "-u", str(settings)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.until(Path(self._address).exists)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()

    def _remote(self, option: str, text: str) -> str:
        command = [str(NVIM), "--server", self._address, option, text]
        # Some versions answer on one stream, some on the other.
        done = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True
        )
        return done.stdout

    def lua(self, code: str, *arguments: Any) -> Any:
        """What a chunk of Lua returns, which may use the arguments as `...`."""
        given = json.dumps([code, list(arguments)]).replace("'", "''")
        return json.loads(
            self._remote(
                "--remote-expr",
                f"json_encode(luaeval('assert(loadstring(_A[1]))(unpack(_A[2]))', json_decode('{given}')))",
            )
        )

    def command(self, text: str) -> None:
        self.lua("vim.cmd(...)", text)

    def open(self, path: Path) -> None:
        """Open a file, and wait until a server serves it."""
        self.command(f"edit {path}")
        self.until(lambda: self.lua("return not vim.tbl_isempty(vim.lsp.buf_get_clients(0))"))

    def type(self, keys: str) -> None:
        self._remote("--remote-send", keys)

    @property
    def lines(self) -> list[str]:
        return list(self.lua("return vim.api.nvim_buf_get_lines(0, 0, -1, true)"))

    @lines.setter
    def lines(self, lines: list[str]) -> None:
        self.lua("vim.api.nvim_buf_set_lines(0, 0, -1, true, ...)", lines)

    def offered(self) -> list[str]:
        """The words of the menu of completions."""
        found = self.lua("return vim.fn.complete_info({'items'}).items")
        return [each["word"] for each in found or []]

    def diagnostics(self) -> list[tuple[str, int, int]]:
        """Code, line from 1 and column in bytes from 0 of what is shown, in order."""
        found = self.lua("return vim.diagnostic.get(0)")
        return sorted((str(each["code"]), each["lnum"] + 1, each["col"]) for each in found)

    def until(self, holds: Callable[[], Any], seconds: float = 30) -> Any:
        end = time.monotonic() + seconds
        while not (found := holds()):
            assert time.monotonic() < end, f"waited too long; {self.diagnostics()}; {self.lines}"
            time.sleep(0.05)
        return found

    def go(self, text: str) -> None:
        """Put the cursor on the beginning of a text."""
        assert self.lua("return vim.fn.search(..., 'w')", rf"\V{text}")


@pytest.fixture
def editor(tmp_path: Path) -> Iterator[Editor]:
    (tmp_path / "pyproject.toml").write_text("")
    (tmp_path / "library.scenic").write_text(LIBRARY, encoding="utf-8")
    (tmp_path / "program.scenic").write_text(PROGRAM, encoding="utf-8")
    editor = Editor(tmp_path)
    try:
        editor.open(tmp_path / "program.scenic")
        yield editor
    finally:
        editor.close()


def test_mistakes_are_shown_where_they_are(editor: Editor) -> None:
    editor.until(lambda: any(line == 6 for _, line, _ in editor.diagnostics()))
    [(_, _, column)] = [each for each in editor.diagnostics() if each[1] == 6]
    assert column == PROGRAM.splitlines()[5].index("lef")
    # Columns are those of Neovim, which counts bytes.
    editor.lines = ["größer = 'é😀' +", *editor.lines]
    editor.until(lambda: any(line == 1 for _, line, _ in editor.diagnostics()))
    [(_, _, column)] = [each for each in editor.diagnostics() if each[1] == 1]
    assert column in (len("größer = 'é😀' ".encode()), len("größer = 'é😀' +".encode()))


def test_a_repair_is_made(editor: Editor) -> None:
    editor.until(lambda: any(line == 6 for _, line, _ in editor.diagnostics()))
    editor.go("lef of")
    actions = editor.lua(
        """
        local params = vim.lsp.util.make_range_params()
        params.context = { diagnostics = vim.lsp.diagnostic.get_line_diagnostics() }
        local answers = vim.lsp.buf_request_sync(0, "textDocument/codeAction", params, 10000)
        local titles = {}
        for id, answer in pairs(answers) do
          for _, action in ipairs(answer.result or {}) do
            table.insert(titles, action.title)
            if action.title:find("left") then
              local client = vim.lsp.get_client_by_id(id)
              if not action.edit then
                action = client.request_sync("codeAction/resolve", action, 10000, 0).result
              end
              vim.lsp.util.apply_workspace_edit(action.edit, client.offset_encoding)
            end
          end
        end
        return titles
        """
    )
    assert any("left" in title for title in actions)
    assert editor.lines[5] == "box = new Object left of ego by größe"
    editor.until(lambda: all(line != 6 or code.startswith("SC3") for code, line, _ in editor.diagnostics()))


def test_completion_offers_what_fits(editor: Editor) -> None:
    editor.until(lambda: editor.diagnostics())
    editor.type("Goego2 = new Object facing dir<C-x><C-o>")
    words = editor.until(editor.offered)
    assert any(word.startswith("directly") for word in words)
    editor.type("<C-e><Esc>ccthing = new Ch<C-x><C-o>")
    words = editor.until(editor.offered)
    assert "Chair" in words
    editor.type("<C-e><Esc>")


def test_renaming_reaches_the_other_file(editor: Editor, tmp_path: Path) -> None:
    editor.until(lambda: editor.diagnostics())
    editor.go("Chair at")
    editor.lua("vim.lsp.buf.rename('Stool')")
    editor.until(lambda: editor.lines[3].startswith("ego = new Stool at"))
    assert editor.lines[0] == "from library import Stool, beside"
    editor.command("wall")
    editor.until(lambda: "class Stool(Object):" in (tmp_path / "library.scenic").read_text(encoding="utf-8"))
    assert (tmp_path / "program.scenic").read_text(encoding="utf-8").count("Stool") == 2


def test_formatting(editor: Editor) -> None:
    editor.lines = ["x   =  3 # three", "ego=new   Object  at (0,0,x)", "require ego.x<3"]
    editor.lua(
        """
        local format = vim.lsp.buf.format
        if format then format { timeout_ms = 10000 } else vim.lsp.buf.formatting_sync(nil, 10000) end
        """
    )
    assert editor.lines == ["x = 3  # three", "ego = new Object at (0, 0, x)", "require ego.x < 3"]


def test_hovering_explains(editor: Editor) -> None:
    editor.until(lambda: editor.diagnostics())
    editor.go("require")
    text = editor.lua(
        """
        local params = vim.lsp.util.make_position_params()
        for _, answer in pairs(vim.lsp.buf_request_sync(0, "textDocument/hover", params, 10000)) do
          return answer.result.contents.value
        end
        """
    )
    assert "Keeps only scenes" in text


def test_definitions_are_found_in_the_other_file(editor: Editor) -> None:
    editor.until(lambda: editor.diagnostics())
    editor.go("beside")
    editor.lua("vim.lsp.buf.definition()")
    editor.until(lambda: editor.lua("return vim.api.nvim_buf_get_name(0)").endswith("library.scenic"))
    assert editor.lua("return vim.api.nvim_get_current_line()").startswith("def beside")


@pytest.mark.slow
def test_scenes_are_sampled(editor: Editor, tmp_path: Path) -> None:
    editor.lines = ["ego = new Object at (Range(1, 2), 0)"]
    page = tmp_path / "page"
    editor.lua(
        "local page = ...; require('scenic').sample(7, function(path) vim.loop.fs_copyfile(path, page) end)",
        str(page),
    )
    editor.until(page.exists, 60)
    editor.until(lambda: '"seed":"7"' in page.read_text(encoding="utf-8"))


@pytest.mark.slow
def test_shares_are_shown_after_a_run(editor: Editor, tmp_path: Path) -> None:
    editor.lines = [
        "x = Range(-10, 10)",
        "ego = new Object at (x, 0)",
        "require x > 5",
        "require (x * x) % 2 > 1",
    ]
    page = tmp_path / "page"
    editor.lua("vim.lsp.codelens.refresh()")
    editor.lua(
        "local page = ...; require('scenic').show(7, function(path) vim.loop.fs_copyfile(path, page) end)",
        str(page),
    )

    def shares() -> list[str]:
        editor.lua("vim.lsp.codelens.refresh()")
        titles = editor.lua(
            """
            local titles = {}
            for _, lens in ipairs(vim.lsp.codelens.get(0)) do
              if lens.command then table.insert(titles, lens.command.title) end
            end
            return titles
            """
        )
        return [each for each in titles or [] if "rejects" in each]

    editor.until(page.exists, 60)
    assert len(editor.until(shares, 60)) == 2


@pytest.mark.slow
def test_programs_are_simulated(editor: Editor, tmp_path: Path) -> None:
    editor.lines = [
        "behavior B():",
        "    for _ in range(3):",
        "        wait",
        "    terminate",
        "ego = new Object with behavior B",
    ]
    page = tmp_path / "page"
    editor.lua(
        "local page = ...; require('scenic').simulate(7, function(path) vim.loop.fs_copyfile(path, page) end)",
        str(page),
    )
    editor.until(page.exists, 60)
    editor.until(lambda: "</html>" in page.read_text(encoding="utf-8"))
    assert editor.lua("return vim.lsp.commands['scenic.simulate'] ~= nil")


def test_colours_and_indentation(editor: Editor) -> None:
    editor.lines = [
        "ego = new Object ahead of x by 3 deg, facing directly toward y",
        "behavior Drive(a):",
        "    take brake",
        "take = behind",
    ]

    def group(line: int, text: str) -> str:
        column = editor.lines[line - 1].index(text) + 1
        return str(editor.lua("return vim.fn.synIDattr(vim.fn.synID(...), 'name')", line, column, 1))

    assert group(1, "ahead of") == group(1, "deg") == group(1, "directly") == "scenicOperator"
    assert group(2, "behavior") == "scenicDefinition"
    assert group(2, "Drive") == "scenicDefined"
    assert group(3, "take") == "scenicStatement"
    assert group(4, "take") == group(4, "behind") == ""
    editor.lines = ["if x:"]
    editor.type("Goy = new Object at 3,<CR>facing 3<Esc>")
    editor.until(lambda: len(editor.lines) == 3)
    assert editor.lines == ["if x:", "    y = new Object at 3,", "        facing 3"]
