"""Errors of the Python API in other processes."""

import pickle

import pytest

import scenic
from scenic.language.errors import GuardViolation, InvariantViolation, PreconditionViolation, ScenicError

PROGRAMS = (
    "x = = 1",
    "y = undefined_name",
    "ego = new Nothing",
    "ego = new Object at 'a'",
    "ego = new Object\nif Range(0, 1) > 0.5:\n    pass",
    "ego = new Object at 0 @ 0, at 1 @ 1",
)


@pytest.mark.parametrize("text", PROGRAMS)
def test_errors_of_programs_survive_pickling(text):
    with pytest.raises(Exception) as found:  # noqa: PT011 - of many classes
        scenic.scenarioFromString(text)
    error = found.value
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert again.diagnostic() == error.diagnostic()
    assert vars(again).keys() == vars(error).keys()


def test_all_problems_of_a_text_survive_pickling():
    with pytest.raises(ScenicError) as found:
        scenic.scenarioFromString("x = undefined_name\ny = another_name")
    assert len(found.value.diagnostics) == 2
    assert pickle.loads(pickle.dumps(found.value)).diagnostics == found.value.diagnostics


@pytest.mark.parametrize("kind", [GuardViolation, PreconditionViolation, InvariantViolation])
def test_violated_guards_survive_pickling(kind):
    again = pickle.loads(pickle.dumps(kind(lambda: None, 7)))
    assert type(again) is kind
    assert again.lineno == 7
    assert str(again) == str(kind(again.behaviorName, 7))
