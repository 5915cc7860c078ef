"""Diagnostics while a program is typed, key by key: ``python -m benchmarks.typing``.

Each phrase is typed at its place in a right program, one character after another; each state is checked as an editor would. A
state is spoilt if an error is shown on a line that is not being typed, or if a name is called undefined that lies in an
unclosed string. Then lines of the programs in ``tests/data/recovery`` are deleted and typed again.

``--show N`` prints the first N spoilt states.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, field
from random import Random

from benchmarks.planting import base_programs
from scenic.compiler.check import check_text
from scenic.language.diagnostics import Diagnostic, Severity
from scenic.project.index import Project
from scenic.project.surroundings import surroundings_in

__all__ = ["PHRASES", "Score", "main", "measure"]

CURSOR = "|"
RETYPED = 60
UNSUPPORTED = "SC900"

_BEFORE = "param time = 3\nclass Car(Object):\n    speed: 5\nego = new Car\n"
_AFTER = "other = new Car left of ego by 3\nrequire other.speed > 2\n"
_BEHAVIOR = "behavior Drive(speed):\n    take speed\n    |\n    wait\n"
_TRY = "behavior Drive(speed):\n    try:\n        take speed\n    |\n    interrupt when speed > 1:\n        wait\n"
_SCENARIO = "scenario Main():\n    setup:\n        ego = new Object\n        |\n    compose:\n        wait\n"

_AT_TOP = (
    "new Car left of ego by 2, facing toward (1, 2, 3)",
    "new Car ahead of ego by Range(1, 3), with speed 3",
    "x = new Object at (1, 2), facing 30 deg",
    "new Car offset by 1 @ 2, facing away from ego",
    "new Car beyond ego by 3 from (1, 2), apparently facing 20 deg",
    "new Car following field from ego for 3",
    "new Object on ego, with behavior None",
    "new Car visible from ego, facing directly toward ego",
    "require ego can see other",
    "require always ego.speed > 2 and eventually ego.speed < 3",
    "require[0.5] distance from ego to other < 20",
    "require (relative heading of ego from other) > 30 deg",
    "require not ego can see other as hidden",
    "param weather = 'sunny', count = 3",
    "record ego.position every 2 steps as trace",
    "record initial ego.speed as start",
    "terminate when ego.speed > 3",
    "terminate after 30 seconds",
    "mutate ego by 2",
    "model scenic.simulators.newtonian.driving_model",
    "from math import sin as sine, cos",
    "import random as chance",
    "x = Uniform(1, 2, 3) + Normal(0, 1)",
    "names = ['one', \"two\", f'{ego.speed} three']",
    "text = 'the car drives on, says undefined'",
    "text = f'the car {ego.speed:.2f} drives'",
    '"""A text that mentions undefined names."""',
    "def area(width, length=3): return width * length",
    "class Truck(Car): pass",
    "total = sum(x * 2 for x in [1, 2, 3] if x > 1)",
    "points = {'a': 1, 'b': [2, 3]}",
    "y = 3 if time_of_day == 2 else 4",
    "z = (ego.position, other_value)",
    "for i in range(3): new Object at (i, 3)",
    "if True: x = 3",
    "while False: pass",
    "assert ego.speed == 5, 'not five'",
    "print(ego.position, ego.speed)",
    "ego.speed = 3",
    "simulator DummySimulator()",
    "q = front left of ego",
    "v = ego offset along 30 deg by 1 @ 2",
    "w = altitude from ego to other",
    "workspace = Workspace(everywhere)",
    "# a comment, with (brackets and 'quotes",
)
_IN_BEHAVIOR = (
    "do Drive(3) for 3 seconds",
    "do choose Drive(1), Drive(2)",
    "do shuffle {Drive(1): 2, Drive(2): 3}",
    "do Drive(1) until self.speed > 3",
    "wait for 3 seconds",
    "wait until self.speed > 3",
    "take speed, 3",
    "terminate simulation",
    "override ego with speed 3",
    "if self.speed > 3: terminate",
    "while self.speed > 3: wait",
)
_IN_TRY = ("interrupt when speed > 3: wait", "except ValueError: wait")
_IN_SETUP = ("monitor Watch(): wait", "require monitor Watch()")


def _states() -> Iterator[tuple[str, int, int]]:
    """Each state of each phrase: the text, and the first and last line that are being typed."""
    for phrase in _AT_TOP:
        yield from _typed(_BEFORE, phrase, _AFTER)
    for frame, phrases in ((_BEHAVIOR, _IN_BEHAVIOR), (_TRY, _IN_TRY), (_SCENARIO, _IN_SETUP)):
        before, after = frame.split(CURSOR)
        if frame is not _SCENARIO:
            before = _BEFORE + before
        for phrase in phrases:
            yield from _typed(before, phrase, after)


def _typed(before: str, phrase: str, after: str) -> Iterator[tuple[str, int, int]]:
    line = before.count("\n") + 1
    for length in range(1, len(phrase) + 1):
        newline = "" if after.startswith("\n") else "\n"
        yield before + phrase[:length] + newline + after, line, line


PHRASES = len(_AT_TOP) + len(_IN_BEHAVIOR) + len(_IN_TRY) + len(_IN_SETUP)


@dataclass(slots=True)
class Score:
    """Counts of all states, and the states that were spoilt."""

    states: int = 0
    spoilt: list[str] = field(default_factory=list)

    @property
    def share(self) -> float:
        """The share of the states that were spoilt."""
        return len(self.spoilt) / max(1, self.states)

    def count(
        self, text: str, first: int, last: int, accepted: frozenset[tuple[str, str]] = frozenset()
    ) -> None:
        """Check a state; ``accepted`` are the diagnostics of the right program."""
        self.states += 1
        wrong = [
            each
            for each in _check(text)
            if _is_error(each)
            and each.span is not None
            and not first <= each.span.line <= last
            and (each.code, each.message) not in accepted
        ]
        if wrong:
            lines = text.split("\n")
            said = "".join(
                f"   {each.span.line}: {each.code} {each.message}\n" for each in wrong if each.span
            )
            self.spoilt.append(f"{first}: {lines[first - 1]}\n{said}")


_SURROUNDINGS = surroundings_in(Project())


def _check(text: str) -> tuple[Diagnostic, ...]:
    """Return the diagnostics that an editor shows."""
    return check_text(text, filename="/nowhere/typed.scenic", surroundings_of=_SURROUNDINGS)


def _is_error(each: Diagnostic) -> bool:
    return each.severity is Severity.ERROR and each.code != UNSUPPORTED


def measure(seed: int) -> tuple[Score, Score, int]:
    """The scores of the phrases and of the lines typed again, and how often a name in an open string was reported."""
    phrases = Score()
    named = 0
    for text, first, last in _states():
        phrases.count(text, first, last)
        line = text.split("\n")[first - 1]
        if line.count("'") % 2 or line.count('"') % 2:
            start = min(place for place in (line.find("'"), line.find('"')) if place >= 0)
            named += any(
                each.code == "SC202"
                and each.span is not None
                and each.span.line == first
                and each.span.column > start
                for each in _check(text)
            )
    return phrases, _retyped(seed), named


def _retyped(seed: int) -> Score:
    score = Score()
    random = Random(seed)
    programs = base_programs()
    for number in range(RETYPED):
        program = programs[number % len(programs)]
        accepted = frozenset((each.code, each.message) for each in _check(program.text) if _is_error(each))
        logical = random.choice([each for each in program.logical if each.first == each.last])
        line = program.lines[logical.first - 1]
        # Without the header of a block, or in the middle of one list of specifiers, the lines after it are wrong indeed.
        text = line.strip()
        if text.endswith((":", ",")):
            continue
        for length in range(1, len(text) + 1):
            lines = list(program.lines)
            lines[logical.first - 1] = line[: len(line) - len(line.lstrip())] + text[:length]
            score.count("\n".join(lines) + "\n", logical.first, logical.first, accepted)
    return score


def main() -> None:
    """Print the scores."""
    parser = argparse.ArgumentParser(description="errors on other lines while a line is typed")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", type=int, default=0, help="print so many spoilt states")
    arguments = parser.parse_args()
    phrases, retyped, named = measure(arguments.seed)
    for title, score in ((f"{PHRASES} phrases", phrases), ("lines typed again", retyped)):
        print(
            f"{title}: {len(score.spoilt)} of {score.states} states show an error elsewhere ({score.share:.2%})"
        )
    print(f"names reported in unclosed strings: {named}")
    for each in [*phrases.spoilt, *retyped.spoilt][: arguments.show]:
        print(each, end="")


if __name__ == "__main__":
    main()
