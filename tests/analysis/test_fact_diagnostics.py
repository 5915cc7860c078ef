"""What is told of contradictions: code, places, words."""

import itertools
import sys
from pathlib import Path

import numpy as np
import pytest
from graph.programs import make, one_of, uniform

from scenic.analysis.fact_diagnostics import prove
from scenic.analysis.facts import Fact
from scenic.deep.findings import deep_check
from scenic.graph import node as graph
from scenic.graph.kinds import Kind
from scenic.graph.node import Graph
from scenic.graph.operations.distributions import LookupTable
from scenic.language.diagnostics import Severity
from scenic.language.spans import Span


def line(number, column=0):
    return Span(number, column, number, column + 5)


def report(*items):
    conditions = [Fact(node, "requirement", span) for node, span in items]
    return prove(Graph([node for node, _ in items]), conditions)


def told(diagnostic):
    return (
        diagnostic.code,
        diagnostic.span.line if diagnostic.span else None,
        [(label.span.line, label.text) for label in diagnostic.labels],
    )


def test_the_worked_example():
    r1, r2, c = uniform(0, 10, span=line(1)), uniform(1, 4, span=line(2)), one_of(1, 2, span=line(2, 9))
    x = make("subtract", r1, make("add", make("add", 0.5, make("divide", c, 2)), r2))
    (found,) = report((make("greater", x, 9), line(3)))
    assert told(found) == ("SC700", 3, [(1, "this range is at most 10"), (2, "this range is at least 1")])
    assert found.severity is Severity.ERROR
    assert found.filename is None
    assert report((make("greater", x, 2), line(3))) == ()


def test_the_last_requirement_is_blamed_whatever_the_order_given():
    x = uniform(0, 10, span=line(1))
    first, last = (make("greater", x, 6), line(4)), (make("less", x, 3), line(7))
    for items in ((first, last), (last, first)):
        (found,) = report(*items)
        assert told(found) == ("SC700", 7, [(4, "while this is required")])


def test_both_ends_of_one_draw_share_a_label():
    x = uniform(0, 10, span=line(1))
    twice = make("or", make("less", x, -1), make("greater", x, 11))
    (found,) = report((twice, line(2)))
    assert told(found) == ("SC700", 2, [(1, "this range is at least 0 and is at most 10")])


def test_a_choice_is_told_by_its_options():
    index = make("choice", graph.axis(), payload=(0.5, 1.0), span=line(1))
    (found,) = report((make("greater", index, 3), line(2)))
    assert told(found) == ("SC700", 2, [(1, "this choice takes one of its options")])
    (found,) = report(
        (make("and", make("greater", make("select", index, 1, 2), 0), make("greater", index, 3)), line(2))
    )
    assert told(found) == ("SC700", 2, [(1, "this choice is one of 1, 2")])


def test_options_are_told_where_all_are_fixed_numbers():
    index = make("choice", graph.axis(), payload=(0.5, 1.0), span=line(1))
    for options, words in (((1, 2.5), "is one of 1, 2.5"), ((1, uniform(0, 1)), "takes one of its options")):
        chosen = make("select", index, *options)
        (found,) = report((make("and", make("greater", chosen, -9), make("greater", index, 3)), line(2)))
        assert told(found) == ("SC700", 2, [(1, f"this choice {words}")])


@pytest.mark.parametrize("columns", list(itertools.product([False, True], repeat=3)))
def test_each_choice_is_told_by_its_own_options(columns):
    """Whether these are nodes or in a table, and whatever other choices there are."""
    options = [(1, 2.5), (3, 4.5), (6, 7.5)]  # of one kind they would all be tables
    draws, chosen = [], []
    for place, (pair, column) in enumerate(zip(options, columns, strict=True)):
        index = make("choice", graph.axis(), payload=(0.5, 1.0), span=line(place + 1))
        table = LookupTable(Kind.SCALAR, np.array(pair, dtype=float))
        chosen.append(make("look-up", index, payload=table) if column else make("select", index, *pair))
        draws.append(index)
    values, places = (make("add", make("add", *parts[:2]), parts[2]) for parts in (chosen, draws))
    (found,) = report((make("and", make("greater", values, -9), make("greater", places, 3)), line(9)))
    words = [
        (place + 1, f"this choice is one of {low:g}, {high:g}") for place, (low, high) in enumerate(options)
    ]
    assert told(found) == ("SC700", 9, words)


