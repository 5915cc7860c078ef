"""What is known of requirements before anything is sampled: how far the draws are narrowed, what is told."""

import numpy as np
import pytest

import scenic
from scenic.analysis.fact_diagnostics import prove
from scenic.narrowing import conditions
from tests.recorded import FOLDER, hold, said, shown


def answer(source: str) -> str:
    """For each condition below a line of ``?``: the boxes of the draws that are left, and what is told of contradictions."""
    program, _, asked = source.partition("\n?\n")
    return "\n".join(f"{line} -> {known(program, line)}" for line in asked.strip("\n").split("\n"))


def known(program: str, line: str) -> str:
    try:
        scenario = scenic.scenarioFromString(f"{program}\n{line}\n")
    except Exception as error:  # noqa: BLE001 - what is said of it is the answer
        return said(error)
    domain = scenario.domain
    (lower,), (upper,) = domain.hull
    ends = [
        f"axis {axis} from {shown(float(lower[axis]))} to {shown(float(upper[axis]))}"
        for axis in np.flatnonzero((lower > 0) | (upper < 1)).tolist()
    ]
    lines = [", ".join([f"{shown(domain.volume)} of all", *ends])]
    for found in prove(scenario.outline.graph, conditions(scenario.outline)):
        lines.append(f"  {found.code} {found.message}")
        lines += [f"    {label.text}" for label in found.labels]
    return "\n".join(lines)


def test_what_is_known(request: pytest.FixtureRequest) -> None:
    hold(FOLDER / "analysis.txt", answer, request)
