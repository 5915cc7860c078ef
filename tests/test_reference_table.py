"""Many small programs over the tables of the language, beside what the reference implementation makes of them.

The programs and results are in ``data/reference/table.json``; `tests.record_table` records the results anew. A program that
names a difference must differ: each is one that the specification wants.
"""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

import scenic
from scenic.runtime.values.values import Orientation
from tests.each import each
from tests.runtime.programs import FALSE_ALARM

DATA: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "reference" / "table.json").read_text())
PROGRAMS: dict[str, dict[str, Any]] = DATA["programs"]
CLOSE = 1e-6


def observed(value: Any) -> Any:
    """A sampled value as plain data, in the form of the recordings."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.generic):
        return float(value)
    if isinstance(value, dict):
        return {str(key): observed(item) for key, item in value.items()}
    if isinstance(value, Orientation):
        sign = 1 if value.w >= 0 else -1
        return {"q": [sign * part for part in (value.x, value.y, value.z, value.w)]}
    if hasattr(value, "position") and hasattr(value, "orientation"):
        return {"position": observed(value.position), "orientation": observed(value.orientation)}
    try:
        return [observed(item) for item in value]
    except TypeError:
        return type(value).__name__


def close(first: Any, second: Any) -> bool:
    if isinstance(first, int | float) and isinstance(second, int | float):
        return bool(abs(first - second) < CLOSE * (1 + abs(first)) or first == second)
    if isinstance(first, dict) and isinstance(second, dict):
        return first.keys() == second.keys() and all(close(first[key], second[key]) for key in first)
    if isinstance(first, list) and isinstance(second, list):
        return len(first) == len(second) and all(map(close, first, second))
    return bool(first == second)


def numbers(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [number for key in sorted(value) for number in numbers(value[key])]
    if isinstance(value, list):
        return [number for item in value for number in numbers(item)]
    return [round(float(value), 9)]  # so that values which differ by rounding alone are the same


def same_laws(first: list[Any], second: list[Any]) -> bool:
    """Whether two samples come from the same law, number by number."""
    one, two = (np.array([numbers(row) for row in rows]) for rows in (first, second))
    return one.shape[1] == two.shape[1] and all(
        np.allclose(a, b.mean(), atol=CLOSE)
        if np.ptp(a) < CLOSE
        else stats.ks_2samp(a, b).pvalue > FALSE_ALARM
        for a, b in zip(one.T, two.T, strict=True)
    )


@pytest.mark.slow
@each(PROGRAMS)
def test_results_agree(name: str) -> None:
    entry = PROGRAMS[name]
    text = entry["program"].replace("{SETTING}", DATA["setting"])
    count = entry.get("scenes", 1)
    error, found = None, []
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = [
                observed(scene.params) for scene in scenic.scenarioFromString(text).sample(count, seed=0)
            ]
    except Exception as problem:  # noqa: BLE001 - which one it is, is compared
        error = problem
    if "error" in entry:
        agrees = entry["error"] in {cls.__name__ for cls in type(error).__mro__}
    elif error is not None:
        agrees = False
    elif count > 1:
        agrees = same_laws(entry["params"], found)
    else:
        agrees = close(entry["params"], found[0])
    assert agrees == ("differs" not in entry), (error, found[:1], entry.get("params"))


def test_the_table_is_large() -> None:
    assert len(PROGRAMS) >= 250
