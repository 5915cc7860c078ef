"""What does not end is a failure."""

import signal
import threading
import time

import pytest

from fuzz.limits import TookTooLongError, limited
from fuzz.properties import Case, Property
from fuzz.session import fault_of, signature_of

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no timer to limit it with")


def go_on() -> None:
    while True:
        # What catches everything must not catch the end.
        try:
            sum(range(1000))
        except Exception:  # noqa: BLE001
            pytest.fail("the end was caught")


def test_what_takes_too_long_is_ended():
    with pytest.raises(TookTooLongError), limited(0.05):
        go_on()


def test_what_ends_in_time_is_left_alone():
    before = signal.getsignal(signal.SIGVTALRM)
    with limited(0.2):
        assert signal.getsignal(signal.SIGVTALRM) != before
    assert signal.getsignal(signal.SIGVTALRM) == before
    assert signal.getitimer(signal.ITIMER_VIRTUAL) == (0.0, 0.0)
    until = time.process_time() + 0.3
    while time.process_time() < until:
        pass


def test_only_processor_time_counts():
    with limited(0.05):
        time.sleep(0.2)


def test_nothing_is_limited_in_other_threads():
    done: list[bool] = []

    def work() -> None:
        with limited(0.01):
            until = time.process_time() + 0.1
            while time.process_time() < until:
                pass
        done.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [True]


def test_a_property_that_does_not_end_fails_like_others():
    def ends(_case: Case) -> None:
        while True:
            pass

    error = fault_of(Property.of(ends), Case("x\n"), seconds=0.05)
    assert isinstance(error, TookTooLongError)
    assert signature_of("ends", error) == ("ends", "TookTooLongError", "it does not end")
    assert fault_of(Property.of(ends, one_in=1 << 40), Case("x\n")) is None
