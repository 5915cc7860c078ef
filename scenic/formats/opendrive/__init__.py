"""Road maps in the OpenDRIVE format: from text to records, and the curves of reference lines."""

from importlib import import_module
from typing import Any


class OpenDriveWarning(UserWarning):
    """A problem of a map that was set right."""


def __getattr__(name: str) -> Any:
    # The established place of a class that needs networks, which this layer knows nothing of.
    if name == "OpenDriveWorkspace":
        return import_module("scenic.domains.driving.opendrive_workspace").OpenDriveWorkspace
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
