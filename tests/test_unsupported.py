"""What the language has and this version does not build is refused with SC900 at its place, and in no other way.

The first table covers what the declarations call unavailable, exactly: a feature that becomes available must leave it. The
second covers what is refused only when the program runs.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

import scenic
from scenic.cli.check import check
from scenic.compiler.check import check_text
from scenic.failures import diagnose
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.language.errors import Located, UnsupportedError
from scenic.language.names import NAMES
from scenic.language.support import refused_features
from scenic.runtime.program.builtins import Unsupported, builtin_names
from scenic.runtime.program.outcome import Program
from tests.runtime.programs import marked


def test_every_unavailable_feature_is_covered() -> None:
    named = {f"name {name}" for name, entry in NAMES.items() if not entry.available}
    assert set(refused_features()) == named


def refused(text: str, *, filename: str = "<string>") -> Located:
    with pytest.raises(Located) as caught:
        scenic.scenarioFromString(text, filename=filename).sample(1, seed=0)
    assert caught.value.code == "SC900", caught.value
    return caught.value


UNAVAILABLE = [name for name, entry in NAMES.items() if not entry.available]


@pytest.mark.parametrize("name", UNAVAILABLE)
def test_unavailable_names_are_refused_at_their_place(name: str) -> None:
    for text in (
        f"x = «{name}»",
        f"x = [«{name}»(3)]",
        f"class A(«{name}»): pass",
        f"try: x = 1\nexcept «{name}»: pass",
    ):
        plain, place = marked(text)
        span = refused(plain).span
        assert span is not None
        assert (span.line, span.column, span.end_column) == place


def test_the_runtime_refuses_the_same_names() -> None:
    provided = builtin_names(Program(), "x.scenic", lambda *_: None)
    assert {name for name, value in provided.items() if isinstance(value, Unsupported)} == set(UNAVAILABLE)
    assert all(name in provided for name in NAMES)


@pytest.mark.parametrize("name", UNAVAILABLE)
def test_unavailable_names_are_refused_when_a_module_might_have_brought_them(
    name: str, tmp_path: Path
) -> None:
    (tmp_path / "names.scenic").write_text("something = 3\n")
    for use in (f"{name}(3)", f"{name}.attribute", f"isinstance(3, {name})"):
        error = refused(f"from names import *\nx = {use}\n", filename=str(tmp_path / "main.scenic"))
        assert isinstance(error, UnsupportedError)
        assert error.line == 2
    refused(f"from names import *\nclass A({name}): pass\n", filename=str(tmp_path / "main.scenic"))


def parts() -> Iterator[tuple[str, str]]:
    """Attributes and methods that the declarations promise, used on instances and values."""
    from scenic.language.properties import CLASSES, attributes_of, properties_of

    arguments = {
        "relativize": "(1, 2)", "relativePosition": "(1, 2)", "distancePast": "(1, 2)", "distanceTo": "(1, 2)",
        "containsPoint": "(1, 2)", "intersects": "ego", "canSee": "(1, 2)",
    }  # fmt: skip
    for cls in CLASSES:
        for name in properties_of(cls):
            yield cls, name
        for name, attribute in attributes_of(cls).items():
            yield cls, f"{name}({arguments.get(name, '')})" if attribute.is_method else name


@pytest.mark.parametrize(("cls", "part"), list(parts()))
def test_what_instances_have_works_or_is_refused(cls: str, part: str) -> None:
    text = f"ego = new Object at (9, 9)\nx = new {cls} at (Range(0, 1), 0), with allowCollisions True\ny = x.{part}\n"
    found = mistake(text)
    assert found is None or (found.code, found.span is not None and found.span.line) == ("SC900", 3), found


def mistake(text: str) -> Diagnostic | None:
    try:
        scenic.scenarioFromString(text).sample(1, seed=0)
    except Exception as error:
        found = diagnose(error)
        if found is None:
            raise
        return found
    return None


@pytest.mark.parametrize("name", UNAVAILABLE)
def test_a_check_says_it_as_information(name: str, tmp_path: Path) -> None:
    file = tmp_path / "main.scenic"
    file.write_text(f"x = {name}(0, 1)\nego = new Object\n")
    (found,) = check_text(file.read_text(), filename=str(file))
    assert (found.code, found.severity) == ("SC900", Severity.INFORMATION)
    assert "no external sampler" in (found.help or "")
    for options in ([], ["--deep"]):
        result = CliRunner().invoke(check, [str(file), *options], standalone_mode=False)
        assert result.return_value == 0, result.output
    refused(file.read_text())
