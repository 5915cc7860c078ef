"""Quality of motion: what cars do on maps, measured against bounds (``python -m benchmarks.motion --help``)."""

from benchmarks.motion.courses import Course

__all__ = ["Course"]
