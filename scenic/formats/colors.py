"""Between sRGB, in which colours are written, and linear light, in which they add up (IEC 61966-2-1)."""

from typing import Any, Final

import numpy as np
import numpy.typing as npt

_STEPS: Final = 4095


def linear(srgb: npt.ArrayLike) -> npt.NDArray[np.float32]:
    """Return components in sRGB, in [0, 1], as linear light."""
    values = np.asarray(srgb, np.float32)
    high = ((np.maximum(values, 0) + 0.055) / 1.055) ** 2.4
    return np.where(values <= 0.04045, values / 12.92, high).astype(np.float32)


def encoded(light: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Return linear light as 8-bit sRGB; finer steps than eight bits can show are lost, so that a table gives the values."""
    values = np.arange(_STEPS + 1) / _STEPS
    # Steps are even in the square root of light, which is close to how sRGB spaces them.
    values = values * values
    srgb = np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055)
    table = (srgb * 255 + 0.5).astype(np.uint8)
    index = np.sqrt(np.clip(light, 0.0, 1.0))
    index *= np.float32(_STEPS)
    index += np.float32(0.5)
    result: npt.NDArray[np.uint8] = table[index.astype(np.uint16)]
    return result


def decoded(srgb: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Return 8-bit sRGB as linear light."""
    return linear(np.arange(256) / 255)[srgb]
