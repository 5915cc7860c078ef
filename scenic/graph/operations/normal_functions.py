"""SciPy's functions of the normal law, without the rest of `scipy.special`, which takes twice as long to import as NumPy."""

import sys
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, Final

__all__ = ["log_ndtr", "ndtr", "ndtri", "ndtri_exp"]

_PACKAGE: Final = "scipy.special"


@cache
def _functions() -> Any:
    """Return the module of compiled functions, or the package where SciPy is laid out otherwise."""
    if _PACKAGE not in sys.modules:
        import scipy

        # The package's own module would import everything; this one only says where its parts are.
        package = ModuleType(_PACKAGE)
        package.__path__ = [str(Path(scipy.__file__).parent / "special")]
        sys.modules[_PACKAGE] = package
        try:
            functions = import_module(f"{_PACKAGE}._ufuncs")
            if all(hasattr(functions, name) for name in __all__):
                return functions
        except ImportError:
            pass
        finally:
            del sys.modules[_PACKAGE]
    return import_module(_PACKAGE)


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
