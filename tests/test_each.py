"""Loops of cases fail where one of their cases fails."""

import pytest

from tests.each import each


def test_every_failing_case_is_reported() -> None:
    asked = []

    @each(range(4))
    def law(case: int) -> None:
        asked.append(case)
        if case == 0:
            pytest.skip("not asked")
        assert case < 2

    with pytest.raises(ExceptionGroup, match="2 of 4 cases fail") as failure:
        law()
    assert asked == [0, 1, 2, 3]
    assert [error.__notes__ for error in failure.value.exceptions] == [["case: 2"], ["case: 3"]]


def test_a_loop_without_a_case_is_a_mistake() -> None:
    with pytest.raises(ValueError, match="no case"):
        each([])


def test_a_loop_that_skips_all_cases_is_skipped() -> None:
    @each(range(2))
    def law(case: int) -> None:
        pytest.skip("not asked")

    with pytest.raises(pytest.skip.Exception):
        law()
