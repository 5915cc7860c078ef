"""Blueprints of CARLA's actors by category, with nominal sizes (section 1.7 of the driving specification).

Ids are those of CARLA's catalogues; sizes are width, length and height in metres of the vehicles that they model. Where the
simulator runs, its own bounding boxes count.
"""

import os
import re
from types import MappingProxyType
from typing import Any, Final

from scenic.language.errors import InvalidScenarioError
from scenic.language.spelling import nearest
from scenic.runtime.ground.context import current, here, warn
from scenic.runtime.python.opaque import call_later
from scenic.runtime.values.values import is_random, options_of, per_option

Size = tuple[float, float, float]

CATALOGUE: Final = MappingProxyType(
    {
        "car": MappingProxyType(
            {
                "vehicle.audi.a2": (1.79, 3.71, 1.55),
                "vehicle.audi.etron": (2.03, 4.86, 1.65),
                "vehicle.audi.tt": (1.99, 4.18, 1.39),
                "vehicle.bmw.grandtourer": (2.24, 4.61, 1.67),
                "vehicle.chevrolet.impala": (2.03, 5.36, 1.41),
                "vehicle.citroen.c3": (1.85, 3.99, 1.62),
                "vehicle.dodge.charger_2020": (1.92, 5.01, 1.53),
                "vehicle.dodge.charger_police": (2.04, 4.97, 1.55),
                "vehicle.dodge.charger_police_2020": (1.93, 5.24, 1.64),
                "vehicle.ford.crown": (1.80, 5.37, 1.57),
                "vehicle.ford.mustang": (1.89, 4.72, 1.30),
                "vehicle.jeep.wrangler_rubicon": (1.91, 3.87, 1.88),
                "vehicle.lincoln.mkz_2017": (2.13, 4.90, 1.51),
                "vehicle.lincoln.mkz_2020": (1.84, 4.89, 1.49),
                "vehicle.mercedes.coupe": (2.15, 5.03, 1.64),
                "vehicle.mercedes.coupe_2020": (1.81, 4.67, 1.44),
                "vehicle.micro.microlino": (1.48, 2.21, 1.38),
                "vehicle.mini.cooper_s": (1.97, 3.81, 1.48),
                "vehicle.mini.cooper_s_2021": (2.10, 4.55, 1.77),
                "vehicle.nissan.micra": (1.85, 3.63, 1.50),
                "vehicle.nissan.patrol": (1.93, 4.60, 1.85),
                "vehicle.nissan.patrol_2021": (2.15, 5.57, 2.05),
                "vehicle.seat.leon": (1.82, 4.19, 1.47),
                "vehicle.tesla.model3": (2.16, 4.79, 1.49),
                "vehicle.toyota.prius": (2.01, 4.51, 1.52),
            }
        ),
        "bicycle": MappingProxyType(
            {
                "vehicle.bh.crossbike": (0.86, 1.49, 1.62),
                "vehicle.diamondback.century": (0.58, 1.64, 1.63),
                "vehicle.gazelle.omafiets": (0.67, 1.84, 1.76),
            }
        ),
        "motorcycle": MappingProxyType(
            {
                "vehicle.harley-davidson.low_rider": (0.76, 2.35, 1.65),
                "vehicle.kawasaki.ninja": (0.80, 2.03, 1.52),
                "vehicle.vespa.zx125": (0.79, 1.80, 1.58),
                "vehicle.yamaha.yzf": (0.87, 2.21, 1.53),
            }
        ),
        "truck": MappingProxyType(
            {
                "vehicle.carlamotors.carlacola": (2.61, 5.20, 2.47),
                "vehicle.carlamotors.european_hgv": (2.90, 7.94, 3.64),
                "vehicle.carlamotors.firetruck": (2.89, 8.47, 3.83),
                "vehicle.tesla.cybertruck": (2.39, 6.27, 2.10),
            }
        ),
        "van": MappingProxyType(
            {
                "vehicle.ford.ambulance": (2.35, 6.37, 2.43),
                "vehicle.mercedes.sprinter": (1.99, 5.92, 2.56),
                "vehicle.volkswagen.t2": (2.07, 4.48, 2.04),
                "vehicle.volkswagen.t2_2021": (1.78, 4.44, 1.99),
            }
        ),
        "bus": MappingProxyType({"vehicle.mitsubishi.fusorosa": (3.94, 10.27, 4.25)}),
        "walker": MappingProxyType(
            {f"walker.pedestrian.{number:04d}": (0.5, 0.5, 1.8) for number in range(1, 50)}
        ),
        "trash": MappingProxyType(
            {f"static.prop.trashcan{number:02d}": (0.6, 0.6, 1.0) for number in range(1, 6)}
            | {"static.prop.bin": (0.6, 0.6, 1.0), "static.prop.trashbag": (0.6, 0.6, 0.7)}
        ),
        "cone": MappingProxyType(
            {
                "static.prop.constructioncone": (0.34, 0.34, 0.59),
                "static.prop.trafficcone01": (0.88, 0.88, 1.18),
            }
            | {"static.prop.trafficcone02": (0.45, 0.45, 1.18)}
        ),
        "debris": MappingProxyType(
            {f"static.prop.dirtdebris{number:02d}": (1.8, 1.8, 0.3) for number in range(1, 4)}
        ),
        "vending_machine": MappingProxyType({"static.prop.vendingmachine": (1.1, 0.9, 2.1)}),
        "chair": MappingProxyType({"static.prop.plasticchair": (0.74, 0.76, 1.28)}),
        "bus_stop": MappingProxyType({"static.prop.busstop": (1.8, 3.9, 2.7)}),
        "advertisement": MappingProxyType(
            {"static.prop.advertisement": (0.4, 1.9, 2.5), "static.prop.streetsign": (0.13, 1.25, 3.6)}
        ),
        "garbage": MappingProxyType(
            {"static.prop.colacan": (0.07, 0.07, 0.11), "static.prop.garbage01": (0.05, 0.05, 0.1)}
            | {f"static.prop.garbage{number:02d}": (0.5, 0.5, 0.1) for number in range(2, 7)}
        ),
        "container": MappingProxyType(
            {"static.prop.container": (1.9, 1.0, 1.7), "static.prop.clothcontainer": (1.9, 1.2, 1.8)}
            | {"static.prop.glasscontainer": (1.9, 1.2, 1.8)}
        ),
        "table": MappingProxyType(
            {"static.prop.table": (2.2, 2.2, 0.8), "static.prop.plastictable": (2.5, 2.5, 1.2)}
        ),
        "barrier": MappingProxyType(
            {"static.prop.streetbarrier": (0.37, 1.2, 1.1), "static.prop.chainbarrier": (0.2, 1.5, 0.9)}
            | {"static.prop.chainbarrierend": (0.2, 1.5, 0.9)}
        ),
        "plant_pot": MappingProxyType(
            {f"static.prop.plantpot{number:02d}": (0.9, 0.9, 0.8) for number in range(1, 9)}
        ),
        "mailbox": MappingProxyType({"static.prop.mailbox": (0.54, 0.5, 1.2)}),
        "gnome": MappingProxyType({"static.prop.gnome": (0.3, 0.3, 0.9)}),
        "creased_box": MappingProxyType(
            {f"static.prop.creasedbox{number:02d}": (0.7, 0.7, 0.5) for number in range(1, 4)}
        ),
        "case": MappingProxyType(
            {"static.prop.travelcase": (0.4, 0.6, 1.2), "static.prop.briefcase": (0.15, 0.45, 0.4)}
            | {"static.prop.guitarcase": (0.13, 1.24, 0.5)}
        ),
        "box": MappingProxyType({f"static.prop.box{number:02d}": (0.7, 0.7, 0.7) for number in range(1, 4)}),
        "bench": MappingProxyType(
            {f"static.prop.bench{number:02d}": (0.65, 1.55, 0.5) for number in range(1, 4)}
        ),
        "barrel": MappingProxyType({"static.prop.barrel": (0.5, 0.5, 0.8)}),
        "atm": MappingProxyType({"static.prop.atm": (0.9, 0.6, 1.7)}),
        "kiosk": MappingProxyType({"static.prop.kiosk_01": (2.8, 2.4, 3.2)}),
        "iron_plate": MappingProxyType({"static.prop.ironplank": (0.8, 1.5, 0.05)}),
        "traffic_warning": MappingProxyType({"static.prop.trafficwarning": (2.9, 2.4, 3.6)}),
    }
)
"""Blueprints by category."""

