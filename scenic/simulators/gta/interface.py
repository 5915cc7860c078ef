"""Models of cars, as toolkits import them; one of an ordinary size stands for all, since the game is not needed to sample."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

__all__ = ["CarModel"]


@dataclass(frozen=True)
class CarModel:
    """A model of a car; lengths in metres."""

    models: ClassVar[Mapping[str, "CarModel"]]
    name: str
    width: float = 1.8
    length: float = 4.5


CarModel.models = MappingProxyType({"CAR": CarModel("CAR")})
