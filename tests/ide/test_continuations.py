"""What may follow at a place: every form of the language is offered word by word, and nothing where nothing fits."""

import pytest

from scenic.ide.continuations import PhraseKind, continuations
from scenic.language.keywords import TEMPORAL_OPERATORS
from scenic.language.operators import OPERATORS
from scenic.language.specifiers import SPECIFIERS
from scenic.language.statements import STATEMENTS


def offered(text: str) -> dict[str, PhraseKind]:
    """By text, what is offered at the end of a text."""
    lines = text.split("\n")
    return {item.text: item.kind for item in continuations(text, len(lines), len(lines[-1])).items}


def check_word_by_word(before: str, form: str, *, first: int = 0) -> None:
    """Every prefix of a form offers its next word, as that or as the beginning of the rest."""
    words = form.split()
    for count in range(first, len(words)):
        if words[count].isidentifier():
            found = offered(before + "".join(f"{word} " for word in words[:count]))
            rest = " ".join(words[count:])
            starts = {text.split()[0] for text in found}
            assert rest in found or words[count] in starts or is_operand(words, count), (before, form, count)


def is_operand(words: list[str], count: int) -> bool:
    """Whether a word of a declared form stands for an operand."""
    text = " ".join(words)
    for table in (SPECIFIERS, OPERATORS, TEMPORAL_OPERATORS):
        for declared in table.values():
            if text in declared.forms:
                names = {getattr(operand, "name", operand) for operand in declared.operands}
                return words[count] in names | {"property"}
    return False


@pytest.mark.parametrize("form", [form for each in SPECIFIERS.values() for form in each.forms])
def test_specifiers(form: str) -> None:
    check_word_by_word("ego = new Object at (0, 0), ", form)
    assert offered("ego = new Object at (0, 0), ")[form] is PhraseKind.SPECIFIER


@pytest.mark.parametrize(
    "form",
    [form for name, each in OPERATORS.items() for form in each.forms if name not in ("@", "deg")],
)
def test_operators(form: str) -> None:
    check_word_by_word("x = ", form)


@pytest.mark.parametrize("form", [form for each in TEMPORAL_OPERATORS.values() for form in each.forms])
def test_temporal_operators(form: str) -> None:
    check_word_by_word("require ", form)


@pytest.mark.parametrize(
    ("node", "form"),
    [(node, form) for node, each in STATEMENTS.items() for form in each.forms if node != "PropertyDef"],
)
def test_statements(node: str, form: str) -> None:
    around = "behavior B():\n    " if node == "Guard" else ""
    assert form in {
        item.form for item in continuations(around, around.count("\n") + 1, len(around) and 4).items
    }


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("new Object facing ", {"toward target", "directly toward target", "away from target"}, {"by"}),
        ("new Object facing directly ", {"toward target", "away from target"}, {"directly toward target"}),
        ("new Object left of x ", {"by"}, {"of", "from"}),
        ("new Object at x,\n    ", {"on target", "with property value"}, {"take action, ..."}),
        ("x = a ", {"can see target", "offset by offset", "relative to base", "if"}, {"distance to end"}),
        ("x = a + ", {"new"}, {"distance to end", "can see target"}),
        ("new Object at ", {"distance to end"}, set()),
        ("require ", {"always condition", "monitor value"}, {"condition until end"}),
        ("require a ", {"until end", "implies conclusion"}, {"always condition"}),
        ("x = a ", set(), {"until end", "implies conclusion"}),
        (
            "terminate ",
            {"when condition", "after duration", "simulation when condition"},
            {"take action, ..."},
        ),
        ("try:\n    x\n", {"except", "finally", "interrupt"}, {"else", "take action, ..."}),
        ("if x:\n    y\n", {"elif", "else", "take action, ..."}, {"except"}),
        ("while x:\n    if y:\n        z\n    ", {"elif", "else"}, {"except"}),
        ("scenario S():\n    setup:\n        x = 1\n    ", {"compose"}, {"take action, ..."}),
        ("match x:\n    ", {"case"}, {"take action, ..."}),
        ("for x ", {"in"}, {"of"}),
        ("class A:\n    x: 1\n    y: distance ", {"to end", "from start"}, {"of"}),
    ],
)
def test_places(text: str, inside: set[str], outside: set[str]) -> None:
    found = offered(text)
    assert inside <= found.keys()
    assert outside.isdisjoint(found)


@pytest.mark.parametrize("text", ["# ", "x = 'a ", 'x = """a\n', "x = f'{a} "])
def test_nothing_in_texts_and_comments(text: str) -> None:
    assert not offered(text)


def test_a_begun_word_is_left_out() -> None:
    assert offered("new Object fac") == offered("new Object ")


def test_mistakes_elsewhere_do_not_matter() -> None:
    assert "toward target" in offered("x = = 3\nif (:\n    y = )\n    ego = new Object facing ")


def test_what_the_words_of_an_item_are() -> None:
    text = "new Object beyond a by b, "
    [item] = [
        each for each in continuations(text, 1, len(text)).items if each.form == "beyond reference by offset"
    ]
    assert (item.words, item.operands, item.name) == ("beyond", ("reference", "offset"), "beyond")
    assert item.markdown is not None
    assert "line of sight" in item.markdown


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ("x = ", "an expression"),
        ("model ", "the name of a module"),
        ("require ", "a condition"),
        ("f(", "an argument"),
        ("new ", "a name"),
        ("match x:\n    case ", "a pattern"),
    ],
)
def test_other_things_by_label(text: str, label: str) -> None:
    lines = text.split("\n")
    assert label in continuations(text, len(lines), len(lines[-1])).labels


def test_all_items_have_documentation_or_are_plain_words() -> None:
    for text in ("", "x = ", "new Object at x, ", "require ", "x = a "):
        for item in continuations(text, 1, len(text)).items:
            assert item.markdown, item
