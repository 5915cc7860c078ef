"""What never answers is a failure like others."""

import math
import threading

import pytest

from fuzz import limits, session
from fuzz.limits import TooSlow, time_limit
from fuzz.properties import Case, Property
from fuzz.session import Report, run_round


def for_ever(_case: object = None) -> None:
    while True:
        pass


def test_what_takes_too_long_is_ended():
    with pytest.raises(TooSlow, match="no answer after 0.05 seconds"), time_limit(0.05):
        for_ever()
    # Nothing comes later.
    sum(range(1_000_000))


def test_what_is_fast_enough_is_not():
    with time_limit(5.0):
        assert sum(range(1000)) == 499500


def test_other_threads_have_no_limit():
    done = []

    def work() -> None:
        with time_limit(0.001):
            done.append(sum(range(300_000)))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done


def stuck_on_lambda(case: Case) -> None:
    if "lambda" in case.text:
        for_ever()


def test_a_run_finds_it_once(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(session, "time_limit", lambda: limits.time_limit(0.02))
    monkeypatch.setattr(session, "_LONGEST", 1.0)
    report = Report()
    run_round(
        report,
        seed_of_round=0,
        until=math.inf,
        programs=60,
        mutants=0,
        formulas=0,
        of_programs=(Property.of(stuck_on_lambda),),
    )
    [failure] = report.failures
    assert failure.signature[:2] == ("stuck_on_lambda", "TooSlow")
    assert "lambda" in failure.text
    assert sum(report.repeated.values()) > 0
