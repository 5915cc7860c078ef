"""Extracting and inlining variables: the text that comes out, and where neither is offered."""

import pytest

from scenic.compiler.fixes import apply_fixes
from scenic.ide.refactoring import extract_variable, inline_variable
from scenic.ide.snapshot import Snapshot
from scenic.language.diagnostics import Fix
from scenic.language.spans import Span
from scenic.project.index import Project


def extracted(marked: str) -> str | None:
    """A text after what stands between two bars has got a name."""
    before, chosen, after = marked.split("|")
    snapshot = Snapshot(before + chosen + after, "f")
    places = []
    for text in (before, before + chosen):
        places += [text.count("\n") + 1, len(text) - text.rfind("\n") - 1]
    found = extract_variable(Project(), snapshot, Span(*places))
    return None if found is None else apply_fixes(snapshot.text, [Fix(found.title, found.edits)])[0]


def inlined(marked: str) -> str | None:
    before, after = marked.split("|")
    snapshot = Snapshot(before + after, "f")
    found = inline_variable(Project(), snapshot, before.count("\n") + 1, len(before) - before.rfind("\n") - 1)
    return None if found is None else apply_fixes(snapshot.text, [Fix(found.title, found.edits)])[0]


def test_an_expression_gets_a_name() -> None:
    assert extracted("ego = new Object at |Range(1, 2)| @ 3\n") == (
        "value = Range(1, 2)\nego = new Object at value @ 3\n"
    )
    assert (
        extracted("value = 3\ndef f(a):\n    return |a + 1| * 2\n") is None
    )  # That is no expression of its own.
    assert extracted("value = 3\ndef f(a):\n    return 2 * |(a + 1)|\n") is None
    assert extracted("value = 3\ndef f(a):\n    return g(|a + 1|)\n") == (
        "value = 3\ndef f(a):\n    value2 = a + 1\n    return g(value2)\n"
    )
    assert extracted("x = |[1,\n  2]|\n") == "value = [1,\n  2]\nx = value\n"


@pytest.mark.parametrize(
    "marked",
    [
        "ego = new Object\nrequire |ego.width + 1| > 2\n",
        "x = a if b else |f(c)|\n",
        "x = [|f(y)| for y in range(3)]\n",
        "ego = new Object with width |self.length * 2|\n",
        "class A:\n    width: |Range(1, 2)|\n",
        "behavior B():\n    while |f(x)|:\n        wait\n",
        "x = 1; y = |f(2)|\n",
        "x = ||f(2)\n",
        "x = (|f(2)|\n",
    ],
)
def test_where_no_name_is_offered(marked: str) -> None:
    assert extracted(marked) is None


def test_a_value_takes_the_place_of_its_name() -> None:
    expected = "ego = new Object at (Range(1, 2) + 1) @ 3\n"
    assert inlined("wi|de = Range(1, 2) + 1\nego = new Object at wide @ 3\n") == expected
    assert inlined("wide = Range(1, 2) + 1\nego = new Object at wi|de @ 3\n") == expected


@pytest.mark.parametrize(
    "marked",
    [
        "w|ide = Range(1, 2)\nx = wide + wide\n",
        "w|ide = Range(1, 2)\nwide = 3\nx = wide\n",
        "w|ide = f()\ny = g()\nx = wide\n",
        "w|ide = Range(1, 2)\nrequire wide > 1\n",
        "w|ide = Range(1, 2)\nx = [wide for _ in range(3)]\n",
        "w|ide = Range(1, 2)\ndef f():\n    return wide\n",
    ],
)
def test_where_a_value_stays(marked: str) -> None:
    assert inlined(marked) is None


def test_a_variable_is_inlined_beside_names_that_a_known_module_brings() -> None:
    program = "from math import *\nwi|de = Range(1, 2)\nego = new Object at (wide, 3)\n"
    assert inlined(program) == "from math import *\nego = new Object at (Range(1, 2), 3)\n"
    assert inlined("p|i = Range(1, 2)\nego = new Object at (pi, 3)\nfrom math import *\n") is None