_JOINED: Final = frozenset({"creased_box", "iron_plate", "plant_pot", "traffic_warning"})
"""Categories whose established names are not capitalised within."""


def _established(category: str) -> str:
    first, *rest = category.split("_")
    return first + "".join(rest if category in _JOINED else map(str.capitalize, rest)) + "Models"


_LISTS: Final = MappingProxyType({_established(category): category for category in CATALOGUE})

__all__ = ["CATALOGUE", "Size", "check_map", "dimension", "ids", "known_blueprint", *_LISTS]

_SIZES: Final = MappingProxyType({name: size for kind in CATALOGUE.values() for name, size in kind.items()})


def ids(category: str) -> tuple[str, ...]:
    """Return the ids of a category's blueprints.

    Raises `InvalidScenarioError` for a category that CARLA does not have.
    """
    if category not in CATALOGUE:
        similar_category = nearest(category, CATALOGUE)
        raise InvalidScenarioError(
            f"CARLA has no blueprints of the category {category!r}",
            span=here(),
            help=f"did you mean `{similar_category}`?"
            if similar_category
            else f"its categories are {', '.join(CATALOGUE)}",
        )
    return tuple(CATALOGUE[category])


def known_blueprint(blueprint: Any) -> Any:
    """Return the blueprint as it is, after a warning (SC405) if it has the form of an id and CARLA's catalogues do not have it."""
    context = current.get()
    for each in options_of(blueprint) or [blueprint]:
        if isinstance(each, str) and _ID.fullmatch(each) and each not in _SIZES:
            similar_id = nearest(each, _SIZES)
            warn(
                f"CARLA's catalogues have no blueprint {each!r}",
                code="SC405",
                span=None if context is None else context.own_place(),
                filename=None if context is None else context.filename,
                help=f"did you mean `{similar_id}`?"
                if similar_id
                else "take one of a list, such as `Uniform(*blueprints.carModels)`",
            )
    return blueprint


