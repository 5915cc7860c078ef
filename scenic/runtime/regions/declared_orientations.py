"""Promises of a program about regions that only the draw shows: whether they give what lies in them an orientation."""

import copy

from scenic.language.errors import InvalidScenarioError
from scenic.language.types import REGION
from scenic.runtime.ground.context import here
from scenic.runtime.regions.base import Region
from scenic.runtime.regions.choice import as_region
from scenic.runtime.regions.drawn import DrawnRegion
from scenic.runtime.values.generic import call_later
from scenic.runtime.values.values import Random, wrong_type

__all__ = ["orientedRegion", "unorientedRegion"]


def orientedRegion(region: object) -> Region:
    """Return a region, perhaps random, whose points have preferred orientations: `in` and `on` take them.

    Raises:
        InvalidScenarioError: if it is known to have none; of a random one in the samples that draw such a region.
        ScenicTypeError: if it is no region.

    """
    checked_region = _region(region, "`orientedRegion`")
    if isinstance(checked_region, DrawnRegion):
        return DrawnRegion(call_later(_oriented, checked_region.parameters[0]))
    return _oriented(checked_region)


def unorientedRegion(region: object) -> Region:
    """Return a region, perhaps random, from which `in` and `on` take only the position, even if it has preferred orientations.

    Raises:
        ScenicTypeError: if it is no region.

    """
    plain = copy.copy(_region(region, "`unorientedRegion`"))
    plain.orientation = None
    plain.has_orientation = False
    return plain


def _region(value: object, what: str) -> Region:
    known = as_region(value)
    if known is not None:
        return known
    if isinstance(value, Random):
        return DrawnRegion.of(value, what)
    raise wrong_type(REGION, value, what)


def _oriented(region: Region) -> Region:
    if not region.has_orientation:
        raise InvalidScenarioError(
            f"a region of the kind {type(region).__name__} has no preferred orientations",
            span=here(),
            help="give it a field: `orientation=field`",
        )
    return region