def test_options_that_are_vectors_are_not_told():
    index = make("choice", graph.axis(), payload=(0.5, 1.0), span=line(1))
    table = LookupTable(Kind.VECTOR, np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
    part = make("component", make("look-up", index, payload=table), payload=0)
    (found,) = report((make("and", make("greater", part, -9), make("greater", index, 3)), line(2)))
    assert told(found) == ("SC700", 2, [(1, "this choice takes one of its options")])


def test_contradictions_that_only_intervals_see():
    x = uniform(0.0, 0.1, span=line(1))
    (found,) = report((make("greater", x, 0.01), line(2)), (make("greater", make("sin", x), 0.5), line(3)))
    assert told(found) == ("SC700", 3, [])
    y = make("sin", uniform(0.0, 3.0))
    z = make("cos", uniform(0.0, 1.0))
    (found,) = report((make("less", y, z), line(2)), (make("less", z, -0.1), line(3)))
    assert told(found) == ("SC700", 3, [])


def test_a_requirement_that_always_holds_is_a_warning():
    x = uniform(0, 1, span=line(1))
    (found,) = report((make("greater", x, -1), line(2)))
    assert told(found) == ("SC701", 2, [])
    assert found.severity is Severity.WARNING


def test_a_constant_requirement():
    (found,) = report((make("less", 2, 1), line(2)))
    assert told(found) == ("SC700", 2, [])
    assert found.message == "this requirement can never hold"


def test_places_that_are_not_known_are_left_out():
    x = uniform(0, 1)
    (found,) = report((make("greater", x, 2), None))
    assert told(found) == ("SC700", None, [])
    assert report() == ()


def test_what_the_language_requires_is_named():
    condition = make("less", 2, 1)
    (found,) = prove(Graph([condition]), [Fact(condition, "Car in view", line(2), built_in=True)])
    assert found.message == "'Car in view', which the language requires, can never hold"


def test_labels_stand_in_the_order_of_the_program():
    x, y = uniform(0, 10, span=line(1)), uniform(0, 10, span=line(5))
    first, last = make("greater", y, make("add", x, 6)), make("greater", x, 5)
    (found,) = report((first, line(4)), (last, line(7)))
    assert told(found) == ("SC700", 7, [(4, "while this is required"), (5, "this range is at most 10")])
    (found,) = report((first, line(6)), (last, line(7)))
    assert told(found) == ("SC700", 7, [(5, "this range is at most 10"), (6, "while this is required")])


def test_what_has_no_place_comes_last():
    x = uniform(0, 10)
    high, low = (make("greater", x, 6), None), (make("less", x, 3), line(7))
    for items in ((high, low), (low, high)):
        (found,) = report(*items)
        assert told(found) == ("SC700", None, [(7, "while this is required")])


def test_a_contradiction_of_which_no_place_is_known_is_told_without():
    x = uniform(0, 10)
    (found,) = report((make("greater", x, 6), None), (make("less", x, 3), None))
    assert told(found) == ("SC700", None, [])


def test_what_intervals_do_not_need_is_not_blamed():
    u, v = uniform(0, 3), uniform(0, 1)
    needed = [(make("greater", make("sin", u), 0.9), line(3)), (make("less", u, 0.3), line(5))]
    for place in (2, 4, 6):
        (found,) = report((make("less", v, 0.5), line(place)), *needed)
        assert told(found) == ("SC700", 5, [(3, "while this is required")])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_of_several_that_intervals_find_impossible_one_alone_is_told(count):
    """Each by itself: none of the others is a reason."""
    never = [
        (make("greater", make("sin", uniform(0.0, 0.1)), 0.5), line(2 + 2 * place)) for place in range(count)
    ]
    fine = (make("less", make("sin", uniform(0.0, 3.0)), 0.5), line(3))
    for items in (never, [fine, *never], [*never, fine]):
        (found,) = report(*items)
        assert told(found) == ("SC700", 2 * count, [])
        assert found.message == "this requirement can never hold"


def test_several_that_a_range_forbids_together_are_told_as_several():
    x, y = uniform(0, 10, span=line(1)), uniform(0, 100, span=line(2))
    (found,) = report((make("greater", make("add", x, y), 15), line(3)), (make("less", y, 3), line(4)))
    assert found.message == "this requirement cannot hold together with the others marked"
    assert {label.text for label in found.labels} >= {"while this is required", "this range is at most 10"}


def test_what_is_said_of_one_two_and_three_conditions_that_cannot_hold_together():
    """Alone it never holds, or for no value of what it depends on; of several, the last is told with all others marked."""
    x = uniform(0.0, 1.0, span=line(1))
    y = make("sin", uniform(0.0, 0.1))
    alone, never = (make("greater", x, 2), line(2)), (make("greater", y, 0.5), line(2))
    two = [(make("less", x, 0.3), line(2)), (make("greater", x, 0.6), line(3))]
    a, b = uniform(0.0, 1.0), uniform(0.0, 1.0)
    three = [
        (make("greater", a, 0.9), line(2)),
        (make("greater", b, 0.8), line(3)),
        (make("less", make("add", a, b), 1.5), line(4)),
    ]
    for items, words, marked in (
        ([never], "this requirement can never hold", 0),
        ([alone], "this requirement cannot hold for any value of what it depends on", 1),
        (two, "this requirement cannot hold together with the others marked", 1),
        (three, "this requirement cannot hold together with the others marked", 2),
    ):
        (found,) = report(*items)
        assert found.message == words
        assert [label.span.line for label in found.labels][-marked or 99 :] == [
            span.line for _, span in items[:-1]
        ] or items == [alone]
        assert len(found.labels) == marked
        assert found.help.startswith("no scene can meet " + ("all of the marked places" if marked else "it"))
        built_in = [Fact(node, "a rule", span, built_in=True) for node, span in items]
        (found,) = prove(Graph([node for node, _ in items]), built_in)
        assert found.message == words.replace("this requirement", "'a rule', which the language requires,")


@pytest.mark.parametrize("options", [(0.123456789, 1234567.5), (1, 2.5), (-3, 10**9)])
def test_options_are_told_with_all_their_digits(options):
    """However they are chosen: as nodes of their own, or from a table."""
    draws = [make("choice", graph.axis(), payload=(0.5, 1.0), span=line(1)) for _ in range(2)]
    chosen = make("select", draws[0], *options)
    column = np.array(options, dtype=np.float64)
    looked_up = make("look-up", draws[1], payload=LookupTable(Kind.SCALAR, column))
    for draw, value in zip(draws, (chosen, looked_up), strict=True):
        both = make("and", make("greater", value, -(10**12)), make("greater", draw, 3))
        (found,) = report((both, line(2)))
        ((_, text),) = told(found)[2]
        numbers = [float(word) for word in text.removeprefix("this choice is one of ").split(", ")]
        assert numbers == list(options)


def drawn(name, *operands, payload=None):
    return make(name, graph.axis(), *operands, payload=payload, span=line(1))


@pytest.mark.parametrize(
    ("draw", "name", "border", "words"),
    [
        (drawn("range", -1.5, 0.1 + 0.2), "greater", 1, "this range is at most 0.3"),
        (drawn("range", 123456789.125, 2e9), "less", 1, "this range is at least 123456789.125"),
        (drawn("range", 3, -2), "less", -2, "this range is at least -2"),
        (drawn("range", uniform(0, 1), 2.0), "greater", 3, "this range lies between its ends"),
        (drawn("discrete range", 1, 6), "greater", 6, "this range of integers is at most 6"),
        (drawn("discrete range", -4, 6), "less", -4, "this range of integers is at least -4"),
        (
            drawn("discrete range", 0, uniform(1, 2)),
            "less",
            0,
            "this range of integers lies between its ends",
        ),
        (
            drawn("weighted integer", payload=(7, (0.5, 0.5, 1.0))),
            "equal",
            8,
            "this range of integers is never 8",
        ),
        (
            drawn("weighted integer", payload=(7, (0.0, 0.5, 1.0, 1.0))),
            "greater",
            9,
            "this range of integers is at most 9",
        ),
        (drawn("truncated normal", 0.0, 1.0, payload=(-1.0, 2.5)), "greater", 2.5, "this truncated normal is at most 2.5"),
        (drawn("truncated normal", 0.0, 1.0, payload=(-1.0, np.inf)), "less", -1, "this truncated normal is at least -1"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)  # fmt: skip
def test_what_a_contradiction_rests_on_is_told_in_words(draw, name, border, words):
    (found,) = report((make(name, draw, border), line(2)))
    assert (1, words) in told(found)[2]
    assert len(found.labels) == 1


def test_places_in_other_files_are_told_with_them():
    x = uniform(0, 10)
    high, low = make("greater", x, 6), make("less", x, 3)
    for first, last, marked in (
        ("a", "b", "a"),
        ("a", "a", None),
        (None, None, None),
        ("a", None, "a"),
        (None, "b", None),
    ):
        facts = [Fact(high, "", line(2), filename=first), Fact(low, "", line(3), filename=last)]
        (found,) = prove(Graph([high, low]), facts)
        assert found.filename == last
        assert [label.filename for label in found.labels] == [marked]
    always = Fact(make("greater", x, -1), "", line(2), filename="a")
    (found,) = prove(Graph([always.node]), [always])
    assert found.filename == "a"


def test_without_the_solver_intervals_and_tables_find_contradictions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "z3", None)
    path = tmp_path / "program.scenic"
    path.write_text(
        "ego = new Object at (Range(0, 10), 0)\na = DiscreteRange(0, 9)\nrequire ego.x > 6\nrequire a * ego.x < 3\nrequire a > 2\n"
    )
    found, advice = deep_check(path)
    assert (found.code, found.span.line, len(found.labels)) == ("SC700", 5, 2)
    assert (advice.code, advice.severity) == ("SC604", Severity.INFORMATION)
    path.write_text("ego = new Object\na, b = Uniform(1, 2), Uniform(1, 2)\nrequire a != b\nrequire a == b\n")
    assert [item.code for item in deep_check(path)] == ["SC700", "SC604"]
