"""Programs and expressions of the language give what was recorded."""

from pathlib import Path

import pytest

from tests.recorded import FOLDER, columns, expressions, hold, scenes


@pytest.mark.parametrize("path", sorted(FOLDER.glob("programs_*.txt")), ids=lambda path: path.stem)
def test_programs(path: Path, request: pytest.FixtureRequest) -> None:
    hold(path, scenes, request)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("expressions_*.txt")), ids=lambda path: path.stem)
def test_expressions(path: Path, request: pytest.FixtureRequest) -> None:
    hold(path, expressions, request)


@pytest.mark.parametrize("path", sorted(FOLDER.glob("columns_*.txt")), ids=lambda path: path.stem)
def test_columns(path: Path, request: pytest.FixtureRequest) -> None:
    hold(path, columns, request)


def test_flat_programs(request: pytest.FixtureRequest) -> None:
    for path in sorted(FOLDER.glob("flat_programs_*.txt")):
        hold(path, lambda source: scenes(source, mode2D=True), request)
