"""Shrinking texts of which nothing is known but that they fail."""

from hypothesis import given
from hypothesis import strategies as st

from fuzz.shrinking import shrunk


def test_what_does_not_matter_is_left_out():
    text = "a = 1\nif x:\n    y = f(1, 2)\n    z = lambda: 0\nb = 2\n"
    assert shrunk(text, lambda each: "lambda" in each) == "lambda"
    assert shrunk(text, lambda each: "y" in each and "b" in each and each.count("\n") >= 1) == "y\nb"
    assert shrunk(text, lambda each: True) in ("", "a")


@given(st.text(alphabet="ab \n(é", max_size=60), st.integers(0, 40))
def test_the_result_fails_and_is_a_part(text: str, most: int):
    def fails(each: str) -> bool:
        return each.count("a") >= text.count("a")

    result = shrunk(text, fails, most=most)
    assert fails(result)
    rest = iter(text)
    assert all(character in rest for character in result)


def test_no_more_is_tried_than_is_allowed():
    tried = []

    def fails(each: str) -> bool:
        tried.append(each)
        return False

    assert shrunk("x y z\n" * 100, fails, most=7) == "x y z\n" * 100
    assert len(tried) == 7
