"""Recorded values as data of files: JSON, arrays of numbers, images."""

from typing import Any

import numpy as np

from scenic.language.errors import ScenicValueError
from scenic.runtime.ground.context import here

__all__ = ["as_array", "as_pixels", "plain"]


def plain(value: Any) -> Any:
    """Return a recorded value as data of JSON: numbers, text, lists and dictionaries; anything else as text."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list | set | frozenset) or hasattr(value, "toVector"):
        items = value.toVector() if hasattr(value, "toVector") else value
        return [plain(item) for item in items]
    if all(hasattr(value, name) for name in "xyzw"):
        return [value.x, value.y, value.z, value.w]
    return repr(value)


def as_array(value: object) -> Any:
    try:
        array = value if isinstance(value, np.ndarray) else np.asarray(plain(value))
    except ValueError:  # lists of different lengths
        array = None
    if array is None or array.dtype == object:
        raise ScenicValueError("only numbers can be recorded as an array", span=here())
    return array


def as_pixels(value: object) -> Any:
    """Return an image as bytes: intensities or RGB, integers from 0 to 255 or floats from 0 to 1; what lies beyond is cut off."""
    array = np.asarray(value)
    if not (array.ndim == 2 or (array.ndim == 3 and array.shape[2] in (3, 4))):
        raise ScenicValueError(
            f"an image is an array of shape (height, width) or (height, width, 3), not {array.shape}",
            span=here(),
        )
    if np.issubdtype(array.dtype, np.floating):
        array = np.round(np.nan_to_num(np.clip(array, 0, 1)) * 255)
    return (array if array.dtype == np.uint8 else np.clip(array, 0, 255)).astype(np.uint8)