def check_map(carla_map: object, map_path: object) -> None:
    """Warn (SC620) if the name of CARLA's map is a town's, and the road map is the file of another one."""
    file = os.path.splitext(os.path.basename(str(map_path)))[0]
    if not isinstance(carla_map, str) or _town(carla_map) == _town(file) or not _TOWN.match(carla_map):
        return
    context = current.get()
    place, name = (
        (None, None) if context is None else context.parameters.places.get("carla_map", (None, None))
    )
    warn(
        f"the cars are placed on the roads of {os.path.basename(str(map_path))!r}, and CARLA is to load {carla_map!r}",
        code="SC620",
        span=place,
        filename=name,
        help=f"set `param carla_map = {file!r}`, or take the map of {carla_map}",
    )


def _town(name: str) -> str:
    """The name of a map without its folder, and without what marks its layered form."""
    return name.rpartition("/")[2].lower().removesuffix("_opt")


_SHOWN: Final = 8
"""Lists that a message names."""
_TOWN: Final = re.compile(r"(?:.*/)?Town\d\d", re.IGNORECASE)
_ID: Final = re.compile(r"(?:vehicle|walker\.pedestrian|static\.prop)\.[\w.-]+")


def dimension(blueprint: Any, axis: int, default: object) -> Any:
    """Return a size of a blueprint in metres (0 width, 1 length, 2 height); ``default`` for unknown ones.

    A random choice among blueprints gives the choice among their sizes.
    """
    if options_of(blueprint):
        return per_option(blueprint, lambda option: dimension(option, axis, default))
    if is_random(blueprint):
        return call_later(dimension, blueprint, axis, default)
    size = _SIZES.get(blueprint)
    return default if size is None else size[axis]


def __getattr__(name: str) -> tuple[str, ...]:
    """The established lists: ``carModels`` are the ids of the category ``car``, ``busStopModels`` those of ``bus_stop``."""
    if name in _LISTS:
        return ids(_LISTS[name])
    similar_list = nearest(name, _LISTS) if not name.startswith("__") else None
    raise AttributeError(
        f"there is no list of blueprints `{name}`"
        + (
            f": did you mean `{similar_list}`?"
            if similar_list
            else f"; there are {', '.join(list(_LISTS)[:_SHOWN])}, ..."
        )
        if not name.startswith("__")
        else f"module {__name__!r} has no attribute {name!r}"
    )
