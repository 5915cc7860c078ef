import pytest

from scenic.compiler import check as checker
from scenic.ide import diagnostics as module
from scenic.ide.diagnostics import diagnostics
from scenic.language.code_selection import Rules


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
