"""Definitions of one member in several classes: what is found and renamed with it, and what cannot be."""

from pathlib import Path

import pytest

from scenic.ide.navigation import RenameError, prepare_rename, rename, usages
from scenic.ide.snapshot import Snapshot
from scenic.project.index import Project

BASE = """\
class Vehicle:
    width: 2
    wheels: 4
    axles: 2

    def sound(self):
        return self.wheels
"""
DERIVED = """\
from base import Vehicle

class Car(Vehicle):
    doors: 4

class Bus(Car):
    wheels: 6

    def sound(self):
        return super().sound() + self.wheels

class Cart:
    wheels: 2

bus = new Bus with wheels 8
cart = new Cart with wheels 2
total = bus.sound() + bus.wheels + cart.wheels
"""


def at(marked: str, folder: Path) -> tuple[Project, Snapshot, int, int]:
    """A project of the two files, and a place in one of them."""
    (folder / "base.scenic").write_text(BASE)
    (folder / "derived.scenic").write_text(DERIVED)
    before, after = marked.split("|")
    name, text = ("base", BASE) if before + after in BASE else ("derived", DERIVED)
    offset = text.index(before + after) + len(before)
    line = text.count("\n", 0, offset)
    column = offset - text.rfind("\n", 0, offset) - 1
    return Project((str(folder),)), Snapshot(text, str(folder / f"{name}.scenic")), line + 1, column


@pytest.mark.parametrize(
    ("marked", "lines"),
    [
        ("wh|eels: 4", {"base": [3, 7], "derived": [7, 10, 15, 17]}),
        ("wh|eels: 6", {"base": [3, 7], "derived": [7, 10, 15, 17]}),
        ("cart.wh|eels", {"derived": [13, 16, 17]}),
        ("do|ors: 4", {"derived": [4]}),
        ("bus.sou|nd", {"base": [6], "derived": [9, 17]}),
    ],
)
def test_what_overrides_each_other_has_one_name(
    marked: str, lines: dict[str, list[int]], tmp_path: Path
) -> None:
    found = list(usages(*at(marked, tmp_path), with_definitions=True))
    assert {
        name: sorted(each.span.line for each in found if Path(each.filename).stem == name) for name in lines
    } == lines
    assert len(found) == sum(map(len, lines.values()))
    assert {place for place, _ in rename(*at(marked, tmp_path), "other")} == set(found)


@pytest.mark.parametrize(
    ("marked", "name", "reason"),
    [
        ("wid|th: 2", "breadth", "language"),
        ("wh|eels: 6", "axles", "has a `axles` already"),
        ("do|ors: 4", "width", "has a `width` already"),
    ],
)
def test_names_that_would_change_the_meaning(marked: str, name: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(RenameError, match=reason):
        rename(*at(marked, tmp_path), name)


def test_a_property_of_the_language_is_no_place_to_rename(tmp_path: Path) -> None:
    with pytest.raises(RenameError, match="`Object`"):
        prepare_rename(*at("wid|th: 2", tmp_path))


CLOSURES = """\
size = 1
def outer(k):
    def inner(j):
        return j + k + size
    def other(size):
        return size
    return [inner(i) for i in range(k)]
"""


@pytest.mark.parametrize(
    ("line", "column", "name", "fits"),
    [
        (3, 14, "k", False),  # `inner` reads the `k` around it
        (2, 10, "j", False),  # and `inner` has a `j` of its own
        (2, 10, "size", False),
        (1, 0, "j", False),
        (1, 0, "range", False),
        (7, 20, "k", False),
        (5, 14, "k", True),
        (1, 0, "other", False),
        (1, 0, "extent", True),
        (2, 10, "m", True),
    ],
)
def test_no_name_comes_between_another_and_its_uses(
    line: int, column: int, name: str, fits: bool, tmp_path: Path
) -> None:
    (tmp_path / "closures.scenic").write_text(CLOSURES)
    filename = str(tmp_path / "closures.scenic")
    place = Project((str(tmp_path),)), Snapshot(CLOSURES, filename), line, column
    if fits:
        assert rename(*place, name)
    else:
        with pytest.raises(RenameError):
            rename(*place, name)
