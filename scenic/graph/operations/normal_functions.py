"""SciPy's functions of the normal law, without the rest of `scipy.special`, which takes twice as long to import as NumPy."""

from functools import cache
from typing import Any

from scenic.graph.scipy_parts import compiled_part

__all__ = ["log_ndtr", "ndtr", "ndtri", "ndtri_exp"]


@cache
def _functions() -> Any:
    return compiled_part("scipy.special", "_ufuncs", __all__)


def ndtr(value: Any) -> Any:
    """Return the distribution function of the standard normal law."""
    return _functions().ndtr(value)


def ndtri(probability: Any) -> Any:
    """Return the inverse of `ndtr`."""
    return _functions().ndtri(probability)


def log_ndtr(value: Any) -> Any:
    """Return the logarithm of `ndtr`."""
    return _functions().log_ndtr(value)


def ndtri_exp(logarithm: Any) -> Any:
    """Return the inverse of `log_ndtr`."""
    return _functions().ndtri_exp(logarithm)
