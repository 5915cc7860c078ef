"""The world models and libraries that existing programs name, whether or not this installation has them."""

from typing import Final

from scenic.language.word_sets import word_set

__all__ = [
    "DRIVING_CLASSES",
    "DRIVING_NAMES",
    "FAMILIES",
    "LIBRARIES",
    "NEEDS_MAP",
    "ROAD_RULES",
    "how_to_get",
]

FAMILIES: Final = frozenset(
    {"scenic.contracts", "scenic.core", "scenic.formats", "scenic.gym", "scenic.syntax"}
)
"""Packages of other implementations; what is in them is their own affair."""

LIBRARIES: Final = word_set(
    "scenic.domains scenic.domains.driving scenic.domains.driving.actions "
    "scenic.domains.driving.behaviors scenic.domains.driving.controllers "
    "scenic.domains.driving.model scenic.domains.driving.roads scenic.domains.driving.simulators "
    "scenic.domains.driving.workspace scenic.simulators scenic.simulators.carla "
    "scenic.simulators.carla.actions scenic.simulators.carla.behaviors "
    "scenic.simulators.carla.blueprints scenic.simulators.carla.controller "
    "scenic.simulators.carla.model scenic.simulators.carla.simulator scenic.simulators.gta "
    "scenic.simulators.gta.interface scenic.simulators.gta.model scenic.simulators.lgsvl "
    "scenic.simulators.lgsvl.actions scenic.simulators.lgsvl.behaviors "
    "scenic.simulators.lgsvl.model scenic.simulators.lgsvl.simulator scenic.simulators.metadrive "
    "scenic.simulators.metadrive.model scenic.simulators.metadrive.simulator "
    "scenic.simulators.newtonian scenic.simulators.newtonian.driving_model "
    "scenic.simulators.newtonian.model scenic.simulators.newtonian.simulator scenic.simulators.sumo "
    "scenic.simulators.sumo.actions scenic.simulators.sumo.behaviors scenic.simulators.sumo.model "
    "scenic.simulators.sumo.simulator scenic.simulators.utils scenic.simulators.utils.colors "
    "scenic.simulators.webots scenic.simulators.webots.actions scenic.simulators.webots.guideways "
    "scenic.simulators.webots.guideways.intersection scenic.simulators.webots.guideways.model "
    "scenic.simulators.webots.mars.model scenic.simulators.webots.model "
    "scenic.simulators.webots.road scenic.simulators.webots.road.car_models "
    "scenic.simulators.webots.road.model scenic.simulators.webots.road.world "
    "scenic.simulators.webots.simulator scenic.simulators.xplane scenic.simulators.xplane.model"
)
"""The modules that worlds are commonly taken from."""


DRIVING_CLASSES: Final = frozenset({"Car", "DrivingObject", "NPCCar", "Pedestrian", "Vehicle"})
"""The classes of objects of the driving domain."""

DRIVING_NAMES: Final = DRIVING_CLASSES | {
    "DriveAvoidingCollisions",
    "FollowLaneBehavior",
    "FollowTrajectoryBehavior",
    "LaneChangeBehavior",
    "ManeuverType",
    "SetBrakeAction",
    "SetSteerAction",
    "SetThrottleAction",
    "TurnBehavior",
    "WalkForwardBehavior",
    "curb",
    "intersection",
    "network",
    "road",
    "roadDirection",
    "roadOrShoulder",
    "sidewalk",
    "withinDistanceToAnyCars",
    "withinDistanceToAnyObjs",
    "withinDistanceToObjsInLane",
}
"""Names of the driving domain that programs use most."""

ROAD_RULES: Final = ("speed_limits", "signals", "signs", "priority", "pedestrians", "gaps")
"""Names of the rules of the road that `DriveByRulesBehavior` can be told to ignore."""

NEEDS_MAP: Final = word_set(
    "scenic.domains.driving.model scenic.simulators.carla.model scenic.simulators.lgsvl.model "
    "scenic.simulators.metadrive.model scenic.simulators.newtonian.driving_model "
    "scenic.simulators.sumo.model"
)
"""World models that read the parameter `map` while they are loaded."""


def how_to_get(model: str) -> str:
    """Return advice on a world model that was not found."""
    if model in LIBRARIES:
        folders = model.rpartition(".")[0].replace(".", "/")
        return (
            f"this package does not have it: copy its files to `{folders}` beside the program, or take another model "
            "(`--model scenic.simulators.newtonian.model`)"
        )
    package, dot, _ = model.partition(".")
    if not dot:
        return "a model is a .scenic file beside the program or on Python's path"
    return f"install the package that `{package}` belongs to, or copy the model's files beside the program"
