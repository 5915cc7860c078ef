from functools import cache

from hypothesis import given
from hypothesis import strategies as st

from scenic.language.spelling import distance, nearest, nearest_attribute, nearest_option

WORDS = st.text("abc", max_size=6)


def by_definition(first: str, second: str) -> int:
    """Fewest edits, straight from the recurrence."""

    @cache
    def edits(i: int, j: int) -> int:
        if i == 0 or j == 0:
            return i + j
        best = min(
            edits(i - 1, j) + 1, edits(i, j - 1) + 1, edits(i - 1, j - 1) + (first[i - 1] != second[j - 1])
        )
        if i > 1 and j > 1 and first[i - 1] == second[j - 2] and first[i - 2] == second[j - 1]:
            best = min(best, edits(i - 2, j - 2) + 1)
        return best

    return edits(len(first), len(second))


@given(WORDS, WORDS, st.integers(0, 4))
def test_distance(first: str, second: str, limit: int) -> None:
    assert distance(first, second, limit=limit) == min(by_definition(first, second), limit + 1)


def test_nearest() -> None:
    assert nearest("widht", ["width", "height", "weight"]) == "width"
    assert nearest("Rnage", ["Range", "range"]) == "Range"
    assert nearest("colour", ["color", "column"]) == "color"
    assert nearest("x", ["y", "z"]) is None
    assert nearest("EGO", ["ego"]) == "ego"
    assert nearest("zebra", ["width", "height"]) is None
    assert nearest("width", ["width"]) is None
    assert nearest("hight", ["height", "right", "light"], limit=2) == "height"


def test_attributes_that_are_missing_remind_of_others() -> None:
    class Wheel:
        radius = 1
        _raduis = 2

    def missing(name: str) -> str | None:
        try:
            getattr(Wheel(), name)
        except AttributeError as error:
            return nearest_attribute(error)
        raise AssertionError

    assert missing("raduis") == "radius"
    assert missing("banana") is None
    assert nearest_attribute(AttributeError("raduis")) is None
    assert nearest_attribute(NameError("raduis", name="raduis")) is None


def test_the_nearest_of_a_few_options() -> None:
    samplers = ["random", "ce", "mab", "eg", "sa", "bo", "cma", "tpe", "sobol"]
    assert nearest_option("cm", samplers) == "cma"
    assert nearest_option("Sob", samplers) == "sobol"
    assert nearest_option("radnom", samplers) == "random"
    assert nearest_option("", samplers) is None
    assert nearest_option("quasi", samplers) is None
