"""Trials in processes: no program takes the others, or the caller, along with it."""

import mmap
import multiprocessing
import sys

import pytest

from scenic.trying.answer import Limits, Trial
from scenic.trying.trial_processes import tried

PROGRAMS = (
    "import os\nos._exit(3)\n",
    "while True: pass\n",
    "print('a line')\nego = new Object\n",
    "import os\nos.chdir('/')\nos.close(1)\nego = new Object\n",
    "ego = new Object\nx = bytearray(9 << 30)\n",
    "import sys\nsys.exit(3)\n",
    "ego = new Object\nx = input()\n",
)


def test_programs_that_misbehave() -> None:
    limits = Limits(seconds=4.0, memory=3 << 30)
    trials = [Trial(text, f"{number}.scenic", limits=limits) for number, text in enumerate(PROGRAMS)]
    answers = list(tried(trials, 2))
    assert [each["file"] for each in answers] == [f"{number}.scenic" for number in range(len(PROGRAMS))]
    codes = [
        [item["code"] for item in each["diagnostics"] if item["severity"] == "error"] for each in answers
    ]
    assert codes == [["SC610"], ["SC608"], [], [], ["SC610"], ["SC401"], ["SC400"]]
    assert answers[2]["output"] == "a line\n"
    assert answers[1]["diagnostics"][-1]["span"]["line"] == 1
    assert not multiprocessing.active_children()


@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux only")
def test_memory_of_the_caller_is_not_counted() -> None:
    limits = Limits(memory=3 << 30)
    with mmap.mmap(-1, limits.memory, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, prot=mmap.PROT_READ):
        [found] = tried([Trial("ego = new Object\n", "small.scenic", limits=limits)])
    assert found["ok"], found["diagnostics"]
