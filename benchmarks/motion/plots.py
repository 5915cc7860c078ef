"""Plots of runs: speed, distance from the centerline and lateral acceleration over time."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.motion.figures import Run

__all__ = ["plot"]


def plot(runs: Sequence[Run], file: Path) -> None:
    """Draw runs into a PNG file."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(3, 1, figsize=(14, 9), sharex=True)
    for run in runs:
        course, lines = run.course, run.lines
        moments = np.arange(len(course.places)) * course.step
        axes[0].plot(moments[1:], course.speeds, lw=0.8)
        axes[1].plot(moments, lines.away(course.places, lines.indices(course.places)), lw=0.8)
        axes[2].plot(moments[1:-1], course.accelerations[0], lw=0.8)
    labels = "speed, m/s", "distance from centerline, m", "lateral acceleration, m/s²"
    for axis, label in zip(axes, labels, strict=True):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    figure.tight_layout()
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=70)
    pyplot.close(figure)
