"""The vehicles that come with Webots, by the names of their PROTO files.

The sizes of the first nine are those that established programs use; the others are those of their makers, in metres.
"""

from typing import Final

from scenic.dataclass import dataclass

__all__ = ["CarModel", "carModels", "modelWithName", "smallVehicles"]


@dataclass(frozen=True, slots=True)
class CarModel:
    """A model of a vehicle; lengths in metres."""

    name: str
    width: float
    length: float


carModels: Final = (  # noqa: N816 - the established name
    CarModel("BmwX5", 2.0, 4.75),
    CarModel("Bus", 3.0, 10.0),
    CarModel("CitroenCZero", 1.5, 3.5),
    CarModel("LincolnMKZ", 1.9, 5.0),
    CarModel("MotorBikeSimple", 1.0, 2.5),
    CarModel("RangeRoverSportSVR", 1.9, 4.5),
    CarModel("ToyotaPrius", 1.9, 4.5),
    CarModel("Tractor", 2.0, 3.0),
    CarModel("Truck", 2.7, 14.5),
    CarModel("MercedesBenzSprinter", 1.993, 5.926),
    CarModel("TeslaModel3", 1.849, 4.694),
)

modelWithName: Final = {model.name: model for model in carModels}  # noqa: N816 - the established name

smallVehicles: Final = tuple(  # noqa: N816 - the established name
    modelWithName[name]
    for name in ("BmwX5", "CitroenCZero", "LincolnMKZ", "RangeRoverSportSVR", "ToyotaPrius")
)
"""Passenger cars."""
