"""Models of cars, as toolkits import them; one of an ordinary size stands for all, since the game is not needed to sample."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

__all__ = ["CarModel"]


class _Models:
    """The models by name, as an attribute of their class."""

    def __get__(self, _instance: object, owner: type["CarModel"]) -> Mapping[str, "CarModel"]:
        return MappingProxyType({"CAR": owner("CAR")})


@dataclass(frozen=True)
class CarModel:
    """A model of a car; lengths in metres."""

    models = _Models()
    name: str
    width: float = 1.8
    length: float = 4.5
