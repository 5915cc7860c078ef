"""The cars that come with Webots, by the names of their PROTO files; sizes are those of their makers."""

from typing import Final

from scenic.dataclass import dataclass

__all__ = ["CarModel", "carModels", "modelWithName"]


@dataclass(frozen=True, slots=True)
class CarModel:
    """A model of a car; lengths in metres."""

    name: str
    width: float
    length: float


carModels: Final = (  # noqa: N816 - the established name
    CarModel("BmwX5", 1.933, 4.854),
    CarModel("CitroenCZero", 1.475, 3.475),
    CarModel("LincolnMKZ", 1.864, 4.930),
    CarModel("MercedesBenzSprinter", 1.993, 5.926),
    CarModel("RangeRoverSportSVR", 1.983, 4.872),
    CarModel("TeslaModel3", 1.849, 4.694),
    CarModel("ToyotaPrius", 1.745, 4.480),
)

modelWithName: Final = {model.name: model for model in carModels}  # noqa: N816 - the established name
