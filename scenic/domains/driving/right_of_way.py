"""Right of way at intersections: ways that are taken, and ways that come first by the rules."""

import math
from functools import lru_cache
from typing import Any, Final

from scenic.dataclass import dataclass
from scenic.domains.driving.elements import Maneuver
from scenic.domains.driving.enumerations import ManeuverType
from scenic.domains.driving.network import RoadNetwork
from scenic.domains.driving.roundabouts import roundabouts

__all__ = ["Claim", "RightOfWay", "comes_first", "ways_meet"]

_WIDTH: Final = 2.4
"""Metres between the middles of two ways below which cars on them may touch."""
_TIME: Final = 3.5
"""Seconds after the own arrival within which a car with priority arrives that is let through."""
_PATIENCE: Final = 6.0
"""Seconds after which a car that waits goes before others that stand."""
_STALE: Final = 1.0


@dataclass(frozen=True, slots=True)
class Claim:
    """A car that comes to an intersection.

    Attributes:
        agent: the car.
        maneuver: its way.
        eta: seconds until it is there.
        since: the time at which it has begun to wait; infinite while it moves.
        at: the time of this claim.
        must_wait: a red light or a rule holds it.

    """

    agent: Any
    maneuver: Maneuver
    eta: float
    since: float
    at: float
    must_wait: bool


@lru_cache(maxsize=65536)
def ways_meet(one: Maneuver, other: Maneuver) -> bool:
    """Return whether cars on two ways through an intersection may touch; not for ways from one lane."""
    import shapely

    if one.startLane is other.startLane or one.connectingLane is None or other.connectingLane is None:
        return False
    lines = shapely.linestrings(one.connectingLane.line), shapely.linestrings(other.connectingLane.line)
    return bool(shapely.distance(*lines) < _WIDTH)


@lru_cache(maxsize=65536)
def comes_first(other: Maneuver, own: Maneuver) -> bool:
    """Return whether traffic on another way has priority over that on the own one.

    By signs; else that on the ring of a roundabout; else ways straight ahead and to the own side before those that turn across oncoming
    traffic; else from the right.
    """
    ranks = [_rank(maneuver) for maneuver in (other, own)]
    if ranks[0] != ranks[1]:
        return ranks[0] > ranks[1]
    network = own.startLane.network
    on_ring = [maneuver.startLane.road.uid in _roads_of_rings(network) for maneuver in (other, own)]
    if on_ring[0] != on_ring[1]:
        return on_ring[0]
    angle = _approach(other) - _approach(own)
    angle = (angle + math.pi) % (2 * math.pi) - math.pi
    if abs(angle) > math.radians(135):
        far = ManeuverType.RIGHT_TURN if network.driveOnLeft else ManeuverType.LEFT_TURN
        crosses = [maneuver.type in (far, ManeuverType.U_TURN) for maneuver in (other, own)]
        return crosses[1] and not crosses[0]
    if abs(angle) < math.radians(45):
        # Ways side by side: the one that keeps on comes first.
        return other.type is ManeuverType.STRAIGHT and own.type is not ManeuverType.STRAIGHT
    # Somebody who comes from the right drives to the left.
    return angle > 0


@lru_cache(maxsize=16)
def _roads_of_rings(network: RoadNetwork) -> frozenset[str]:
    """Return the ``uid`` of the roads that are rings of roundabouts."""
    return frozenset(lane.road.uid for ring in roundabouts(network) for lane in ring.lanes)


def _rank(maneuver: Maneuver) -> int:
    signals = maneuver.signals
    if any(signal.isStopSign for signal in signals):
        return 0
    return 1 if any(signal.isYieldSign for signal in signals) else 2


def _approach(maneuver: Maneuver) -> float:
    x, y = maneuver.startLane.line[-1] - maneuver.startLane.line[-2]
    return math.atan2(-x, y)


class RightOfWay:
    """The ways through intersections that cars of a simulation have taken, and the cars that come to intersections."""

    def __init__(self) -> None:
        self._taken: dict[str, dict[int, tuple[Any, Maneuver]]] = {}
        self._claims: dict[str, dict[int, Claim]] = {}

    def announce(self, claim: Claim) -> None:
        """Note a car that comes to an intersection."""
        assert claim.maneuver.intersection is not None
        self._claims.setdefault(claim.maneuver.intersection.uid, {})[id(claim.agent)] = claim

    def holds(self, agent: object, maneuver: Maneuver) -> bool:
        """Return whether a car has taken a way."""
        assert maneuver.intersection is not None
        own = self._taken.get(maneuver.intersection.uid, {}).get(id(agent))
        return own is not None and own[1] is maneuver

    def hold(self, agent: Any, maneuver: Maneuver) -> None:
        """Note the way of a car that is in an intersection, whoever else is there."""
        assert maneuver.intersection is not None
        self._taken.setdefault(maneuver.intersection.uid, {})[id(agent)] = agent, maneuver

    def take(self, claim: Claim, *, by_priority: bool = True) -> bool:
        """Take a way if it is free; return whether it is.

        Args:
            claim: the car and its way.
            by_priority: let those with priority go first.

        """
        intersection = claim.maneuver.intersection
        assert intersection is not None
        claims = self._taken.setdefault(intersection.uid, {})
        for key, (_, way) in claims.items():
            if key != id(claim.agent) and ways_meet(claim.maneuver, way):
                return False
        if by_priority:
            for key, other in self._claims.get(intersection.uid, {}).items():
                if key != id(claim.agent) and self._goes_before(other, claim):
                    return False
        claims[id(claim.agent)] = claim.agent, claim.maneuver
        return True

    def _goes_before(self, other: Claim, own: Claim) -> bool:
        if other.must_wait or other.at < own.at - _STALE or other.eta > own.eta + _TIME:
            return False
        if not ways_meet(own.maneuver, other.maneuver) or not comes_first(other.maneuver, own.maneuver):
            return False
        # Of cars that all wait for each other, the one that has waited longest goes.
        waited = own.at - own.since
        return not (other.since < math.inf and waited > _PATIENCE and own.since <= other.since)

    def leave(self, agent: object, maneuver: Maneuver) -> None:
        """Give a way back."""
        assert maneuver.intersection is not None
        self._taken.get(maneuver.intersection.uid, {}).pop(id(agent), None)
        self._claims.get(maneuver.intersection.uid, {}).pop(id(agent), None)
