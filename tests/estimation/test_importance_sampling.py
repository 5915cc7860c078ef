"""Importance sampling: weights that make up for where runs are drawn, and searches that cannot be followed."""

from pathlib import Path
from typing import Any

import pytest

import scenic
from scenic.estimation.estimate import Estimate
from scenic.estimation.importance_sampling import FollowError
from scenic.estimation.sentences import notes
from scenic.falsification.replaying import kept_run, replay

TAIL = """
xs = [Normal(0, 1) for i in range(2)]
param beyond = 2.326348 - sum(xs) / 2 ** 0.5
ego = new Object
"""
HALF = f"{TAIL}\nrequire xs[0] > xs[1]"
"""Symmetric: the requirement changes nothing about the probability, 0.01, but half of the candidates are no scenes."""


def searched(text: str, folder: Path, **options: Any) -> Path:
    wanted = {"objective": "beyond", "static": True, "seed": 1, "n": 1500, "sampler": "ce", **options}
    scenic.falsify(scenic.scenarioFromString(text), folder=folder, **wanted)
    return folder


def followed(text: str, search: Path, **options: Any) -> Estimate:
    scenario = scenic.scenarioFromString(text)
    return scenic.estimate(
        scenario, objective="beyond", static=True, follow=search, **{"seed": 2, "n": 6000, **options}
    )


@pytest.mark.parametrize("text", [TAIL, HALF])
def test_a_search_is_followed(tmp_path: Path, text: str) -> None:
    result = followed(text, searched(text, tmp_path / "search"), folder=tmp_path / "kept")
    low, high = result.interval
    assert low < 0.01 < high
    assert high / low < 3
    assert result.violations > 50
    assert any("count as" in note for note in notes(result))
    whole = followed(text, tmp_path / "search")
    assert whole.rows == result.rows
    assert replay(kept_run(tmp_path / "kept", 3), scenic.scenarioFromString(text)).departures == []


def test_too_few_effective_counterexamples_give_no_estimate(tmp_path: Path) -> None:
    result = followed(TAIL, searched(TAIL, tmp_path / "search"), n=20)
    assert result.interval == (0, 1)
    assert not result.is_finished
    assert any("there is no estimate" in note for note in notes(result))


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (TAIL, {"sampler": "random"}, "the sampler random"),
        (TAIL, {"n": 16}, "too few to follow"),
        (HALF, {}, "of another program"),
    ],
)
def test_searches_that_cannot_be_followed(
    tmp_path: Path, text: str, options: dict[str, Any], words: str
) -> None:
    folder = searched(text, tmp_path / "search", **{"n": 60, **options})
    with pytest.raises(FollowError, match=words):
        followed(TAIL, folder)
