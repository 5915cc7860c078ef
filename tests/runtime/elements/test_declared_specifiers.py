"""Specifiers of the runtime follow their declarations: a changed declaration changes what a program does."""

from dataclasses import replace
from types import MappingProxyType

import pytest

from scenic.language.errors import SpecifierError
from scenic.language.specifiers import SPECIFIERS, Specified
from scenic.runtime.elements import specifiers
from tests.runtime.programs import failure, thing


def declare(monkeypatch: pytest.MonkeyPatch, name: str, **changes: object) -> None:
    """Declare a specifier otherwise, for one test."""
    changed = replace(SPECIFIERS[name], **changes)  # type: ignore[arg-type]
    declared = {**specifiers._DECLARED, name: specifiers._Declared.of(changed)}
    monkeypatch.setattr(specifiers, "_DECLARED", MappingProxyType(declared))


def test_every_available_specifier_is_built() -> None:
    assert set(specifiers.BUILDERS) == {name for name, declared in SPECIFIERS.items() if declared.available}


def test_priority(monkeypatch: pytest.MonkeyPatch) -> None:
    program = "ego = new Object\nx = new Object visible, at (3, 0)\n"
    assert tuple(thing(program).position) == (3, 0, 0)
    declare(monkeypatch, "visible", specifies=(Specified("position", 1),))
    assert "'position' is specified twice" in str(failure(program))


def test_modified_properties(monkeypatch: pytest.MonkeyPatch) -> None:
    program = "x = new Object at (1, 2, 9), on RectangularRegion((0, 0), 0, 9, 9)\n"
    assert thing(program).position.x == 1
    declare(monkeypatch, "on", modifies=())
    assert isinstance(failure(program), SpecifierError)


def test_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    declare(monkeypatch, "at", needs=("position",))
    assert "depends on it at the same time" in str(failure("x = new Object at (1, 2)\n"))
