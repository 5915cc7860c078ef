"""Models of cars, as toolkits import them. Sizes are nominal, since the game is not needed to sample."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.runtime.values.distributions import Discrete, Uniform

__all__ = ["CarModel"]

_SIZES: Final = {
    "BLISTA": (1.8, 4.0),
    "BUS": (2.7, 12.0),
    "NINEF": (2.0, 4.5),
    "ASEA": (1.8, 4.4),
    "BALLER": (2.1, 4.9),
    "BISON": (2.1, 5.6),
    "BUFFALO": (2.0, 5.0),
    "BOBCATXL": (2.1, 5.7),
    "DOMINATOR": (1.9, 4.8),
    "GRANGER": (2.1, 5.6),
    "JACKAL": (1.9, 4.8),
    "ORACLE": (1.9, 5.0),
    "PATRIOT": (2.2, 5.3),
    "PRANGER": (2.1, 5.6),
}
"""Width and length in metres by the game's name."""
_RARE: Final = frozenset({"BUS", "PRANGER"})
"""Models that are a tenth as frequent as others."""


class _Models:
    """The models by name, as an attribute of their class."""

    def __get__(self, _instance: object, owner: type["CarModel"]) -> Mapping[str, "CarModel"]:
        return MappingProxyType({name: owner(name, *size) for name, size in _SIZES.items()})


@dataclass(frozen=True)
class CarModel:
    """A model of a car; lengths in metres."""

    models = _Models()
    name: str
    width: float = 1.8
    length: float = 4.5

    @classmethod
    def uniformModel(cls) -> Any:
        """Return one of the models, each as likely."""
        return Uniform(*cls.models.values())

    @classmethod
    def defaultModel(cls) -> Any:
        """Return one of the models; rare ones are rare."""
        return Discrete({model: 0.1 if name in _RARE else 1 for name, model in cls.models.items()})

    @classmethod
    def egoModel(cls) -> "CarModel":
        """Return the model of the car that takes pictures."""
        return cls.models["BLISTA"]
