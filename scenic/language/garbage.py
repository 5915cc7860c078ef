"""Pausing Python's search for garbage while much is made of which nothing is garbage."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

__all__ = ["import_lasting", "no_garbage_collection", "promote_young"]


@contextmanager
def no_garbage_collection() -> Iterator[None]:
    """For passes over trees and for objects made by the thousand: looking for garbage takes longer than they do."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def import_lasting(name: str) -> ModuleType:
    """Import a module that brings many others, and exempt all their objects from Python's garbage collector.

    With NumPy they are some forty thousand objects, which it would look through twelve times: in the midst of whatever
    the program does next.
    """
    is_known = name in sys.modules
    with no_garbage_collection():
        module = import_module(name)
    # Python counts what is frozen object by object: not for each command of a process that runs many.
    if not is_known and gc.isenabled() and not gc.get_freeze_count():
        # What is frozen is not looked at, and is old when it is thawed: an import leaves no garbage to look for.
        gc.freeze()
        gc.unfreeze()
    return module


def promote_young() -> None:
    """Exempt recent objects from Python's garbage collector, which would otherwise traverse them while the next objects are made."""
    if gc.isenabled():
        gc.collect(1)  # what is young is old from now on
