"""Our results beside those of the reference implementation, recorded in ``data/reference``.

Programs with one possible result must agree within rounding; the parameters of the others are compared law by law, by the
two-sample Kolmogorov-Smirnov test at the false-alarm rate `FALSE_ALARM` each. Wanted differences carry the tag of the
specification, and must be there.
"""

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

import scenic
from tests.record_reference import DIGITS
from tests.reference_programs import DRAWN, FIXED
from tests.runtime.programs import FALSE_ALARM

DATA = Path(__file__).parent / "data" / "reference"
RECORDED = {name: json.loads((DATA / f"{name}.json").read_text()) for name in ("fixed", "drawn")}


def test_the_recordings_are_of_these_programs() -> None:
    """Run ``python -m tests.record_reference`` after a change of the programs."""
    for name, programs in (("fixed", FIXED), ("drawn", DRAWN)):
        assert {key: entry["program"] for key, entry in RECORDED[name].items()} == {
            key: program.text for key, program in programs.items()
        }


def agrees(scene: scenic.Scene, recorded: dict[str, Any]) -> bool:
    """Whether a scene's objects and parameters are those recorded."""
    if len(scene.objects) != len(recorded["objects"]):
        return False
    for found, expected in zip(scene.objects, recorded["objects"], strict=True):
        turned = Rotation.from_euler("ZXY", [found.yaw, found.pitch, found.roll]).as_matrix()
        wanted = Rotation.from_euler("ZXY", expected["yaw_pitch_roll"]).as_matrix()
        parts = [
            # The reference has other classes of the same names in its 2D mode.
            type(found).__name__ == expected["class"].removesuffix("2D"),
            np.allclose(tuple(found.position), expected["position"], rtol=0, atol=1e-9),
            np.allclose(turned, wanted, rtol=0, atol=1e-9),
            np.isclose(np.exp(1j * found.heading), np.exp(1j * expected["heading"]), rtol=0, atol=1e-9),
            np.allclose((found.width, found.length, found.height), expected["size"], rtol=0, atol=1e-9),
        ]
        if not all(parts):
            return False
    return np.allclose(numbers(scene.params), numbers(recorded["params"]), rtol=0, atol=1e-9)


def numbers(value: Any) -> list[float]:
    """All numbers in a value, in order."""
    if isinstance(value, dict):
        return [number for key in sorted(value) for number in numbers(value[key])]
    if isinstance(value, int | float):
        return [float(value)]
    return [number for item in value for number in numbers(item)]


@pytest.mark.parametrize("name", list(FIXED))
def test_fixed_results_agree(name: str) -> None:
    program, recorded = FIXED[name], RECORDED["fixed"][name]
    error: str | None = None
    scene: scenic.Scene | None = None
    try:
        (scene,) = scenic.scenarioFromString(program.text, mode2D=program.mode_2d).sample(1, seed=0)
    except Exception as problem:  # noqa: BLE001 - which one it is, is compared
        bases = {cls.__name__ for cls in type(problem).__mro__}
        error = recorded.get("error") if recorded.get("error") in bases else type(problem).__name__
    same = error == recorded.get("error") and (scene is None or agrees(scene, recorded))
    assert same == (program.differs is None), error


@pytest.mark.parametrize("name", list(DRAWN))
def test_laws_agree(name: str) -> None:
    recorded = RECORDED["drawn"][name]["params"]
    scenes = scenic.scenarioFromString(DRAWN[name].text).sample(1500, seed=1)
    drawn = {key: np.array([float(scene.params[key]) for scene in scenes]) for key in recorded}
    assert list(recorded) == list(scenes[0].params)
    for key, expected in recorded.items():
        # Ties at the ends of a rounded recording must not count.
        found = np.round(drawn[key], DIGITS)
        assert stats.ks_2samp(found, expected).pvalue > FALSE_ALARM, key
    # The dependence of the parameters, through the sums of neighbours.
    keys = list(recorded)
    for first, second in itertools.pairwise(keys):
        found = drawn[first] + 0.7 * drawn[second]
        expected = np.array(recorded[first]) + 0.7 * np.array(recorded[second])
        assert (
            stats.ks_2samp(np.round(found, DIGITS - 1), np.round(expected, DIGITS - 1)).pvalue > FALSE_ALARM
        ), (first, second)
