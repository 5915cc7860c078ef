import gc
import weakref
from pathlib import Path

import pytest

from scenic.compiler import check as checker
from scenic.ide import diagnostics as module
from scenic.ide.diagnostics import diagnostics
from scenic.ide.snapshot import Snapshot
from scenic.language.code_selection import Rules
from scenic.lsp.convert import Encoding
from scenic.lsp.documents import Document
from scenic.project.index import Project


def test_the_same_as_the_command_shows() -> None:
    text = "x = (1\nrequire x >\n"
    found = diagnostics(text, filename="a.scenic")
    assert found == checker.check_text(text, filename="a.scenic")
    assert found[0].code == "SC103"
    assert {item.filename for item in found} == {"a.scenic"}
    assert diagnostics("x = 1\n", filename="a.scenic") == ()


def test_a_fault_of_the_compiler_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise KeyError("oops")

    monkeypatch.setattr(module.Snapshot, "check", fail)
    (found,) = diagnostics("x = 1\n", filename="a.scenic")
    assert found.code == "SC999"
    assert "KeyError" in found.message


def test_rules_decide_what_is_shown() -> None:
    text = "ego = new Object with wdth 3\n"
    assert [item.code for item in diagnostics(text, filename="a.scenic")] == ["SC300"]
    assert diagnostics(text, filename="a.scenic", rules=Rules(ignore=("SC3",))) == ()


def test_what_is_made_of_a_version_is_gone_with_it() -> None:
    """Searching for cycles takes longer than a check: there are none."""
    path = Path(__file__).parents[2] / "examples" / "driving" / "left_turn.scenic"
    text = path.read_text(encoding="utf-8")
    gc.collect()
    gc.disable()
    try:
        document = Document("file:///a.scenic", "scenic", 1, text, Encoding.UTF16, Snapshot(text, str(path)))
        (program,) = document.programs
        module.found_in(program.snapshot, Rules(), Project((str(path.parent),)))
        scopes = [weakref.ref(scope) for scope in program.snapshot.resolution.scopes.values()]
        del document, program
        assert len(scopes) > 1
        assert not any(scope() for scope in scopes)
    finally:
        gc.enable()
