"""Compiled modules of SciPy without the package around them, which takes two to three times as long to import as NumPy."""

import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

__all__ = ["compiled_part"]


def compiled_part(package: str, module: str, names: Sequence[str], fallback: str = "") -> Any:
    """Return a compiled module of a package of SciPy, or a public module where SciPy is laid out otherwise.

    Args:
        package: full name of the package, such as ``scipy.special``.
        module: name of the compiled module within it.
        names: functions that the module has to have.
        fallback: full name of the public module with the same functions; the package by default.

    """
    if package not in sys.modules:
        import scipy

        # The package's own module would import everything; this one only says where its parts are.
        stub = ModuleType(package)
        stub.__path__ = [str(Path(scipy.__file__).parent.joinpath(*package.split(".")[1:]))]
        sys.modules[package] = stub
        try:
            functions = import_module(f"{package}.{module}")
            if all(hasattr(functions, name) for name in names):
                return functions
        except ImportError:
            pass
        finally:
            del sys.modules[package]
    return import_module(fallback or package)
