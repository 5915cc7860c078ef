"""Bounds and inverse readings of every operation over boxes give what was recorded, nearly to the last digit.

That they enclose all values is tested elsewhere; here, that they are as narrow as they were, with the margins they had.
"""

import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from graph.programs import Case, draw, random_bounds
from graph.readings import CASES, bounds_of, has, narrowed
from tests.recorded import FOLDER, hold

BOXES = 6


def boxes_of(case: Case) -> Iterator[list[tuple[Any, Any]]]:
    """Boxes of the operands of a case: of all sizes, single values, the whole unit interval."""
    rng = np.random.default_rng(zlib.crc32(str(case).encode()))
    for number in range(BOXES):
        known = [random_bounds(part, rng) for part in case.operands]
        ends = [(each.lower[0], each.upper[0]) for each in known]
        if number == 1:
            ends = [(np.minimum(low, -np.abs(high)), high) for low, high in ends]
        elif number == 2:
            ends = [(low, high + 1.0) for low, high in ends]
        yield [
            (0.0, 1.0) if part == "axis" and number == 3 else end
            for part, end in zip(case.operands, ends, strict=True)
        ]


def text(box: tuple[Any, Any]) -> str:
    low, high = (np.ravel(end).astype(float) + 0.0 for end in box)
    return " ".join(f"{a!r} to {b!r}" for a, b in zip(low.tolist(), high.tolist(), strict=True))


def reading(case: Case) -> str:
    rng = np.random.default_rng(1)
    columns = [draw(part, 2, rng) for part in case.operands]
    lines = []
    for boxes in boxes_of(case):
        lines.append(", ".join(map(text, boxes)))
        low, high = bounds_of(case, columns, boxes)
        lines.append(f"  gives {text((low, high))}")
        if not has(case, "inverse"):
            continue
        with np.errstate(invalid="ignore"):
            middle = np.clip((low + high) / 2, -1e9, 1e9)
        results = ((low, middle), (middle, middle), (middle + 0.25, high + 0.5))
        lines += [
            f"  {text(result)} from {', '.join(map(text, narrowed(case, result, boxes)))}"
            for result in results
        ]
    return "\n".join(lines)


def test_readings(request: pytest.FixtureRequest) -> None:
    cases = {str(case): case for case in CASES if has(case, "bounds")}
    path = FOLDER / "readings.txt"
    if request.config.getoption("--update-golden"):
        path.write_text("".join(f"== {name}\n{name}\n--\n\n" for name in cases))
    with np.errstate(all="ignore"):
        hold(path, lambda source: reading(cases[source.strip()]), request, rounding=1e-12)
    assert sum(line.startswith("== ") for line in path.read_text().splitlines()) == len(cases)
