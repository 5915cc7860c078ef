"""Curves through bends that are sharper than a car drives."""

import math
from pathlib import Path

import numpy as np
import pytest

from scenic.domains.driving import tight_bends
from scenic.domains.driving.path_smoothing import curvatures_of, resampled, smoothed


def bend(radius: float, angle: float) -> np.ndarray:
    """A line of 30 m, an arc, and a line of 30 m."""
    turns = np.linspace(0.0, angle, 30)
    arc = np.column_stack([radius * np.sin(turns), radius * (1 - np.cos(turns))])
    out = np.array([math.cos(angle), math.sin(angle)])
    return np.vstack([[-30.0, 0.0], arc, arc[-1] + 30 * out])


@pytest.mark.parametrize(("radius", "most"), [(3.0, 0.4), (3.5, 0.35), (4.0, 0.3), (4.5, 0.25)])
@pytest.mark.parametrize("angle", [70, 90, -90])
def test_paths_swing_out_and_cut_alike(radius: float, most: float, angle: float) -> None:
    line = bend(radius, math.radians(abs(angle))) * [1.0, math.copysign(1.0, angle)]
    points = resampled(line)
    curve = smoothed(points)
    assert np.abs(curvatures_of(curve)).max() < 0.205
    away = np.hypot(*(curve[:, None] - resampled(line, 0.02)[None]).transpose(2, 0, 1)).min(axis=1)
    assert away.max() < most
    # Far from the bend nothing moves.
    assert away[:25].max() < 0.05


def test_change_of_curvature_is_bounded() -> None:
    curve = smoothed(resampled(bend(3.5, math.pi / 2)))
    assert np.abs(np.diff(curvatures_of(curve))).max() / 0.5 < 0.14


def test_curves_are_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SCENIC_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("SCENIC_CACHE", raising=False)
    points = resampled(bend(3.5, math.pi / 2))
    first = smoothed(points)
    monkeypatch.setattr(tight_bends, "_bend", lambda *given: pytest.fail("it has been computed again"))
    assert (smoothed(points) == first).all()
    # Another line is another curve, whatever is kept.
    with pytest.raises(pytest.fail.Exception):
        smoothed(points + 0.25)
